"""The search for a choice in which nothing clashes."""

from __future__ import annotations

import numpy as np

from .arrangement import Arrangement, Clash, Scene
from .min_conflicts import min_conflicts
from .options import Option
from .solids import ScanPoints, Solid


class Search:
    """Rounds of min-conflicts, seating and falling back to scans, until nothing clashes."""

    def __init__(self, scene: Scene, options: dict[int, list[Option]]) -> None:
        self.scene, self.options, self.tried = scene, dict(options), options
        self.fallen: dict[int, str] = {}
        """Entities whose scan stays because of a conflict, and that conflict."""
        self._excess: dict[tuple[int, int, int, int], float] = {}
        self._known: set[tuple[int, int, int, int]] = set()

    def run(self) -> Arrangement:
        """The final arrangement. Each round learns a conflict or takes an entity out."""
        while True:
            arrangement = Arrangement(self.scene, self._choose())
            clashes = arrangement.clashes(set(self.fallen))
            if not clashes:
                return arrangement
            if self._learn(arrangement, clashes):
                continue
            if self.scene.settings.max_nudge_m > 0 and arrangement.nudge(set(self.fallen)):
                return arrangement
            self._give_way(arrangement, clashes[0])

    def _choose(self) -> dict[int, Option]:
        active = [i for i in self.scene.solid_things if i not in self.fallen]
        # A kept scan takes part with the one option that it has.
        errors = [np.array([o.error_m for o in self.options[i]]) if i in self.options
                  else np.zeros(1) for i in active]  # fmt: skip
        chosen = min_conflicts(
            errors,
            self._neighbours(active),
            lambda i, a, j, b: self.conflict(active[i], a, active[j], b),
            max_rounds=self.scene.settings.max_rounds,
            seed=self.scene.settings.seed,
        )
        return {i: self.options[i][a] for i, a in zip(active, chosen, strict=True)
                if i in self.options}  # fmt: skip

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

    def conflict(self, i: int, a: int, j: int, b: int) -> float:
        """Depth to which option a of i and option b of j overlap too much, 0 where they do not."""
        key = (i, a, j, b) if i < j else (j, b, i, a)
        if key not in self._excess:
            self._excess[key] = self.scene.excess(self._thing(i, a), self._thing(j, b))
        return self._excess[key]

    def _learn(self, arrangement: Arrangement, clashes: list[Clash]) -> bool:
        """Keep conflicts that only show once children are seated; False where all are known."""
        fresh = False
        for clash in clashes:
            key = (clash.a, self.index(arrangement, clash.a),
                   clash.b, self.index(arrangement, clash.b))  # fmt: skip
            fresh |= key not in self._known
            self._known.add(key)
            self._excess[key] = clash.depth_m
        return fresh

    def index(self, arrangement: Arrangement, i: int) -> int:
        """Which of its options a thing has; scans have one."""
        return self.tried[i].index(arrangement.chosen[i]) if i in arrangement.chosen else 0

    def _give_way(self, arrangement: Arrangement, clash: Clash) -> None:
        models = [i for i in (clash.a, clash.b) if i in arrangement.chosen]
        loser = max(models, key=lambda i: arrangement.chosen[i].error_m)
        winner = clash.b if loser == clash.a else clash.a
        self.fallen[loser] = collision(self.scene.entities[winner].name, clash.depth_m)
        del self.options[loser]


def collision(name: str, depth_m: float) -> str:
    """The reason against a candidate that overlaps something."""
    return f"collides with {name} by {depth_m:.3f} m"
