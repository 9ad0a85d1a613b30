"""What the check starts from, and which overlaps count."""

from __future__ import annotations

from collections.abc import Mapping

from ..config import PhysicalCheckSettings
from ..geometry.placed_solids import PartOverlap, PlacedSolid, deepest_overlap
from ..geometry.standing import SupportTree
from ..types import ContactGraph, Entities
from .layout import layout_planes
from .things import ScanPoints, Thing, depth_between, scan_points


class CheckProblem:
    """What does not change while options are tried."""

    def __init__(
        self, entities: Entities, graph: ContactGraph, settings: PhysicalCheckSettings
    ) -> None:
        self.entities, self.graph, self.settings = entities, graph, settings
        self.tree = SupportTree(graph.parent)
        self.walls = [plane for plane in layout_planes(entities) if not plane.level]
        self.positions = [i for i in range(len(entities)) if not entities[i].is_layout]
        """Of all things, in the entities."""
        self.scans: Mapping[int, ScanPoints] = {
            i: scan_points(entities[i].mesh.vertices, self.support_m(i)) for i in self.positions
        }

    def support_m(self, i: int) -> float:
        """Height of what carries a thing; of its own bottom where nothing does."""
        return float(self.graph.support_height_m[i])

    def carried(self, i: int) -> bool:
        """Whether anything carries a thing."""
        return bool(self.graph.parent[i] >= 0)

    def excess(self, i: int, a: Thing, j: int, b: Thing) -> float:
        """Depth of overlap of ``a`` for i and ``b`` for j where it is more than tolerated, else 0.

        Of a thing and what carries it, contact at the carrying plane does not count.
        """
        if self.tree.stands_on(j, i):
            i, a, j, b = j, b, i, a
        depth_m = depth_between(a, b, carried=self.tree.stands_on(i, j))
        scanned = isinstance(a, ScanPoints) or isinstance(b, ScanPoints)
        settings = self.settings
        limit_m = settings.scan_tolerance_m if scanned else settings.penetration_tolerance_m
        return depth_m if depth_m > limit_m else 0.0

    def overlap(self, i: int, a: Thing, j: int, b: Thing) -> PartOverlap | None:
        """The deepest overlap of ``a`` for i with ``b`` for j that is not contact, of models."""
        if isinstance(a, ScanPoints) or isinstance(b, ScanPoints):
            return None
        if not self.tree.stands_on(j, i):
            return deepest_overlap(a, b, carried=self.tree.stands_on(i, j))
        found = deepest_overlap(b, a, carried=True)
        return PartOverlap(found.depth_m, found.other, found.part) if found is not None else None

    def cut_later(self, i: int, a: Thing, j: int, b: Thing) -> bool:
        """Whether one is a kept scan on the other's model: export cuts such a scan, so it does not
        cost its carrier the model."""
        if self.tree.stands_on(j, i):
            i, a, j, b = j, b, i, a
        return (
            self.tree.stands_on(i, j) and isinstance(a, ScanPoints) and isinstance(b, PlacedSolid)
        )
