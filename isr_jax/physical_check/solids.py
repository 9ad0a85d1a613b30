"""Border: python-fcl. Solid shapes of placed models, and how deep two of them overlap.

FCL tells whether two convex parts meet, `geometry.penetration` how deep: FCL's own depths are
not exact (see there), and with triangle meshes it misses a box that lies wholly in another.
"""

from __future__ import annotations

import dataclasses
import functools

import fcl
import numpy as np
from jaxtyping import Float

from ..geometry import ConvexPart, convex_part, depth_inside, moved_part, penetration
from ..library import CadModel
from ..robot_model import link_transforms

_STRAY_POINTS = 8
_STRAY_SHARE = 0.02
"""So many points of a scan may lie deeper in a model than the depth that counts: segmentation
bleeds over edges."""
_MAX_SCAN_POINTS = 4096


@dataclasses.dataclass(frozen=True, eq=False)
class Solid:
    """A placed model: its convex parts, world frame."""

    parts: tuple[ConvexPart, ...]
    shapes: tuple[fcl.Convex, ...]
    """The parts at the world's origin, unmoved by ``offset``."""
    offset: Float[np.ndarray, "3"]
    """How far the solid was moved since its shapes were made, metres."""

    @functools.cached_property
    def lows(self) -> np.ndarray:
        """Least coordinates of each part."""
        return np.array([p.low for p in self.parts])

    @functools.cached_property
    def highs(self) -> np.ndarray:
        """Greatest coordinates of each part."""
        return np.array([p.high for p in self.parts])

    @functools.cached_property
    def low(self) -> np.ndarray:
        return self.lows.min(0)

    @functools.cached_property
    def high(self) -> np.ndarray:
        return self.highs.max(0)

    def moved(self, step: np.ndarray) -> Solid:
        """The same solid, shifted."""
        if not np.any(step):
            return self
        T = np.eye(4)
        T[:3, 3] = step
        return Solid(tuple(moved_part(p, T) for p in self.parts), self.shapes, self.offset + step)


@dataclasses.dataclass(frozen=True, eq=False)
class ScanPoints:
    """A kept scan: its surface points, world frame. A scan is open, so it has no inside."""

    points: Float[np.ndarray, "points 3"]

    @functools.cached_property
    def low(self) -> np.ndarray:
        return self.points.min(0)

    @functools.cached_property
    def high(self) -> np.ndarray:
        return self.points.max(0)


@functools.lru_cache(maxsize=1024)
def model_parts(model: CadModel) -> tuple[ConvexPart, ...]:
    """Collision hulls of a model in its canonical frame, joints closed."""
    T_model_link = link_transforms(model.robot)
    return tuple(
        moved_part(convex_part(np.asarray(hull.vertices, np.float64)), T_model_link[link.name])
        for link in model.robot.links
        for hull in link.hulls
    )


def solid_of(parts: tuple[ConvexPart, ...], T_world_cad: np.ndarray, scale: float) -> Solid:
    """The placed solid of a model's parts."""
    moved = tuple(moved_part(part, T_world_cad, scale) for part in parts)
    return Solid(moved, tuple(_shape(part) for part in moved), np.zeros(3))


def _shape(part: ConvexPart) -> fcl.Convex:
    count = len(part.faces)
    rows = np.concatenate([np.full((count, 1), 3, np.int32), part.faces], axis=1)
    return fcl.Convex(part.vertices, count, rows.ravel())


def scan_points(vertices: np.ndarray) -> ScanPoints:
    """Surface points of a scan, at most some thousands, evenly spread over their order."""
    count = min(len(vertices), _MAX_SCAN_POINTS)
    rows = np.linspace(0, len(vertices) - 1, count).astype(int)
    return ScanPoints(np.asarray(vertices, np.float64)[rows])


def apart(a: Solid | ScanPoints, b: Solid | ScanPoints) -> bool:
    """Whether the axis-aligned boxes of two things are apart."""
    return bool(np.any(a.low > b.high) or np.any(b.low > a.high))


def deepest(a: Solid, b: Solid) -> tuple[float, np.ndarray]:
    """Depth of the deepest pair of parts, and the direction that frees ``a``."""
    best = 0.0, np.zeros(3)
    if apart(a, b):
        return best
    near = np.all((a.lows[:, None] <= b.highs) & (b.lows <= a.highs[:, None]), axis=2)
    for i, j in np.argwhere(near).tolist():
        if _meet(a.shapes[i], a.offset, b.shapes[j], b.offset):
            best = max(best, penetration(a.parts[i], b.parts[j]), key=lambda found: found[0])
    return best


def _meet(a: fcl.Convex, a_offset: np.ndarray, b: fcl.Convex, b_offset: np.ndarray) -> bool:
    return bool(
        fcl.collide(
            fcl.CollisionObject(a, fcl.Transform(np.eye(3), a_offset)),
            fcl.CollisionObject(b, fcl.Transform(np.eye(3), b_offset)),
            fcl.CollisionRequest(),
            fcl.CollisionResult(),
        )
    )


def scan_depth(solid: Solid, scan: ScanPoints) -> float:
    """How deep a scan's surface reaches into a solid, stray points aside, metres."""
    if apart(solid, scan):
        return 0.0
    near = np.all((scan.points >= solid.low) & (scan.points <= solid.high), axis=1)
    stray = max(_STRAY_POINTS, int(_STRAY_SHARE * len(scan.points)))
    if near.sum() <= stray:
        return 0.0
    inside = np.max([depth_inside(part, scan.points[near]) for part in solid.parts], 0)
    return max(0.0, float(np.sort(inside)[-stray - 1]))


def depth_between(a: Solid | ScanPoints, b: Solid | ScanPoints) -> float:
    """Depth of overlap. Two scans never overlap: both were seen where they are."""
    if isinstance(a, Solid) and isinstance(b, Solid):
        return deepest(a, b)[0]
    if isinstance(a, Solid) and isinstance(b, ScanPoints):
        return scan_depth(a, b)
    if isinstance(a, ScanPoints) and isinstance(b, Solid):
        return scan_depth(b, a)
    return 0.0
