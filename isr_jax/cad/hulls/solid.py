"""One convex hull: made from any points, with few corners, cut by planes."""

from __future__ import annotations

import dataclasses
import functools

import numpy as np
from jaxtyping import Float
from scipy.spatial import ConvexHull, QhullError

from ...geometry.convex import outward_triangles
from ...types import Mesh
from ..planes import sphere_directions

MAX_VERTICES = 64
MIN_THICKNESS_M = 0.002
"""Flatter points are thickened: simulators want a volume."""
_GRIDS_M = (0.0, 1e-5, 1e-4, 5e-4)
"""Corners are rounded to the first of these that leaves no slivers."""
_SLIVER_M2 = 2e-10
_FLAT_M = 5e-6
_LEAST_VOLUME = 1e-12


@dataclasses.dataclass(frozen=True, eq=False)
class Hull:
    """A convex polytope with at most `MAX_VERTICES` corners, metres."""

    points: Float[np.ndarray, "points 3"]
    """Its corners."""
    planes: Float[np.ndarray, "faces 4"]
    """Outward unit normal and offset of each triangle: n . p + d <= 0 inside."""
    faces: np.ndarray
    """[faces, 3]: triangles, wound outwards."""
    volume: float

    @functools.cached_property
    def low(self) -> np.ndarray:
        return self.points.min(0)

    @functools.cached_property
    def high(self) -> np.ndarray:
        return self.points.max(0)

    def mesh(self) -> Mesh:
        """As a mesh for a link."""
        return Mesh(self.points.astype(np.float32), self.faces.astype(np.int32))

    def height(self, points: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, " n"]:
        """How far points lie above the nearest face's plane at least; negative inside."""
        return (points @ self.planes[:, :3].T + self.planes[:, 3]).max(1)


def hull_of(points: Float[np.ndarray, "points 3"]) -> Hull:
    """The convex hull of points; flat ones become 2 mm thick, corners above 64 are left out."""
    points = _thick(np.asarray(points, np.float64))
    hull = ConvexHull(points)
    corners = hull.points[hull.vertices]
    if len(corners) > MAX_VERTICES:
        corners = corners[_extreme(corners)]
    for tried in (corners, _thick(corners, at_least=True)):
        for grid_m in _GRIDS_M:
            try:
                made = _finished(ConvexHull(_snapped(tried, grid_m)))
            except QhullError:
                continue
            if _is_convex(made) and len(made.points) <= MAX_VERTICES:
                return made
    return _finished(ConvexHull(_thick(_box_corners(points), at_least=True)))


def _snapped(corners: np.ndarray, grid_m: float) -> np.ndarray:
    """In float32, which is what files and simulators get: the planes belong to that."""
    even = np.round(corners / grid_m) * grid_m if grid_m > 0 else corners
    return even.astype(np.float32).astype(np.float64)


def _is_convex(hull: Hull) -> bool:
    """Whether the triangles' own normals agree: slivers between nearly equal corners do not."""
    corners = hull.points[hull.faces]
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(cross, axis=1)
    large = length > _SLIVER_M2
    unit = cross[large] / length[large, None]
    height = np.einsum("fc,fvc->fv", unit, hull.points - corners[large, :1])
    return bool(height.max(initial=0.0) < _FLAT_M)


def _box_corners(points: np.ndarray) -> np.ndarray:
    low, high = points.min(0), points.max(0)
    signs = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)])
    return low + signs * (high - low)


def _extreme(corners: np.ndarray) -> np.ndarray:
    """Rows of the corners that are farthest along spread directions.

    Seen as if the body were as thick as it is wide: else both faces of a board would not count.
    """
    centred = corners - corners.mean(0)
    along = centred @ np.linalg.eigh(centred.T @ centred)[1]
    even = along / np.maximum(np.ptp(along, axis=0), 1e-9)
    directions = np.concatenate([np.eye(3), -np.eye(3), sphere_directions(MAX_VERTICES - 6)])
    return np.unique(np.argmax(even @ directions.T, axis=0))


def _finished(hull: ConvexHull) -> Hull:
    renumber = np.full(len(hull.points), -1)
    renumber[hull.vertices] = np.arange(len(hull.vertices))
    faces = renumber[outward_triangles(hull)]
    return Hull(hull.points[hull.vertices], hull.equations, faces, float(hull.volume))


def _thick(points: np.ndarray, *, at_least: bool = False) -> np.ndarray:
    """The points, and where they are flat along an axis of theirs, copies on both sides.

    With ``at_least`` the thinnest axis counts as flat whatever its extent.
    """
    centred = points - points.mean(0)
    axes = np.linalg.eigh(centred.T @ centred)[1].T
    for k, axis in enumerate(axes):
        flat = np.ptp((points - points.mean(0)) @ axis) < MIN_THICKNESS_M
        if flat or (at_least and k == 0):
            step = axis * MIN_THICKNESS_M / 2
            points = np.concatenate([points - step, points + step])
    return points


def cut(hull: Hull, normal: Float[np.ndarray, "3"], offset_m: float) -> Hull | None:
    """The part of a hull where normal . p <= offset; None where hardly anything is left."""
    side = hull.points @ normal - offset_m
    if side.max() <= 0:
        return hull
    edges = np.concatenate([hull.faces[:, [0, 1]], hull.faces[:, [1, 2]], hull.faces[:, [2, 0]]])
    a, b = edges[:, 0], edges[:, 1]
    crossing = (side[a] < 0) & (side[b] > 0)
    a, b = a[crossing], b[crossing]
    share = (side[a] / (side[a] - side[b]))[:, None]
    crossed = hull.points[a] + share * (hull.points[b] - hull.points[a])
    kept = np.concatenate([hull.points[side <= 0], crossed])
    if len(kept) < 4 or np.ptp(kept @ normal) < MIN_THICKNESS_M / 2:
        return None
    left = hull_of(kept)
    return left if left.volume > _LEAST_VOLUME else None
