"""What the projector of a structured-light camera does not light."""

from __future__ import annotations

import numpy as np
from jaxtyping import Bool, Float

_BETWEEN_PX = 1.5
"""An occluder lies so much disparity in front: neighbours on one surface differ by less."""
_NEAREST_M = 0.2


def unlit(
    depth_m: Float[np.ndarray, "height width"], focal_baseline: float
) -> Bool[np.ndarray, "height width"]:
    """Pixels in the shadow that nearer surfaces throw to their left.

    The projector stands a baseline b to the camera's right, as a Kinect's does, so the point at
    pixel u and depth z meets its image at u - f b / z. Of two points of a row that meet it at one
    place, the farther is not lit, so it has no disparity: the band beside the left edge of near
    things (Khoshelham and Oude Elberink, Sensors 12, 2012, section 2), (f b)(1/z_near - 1/z_far)
    pixels wide, unless the near thing is thinner than that.

    Args:
        depth_m: True depth along the optical axis; 0 = nothing there.
        focal_baseline: f b, pixel metres.
    """
    height, width = depth_m.shape
    if focal_baseline == 0 or width < 2:
        return np.zeros(depth_m.shape, bool)
    disparity = np.float32(focal_baseline) / np.maximum(depth_m, np.float32(_NEAREST_M))
    disparity[depth_m == 0] = 0
    meets = np.arange(width, dtype=np.float32) - disparity
    # Only who is overtaken from the right can be hidden, and only who overtakes can hide.
    least_behind = np.minimum.accumulate(meets[:, ::-1], axis=1)[:, ::-1]
    most_before = np.maximum.accumulate(meets, axis=1)
    hidden = np.flatnonzero((least_behind < meets) & (depth_m > 0))
    hiding = np.flatnonzero(most_before > meets)
    # Image of the projector, two cells per point so that a stretched surface leaves no gaps.
    margin = int(np.ceil(focal_baseline / _NEAREST_M)) + 1
    stride = width + margin + 2
    nearest = np.zeros(height * stride, np.float32)
    cell = _cells(meets, hiding, margin, stride)
    flat = disparity.ravel()
    # Where many meet one cell the last assignment stays: ascending, it is the nearest.
    order = np.argsort(flat[hiding], kind="stable")
    near, cell = flat[hiding][order], cell[order]
    for offset in (0, 1):
        nearest[cell + offset] = np.maximum(nearest[cell + offset], near)
    cell = _cells(meets, hidden, margin, stride)
    between = np.maximum(nearest[cell], nearest[cell + 1]) - flat[hidden]
    lost = np.zeros(depth_m.size, bool)
    lost[hidden[between > _BETWEEN_PX]] = True
    return lost.reshape(depth_m.shape)


def _cells(meets: np.ndarray, pixels: np.ndarray, margin: int, stride: int) -> np.ndarray:
    """First of the two cells around where each pixel's point meets the projector's image."""
    row = pixels // meets.shape[1]
    return row * stride + np.floor(meets.ravel()[pixels]).astype(np.int64) + margin
