"""A choice of options as it stands: children re-seated, conflicts found, small ones nudged away."""

from __future__ import annotations

import dataclasses

import numpy as np

from ..classes import class_named
from ..config import PhysicalCheckSettings
from ..types import ContactGraph, Entities
from .layout import depth_through, layout_planes
from .options import Option, observed_support
from .solids import ScanPoints, Solid, apart, deepest, depth_between

_NUDGES = 10
_LEVEL = 0.5
"""Least horizontal share of a direction out: others would lift a thing off its support."""


@dataclasses.dataclass(frozen=True)
class Clash:
    """Two things that overlap by more than is tolerated."""

    depth_m: float
    a: int
    b: int


class Scene:
    """What does not change while options are tried."""

    def __init__(
        self,
        entities: Entities,
        graph: ContactGraph,
        scans: dict[int, ScanPoints],
        settings: PhysicalCheckSettings,
    ) -> None:
        self.entities, self.graph, self.settings = entities, graph, settings
        self.scans = scans
        self.walls = [plane for plane in layout_planes(entities) if not plane.level]
        self.solid_things = [i for i in range(len(entities)) if not entities[i].is_layout]
        self.support = {i: observed_support(entities, graph, i) for i in self.solid_things}

    def exempt(self, a: int, b: int) -> bool:
        """What carries one another touches."""
        return bool(self.graph.parent[a] == b or self.graph.parent[b] == a)

    def excess(self, a: Solid | ScanPoints, b: Solid | ScanPoints) -> float:
        """Depth of overlap where it is more than tolerated, else 0."""
        depth = depth_between(a, b)
        scanned = isinstance(a, ScanPoints) or isinstance(b, ScanPoints)
        settings = self.settings
        limit = settings.scan_tolerance_m if scanned else settings.penetration_tolerance_m
        return depth if depth > limit else 0.0

    def depth_in_tree(self, i: int) -> int:
        """Number of entities below one."""
        count = 0
        while (i := int(self.graph.parent[i])) >= 0:
            count += 1
        return count


class Arrangement:
    """Every thing of a scene at its place under one choice of options."""

    def __init__(self, scene: Scene, chosen: dict[int, Option]) -> None:
        self.scene, self.chosen = scene, chosen
        self.step = {i: np.zeros(3) for i in scene.solid_things}
        self._seat()

    def _seat(self) -> None:
        """Top-down, each child onto the plane of its parent's model that carries it."""
        graph, clearance = self.scene.graph, self.scene.settings.clearance_m
        for i in sorted(self.scene.solid_things, key=self.scene.depth_in_tree):
            parent = int(graph.parent[i])
            option = self.chosen.get(parent)
            support = self.scene.support[i]
            if parent < 0 or support is None or parent not in self.step:
                continue
            height = self.step[parent][2]
            planes = option.carrying_m.get(i) if option is not None else None
            heights = np.array(planes or [support])
            height += heights[np.argmin(np.abs(heights - support))]
            own = self.chosen.get(i)
            bottom = own.solid.low[2] - clearance if own is not None else support
            self.step[i] = np.array([0.0, 0.0, height - bottom])

    def thing(self, i: int) -> Solid | ScanPoints:
        """The solid or scan of an entity where it stands."""
        if i in self.chosen:
            return self.solid(i)
        return ScanPoints(self.scene.scans[i].points + self.step[i])

    def solid(self, i: int) -> Solid:
        """The model of an entity where it stands."""
        return self.chosen[i].solid.moved(self.step[i])

    def clashes(self, fallen: set[int], only: int | None = None) -> list[Clash]:
        """Pairs that overlap too much, deepest first; scans of ``fallen`` entities yield."""
        things = {i: self.thing(i) for i in self.scene.solid_things if i not in fallen}
        pairs = [(a, b) for a in things for b in things if a < b and only in (None, a, b)]
        found = [
            Clash(depth, a, b)
            for a, b in pairs
            if not self.scene.exempt(a, b)
            and not apart(things[a], things[b])
            and (depth := self.scene.excess(things[a], things[b])) > 0
        ]
        return sorted(found, key=lambda c: -c.depth_m)

    def subtree(self, i: int) -> list[int]:
        """The entity and all that stands on it."""
        below = [i]
        for p in below:
            below += self.scene.graph.children(p).tolist()
        return below

    def part(self, fallen: set[int]) -> Clash | None:
        """Move models sideways out of one another, in place; undone, with the clash that stays."""
        before = {i: step.copy() for i, step in self.step.items()}
        clashes = first = self.clashes(fallen)
        for _ in range(_NUDGES):
            if not clashes:
                return None
            if not self._nudge_apart(clashes[0], before):
                break
            clashes = self.clashes(fallen)
        self.step = before
        known = {(c.a, c.b): c for c in first}
        return known.get((clashes[0].a, clashes[0].b), clashes[0]) if clashes else None

    def _nudge_apart(self, clash: Clash, before: dict[int, np.ndarray]) -> bool:
        """Move the less firm of two with all that it carries, or the other where that fails."""
        movers = [i for i in (clash.a, clash.b) if i in self.chosen]
        if len(movers) < 2:
            return False
        loose, firm = sorted(movers, key=self.firmness)
        return self._nudge(loose, firm, before) or self._nudge(firm, loose, before)

    def _nudge(self, i: int, other: int, before: dict[int, np.ndarray]) -> bool:
        depth, direction = deepest(self.solid(i), self.solid(other))
        level = float(np.linalg.norm(direction[:2]))
        if level < _LEVEL:
            return False
        length = depth / level + self.scene.settings.clearance_m
        step = np.append(direction[:2] / level * length, 0.0)
        far = np.linalg.norm((self.step[i] + step - before[i])[:2])
        if far > self.scene.settings.max_nudge_m or self._in_a_wall(i, step):
            return False
        for k in self.subtree(i):
            self.step[k] = self.step[k] + step
        return True

    def _in_a_wall(self, i: int, step: np.ndarray) -> bool:
        """Whether a step leads into a wall; where a thing was in one already was accepted."""
        here, limit = self.solid(i), self.scene.settings.penetration_tolerance_m
        there = here.moved(step)
        return any(
            depth_through(there, plane)[0] > max(depth_through(here, plane)[0], limit)
            for plane in self.scene.walls
        )

    def firmness(self, i: int) -> tuple[bool, float]:
        """Furniture that stands fixed yields last; of the rest, what fits best."""
        movable = class_named(self.scene.entities[i].class_name).movable
        return not movable, -self.chosen[i].cost_m
