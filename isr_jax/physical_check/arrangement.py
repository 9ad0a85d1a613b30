"""A choice of options as it stands: children re-seated, conflicts found, small ones nudged away."""

from __future__ import annotations

import dataclasses

import numpy as np
from jaxtyping import Float

from ..classes import class_named
from ..geometry.placed_solids import PlacedSolid
from ..geometry.standing import StandingThings
from .layout import depth_through
from .options import Option
from .problem import CheckProblem
from .things import Thing, boxes_apart

_NUDGES = 10


@dataclasses.dataclass(frozen=True)
class Clash:
    """Two things that overlap by more than is tolerated."""

    depth_m: float
    a: int
    b: int


def option_or_scan(problem: CheckProblem, i: int, option: Option | None) -> Thing:
    """What stands for an entity: the model of an option, or the kept scan."""
    return option.solid if option is not None else problem.scans[i]


def seat_m(
    problem: CheckProblem, i: int, own: Option | None, carrier: Option | None
) -> Float[np.ndarray, "3"]:
    """The step of a carried thing onto the plane of its carrier's model that is nearest to the one
    that was observed; none where the carrier keeps its scan."""
    support_m = problem.support_m(i)
    heights = np.array(carrier.carrying_m[i] if carrier is not None else [support_m])
    height_m = heights[np.argmin(np.abs(heights - support_m))]
    clearance_m = problem.settings.clearance_m if own is not None else 0.0
    bottom_m = option_or_scan(problem, i, own).bottom_m - clearance_m
    return np.array([0.0, 0.0, height_m - bottom_m])


class Arrangement:
    """Every thing of a scene at its place under one choice of options."""

    def __init__(self, problem: CheckProblem, chosen: dict[int, Option]) -> None:
        self.problem, self.chosen = problem, chosen
        placed = {i: option_or_scan(problem, i, chosen.get(i)) for i in problem.positions}
        standing = StandingThings(problem.tree, placed)
        self._seat(standing)
        self.seat_m = standing.shift_m
        """Of each thing, from its option's place."""
        self._standing = StandingThings(problem.tree, standing.things)

    def _seat(self, standing: StandingThings) -> None:
        """Top-down, each child onto the plane of its parent's model that carries it."""
        for i in self.problem.tree.top_down(self.problem.positions):
            carrier = int(self.problem.graph.parent[i])
            if carrier in standing.things:
                step = seat_m(self.problem, i, self.chosen.get(i), self.chosen.get(carrier))
                standing.move(i, step)

    def step_m(self, i: int) -> Float[np.ndarray, "3"]:
        """From the place of a thing's option to where it stands."""
        return self.seat_m[i] + self._standing.shift_m[i]

    def clashes(self, fallen: set[int]) -> list[Clash]:
        """Pairs that overlap too much, deepest first; scans of ``fallen`` entities yield."""
        things = {i: t for i, t in self._standing.things.items() if i not in fallen}
        found = [
            Clash(depth, a, b)
            for a in things
            for b in things
            if a < b
            and not boxes_apart(things[a], things[b])
            and not self.problem.cut_later(a, things[a], b, things[b])
            and (depth := self.problem.excess(a, things[a], b, things[b])) > 0
        ]
        return sorted(found, key=lambda c: -c.depth_m)

    def part(self, fallen: set[int]) -> Clash | None:
        """Move models sideways out of one another, in place; undone, with the clash that stays."""
        before = self._standing.places()
        clashes = first = self.clashes(fallen)
        for _ in range(_NUDGES):
            if not clashes:
                return None
            if not self._nudge_apart(clashes[0]):
                break
            clashes = self.clashes(fallen)
        self._standing.put_back(before)
        known = {(c.a, c.b): c for c in first}
        return known.get((clashes[0].a, clashes[0].b), clashes[0]) if clashes else None

    def _nudge_apart(self, clash: Clash) -> bool:
        """Move the less firm of two with all that it carries, or the other where that fails."""
        movers = [i for i in (clash.a, clash.b) if i in self.chosen]
        if len(movers) < 2:
            return False
        loose, firm = sorted(movers, key=self.firmness)
        return self._nudge(loose, firm) or self._nudge(firm, loose)

    def _nudge(self, i: int, other: int) -> bool:
        if i in self.problem.tree.carriers(other):
            return False  # the other comes along
        overlap = self.problem.overlap(
            i, self._standing.things[i], other, self._standing.things[other]
        )
        if overlap is None:
            return False
        settings = self.problem.settings
        step = self._standing.step_out(
            i, overlap, gap_m=settings.clearance_m, farthest_m=settings.max_nudge_m
        )
        if step is None or self._in_a_wall(i, step):
            return False
        self._standing.move(i, step)
        return True

    def _in_a_wall(self, i: int, step_m: Float[np.ndarray, "3"]) -> bool:
        """Whether a step leads into a wall; where a thing was in one already was accepted."""
        here, limit_m = self._standing.things[i], self.problem.settings.penetration_tolerance_m
        assert isinstance(here, PlacedSolid)
        there = here.moved(step_m)
        return any(
            depth_through(there, plane)[0] > max(depth_through(here, plane)[0], limit_m)
            for plane in self.problem.walls
        )

    def firmness(self, i: int) -> tuple[bool, float]:
        """Furniture that stands fixed yields last; of the rest, what fits best."""
        movable = class_named(self.problem.entities[i].class_name).movable
        return not movable, -self.chosen[i].cost_m
