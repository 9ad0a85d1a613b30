"""Slow NumPy/SciPy twin of the alignment, one pair at a time, float64."""

from __future__ import annotations

import numpy as np
from scipy.optimize import least_squares


def rotation_z(angle):
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1.0]])


def residual_parts(pose, pair, weights, normal_residual="vector"):
    """sqrt(Sigma) e at (scale, world yaw, world x, world y), straight from world coordinates."""
    scale, yaw, x, y = pose
    R = rotation_z(yaw) @ pair["rotation"]
    size = scale * np.abs(pair["rotation"]) @ pair["model_size"]
    center = np.array([x, y, pair["support_height_m"] + size[2] / 2])
    box = pair["box_center"], pair["box_yaw"], pair["box_size"]
    out = []
    for sx, sy in ((-1, -1), (1, -1), (1, 1), (-1, 1)):
        corner = rotation_z(yaw) @ np.array([sx * size[0] / 2, sy * size[1] / 2, 0]) + center
        local = rotation_z(box[1]).T @ (corner - box[0])
        for axis in (0, 1):
            for sign in (-1, 1):
                beyond = max(0.0, sign * local[axis] - box[2][axis] / 2)
                out.append(weights["footprint"] * beyond)
    out.append(weights["height"] * (size[2] - box[2][2]) / 2)
    out.append(weights["scale"] * np.log(scale))
    for k in np.flatnonzero(pair["plane_valid"]):
        n, d = (
            pair["entity_normal"][k],
            pair["entity_offset"][k] + pair["entity_normal"][k] @ box[0],
        )
        m = R @ pair["model_normal"][k]
        e = scale * pair["model_offset"][k] - m @ (center - box[0])
        gap = n - m if normal_residual == "vector" else [1 - n @ m]
        out.extend(weights["normal"] * np.asarray(gap))
        out.append(weights["offset"] * (d - e))
        if pair["plane_supporting"][k]:
            above_center = -d / n[2]
            moved = -(e + m[:2] @ (center - box[0])[:2]) / m[2]
            out.append(weights["support"] * (above_center - moved))
    return np.array(out)


def solve(pair, weights, bounds, normal_residual="vector"):
    """The best (scale, world yaw, world x, world y) and its J, by scipy's bounded solver."""
    start = np.array([pair["start_scale"], pair["box_yaw"], *pair["box_center"][:2]])
    low = np.array([bounds[0], -np.inf, -np.inf, -np.inf])
    high = np.array([bounds[1], np.inf, np.inf, np.inf])
    mid, half = np.log(np.prod(bounds)) / 2, np.log(bounds[1] / bounds[0]) / 2

    def u(scale):
        return np.arcsin(np.clip((np.log(scale) - mid) / half, -1, 1))

    u0 = np.arcsin(np.clip((np.log(pair["start_scale"]) - mid) / half, -0.9, 0.9))

    def fun(pose):
        turn_back = rotation_z(pair["box_yaw"])[:2, :2].T
        shift = turn_back @ (pose[2:] - pair["box_center"][:2])
        prior = np.array([u(pose[0]) - u0, pose[1] - pair["box_yaw"], *shift])
        return np.concatenate(
            [residual_parts(pose, pair, weights, normal_residual), weights["prior"] * prior]
        )

    start[0] = np.clip(start[0], low[0] * 1.01, high[0] / 1.01)
    found = least_squares(fun, start, bounds=(low, high), xtol=1e-14, ftol=1e-14, gtol=1e-14)
    return found.x, np.sum(residual_parts(found.x, pair, weights, normal_residual) ** 2)


def point_triangle_distance(p, a, b, c):
    """By regions (Ericson, Real-Time Collision Detection, 5.1.5); needles by their edges."""
    if np.linalg.norm(np.cross(b - a, c - a)) < 1e-12:
        return min(segment_distance(p, *ends) for ends in ((a, b), (b, c), (c, a)))
    ab, ac, ap = b - a, c - a, p - a
    d1, d2 = ab @ ap, ac @ ap
    if d1 <= 0 and d2 <= 0:
        return np.linalg.norm(p - a)
    bp = p - b
    d3, d4 = ab @ bp, ac @ bp
    if d3 >= 0 and d4 <= d3:
        return np.linalg.norm(p - b)
    vc = d1 * d4 - d3 * d2
    if vc <= 0 and d1 >= 0 and d3 <= 0:
        return np.linalg.norm(p - (a + d1 / (d1 - d3) * ab))
    cp = p - c
    d5, d6 = ab @ cp, ac @ cp
    if d6 >= 0 and d5 <= d6:
        return np.linalg.norm(p - c)
    vb = d5 * d2 - d1 * d6
    if vb <= 0 and d2 >= 0 and d6 <= 0:
        return np.linalg.norm(p - (a + d2 / (d2 - d6) * ac))
    va = d3 * d6 - d5 * d4
    if va <= 0 and d4 - d3 >= 0 and d5 - d6 >= 0:
        w = (d4 - d3) / ((d4 - d3) + (d5 - d6))
        return np.linalg.norm(p - (b + w * (c - b)))
    total = va + vb + vc
    return np.linalg.norm(p - (a + vb / total * ab + vc / total * ac))


def segment_distance(p, a, b):
    along = b - a
    t = np.clip((p - a) @ along / max(along @ along, 1e-30), 0, 1)
    return np.linalg.norm(p - a - t * along)


def alignment_error(T, scale, points, vertices, faces):
    """RMS distance from points to the moved mesh, by brute force over moved triangles."""
    moved = scale * vertices @ T[:3, :3].T + T[:3, 3]
    nearest = [min(point_triangle_distance(p, *moved[face]) for face in faces) for p in points]
    return np.sqrt(np.mean(np.square(nearest)))
