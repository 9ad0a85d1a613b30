"""Which pixels the lamp of a room lights."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float

from ...borders.raycast import RayScene

STRIDE = 2
"""Pixels between rays; what lies between is interpolated, which also softens the edges."""
_OFF_M = 0.004
"""Rays start this far off the surface."""
_SHORT_OF = 0.995
"""And end short of the lamp by the rest of their length."""


def lit_share(
    scene: RayScene,
    lamp: Float[np.ndarray, "3"],
    point: Float[np.ndarray, "rows columns 3"],
    normal: Float[np.ndarray, "rows columns 3"],
    shape: tuple[int, int],
) -> Float[np.ndarray, "height width"]:
    """Share of the lamp each pixel sees, from the points of every second row and column.

    Args:
        scene: What throws shadows.
        lamp: World frame, metres.
        point: Of pixels (2 i, 2 j), world frame.
        normal: There, unit, towards the camera; 0 where nothing is.
        shape: Of the image.
    """
    towards = lamp - point
    away = np.einsum("rci,rci->rc", towards, normal) <= 0
    start = (point + np.float32(_OFF_M) * normal).reshape(-1, 3)
    faces_lamp = np.flatnonzero(~away.ravel())
    lit = np.zeros(away.size, np.float32)
    blocked = scene.blocked(start[faces_lamp], towards.reshape(-1, 3)[faces_lamp], _SHORT_OF)
    lit[faces_lamp] = ~blocked
    lit = lit.reshape(away.shape)
    # A surface turned from the lamp is dark by its cosine; here it would darken its neighbours.
    lit[away] = 1.0
    return between(between(lit, 0, shape[0]), 1, shape[1])


def between(
    samples: Float[np.ndarray, "rows columns"], axis: int, length: int
) -> Float[np.ndarray, "out_rows out_columns"]:
    """Samples at 0, 2, 4, ... and the means of neighbours between them, ``length`` in all."""
    later = np.concatenate([samples[1:], samples[-1:]]) if axis == 0 else None
    if later is None:
        later = np.concatenate([samples[:, 1:], samples[:, -1:]], axis=1)
    pairs = np.stack([samples, (samples + later) * np.float32(0.5)], axis + 1)
    shape = list(samples.shape)
    shape[axis] *= 2
    whole = pairs.reshape(shape)
    return whole[:length] if axis == 0 else whole[:, :length]
