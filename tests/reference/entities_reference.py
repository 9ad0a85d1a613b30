"""Slow twins of the entity kernels: one plane by draws, and the least rectangle by search."""

from __future__ import annotations

import numpy as np


def fit_plane(points: np.ndarray) -> tuple[np.ndarray, float]:
    """Total least squares by singular values."""
    center = points.mean(0)
    normal = np.linalg.svd(points - center)[2][2]
    return normal, float(-normal @ center)


def inliers(points, normals, live, normal, offset, threshold, min_cosine):
    return [
        i
        for i in range(len(points))
        if live[i]
        and abs(points[i] @ normal + offset) < threshold
        and normals[i] @ normal > min_cosine
    ]


def refit(points, normals, live, plane, threshold, min_cosine):
    chosen = inliers(points, normals, live, *plane, threshold, min_cosine)
    if len(chosen) < 3:
        return plane
    normal, offset = fit_plane(points[chosen])
    sign = -1.0 if normals[chosen].sum(0) @ normal < 0 else 1.0
    return sign * normal, sign * offset


def best_plane(points, normals, live, draws, threshold, min_cosine):
    """The plane of the draw with the most inliers (the first of equals), refitted twice."""
    points, normals = points.astype(float), normals.astype(float)
    alive = np.flatnonzero(live)
    best, most = None, -1
    for draw in draws:
        pick = alive[int(np.floor(np.float32(draw) * np.float32(len(alive))))]
        plane = normals[pick], -normals[pick] @ points[pick]
        plane = refit(points, normals, live, plane, 2 * threshold, min_cosine)
        count = len(inliers(points, normals, live, *plane, threshold, min_cosine))
        if count > most:
            best, most = plane, count
    for _ in range(2):
        best = refit(points, normals, live, best, threshold, min_cosine)
    return (*best, inliers(points, normals, live, *best, threshold, min_cosine))


def least_rectangle_area(points, steps=9001):
    """Least area over a fine grid of directions."""
    angles = np.linspace(0, np.pi / 2, steps)
    along = points @ np.stack([np.cos(angles), np.sin(angles)])
    across = points @ np.stack([-np.sin(angles), np.cos(angles)])
    return float(np.min(np.ptp(along, 0) * np.ptp(across, 0)))
