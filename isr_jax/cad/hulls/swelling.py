"""How far hulls reach beyond the surface that they stand for."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float
from scipy.spatial import KDTree

from ...borders.raycast import RayScene
from ...types import Mesh
from ..planes import sphere_directions
from .solid import Hull

_POINTS_PER_HULL = 160
_POINTS_PER_FACE = 10
_SURFACE_POINTS = (1000, 20_000)
_DIRECTIONS = 24


class Reference:
    """The surface of one link, to measure hulls against."""

    def __init__(self, corners: Float[np.ndarray, "faces 3 3"]) -> None:
        """Args: corners: Of its triangles, metres."""
        count = int(np.clip(_POINTS_PER_FACE * len(corners), *_SURFACE_POINTS))
        self._tree = KDTree(spread_points(corners, count))
        flat = corners.reshape(-1, 3).astype(np.float32)
        faces = np.arange(len(flat), dtype=np.int32).reshape(-1, 3)
        self._rays = RayScene([Mesh(flat, faces)], [1])

    def heights(self, hull: Hull, others: Sequence[Hull] = ()) -> Float[np.ndarray, " points"]:
        """How far points spread over a hull's surface lie above the link's surface, metres.

        Points inside another hull or in the closed interior of the link count as 0: nothing
        can get there.
        """
        points, normals = _spread_over(hull)
        near = self._tree.query(points)[0]
        # Along the normal the surface may be nearer than the nearest of its sampled points.
        below = self._rays.cast(points + 1e-4 * normals, -normals)
        depth = np.where(below.triangle >= 0, np.maximum(below.distance - 1e-4, 0.0), np.inf)
        height = np.minimum(near, depth)
        for other in others:
            if np.all(other.low <= hull.high) and np.all(other.high >= hull.low):
                height[other.height(points) < -1e-6] = 0.0
        high = np.flatnonzero(height > 1e-3)
        height[high[~self._open(points[high])]] = 0.0
        return height

    def _open(self, points: np.ndarray) -> np.ndarray:
        """Whether a straight line leads from each point to far outside."""
        directions = sphere_directions(_DIRECTIONS)
        if not len(points):
            return np.zeros(0, bool)
        origins = np.repeat(points, len(directions), 0)
        hits = self._rays.cast(origins, np.tile(directions, (len(points), 1)))
        return np.asarray((hits.triangle < 0).reshape(len(points), len(directions)).any(1))


def spread_points(corners: Float[np.ndarray, "faces 3 3"], count: int) -> Float[np.ndarray, "n 3"]:
    """All corners, and points spread evenly over the triangles by area."""
    return np.concatenate([corners.reshape(-1, 3), _spread(corners, count)[0]])


def _spread_over(hull: Hull) -> tuple[np.ndarray, np.ndarray]:
    """Points on a hull's faces, and the faces' normals there."""
    points, row = _spread(hull.points[hull.faces], _POINTS_PER_HULL)
    return points, hull.planes[row, :3]


def _spread(corners: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Points spread evenly over triangles by area, and the triangle of each."""
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    ends = np.cumsum(np.linalg.norm(cross, axis=1))
    k = np.arange(count)
    row = np.minimum(np.searchsorted(ends, (k + 0.5) / count * ends[-1]), len(ends) - 1)
    u, v = (0.5 + k * 0.7548776662466927) % 1, (0.5 + k * 0.5698402909980532) % 1
    over = u + v > 1
    u, v = np.where(over, 1 - u, u), np.where(over, 1 - v, v)
    a, b, c = np.moveaxis(corners[row], 1, 0)
    return a + u[:, None] * (b - a) + v[:, None] * (c - a), row
