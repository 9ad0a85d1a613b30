"""Convex polytopes and the exact depth to which two of them overlap (host, float64).

GJK-based libraries tell whether two polytopes meet; the depth they give is that of the portal or
polytope at which they stopped. Measured against separating axes on overlapping boxes, libccd's was
up to 2.4 times too large, FCL's own up to 3 times too small.
"""

from __future__ import annotations

import dataclasses

import numpy as np
from jaxtyping import Float, Int
from scipy.spatial import ConvexHull

_DIRECTION_DECIMALS = 6
_AXES_AT_ONCE = 1 << 16
_SAME = 1e-9


@dataclasses.dataclass(frozen=True, eq=False)
class ConvexPart:
    """A convex polytope, metres."""

    vertices: Float[np.ndarray, "vertices 3"]
    faces: Int[np.ndarray, "faces 3"]
    """Triangles, wound outward."""
    normals: Float[np.ndarray, "normals 3"]
    """Unit, outward; coplanar triangles share one."""
    offsets: Float[np.ndarray, " normals"]
    """n . v + d = 0 on a face."""
    edges: Float[np.ndarray, "edges 3"]
    """Distinct unit directions of the edges, up to sign."""

    @property
    def low(self) -> np.ndarray:
        return self.vertices.min(0)

    @property
    def high(self) -> np.ndarray:
        return self.vertices.max(0)


def convex_part(points: Float[np.ndarray, "points 3"]) -> ConvexPart:
    """The convex hull of points that span a volume."""
    hull = ConvexHull(np.asarray(points, np.float64))
    renumber = np.full(len(points), -1)
    renumber[hull.vertices] = np.arange(len(hull.vertices))
    corners = hull.points[hull.simplices]
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    inward = np.einsum("ij,ij->i", cross, hull.equations[:, :3]) < 0
    triangles = np.where(inward[:, None], hull.simplices[:, ::-1], hull.simplices)
    _, rows = np.unique(np.round(hull.equations, _DIRECTION_DECIMALS), axis=0, return_index=True)
    planes = hull.equations[np.sort(rows)]
    return ConvexPart(
        hull.points[hull.vertices],
        renumber[triangles].astype(np.int32),
        planes[:, :3],
        planes[:, 3],
        _edge_directions(hull, corners),
    )


def _edge_directions(hull: ConvexHull, corners: np.ndarray) -> np.ndarray:
    """Of edges between faces of different planes: diagonals of flat faces are none."""
    found = []
    for k in range(3):  # neighbour k lies across the edge opposite to corner k
        other = hull.equations[hull.neighbors[:, k], :3]
        bent = np.einsum("ij,ij->i", other, hull.equations[:, :3]) < 1 - _SAME
        found.append((corners[:, (k + 1) % 3] - corners[:, (k + 2) % 3])[bent])
    edges = np.concatenate(found)
    edges /= np.linalg.norm(edges, axis=1, keepdims=True)
    lead = edges[np.arange(len(edges)), np.argmax(np.abs(edges) > 1e-4, axis=1)]
    edges *= np.where(lead < 0, -1.0, 1.0)[:, None]
    _, rows = np.unique(np.round(edges, _DIRECTION_DECIMALS), axis=0, return_index=True)
    return edges[np.sort(rows)]


def moved_part(part: ConvexPart, T: Float[np.ndarray, "4 4"], scale: float = 1.0) -> ConvexPart:
    """The part under p -> R (scale p) + t."""
    R, t = np.asarray(T, np.float64)[:3, :3], np.asarray(T, np.float64)[:3, 3]
    normals = part.normals @ R.T
    return ConvexPart(
        scale * part.vertices @ R.T + t,
        part.faces,
        normals,
        scale * part.offsets - normals @ t,
        part.edges @ R.T,
    )


def parts_apart(a: ConvexPart, b: ConvexPart) -> bool:
    """Whether the axis-aligned boxes of two parts are apart."""
    return bool(np.any(a.low > b.high) or np.any(b.low > a.high))


def penetration(a: ConvexPart, b: ConvexPart) -> tuple[float, np.ndarray]:
    """Least move of ``a`` that parts it from ``b``: its length (0 when apart) and direction.

    Separating axes: the facets of the Minkowski difference of two polytopes have the normals of
    faces of either, or of an edge of each. Exact, containment included.
    """
    if parts_apart(a, b):
        return 0.0, np.zeros(3)
    depth, direction = _least_overlap(a, b, np.concatenate([-a.normals, b.normals]))
    if depth <= 0:
        return 0.0, np.zeros(3)
    rows = max(1, _AXES_AT_ONCE // max(1, len(b.edges)))
    for start in range(0, len(a.edges), rows):
        cross = np.cross(a.edges[start : start + rows, None], b.edges[None]).reshape(-1, 3)
        length = np.linalg.norm(cross, axis=1)
        axes = cross[length > 1e-6] / length[length > 1e-6, None]
        if len(axes):
            found = _least_overlap(a, b, np.concatenate([axes, -axes]))
            depth, direction = min((depth, direction), found, key=lambda f: f[0])
        if depth <= 0:
            return 0.0, np.zeros(3)
    return depth, direction


def _least_overlap(a: ConvexPart, b: ConvexPart, axes: np.ndarray) -> tuple[float, np.ndarray]:
    """Over moves of ``a`` along the axes: the shortest that parts it from ``b``."""
    overlap = (b.vertices @ axes.T).max(0) - (a.vertices @ axes.T).min(0)
    best = int(np.argmin(overlap))
    return float(overlap[best]), axes[best]


def depth_inside(
    part: ConvexPart, points: Float[np.ndarray, "points 3"]
) -> Float[np.ndarray, " points"]:
    """How deep points lie in a part: distance to its nearest face, negative outside."""
    return -(points @ part.normals.T + part.offsets).max(1)
