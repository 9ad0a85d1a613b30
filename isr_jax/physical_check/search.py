"""The search for a choice in which nothing clashes."""

from __future__ import annotations

import numpy as np

from .arrangement import Arrangement, Clash, option_or_scan, seat_m
from .min_conflicts import Depth, min_conflicts
from .options import Candidates, Option
from .problem import CheckProblem
from .things import Thing

_Pair = tuple[int, int]
"""Two choices, the smaller first: the row of an option, or `_scan_of`."""


class Search:
    """Rounds of min-conflicts, seating and falling back to scans, until nothing clashes.

    Most candidates are never chosen, so they are judged by hulls that are quick to make, and only
    what is certain counts against them. A model that is chosen gets the hulls that are written, and
    the search goes on: what it returns was judged by those alone.
    """

    def __init__(self, problem: CheckProblem, candidates: Candidates) -> None:
        self.problem, self.candidates = problem, candidates
        self.fallen: dict[int, str] = {}
        """Entities whose scan stays because of a conflict, and that conflict."""
        self.tried: dict[int, Option] = {}
        """Options by their row, those of fallen entities included."""
        self.reasons: dict[int, str] = {}
        """Against rows that are no option."""
        self._overlap: dict[_Pair, float] = {}
        self._stuck: set[_Pair] = set()
        self._depth: dict[_Pair, float] = {}
        self._judge(range(len(candidates.shortlist.entity)))

    def run(self) -> Arrangement:
        """The final arrangement; each round makes hulls, learns a conflict or takes one out."""
        while True:
            arrangement = Arrangement(self.problem, self._choose())
            rough = [o for o in arrangement.chosen.values() if not o.as_written]
            if rough:
                self._judge(self.candidates.write(rough))
                continue
            stuck = arrangement.part(set(self.fallen))
            if stuck is None:
                return arrangement
            if not self._learn(arrangement, stuck):
                self._give_way(arrangement, stuck)

    def _judge(self, rows: range | list[int]) -> None:
        """Take rows as options, or again where their hulls have changed."""
        again = set(rows)
        options, reasons = self.candidates.options(list(rows))
        for row in again:
            self.tried.pop(row, None)
            self.reasons.pop(row, None)
        self.tried |= {option.row: option for option in options}
        self.reasons |= reasons
        for known in (self._overlap, self._depth):
            for pair in [p for p in known if again & set(p)]:
                del known[pair]

    def _choices(self, active: list[int]) -> list[list[Option | None]]:
        """Options of each entity in the order of the shortlist; without any, its scan alone."""
        of_one: dict[int, list[Option | None]] = {i: [] for i in active}
        for row in sorted(self.tried):
            of_one.get(self.candidates.owner(row), []).append(self.tried[row])
        return [of_one[i] or [None] for i in active]

    def _choose(self) -> dict[int, Option]:
        active = [i for i in self.problem.positions if i not in self.fallen]
        choices = self._choices(active)
        chosen = min_conflicts(
            [np.array([o.cost_m if o is not None else 0.0 for o in of_one]) for of_one in choices],
            self._neighbours(active, choices),
            self._depth_of(active, choices),
            tolerance_m=self.problem.settings.max_nudge_m,
            max_rounds=self.problem.settings.max_rounds,
            seed=self.problem.settings.seed,
        )
        taken = {i: of_one[a] for i, of_one, a in zip(active, choices, chosen, strict=True)}
        return {i: option for i, option in taken.items() if option is not None}

    def _neighbours(self, active: list[int], choices: list[list[Option | None]]) -> list[list[int]]:
        """Pairs of which any two choices come near each other."""
        low, high = [], []
        for i, of_one in zip(active, choices):
            things = [option_or_scan(self.problem, i, option) for option in of_one]
            low.append(np.min([t.low for t in things], 0))
            high.append(np.max([t.high for t in things], 0))
        lows, highs = np.reshape(low, (-1, 3)), np.reshape(high, (-1, 3))
        reach_m = self.problem.settings.child_height_tolerance_m
        near = np.all(lows[:, None] <= highs + reach_m, axis=2)
        near &= near.T
        np.fill_diagonal(near, False)
        model = np.array([of_one[0] is not None for of_one in choices], bool)
        near &= model[:, None] | model
        return [np.flatnonzero(row).tolist() for row in near]

    def _depth_of(self, active: list[int], choices: list[list[Option | None]]) -> Depth:
        """`depth` of choices by their places in these lists; it is asked a million times."""
        name = [[_name(i, option) for option in of_one] for i, of_one in zip(active, choices)]

        def depth(i: int, a: int, j: int, b: int) -> float:
            one, two = name[i][a], name[j][b]
            pair = (one, two) if one < two else (two, one)
            found = self._depth.get(pair)
            if found is None:
                found = self.depth_m(active[i], choices[i][a], active[j], choices[j][b])
                self._depth[pair] = found
            return found

        return depth

    def depth_m(self, i: int, a: Option | None, j: int, b: Option | None) -> float:
        """`overlap_m`, deeper by the longest sideways move where no such move ends it."""
        depth_m, farthest_m = self.overlap_m(i, a, j, b), self.problem.settings.max_nudge_m
        if not 0 < depth_m <= farthest_m:
            return depth_m
        return depth_m + (0.0 if self._can_end(i, a, j, b) else farthest_m)

    def _can_end(self, i: int, a: Option | None, j: int, b: Option | None) -> bool:
        """Whether a small sideways move may end an overlap, or export cuts what overlaps."""
        one, two = self._seated(i, a, j, b), self._seated(j, b, i, a)
        if a is None or b is None:
            return self.problem.cut_later(i, one, j, two)
        if _pair(i, a, j, b) in self._stuck:
            return False
        if not (a.as_written and b.as_written):
            return True  # how far they overlap is not known
        overlap = self.problem.overlap(i, one, j, two)
        return overlap is None or overlap.way_out()[0] <= self.problem.settings.max_nudge_m

    def overlap_m(self, i: int, a: Option | None, j: int, b: Option | None) -> float:
        """Depth to which two choices overlap too much, 0 where they do not."""
        pair = _pair(i, a, j, b)
        if pair not in self._overlap:
            one, two = self._seated(i, a, j, b), self._seated(j, b, i, a)
            self._overlap[pair] = self.problem.excess(i, one, j, two)
        return self._overlap[pair]

    def _seated(self, i: int, own: Option | None, j: int, other: Option | None) -> Thing:
        """What stands for i: on j's model if that carries it, else where it was observed."""
        thing = option_or_scan(self.problem, i, own)
        if not self.problem.tree.stands_on(i, j):
            return thing
        return thing.moved(seat_m(self.problem, i, own, other))

    def _learn(self, arrangement: Arrangement, clash: Clash) -> bool:
        """Keep a clash that no small move ended; False where it was known when it was chosen."""
        one, two = arrangement.chosen.get(clash.a), arrangement.chosen.get(clash.b)
        pair = _pair(clash.a, one, clash.b, two)
        counted_m = self.depth_m(clash.a, one, clash.b, two)
        fresh = counted_m <= self.problem.settings.max_nudge_m
        self._stuck.add(pair)
        self._overlap[pair] = clash.depth_m
        self._depth.pop(pair, None)
        return fresh

    def _give_way(self, arrangement: Arrangement, clash: Clash) -> None:
        """The less firm of two keeps its scan: a book does not cost its shelf the model."""
        models = [i for i in (clash.a, clash.b) if i in arrangement.chosen]
        carried = [i for i in models if {clash.a, clash.b} & set(self.problem.tree.carriers(i))]
        loser = min(carried or models, key=arrangement.firmness)
        winner = clash.b if loser == clash.a else clash.a
        self.fallen[loser] = collision(self.problem.entities[winner].name, clash.depth_m)


def _name(i: int, option: Option | None) -> int:
    """A choice by a number: the row of an option, one below 0 for a scan."""
    return option.row if option is not None else -1 - i


def _pair(i: int, a: Option | None, j: int, b: Option | None) -> _Pair:
    one, two = _name(i, a), _name(j, b)
    return (one, two) if one < two else (two, one)


def collision(name: str, depth_m: float) -> str:
    """The reason against a candidate that overlaps something."""
    return f"collides with {name} by {depth_m:.3f} m"
