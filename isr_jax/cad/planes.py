"""What a plane of a model is: its rectangle, and when it is large and free enough to carry.

The kit finds planes from convex solids, imports from the faces of meshes; both mean this.
"""

from __future__ import annotations

import dataclasses
import functools

import numpy as np
from jaxtyping import Float

MAX_PLANES = 16
MIN_AREA_SHARE = 0.03
"""Of the three box faces' sum: smaller planes are neither found in a scan nor kept."""
MIN_SUPPORT_SIDE_M = 0.07
MIN_SUPPORT_AREA_M2 = 0.008
MIN_SUPPORT_SHARE = 0.4
"""Of the rectangle: less is a rim around something else."""
CLEARANCE_M = 0.08
"""What stands on a surface needs at least this height above it."""
LEVEL_COSINE = 0.9
"""Least upward part of the normal of what carries."""
SIGHT_POINTS = 32
SEEN_SHARE = 0.3
"""Of so many points a plane shows at least this share to someone outside."""
LEAST_SIGHT_COSINE = 0.1
"""Least cosine between a line of sight and the normal."""


@dataclasses.dataclass(frozen=True, eq=False)
class Plane:
    """One plane with its rectangle, frame of the model."""

    normal: np.ndarray
    corners: np.ndarray
    """[4, 3], counter-clockwise seen against the normal."""
    area_m2: float
    link: str
    supporting: bool


def rectangle_corners(
    axes: Float[np.ndarray, "2 3"],
    normal: Float[np.ndarray, "3"],
    offset: float,
    low: Float[np.ndarray, "2"],
    high: Float[np.ndarray, "2"],
) -> Float[np.ndarray, "4 3"]:
    """Corners of the rectangle from ``low`` to ``high`` along two axes of a plane, metres."""
    (u0, v0), (u1, v1) = low, high
    return np.array([(u0, v0), (u1, v0), (u1, v1), (u0, v1)]) @ axes - offset * normal


def can_carry(sides_m: Float[np.ndarray, "2"], area_m2: float) -> bool:
    """Whether a free rectangle of these sides, so much of it solid, is large enough to carry."""
    least = max(MIN_SUPPORT_AREA_M2, MIN_SUPPORT_SHARE * sides_m.prod())
    return bool(sides_m.min() >= MIN_SUPPORT_SIDE_M and area_m2 >= least)


@functools.cache
def sphere_directions(count: int = 40) -> np.ndarray:
    """Directions spread evenly over the sphere (golden spiral)."""
    i = np.arange(count) + 0.5
    z, angle = 1 - 2 * i / count, np.pi * (1 + 5**0.5) * i
    ring = np.sqrt(1 - z * z)
    return np.stack([ring * np.cos(angle), ring * np.sin(angle), z], 1)
