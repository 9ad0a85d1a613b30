"""The search for a choice in which nothing clashes."""

from __future__ import annotations

import numpy as np

from .arrangement import Arrangement, Clash, Scene
from .min_conflicts import min_conflicts
from .options import Option
from .solids import ScanPoints, Solid

_Key = tuple[int, int, int, int]


class Search:
    """Rounds of min-conflicts, seating and falling back to scans, until nothing clashes."""

    def __init__(self, scene: Scene, options: dict[int, list[Option]]) -> None:
        self.scene, self.options, self.tried = scene, dict(options), options
        self.fallen: dict[int, str] = {}
        """Entities whose scan stays because of a conflict, and that conflict."""
        self._overlap: dict[_Key, float] = {}
        self._stuck: set[_Key] = set()

    def run(self) -> Arrangement:
        """The final arrangement; each round learns a conflict or takes an entity out."""
        while True:
            arrangement = Arrangement(self.scene, self._choose())
            stuck = arrangement.part(set(self.fallen))
            if stuck is None:
                return arrangement
            if not self._learn(arrangement, stuck):
                self._give_way(arrangement, stuck)

    def _choose(self) -> dict[int, Option]:
        active = [i for i in self.scene.solid_things if i not in self.fallen]
        # A kept scan takes part with the one option that it has.
        errors = [
            np.array([o.cost_m for o in self.options[i]]) if i in self.options else np.zeros(1)
            for i in active
        ]
        chosen = min_conflicts(
            errors,
            self._neighbours(active),
            lambda i, a, j, b: self.depth(active[i], a, active[j], b),
            tolerance_m=self.scene.settings.max_nudge_m,
            max_rounds=self.scene.settings.max_rounds,
            seed=self.scene.settings.seed,
        )
        return {
            i: self.options[i][a] for i, a in zip(active, chosen, strict=True) if i in self.options
        }

    def _thing(self, i: int, a: int) -> Solid | ScanPoints:
        return self.tried[i][a].solid if i in self.tried else self.scene.scans[i]

    def _neighbours(self, active: list[int]) -> list[list[int]]:
        """Pairs of which any two options come near each other."""
        low, high = {}, {}
        for i in active:
            things = [self._thing(i, a) for a in range(len(self.options.get(i, [0])))]
            low[i] = np.min([t.low for t in things], 0)
            high[i] = np.max([t.high for t in things], 0)
        reach = self.scene.settings.child_height_tolerance_m
        return [
            [
                k
                for k, j in enumerate(active)
                if j != i
                and not self.scene.exempt(i, j)
                and (i in self.options or j in self.options)
                and np.all(low[i] <= high[j] + reach)
                and np.all(low[j] <= high[i] + reach)
            ]
            for i in active
        ]

    def depth(self, i: int, a: int, j: int, b: int) -> float:
        """`overlap`, deeper by the longest sideways move where no such move ends it."""
        depth, key = self.overlap(i, a, j, b), _key(i, a, j, b)
        scanned = i not in self.tried or j not in self.tried
        fixed = depth > 0 and (scanned or key in self._stuck)
        return depth + (self.scene.settings.max_nudge_m if fixed else 0.0)

    def overlap(self, i: int, a: int, j: int, b: int) -> float:
        """Depth to which option a of i and option b of j overlap too much, 0 where they do not."""
        key = _key(i, a, j, b)
        if key not in self._overlap:
            self._overlap[key] = self.scene.excess(self._thing(i, a), self._thing(j, b))
        return self._overlap[key]

    def _learn(self, arrangement: Arrangement, clash: Clash) -> bool:
        """Keep a clash that no small move ended; False where it was known."""
        a, b = self.index(arrangement, clash.a), self.index(arrangement, clash.b)
        key = _key(clash.a, a, clash.b, b)
        fresh = key not in self._stuck
        self._stuck.add(key)
        self._overlap[key] = clash.depth_m
        return fresh

    def index(self, arrangement: Arrangement, i: int) -> int:
        """Which of its options a thing has; scans have one."""
        return self.tried[i].index(arrangement.chosen[i]) if i in arrangement.chosen else 0

    def _give_way(self, arrangement: Arrangement, clash: Clash) -> None:
        """The less firm of two keeps its scan: a book does not cost its shelf the model."""
        models = [i for i in (clash.a, clash.b) if i in arrangement.chosen]
        loser = min(models, key=arrangement.firmness)
        winner = clash.b if loser == clash.a else clash.a
        self.fallen[loser] = collision(self.scene.entities[winner].name, clash.depth_m)
        del self.options[loser]


def _key(i: int, a: int, j: int, b: int) -> _Key:
    return (i, a, j, b) if i < j else (j, b, i, a)


def collision(name: str, depth_m: float) -> str:
    """The reason against a candidate that overlaps something."""
    return f"collides with {name} by {depth_m:.3f} m"
