"""Slow NumPy twins of `isr_jax.geometry`, float64, by other methods where there are any."""

from __future__ import annotations

import itertools

import numpy as np
from scipy.optimize import linprog
from scipy.spatial import ConvexHull, QhullError


def rotation_z(yaw: float) -> np.ndarray:
    c, s = np.cos(yaw), np.sin(yaw)
    return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])


def corners_of(box) -> np.ndarray:
    """Eight corners, in the order of the counting of three bits."""
    size, yaw = np.asarray(box.size, float), float(box.yaw)
    rows = []
    for signs in itertools.product((-0.5, 0.5), repeat=3):
        rows.append(rotation_z(yaw) @ (np.array(signs) * size) + np.asarray(box.center, float))
    return np.array(rows)


def footprint_of(box) -> np.ndarray:
    """Four corners seen from above, counter-clockwise."""
    return corners_of(box)[[0, 4, 6, 2], :2]


def _inside(polygon: np.ndarray, point: np.ndarray) -> bool:
    edges = np.roll(polygon, -1, 0) - polygon
    away = point - polygon
    return bool(np.all(edges[:, 0] * away[:, 1] - edges[:, 1] * away[:, 0] >= -1e-12))


def _crossings(a: np.ndarray, b: np.ndarray):
    for i, j in itertools.product(range(len(a)), range(len(b))):
        p, r = a[i], a[(i + 1) % len(a)] - a[i]
        q, s = b[j], b[(j + 1) % len(b)] - b[j]
        cross = r[0] * s[1] - r[1] * s[0]
        if abs(cross) < 1e-14:
            continue
        t = ((q - p)[0] * s[1] - (q - p)[1] * s[0]) / cross
        u = ((q - p)[0] * r[1] - (q - p)[1] * r[0]) / cross
        if 0 <= t <= 1 and 0 <= u <= 1:
            yield p + t * r


def convex_overlap(a: np.ndarray, b: np.ndarray) -> float:
    """Common area of two convex polygons: the hull of inner corners and of edge crossings."""
    points = [p for p in a if _inside(b, p)] + [p for p in b if _inside(a, p)]
    points += list(_crossings(a, b))
    if len(points) < 3:
        return 0.0
    try:
        return float(ConvexHull(np.array(points)).volume)
    except QhullError:  # all on one line
        return 0.0


def iou(a, b) -> float:
    top = [float(x.center[2] + x.size[2] / 2) for x in (a, b)]
    bottom = [float(x.center[2] - x.size[2] / 2) for x in (a, b)]
    common = convex_overlap(footprint_of(a), footprint_of(b)) * max(0.0, min(top) - max(bottom))
    volumes = float(np.prod(np.asarray(a.size, float)) + np.prod(np.asarray(b.size, float)))
    return common / (volumes - common)


def overlap_depth(a, b) -> float:
    """The least over the face normals of both boxes of how far their shadows overlap."""
    axes = [np.array([0.0, 0, 1])]
    for box in (a, b):
        axes += list(rotation_z(float(box.yaw)).T[:2])
    depths = []
    for axis in axes:
        pa, pb = corners_of(a) @ axis, corners_of(b) @ axis
        depths.append(min(pa.max() - pb.min(), pb.max() - pa.min()))
    return min(depths)


def boxes_meet(a, b) -> bool:
    """Whether two boxes share a point, as a linear programme over both sets of corners."""
    ca, cb = corners_of(a), corners_of(b)
    equal = np.concatenate([ca.T, -cb.T], 1)
    sums = np.zeros((2, 16))
    sums[0, :8] = sums[1, 8:] = 1
    found = linprog(np.zeros(16), A_eq=np.vstack([equal, sums]), b_eq=[0, 0, 0, 1, 1])
    return found.status == 0


def point_triangle_distance(point: np.ndarray, triangle: np.ndarray) -> float:
    """Distance to a triangle as a tiny bounded least-squares problem over its weights."""
    a, b, c = np.asarray(triangle, float)
    point = np.asarray(point, float)
    basis = np.stack([b - a, c - a], 1)
    found = [np.linalg.norm(point - corner) for corner in (a, b, c)]
    weights = np.linalg.lstsq(basis, point - a, rcond=None)[0]
    if weights.min() >= 0 and weights.sum() <= 1:
        found.append(np.linalg.norm(a + basis @ weights - point))
    for start, end in ((a, b), (b, c), (c, a)):
        along = end - start
        length = along @ along
        t = np.clip((point - start) @ along / length, 0, 1) if length > 0 else 0.0
        found.append(np.linalg.norm(start + t * along - point))
    return float(min(found))
