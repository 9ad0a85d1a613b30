"""Slow twins of the measures of CAD replacement, one loop a sentence of their definition."""

from __future__ import annotations

import itertools

import numpy as np


def point_triangle_distance(p, triangle) -> float:
    """Least distance over the inside and the three sides, each by its own formula."""
    a, b, c = (np.asarray(v, np.float64) for v in triangle)
    found = [_segment_distance(p, u, v) for u, v in ((a, b), (b, c), (c, a))]
    normal = np.cross(b - a, c - a)
    if normal @ normal > 0:
        foot = p - normal * ((p - a) @ normal) / (normal @ normal)
        turns = [np.cross(v - u, foot - u) @ normal for u, v in ((a, b), (b, c), (c, a))]
        if min(turns) >= 0:
            found.append(float(np.linalg.norm(p - foot)))
    return min(found)


def _segment_distance(p, u, v) -> float:
    along = v - u
    t = np.clip((p - u) @ along / max(along @ along, 1e-300), 0, 1)
    return float(np.linalg.norm(p - u - t * along))


def surface_distances(points, triangles) -> np.ndarray:
    return np.array([min(point_triangle_distance(p, t) for t in triangles) for p in points])


def quaternion(R) -> np.ndarray:
    """w x y z of a rotation matrix, from its largest component."""
    K = np.array(
        [
            [R[0, 0] + R[1, 1] + R[2, 2], 0, 0, 0],
            [R[2, 1] - R[1, 2], R[0, 0] - R[1, 1] - R[2, 2], 0, 0],
            [R[0, 2] - R[2, 0], R[0, 1] + R[1, 0], R[1, 1] - R[0, 0] - R[2, 2], 0],
            [R[1, 0] - R[0, 1], R[0, 2] + R[2, 0], R[1, 2] + R[2, 1], R[2, 2] - R[0, 0] - R[1, 1]],
        ]
    )
    values, vectors = np.linalg.eigh(K / 3)  # reads the lower triangle
    assert values[-1] > 0.99  # of a rotation the largest is 1
    return vectors[:, -1]


def product(p, q) -> np.ndarray:
    w, v, a, b = p[0], p[1:], q[0], q[1:]
    return np.array([w * a - v @ b, *(w * b + a * v + np.cross(v, b))])


def official_scan2cad(truth, predicted, center_m=0.2, degrees=20.0, percent=20.0):
    """(good, total) a class, as the benchmark counts: quaternions, lists, first fit deleted.

    ``truth`` and ``predicted`` are dicts of id, class, R, t, s, symmetry. Up is +z.
    """
    left = {}
    for cad in truth:
        left.setdefault(cad["class"], []).append(cad)
    total = {name: len(cads) for name, cads in left.items()}
    good = dict.fromkeys(total, 0)
    allowed = {cad["id"]: sum(c["id"] == cad["id"] for c in truth) for cad in truth}
    symmetry = {cad["id"]: cad["symmetry"] for cad in truth}
    counter = {}
    for cad in predicted:
        if counter.get(cad["id"], 0) >= allowed.get(cad["id"], 0):
            continue
        counter[cad["id"]] = counter.get(cad["id"], 0) + 1
        steps = {1: 1, 2: 2, 4: 4, 0: 36}[symmetry[cad["id"]]]
        for k, true in enumerate(left.get(cad["class"], [])):
            angles = []
            for i in range(steps):
                half = i * np.pi / steps
                turned = product(
                    quaternion(true["R"]), np.array([np.cos(half), 0, 0, np.sin(half)])
                )
                dot = min(1.0, abs(turned @ quaternion(cad["R"])))
                angles.append(np.rad2deg(2 * np.arccos(dot)))
            near = np.linalg.norm(cad["t"] - true["t"]) <= center_m
            scaled = 100 * abs(np.mean(cad["s"] / true["s"]) - 1) <= percent
            if near and min(angles) <= degrees and scaled:
                good[cad["class"]] += 1
                del left[cad["class"]][k]
                break
    return {name: (good[name], total[name]) for name in total}


def most_pairs(fits) -> int:
    """Most pairs of a one-to-one assignment, by trying all of them."""
    rows, columns = fits.shape
    if rows > columns:
        fits, rows, columns = fits.T, columns, rows
    ways = itertools.permutations(range(columns), rows)
    return max((sum(bool(fits[r, c]) for r, c in enumerate(way)) for way in ways), default=0)


def lexicographic_rank(grades) -> int:
    """How many of the 81 grades stand before this one in a dictionary."""
    return sorted(itertools.product(range(3), repeat=4)).index(tuple(grades))
