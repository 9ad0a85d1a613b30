"""The least gravity-aligned box around points, strays and all."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float
from scipy.spatial import ConvexHull, QhullError

from ...geometry.boxes import canonical_box
from ...types import Box


def tight_box(points: Float[np.ndarray, "points 3"]) -> Box:
    """Footprint of least area, height from the lowest to the highest point; metres.

    One side of the rectangle of least area lies along an edge of the convex hull (Freeman and
    Shapira 1975), so every edge is tried. Fewer than three points, or points on one line, give
    the box along the axes.
    """
    flat = points[:, :2].astype(np.float64)
    try:
        hull = flat[ConvexHull(flat).vertices]
        edges = np.roll(hull, -1, 0) - hull
        angles = np.unique(np.arctan2(edges[:, 1], edges[:, 0]) % (np.pi / 2))
    except (QhullError, ValueError):
        hull, angles = flat, np.zeros(1)
    axes = np.stack([np.cos(angles), np.sin(angles)], 1)
    u, v = hull @ axes.T, hull @ np.stack([-axes[:, 1], axes[:, 0]])
    best = int(np.argmin(np.ptp(u, 0) * np.ptp(v, 0)))
    middle = np.array([np.ptp(w[:, best]) / 2 + w[:, best].min() for w in (u, v)])
    c, s = axes[best]
    low, high = points[:, 2].min(), points[:, 2].max()
    center = [c * middle[0] - s * middle[1], s * middle[0] + c * middle[1], (low + high) / 2]
    size = [np.ptp(u[:, best]), np.ptp(v[:, best]), high - low]
    return canonical_box(np.array(center), float(angles[best]), np.array(size))
