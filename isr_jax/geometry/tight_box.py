"""The least rectangle around points, and the least gravity-aligned box, strays and all."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float
from scipy.spatial import ConvexHull, QhullError

from ..types import Box
from .boxes import canonical_box


def hull_points(points: Float[np.ndarray, "points 2"]) -> Float[np.ndarray, "hull 2"]:
    """Corners of the convex hull; the points themselves where they lie on one line."""
    try:
        return points[ConvexHull(points).vertices]
    except (QhullError, ValueError):
        return points


def min_area_angle(
    points: Float[np.ndarray, "points 2"], facing: complex = 0j, weight: float = 0.0
) -> float:
    """Direction of a side of the least rectangle around the points, in [-pi/4, pi/4).

    One side of it lies on the hull (Freeman and Shapira, 1975), so every hull edge is tried; ties
    go to the direction nearest the axes. Points on one line give the direction of the line.

    Where ``weight`` > 0 the score is area / least area - weight * Re(facing exp(-4i angle)): two
    faces of a cabinet are a right triangle from above, whose least rectangles along its legs and
    along its hypotenuse are equally large, and only the faces' normals tell them apart.

    Args:
        points: Seen from above.
        facing: Mean of h^2 exp(4i phi) over normals of level length h and bearing phi: its
            argument / 4 is the direction that upright faces have, its modulus how many agree.
        weight: Of the faces against the area; 0: the area alone.
    """
    hull = hull_points(np.asarray(points, np.float64))
    edges = np.roll(hull, -1, 0) - hull
    edges = edges[np.linalg.norm(edges, axis=1) > 1e-9]
    angles = np.arctan2(edges[:, 1], edges[:, 0])
    if weight > 0 and abs(facing) > 0:
        angles = np.append(angles, np.angle(facing) / 4)
    if len(angles) == 0:
        return 0.0
    angles = np.mod(angles + np.pi / 4, np.pi / 2) - np.pi / 4
    along = np.stack([np.cos(angles), np.sin(angles)], 1)
    across = np.stack([-along[:, 1], along[:, 0]], 1)
    area = np.ptp(along @ hull.T, 1) * np.ptp(across @ hull.T, 1)
    score = area / max(float(area.min()), 1e-9) - weight * (facing * np.exp(-4j * angles)).real
    best = np.lexsort((np.abs(angles), np.round(score, 9)))[0]
    return float(angles[best])


def tight_box(points: Float[np.ndarray, "points 3"]) -> Box:
    """Footprint of least area, height from the lowest to the highest point; metres."""
    angle = min_area_angle(points[:, :2])
    c, s = np.cos(angle), np.sin(angle)
    axes = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    turned = points.astype(np.float64) @ axes
    low, high = turned.min(0), turned.max(0)
    return canonical_box(axes @ ((low + high) / 2), angle, high - low)
