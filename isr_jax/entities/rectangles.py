"""Minimum-area rectangles and gravity-aligned boxes that a few stray points do not stretch."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float

from ..geometry import canonical_box
from ..geometry.tight_box import min_area_angle
from ..types import Box

_ROUNDS = 3
"""Trim and fit anew this often; the trimmed set settles after one or two."""


def facing_direction(normals: Float[np.ndarray, "points 3"]) -> complex:
    """Mean of h^2 exp(4i phi) over normals of level length h and bearing phi.

    Its argument / 4 is the direction, up to quarter turns, that upright faces have; its modulus,
    at most 1, says how many are upright and how well they agree (0 for a cylinder).
    """
    level = normals[:, 0].astype(np.float64) + 1j * normals[:, 1]
    size = np.abs(level)
    return complex(np.mean(level**4 / np.maximum(size, 1e-9) ** 2)) if len(normals) else 0j


def trimmed_range(values: Float[np.ndarray, " points"], trim: float, margin: float):
    """Least and greatest value, without strays.

    The outer ``trim`` of an end counts as stray only if it lies farther than ``margin`` beyond the
    rest, so a clean outline keeps its exact extent.
    """
    low, high = np.quantile(values, [trim, 1 - trim])
    kept = values[(values >= low - margin) & (values <= high + margin)]
    return float(kept.min()), float(kept.max())


def robust_rectangle(
    points: Float[np.ndarray, "points 2"],
    trim: float,
    margin: float,
    facing: complex = 0j,
    weight: float = 0.0,
):
    """Angle, low corner and high corner (in the turned axes) of the least trimmed rectangle.

    ``facing`` and ``weight`` as in `min_area_angle`.
    """
    points = np.asarray(points, np.float64)
    kept = points
    for _ in range(_ROUNDS):
        angle = min_area_angle(kept, facing, weight)
        turned = points @ _turn(angle)
        ranges = [trimmed_range(turned[:, k], trim, margin) for k in range(2)]
        low, high = np.array(ranges).T
        kept = points[np.all((turned >= low - 1e-9) & (turned <= high + 1e-9), 1)]
    return angle, low, high


def _turn(angle: float) -> np.ndarray:
    """[2, 2]: row vectors times this are in axes turned by ``angle``."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s], [s, c]])


def rectangle_corners(angle: float, low, high) -> Float[np.ndarray, "4 2"]:
    """Corners of a turned rectangle, counter-clockwise."""
    corners = np.array([[low[0], low[1]], [high[0], low[1]], [high[0], high[1]], [low[0], high[1]]])
    return corners @ _turn(angle).T


def gravity_box(
    vertices: Float[np.ndarray, "vertices 3"],
    trim: float,
    margin: float,
    min_size_m: float,
    *,
    facing: complex = 0j,
    weight: float = 0.0,
) -> Box:
    """Least gravity-aligned box around the vertices, strays left out; no side below a minimum.

    ``facing`` and ``weight`` as in `min_area_angle`.
    """
    angle, low, high = robust_rectangle(vertices[:, :2], trim, margin, facing, weight)
    z = trimmed_range(vertices[:, 2].astype(np.float64), trim, margin)
    size = np.array([high[0] - low[0], high[1] - low[1], z[1] - z[0]])
    middle = (low + high) / 2 @ _turn(angle).T
    center = np.array([middle[0], middle[1], (z[0] + z[1]) / 2])
    return canonical_box(center, angle, np.maximum(size, min_size_m))
