"""Polygons as triangles: fans where they are convex, ears where they are not."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float, Int

Corners = Int[np.ndarray, "triangles 3"]


def triangulated(
    points: Float[np.ndarray, "corners 3"], counts: Int[np.ndarray, " polygons"]
) -> tuple[Corners, Int[np.ndarray, " triangles"]]:
    """Triangles over corners, and the polygon that each is of; polygons stay in order.

    Args:
        points: Corners of all polygons, one polygon after the other.
        counts: Corners a polygon, at least 3.
    """
    starts = np.cumsum(counts) - counts
    triangles, owners = [], []
    for n in np.unique(counts):
        rows = np.flatnonzero(counts == n)
        corners = starts[rows, None] + np.arange(n)
        fans = _fans(points, corners)
        triangles.append(fans.reshape(-1, 3))
        owners.append(np.repeat(rows, n - 2))
    order = np.argsort(np.concatenate(owners), kind="stable")
    return np.concatenate(triangles)[order], np.concatenate(owners)[order]


def _fans(points: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """Triangles [polygons, n - 2, 3] of polygons [polygons, n] with equal numbers of corners."""
    n = corners.shape[1]
    apex = np.broadcast_to(corners[:, :1], (len(corners), n - 2))
    fans = np.stack([apex, corners[:, 1:-1], corners[:, 2:]], 2)
    if n == 3:
        return fans
    normal = _newell(points[corners])
    bad = np.flatnonzero(np.any(_turns(points, fans, normal) < 0, 1))
    for row in bad:
        fans[row] = corners[row][_ears(_flat(points[corners[row]], normal[row]))]
    return fans


def _newell(polygons: np.ndarray) -> np.ndarray:
    """Normal of each polygon [polygons, n, 3], twice its area long."""
    centred = polygons - polygons[:, :1]
    return np.cross(centred, np.roll(centred, -1, 1)).sum(1)


def _turns(points: np.ndarray, fans: np.ndarray, normal: np.ndarray) -> np.ndarray:
    a, b, c = (points[fans[..., k]] for k in range(3))
    return np.einsum("ptk,pk->pt", np.cross(b - a, c - a), normal)


def _flat(polygon: np.ndarray, normal: np.ndarray) -> np.ndarray:
    """Corners [n, 2] seen against the normal: counter-clockwise."""
    drop = int(np.argmax(np.abs(normal)))
    u, v = ((1, 2), (2, 0), (0, 1))[drop]
    return polygon[:, [u, v] if normal[drop] >= 0 else [v, u]]


def _ears(polygon: np.ndarray) -> np.ndarray:
    """Cut off one ear after the other; [n - 2, 3] positions in a polygon [n, 2]."""
    left, triangles = list(range(len(polygon))), []
    while len(left) > 3:
        found = next((k for k in range(len(left)) if _is_ear(polygon, left, k)), 0)
        triangles.append([left[found - 1], left[found], left[(found + 1) % len(left)]])
        del left[found]
    return np.array([*triangles, left])


def _is_ear(polygon: np.ndarray, left: list[int], k: int) -> bool:
    ear = [left[i % len(left)] for i in (k - 1, k, k + 1)]
    a, b, c = polygon[ear]
    if _cross(b - a, c - a) <= 0:
        return False
    others = polygon[[i for i in left if i not in ear]]
    inside = (
        (_cross(b - a, others - a) >= 0)
        & (_cross(c - b, others - b) >= 0)
        & (_cross(a - c, others - c) >= 0)
    )
    corner = np.any(np.all(others[:, None] == np.stack([a, b, c]), 2), 1)
    return not np.any(inside & ~corner)


def _cross(a: np.ndarray, b: np.ndarray) -> np.ndarray | np.floating:
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
