"""Convex hulls as plain arrays: made from points, cut, and measured against each other.

Depths are taken along the face normals of both hulls and the world's axes (the separating axis
test without its edge-edge axes). That is exact for boxes turned about the vertical and for flat
faces that rest on each other; where two edges cross, it may report an overlap that is not there,
never miss one.
"""

from __future__ import annotations

import dataclasses
import functools

import numpy as np
from jaxtyping import Float
from scipy.spatial import ConvexHull

from ..types import Mesh

_MIN_THICKNESS_M = 0.01
"""Thinner point sets are thickened: a flat scan has no volume, and MuJoCo wants one."""


_AXES = np.concatenate([np.eye(3), -np.eye(3)])
_LEVEL = 1e-6
"""Slope below which a normal counts as level."""


@dataclasses.dataclass(frozen=True, eq=False)
class Hull:
    """A convex polytope: its corners, and the outward normals of its faces."""

    vertices: Float[np.ndarray, "vertices 3"]
    normals: Float[np.ndarray, "faces 3"]

    def moved(self, T: np.ndarray) -> Hull:
        return Hull(self.vertices @ T[:3, :3].T + T[:3, 3], self.normals @ T[:3, :3].T)

    @functools.cached_property
    def low(self) -> np.ndarray:
        return self.vertices.min(0)

    @functools.cached_property
    def high(self) -> np.ndarray:
        return self.vertices.max(0)


def hull_of_mesh(mesh: Mesh) -> Hull:
    """The hull of a mesh that is convex already."""
    hull = _quickhull(np.asarray(mesh.vertices, np.float64))
    return Hull(hull.points[hull.vertices], _distinct(hull.equations[:, :3]))


def box_hull(size: np.ndarray, T: np.ndarray) -> Hull:
    """A box of full ``size`` centred at the origin of ``T``."""
    signs = np.array(np.meshgrid([-1, 1], [-1, 1], [-1, 1])).reshape(3, 8).T
    return Hull(signs * np.asarray(size) / 2.0, _AXES).moved(np.asarray(T, np.float64))


def _distinct(normals: np.ndarray) -> np.ndarray:
    """Qhull triangulates: coplanar triangles share one normal."""
    _, rows = np.unique(np.round(normals, 6), axis=0, return_index=True)
    return normals[np.sort(rows)]


def _quickhull(points: np.ndarray) -> ConvexHull:
    return ConvexHull(points)


def separations(a: Hull, b: Hull) -> tuple[np.ndarray, np.ndarray]:
    """Signed gap along each tested normal, and the normals, pointing from ``b`` to ``a``.

    Positive: a plane with that normal lies between them. All negative: they overlap, by the
    largest of them along its normal.
    """
    normals = np.concatenate([-a.normals, b.normals, _AXES])
    gap = (a.vertices @ normals.T).min(0) - (b.vertices @ normals.T).max(0)
    return gap, normals


def boxes_apart(a: Hull, b: Hull, margin_m: float = 0.0) -> bool:
    """Whether the axis-aligned boxes of two hulls are farther apart than the margin."""
    return bool(np.any(a.low > b.high + margin_m) or np.any(b.low > a.high + margin_m))


def penetration_depth(a: Hull, b: Hull) -> float:
    """Depth of overlap, 0 where there is none."""
    if boxes_apart(a, b):
        return 0.0
    return max(0.0, -float(separations(a, b)[0].max()))


def vertical_gap(a: Hull, b: Hull) -> float:
    """How far ``a`` can sink until it touches ``b``; negative: how far it has to be lifted.

    After sinking by t the gap along n is sep(n) - t n_z: a normal that points up keeps them apart
    until t = sep / n_z, one that points down does so from t = sep / n_z on. Where the latter comes
    first, or has come already, or a level normal separates them, ``a`` is beside or below: inf.
    """
    gap, normals = separations(a, b)
    up = normals[:, 2]
    rising, falling = up > _LEVEL, up < -_LEVEL
    if not rising.any() or np.any(gap[~rising & ~falling] >= 0):
        return np.inf
    touch = float(np.max(gap[rising] / up[rising]))
    clear = float(np.min(gap[falling] / up[falling], initial=np.inf))
    return touch if touch < clear and clear > 0 else np.inf


def sideways_exit(a: Hull, b: Hull) -> tuple[float, np.ndarray]:
    """Shortest horizontal move of ``a`` out of ``b``: its length, and the unit direction."""
    gap, normals = separations(a, b)
    level = np.linalg.norm(normals[:, :2], axis=1)
    usable = level > 0.1
    length = np.where(usable, -gap / np.where(usable, level, 1.0), np.inf)
    best = int(np.argmin(length))
    direction = np.append(normals[best, :2] / level[best], 0.0) if usable[best] else np.zeros(3)
    return float(length[best]), direction


def hull_mesh(points: np.ndarray, max_vertices: int) -> Mesh:
    """Convex hull of points as a mesh of at most ``max_vertices``, faces wound outwards.

    Above the limit it keeps the extreme points along evenly spread directions, so the result lies
    inside the true hull. Thin point sets grow to 1 cm along their thinnest direction.
    """
    points = _thickened(np.asarray(points, np.float64))
    hull = _quickhull(points)
    corners = points[hull.vertices]
    if len(corners) > max_vertices:
        corners = corners[extreme_points(corners, max_vertices)]
        hull = _quickhull(corners)
        corners = corners[hull.vertices]
    final = _quickhull(corners)
    return Mesh(corners.astype(np.float32), _outward_faces(final).astype(np.int32))


def extreme_points(points: np.ndarray, count: int) -> np.ndarray:
    """Rows of the points farthest along ``count`` evenly spread directions, sorted, distinct."""
    return np.unique(np.argmax(points @ _directions(count).T, axis=0))


def _directions(count: int) -> np.ndarray:
    """The 6 axes, then a Fibonacci spiral on the sphere."""
    k = np.arange(count - 6) + 0.5
    z = 1 - 2 * k / max(count - 6, 1)
    angle = np.pi * (1 + 5**0.5) * k
    radius = np.sqrt(1 - z * z)
    spiral = np.stack([radius * np.cos(angle), radius * np.sin(angle), z], 1)
    return np.concatenate([_AXES, spiral])


def _thickened(points: np.ndarray) -> np.ndarray:
    centred = points - points.mean(0)
    axes = np.linalg.svd(centred, full_matrices=True)[2] if len(points) < 4 else None
    axes = np.linalg.eigh(centred.T @ centred)[1].T if axes is None else axes[::-1]
    for axis in axes:
        along = centred @ axis
        if np.ptp(along) < _MIN_THICKNESS_M:
            step = axis * _MIN_THICKNESS_M / 2
            points = np.concatenate([points - step, points + step])
            centred = points - points.mean(0)
    return points


def _outward_faces(hull: ConvexHull) -> np.ndarray:
    corners = hull.points[hull.simplices]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    inward = np.sum(normal * hull.equations[:, :3], 1) < 0
    return np.where(inward[:, None], hull.simplices[:, ::-1], hull.simplices)


def cut_hull(mesh: Mesh, normal: np.ndarray, offset: float, max_vertices: int) -> Mesh | None:
    """The part of a convex mesh where normal . p >= offset; None where nothing solid is left."""
    vertices = np.asarray(mesh.vertices, np.float64)
    side = vertices @ normal - offset
    if side.min() >= 0:
        return mesh
    edges = np.concatenate([mesh.faces[:, [0, 1]], mesh.faces[:, [1, 2]], mesh.faces[:, [2, 0]]])
    a, b = edges[:, 0], edges[:, 1]
    crossing = (side[a] > 0) & (side[b] < 0)
    a, b = a[crossing], b[crossing]
    share = (side[a] / (side[a] - side[b]))[:, None]
    points = np.concatenate(
        [vertices[side >= 0], vertices[a] + share * (vertices[b] - vertices[a])]
    )
    if len(points) < 4 or np.ptp(points @ normal) < _MIN_THICKNESS_M:
        return None
    return hull_mesh(points, max_vertices)
