"""Convex polytopes, and the exact depth to which two of them overlap (host, float64).

GJK-based libraries tell whether two polytopes meet; the depth they give is that of the portal or
polytope at which they stopped. Measured against separating axes on overlapping boxes, libccd's was
up to 2.4 times too large, FCL's own up to 3 times too small.
"""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Iterator

import numpy as np
from jaxtyping import Float, Int
from scipy.spatial import ConvexHull

_DIRECTION_DECIMALS = 6
_AXES_AT_ONCE = 1 << 16
_SAME = 1e-9
_LEVEL = 1e-6
"""Slope below which a normal counts as level."""
_LEAST_SIDEWAYS = 0.1
"""Horizontal share of an axis below which it leads up or down, not sideways."""


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

    @functools.cached_property
    def low(self) -> Float[np.ndarray, "3"]:
        return self.vertices.min(0)

    @functools.cached_property
    def high(self) -> Float[np.ndarray, "3"]:
        return self.vertices.max(0)


def convex_part(points: Float[np.ndarray, "points 3"]) -> ConvexPart:
    """The convex hull of points that span a volume."""
    hull = ConvexHull(np.asarray(points, np.float64))
    renumber = np.full(len(points), -1)
    renumber[hull.vertices] = np.arange(len(hull.vertices))
    corners = hull.points[hull.simplices]
    triangles = outward_triangles(hull)
    _, rows = np.unique(np.round(hull.equations, _DIRECTION_DECIMALS), axis=0, return_index=True)
    planes = hull.equations[np.sort(rows)]
    return ConvexPart(
        hull.points[hull.vertices],
        renumber[triangles].astype(np.int32),
        planes[:, :3],
        planes[:, 3],
        _edge_directions(hull, corners),
    )


def outward_triangles(hull: ConvexHull) -> Int[np.ndarray, "faces 3"]:
    """Rows of the hull's points for each triangle, wound outward: Qhull winds either way."""
    corners = hull.points[hull.simplices]
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    inward = np.einsum("ij,ij->i", cross, hull.equations[:, :3]) < 0
    return np.where(inward[:, None], hull.simplices[:, ::-1], hull.simplices)


def box_part(size_m: Float[np.ndarray, "3"], T: Float[np.ndarray, "4 4"]) -> ConvexPart:
    """A box of full ``size_m`` centred at the origin of ``T``."""
    signs = np.array(np.meshgrid([-1, 1], [-1, 1], [-1, 1])).reshape(3, 8).T
    return moved_part(convex_part(signs * np.asarray(size_m, np.float64) / 2), T)


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


def shifted_part(part: ConvexPart, step_m: Float[np.ndarray, "3"]) -> ConvexPart:
    """The part, moved without a turn."""
    return dataclasses.replace(
        part, vertices=part.vertices + step_m, offsets=part.offsets - part.normals @ step_m
    )


def _boxes_apart(a: ConvexPart, b: ConvexPart) -> bool:
    """Whether the axis-aligned boxes of two parts are apart."""
    return bool(np.any(a.low > b.high) or np.any(b.low > a.high))


def penetration(a: ConvexPart, b: ConvexPart) -> tuple[float, Float[np.ndarray, "3"]]:
    """Least move of ``a`` that parts it from ``b``: its length (0 when apart) and direction.

    Separating axes: the facets of the Minkowski difference of two polytopes have the normals of
    faces of either, or of an edge of each. Exact, containment included.
    """
    depth, direction = np.inf, np.zeros(3)
    if _boxes_apart(a, b):
        return 0.0, direction
    for axes in _facet_normals(a, b):
        overlap = -_gaps(a, b, axes)
        best = int(np.argmin(overlap))
        if overlap[best] < depth:
            depth, direction = float(overlap[best]), axes[best]
        if depth <= 0:
            return 0.0, np.zeros(3)
    return depth, direction


def vertical_gap(a: ConvexPart, b: ConvexPart) -> float:
    """How far ``a`` can sink until it touches ``b``; negative: how far it has to be lifted.

    After sinking by t the gap along n is gap(n) - t n_z: a normal that points up keeps them apart
    until t = gap / n_z, one that points down does so from t = gap / n_z on. Where the latter comes
    first, or has come already, or a level normal separates them, ``a`` is beside or below: inf.
    """
    if np.any(a.low[:2] > b.high[:2]) or np.any(b.low[:2] > a.high[:2]):
        return np.inf
    touch, clear = -np.inf, np.inf
    for axes in _facet_normals(a, b):
        gap, up = _gaps(a, b, axes), axes[:, 2]
        rising, falling = up > _LEVEL, up < -_LEVEL
        if np.any(gap[~rising & ~falling] >= 0):
            return np.inf
        touch = max(touch, float(np.max(gap[rising] / up[rising], initial=-np.inf)))
        clear = min(clear, float(np.min(gap[falling] / up[falling], initial=np.inf)))
    return touch if -np.inf < touch < clear and clear > 0 else np.inf


def sideways_exit(a: ConvexPart, b: ConvexPart) -> tuple[float, Float[np.ndarray, "3"]]:
    """Shortest horizontal move of ``a`` out of ``b``: its length, and the unit direction.

    Both are meant to overlap. inf: no way out leads sideways.
    """
    length, direction = np.inf, np.zeros(3)
    for axes in _facet_normals(a, b):
        sideways = np.linalg.norm(axes[:, :2], axis=1)
        usable = sideways > _LEAST_SIDEWAYS
        way = np.where(usable, -_gaps(a, b, axes) / np.where(usable, sideways, 1.0), np.inf)
        best = int(np.argmin(way))
        if way[best] < length:
            length = float(way[best])
            direction = np.append(axes[best, :2] / sideways[best], 0.0)
    return length, direction


def depth_inside(
    part: ConvexPart, points: Float[np.ndarray, "points 3"]
) -> Float[np.ndarray, " points"]:
    """How deep points lie in a part: distance to its nearest face, negative outside."""
    return -(points @ part.normals.T + part.offsets).max(1)


def _facet_normals(a: ConvexPart, b: ConvexPart) -> Iterator[Float[np.ndarray, "axes 3"]]:
    """Unit normals of all facets that the Minkowski difference may have, pointing from ``b`` to
    ``a``: those of faces first, then those of pairs of edges, some at a time."""
    yield np.concatenate([-a.normals, b.normals])
    rows = max(1, _AXES_AT_ONCE // max(1, len(b.edges)))
    for start in range(0, len(a.edges), rows):
        cross = np.cross(a.edges[start : start + rows, None], b.edges[None]).reshape(-1, 3)
        length = np.linalg.norm(cross, axis=1)
        axes = cross[length > 1e-6] / length[length > 1e-6, None]
        if len(axes):
            yield np.concatenate([axes, -axes])


def _gaps(a: ConvexPart, b: ConvexPart, axes: np.ndarray) -> Float[np.ndarray, " axes"]:
    """Signed gap along each axis from ``b`` to ``a``; negative: the overlap along it."""
    return (a.vertices @ axes.T).min(0) - (b.vertices @ axes.T).max(0)
