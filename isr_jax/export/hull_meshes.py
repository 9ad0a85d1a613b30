"""Convex hulls of scans as meshes: made from points, of few corners, cut by planes."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float, Int
from scipy.spatial import ConvexHull

from ..geometry.convex import ConvexPart, convex_part, outward_triangles
from ..types import Mesh

_MIN_THICKNESS_M = 0.01
"""Thinner point sets are thickened: a flat scan has no volume, and MuJoCo wants one."""
_AXES = np.concatenate([np.eye(3), -np.eye(3)])


def part_of(mesh: Mesh) -> ConvexPart:
    """A convex mesh as a part."""
    return convex_part(np.asarray(mesh.vertices, np.float64))


def hull_mesh(points: Float[np.ndarray, "points 3"], max_vertices: int) -> Mesh:
    """Convex hull of points as a mesh of at most ``max_vertices``, faces wound outwards.

    Above the limit it keeps the extreme points along evenly spread directions, so the result lies
    inside the true hull. Thin point sets grow to 1 cm along their thinnest direction.
    """
    points = _thickened(np.asarray(points, np.float64))
    hull = ConvexHull(points)
    corners = points[hull.vertices]
    if len(corners) > max_vertices:
        corners = corners[extreme_points(corners, max_vertices)]
        hull = ConvexHull(corners)
        corners = corners[hull.vertices]
    final = ConvexHull(corners)
    return Mesh(corners.astype(np.float32), outward_triangles(final).astype(np.int32))


def extreme_points(points: Float[np.ndarray, "points 3"], count: int) -> Int[np.ndarray, " rows"]:
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


def cut_hull(
    mesh: Mesh, normal: Float[np.ndarray, "3"], offset_m: float, max_vertices: int
) -> Mesh | None:
    """The part of a convex mesh where normal . p >= offset; None where nothing solid is left."""
    vertices = np.asarray(mesh.vertices, np.float64)
    side = vertices @ normal - offset_m
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
