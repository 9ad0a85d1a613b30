"""What may stand for an entity: a placed model, or its kept scan; and how deep two overlap."""

from __future__ import annotations

import dataclasses
import functools

import numpy as np
from jaxtyping import Float

from ..errors import LibraryError
from ..geometry import ConvexPart, convex_part, depth_inside, moved_part
from ..geometry.placed_solids import CONTACT_LIFT_M, PlacedSolid, deepest_overlap
from ..library import CadModel
from ..robot_model import link_transforms

_STRAY_POINTS = 8
_STRAY_SHARE = 0.02
"""So many points of a scan may lie deeper in a model than the depth that counts: segmentation
bleeds over edges."""
_MAX_SCAN_POINTS = 4096


@dataclasses.dataclass(frozen=True, eq=False)
class ScanPoints:
    """A kept scan: its surface points, world frame. A scan is open, so it has no inside."""

    points: Float[np.ndarray, "points 3"]
    bottom_m: float = -np.inf
    """Height at which it stands: that of its support, for a scan's own lowest points are noise."""

    @functools.cached_property
    def low(self) -> Float[np.ndarray, "3"]:
        return self.points.min(0)

    @functools.cached_property
    def high(self) -> Float[np.ndarray, "3"]:
        return self.points.max(0)

    def moved(self, step_m: Float[np.ndarray, "3"]) -> ScanPoints:
        """The same scan, shifted."""
        if not np.any(step_m):
            return self
        return ScanPoints(self.points + step_m, self.bottom_m + float(step_m[2]))


Thing = PlacedSolid | ScanPoints


@functools.lru_cache(maxsize=1024)
def model_parts(model: CadModel) -> tuple[ConvexPart, ...]:
    """Collision hulls of a model in its canonical frame, joints closed.

    Raises:
        LibraryError: the model has none.
    """
    T_model_link = link_transforms(model.robot)
    parts = tuple(
        moved_part(convex_part(np.asarray(hull.vertices, np.float64)), T_model_link[link.name])
        for link in model.robot.links
        for hull in link.hulls
    )
    if not parts:
        raise LibraryError(
            f"{model.id} has no collision hulls", "open the library with `isr_jax.load_library`"
        )
    return parts


def solid_of(
    parts: tuple[ConvexPart, ...],
    T_world_cad: Float[np.ndarray, "4 4"],
    scale: float,
    swelling_m: float = 0.0,
) -> PlacedSolid:
    """The placed solid of a model's parts, which reach ``swelling_m`` too far before scaling."""
    moved = tuple(moved_part(part, T_world_cad, scale) for part in parts)
    return PlacedSolid(moved, scale * swelling_m)


def scan_points(vertices: Float[np.ndarray, "points 3"], bottom_m: float = -np.inf) -> ScanPoints:
    """Surface points of a scan, at most some thousands, evenly spread over their order."""
    count = min(len(vertices), _MAX_SCAN_POINTS)
    rows = np.linspace(0, len(vertices) - 1, count).astype(int)
    return ScanPoints(np.asarray(vertices, np.float64)[rows], bottom_m)


def boxes_apart(a: Thing, b: Thing) -> bool:
    """Whether the axis-aligned boxes of two things are apart."""
    return bool(np.any(a.low > b.high) or np.any(b.low > a.high))


def depth_between(a: Thing, b: Thing, *, carried: bool = False) -> float:
    """Depth of overlap that is certain, metres; 0 where they may be apart.

    Hulls that may reach too far count for that much less. Two scans never overlap: both were seen
    where they are.

    Args:
        a: A thing.
        b: Another one.
        carried: ``a`` stands on ``b``: what a small lift of ``a`` ends is contact.
    """
    if isinstance(a, PlacedSolid) and isinstance(b, PlacedSolid):
        swelling_m = a.swelling_m + b.swelling_m
        overlap = deepest_overlap(a, b, carried=carried, least_m=swelling_m)
        return overlap.depth_m - swelling_m if overlap is not None else 0.0
    above_m = a.bottom_m + CONTACT_LIFT_M if carried else -np.inf
    if isinstance(a, PlacedSolid) and isinstance(b, ScanPoints):
        return scan_depth(a, b, above_m)
    if isinstance(a, ScanPoints) and isinstance(b, PlacedSolid):
        return scan_depth(b, a, above_m)
    return 0.0


def scan_depth(solid: PlacedSolid, scan: ScanPoints, above_m: float = -np.inf) -> float:
    """How deep a scan's surface above a height reaches into a solid, stray points aside, metres."""
    if boxes_apart(solid, scan):
        return 0.0
    near = np.all((scan.points >= solid.low) & (scan.points <= solid.high), axis=1)
    near &= scan.points[:, 2] > above_m
    stray = max(_STRAY_POINTS, int(_STRAY_SHARE * len(scan.points)))
    if near.sum() <= stray:
        return 0.0
    inside = np.max([depth_inside(part, scan.points[near]) for part in solid.parts], 0)
    return max(0.0, float(np.sort(inside)[-stray - 1]) - solid.swelling_m)
