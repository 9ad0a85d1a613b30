"""Primitives and hulls as convex meshes with few corners, and pieces of a mesh that are convex."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import ConvexHull, QhullError

from ....geometry.convex import outward_triangles
from ....robot_model.primitives import box_between
from ....types import Mesh

MAX_CORNERS = 64
"""Of a collision hull."""
_ROUND_SIDES = 32
_BALL_RINGS = 6
_BALL_SIDES = 10
_CONVEX_SHARE = 0.98
"""A piece that fills so much of its hull is convex, up to how finely it is rounded."""


def box(size: Float[np.ndarray, "3"]) -> Mesh:
    """A box about the origin."""
    half = np.asarray(size, np.float64) / 2
    return box_between(-half, half)


def cylinder(radius: float, length: float) -> Mesh:
    """Along z about the origin; its corners lie on the circle."""
    return turned_hull([(radius, -length / 2), (radius, length / 2)], _ROUND_SIDES)


def ball(radii: Float[np.ndarray, "3"]) -> Mesh:
    """A sphere, or an ellipsoid, with 62 corners."""
    angles = np.pi * (np.arange(_BALL_RINGS) + 1) / (_BALL_RINGS + 1)
    rings = [(float(np.sin(a)), -float(np.cos(a))) for a in angles]
    mesh = turned_hull([(0.0, -1.0), *rings, (0.0, 1.0)], _BALL_SIDES)
    scaled = mesh.vertices * np.asarray(radii, np.float64)
    return Mesh(scaled, mesh.faces)


def capsule(radius: float, length: float) -> Mesh:
    """A cylinder of this length along z with half balls on its ends; 62 corners."""
    bow = [(radius * np.cos(a), radius * np.sin(a)) for a in np.pi / 2 * np.arange(3) / 3]
    top = [(float(r), float(length / 2 + z)) for r, z in bow]
    bottom = [(r, -z) for r, z in top[::-1]]
    ends = [(0.0, -length / 2 - radius)], [(0.0, length / 2 + radius)]
    return turned_hull([*ends[0], *bottom, *top, *ends[1]], _BALL_SIDES)


def turned_hull(profile: list[tuple[float, float]], sides: int) -> Mesh:
    """The hull of (radius, z) points turned about z; a radius of 0 is one point."""
    angles = 2 * np.pi * np.arange(sides) / sides
    around = np.stack([np.cos(angles), np.sin(angles)], 1)
    points = [
        np.concatenate([radius * around, np.full((sides, 1), z)], 1)
        if radius > 0
        else np.array([[0.0, 0.0, z]])
        for radius, z in profile
    ]
    hull = hull_of(np.concatenate(points), max_corners=None)
    if hull is None:
        raise ValueError("a profile without volume")
    return hull


def hull_of(
    points: Float[np.ndarray, "points 3"], max_corners: int | None = MAX_CORNERS
) -> Mesh | None:
    """Convex hull with faces outward; None where the points have no volume.

    With more corners than ``max_corners`` it is the hull of those that make it largest, taken
    one by one: it lies inside the true hull and keeps its extreme points.
    """
    try:
        hull = ConvexHull(points)
        corners = points[hull.vertices]
        if max_corners is not None and len(corners) > max_corners:
            corners = corners[_outermost(corners, max_corners)]
            hull = ConvexHull(corners)
            corners = corners[hull.vertices]
        return _oriented(corners)
    except (QhullError, ValueError):
        return None


def _outermost(points: np.ndarray, count: int) -> np.ndarray:
    """Rows of points, each the farthest outside of the hull of those before it."""
    chosen = list(dict.fromkeys([*points.argmin(0).tolist(), *points.argmax(0).tolist()]))
    centred = points - points.mean(0)
    while len(chosen) < 4 or np.linalg.matrix_rank(points[chosen][1:] - points[chosen[0]]) < 3:
        left = np.setdiff1d(np.arange(len(points)), chosen)
        basis = np.linalg.svd(points[chosen][1:] - points[chosen[0]])[2]
        rank = np.linalg.matrix_rank(points[chosen][1:] - points[chosen[0]])
        beyond = np.linalg.norm((points[left] - points[chosen[0]]) @ basis[rank:].T, axis=1)
        chosen.append(int(left[np.argmax(beyond)]))
    while len(chosen) < count:
        hull = ConvexHull(points[chosen])
        outside = (points @ hull.equations[:, :3].T + hull.equations[:, 3]).max(1)
        outside[chosen] = -np.inf
        farthest = int(np.argmax(outside))
        if outside[farthest] <= 1e-9 * np.abs(centred).max():
            break
        chosen.append(farthest)
    return np.array(chosen)


def _oriented(corners: np.ndarray) -> Mesh:
    hull = ConvexHull(corners)
    faces = outward_triangles(hull)
    order = np.lexsort(np.sort(faces, 1).T[::-1])
    return Mesh(corners.copy(), faces[order].astype(np.int32))


def convex_pieces(mesh: Mesh) -> tuple[Mesh, ...] | None:
    """Hulls of the connected pieces of a mesh, None where a piece is not convex."""
    hulls = []
    for vertices, faces in _pieces(mesh):
        hull = hull_of(vertices, max_corners=None)
        if hull is None or not _fills(vertices[faces], hull):
            return None
        small = hull_of(vertices)
        hulls.append(hull if small is None else small)
    return tuple(hulls)


def _pieces(mesh: Mesh):
    """Vertices and faces of each connected piece."""
    faces = np.asarray(mesh.faces)
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]]])
    count = len(mesh.vertices)
    graph = coo_matrix((np.ones(len(edges)), (edges[:, 0], edges[:, 1])), shape=(count, count))
    _, piece = connected_components(graph, directed=False)
    for number in np.unique(piece[faces[:, 0]]):
        used, rows = np.unique(faces[piece[faces[:, 0]] == number], return_inverse=True)
        yield np.asarray(mesh.vertices, np.float64)[used], rows.reshape(-1, 3)


def _fills(triangles: np.ndarray, hull: Mesh) -> bool:
    """Whether a closed surface encloses nearly all of its hull."""
    middle = hull.vertices.mean(0)
    own = abs(np.linalg.det(triangles - middle).sum())
    whole = np.linalg.det(hull.vertices[hull.faces] - middle).sum()
    return bool(own >= _CONVEX_SHARE * whole)
