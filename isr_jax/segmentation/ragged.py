"""Border: masks with ragged edges at a wanted IoU (OpenCV's distance transform)."""

from __future__ import annotations

import cv2
import numpy as np
from jaxtyping import Bool, Float

_STEPS = 12
"""Bisections of the raggedness: 2^-12 of its range is far below a pixel."""


def smooth_noise(
    shape: tuple[int, ...], wavelength_px: float, generator: np.random.Generator
) -> Float[np.ndarray, "height width"]:
    """Smooth noise in [-1, 1]: random values on a coarse grid, enlarged by cubics."""
    coarse = [max(2, int(np.ceil(n / wavelength_px)) + 1) for n in shape]
    values = generator.uniform(-1, 1, coarse).astype(np.float32)
    return cv2.resize(values, (shape[1], shape[0]), interpolation=cv2.INTER_CUBIC)


def ragged(
    mask: Bool[np.ndarray, "height width"],
    allowed: Bool[np.ndarray, "height width"],
    iou: float,
    generator: np.random.Generator,
) -> Bool[np.ndarray, "height width"]:
    """``mask`` with an uneven edge such that its IoU with ``mask`` is ``iou``.

    The edge moves to where the signed distance equals a smooth noise, whose amplitude is found by
    bisection. It may grow only into ``allowed``.
    """
    rows, columns = _window(mask)
    inside, allowed = mask[rows, columns], allowed[rows, columns]
    distance = cv2.distanceTransform(inside.astype(np.uint8), cv2.DIST_L2, 3)
    distance -= cv2.distanceTransform((~inside).astype(np.uint8), cv2.DIST_L2, 3)
    size = np.sqrt(np.count_nonzero(inside))
    noise = smooth_noise(inside.shape, max(4.0, size / 4), generator)
    low, high = 0.0, 4.0 * float(size)
    for _ in range(_STEPS):
        middle = 0.5 * (low + high)
        found = (distance + middle * noise > 0) & (inside | allowed)
        overlap = np.count_nonzero(found & inside)
        union = np.count_nonzero(found) + np.count_nonzero(inside) - overlap
        low, high = (middle, high) if overlap > iou * union else (low, middle)
    result = np.zeros(mask.shape, bool)
    result[rows, columns] = (distance + low * noise > 0) & (inside | allowed)
    return result


def _window(mask: np.ndarray) -> tuple[slice, slice]:
    """The mask's box, grown by a third of its size on each side."""
    slices = []
    for axis in (1, 0):
        at = np.flatnonzero(mask.any(axis))
        margin = (at[-1] - at[0]) // 3 + 4
        slices.append(slice(max(at[0] - margin, 0), min(at[-1] + margin + 1, mask.shape[1 - axis])))
    return slices[0], slices[1]
