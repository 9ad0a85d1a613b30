"""Border: from an image to a model's input, and from maps of a model back to the image (OpenCV)."""

from __future__ import annotations

import cv2
import numpy as np
from jaxtyping import Shaped, UInt8

from .sidecar import Sidecar


def prepare(
    image: UInt8[np.ndarray, "height width 3"], sidecar: Sidecar
) -> Shaped[np.ndarray, "a b c"]:
    """An RGB image as the model wants it: size, channel order, numbers, layout; no batch axis."""
    height, width = sidecar.input_size
    if sidecar.resize == "letterbox":
        ratio = pixels_per_pixel(image.shape[:2], sidecar)[0]
        inner = (round(image.shape[1] * ratio), round(image.shape[0] * ratio))
        fitted = np.full((height, width, 3), sidecar.pad, np.uint8)
        fitted[: inner[1], : inner[0]] = cv2.resize(image, inner, interpolation=cv2.INTER_LINEAR)
    else:
        fitted = cv2.resize(image, (width, height), interpolation=cv2.INTER_LINEAR)
    if sidecar.color == "BGR":
        fitted = fitted[..., ::-1]
    if sidecar.dtype != "uint8":
        fitted = (fitted - np.array(sidecar.mean, np.float32)) * np.array(sidecar.scale, np.float32)
        fitted = fitted.astype(sidecar.dtype)
    if sidecar.layout == "NCHW":
        fitted = fitted.transpose(2, 0, 1)
    return np.ascontiguousarray(fitted)


def pixels_per_pixel(shape: tuple[int, ...], sidecar: Sidecar) -> tuple[float, float]:
    """Pixels of the model's input per pixel of an image of ``shape`` (height, width): x, y."""
    height, width = sidecar.input_size
    x, y = width / shape[1], height / shape[0]
    return (min(x, y), min(x, y)) if sidecar.resize == "letterbox" else (x, y)


def to_image(
    model_map: Shaped[np.ndarray, "h w"],
    sidecar: Sidecar,
    shape: tuple[int, ...],
    *,
    smooth: bool,
    window: tuple[int, int, int, int] | None = None,
) -> Shaped[np.ndarray, "rows columns"]:
    """A map that covers the model's input, at the pixels of an image of ``shape``.

    Args:
        model_map: Of any resolution.
        sidecar: Says how the image was fitted into the input.
        shape: Height and width of the image.
        smooth: Interpolate linearly; else the nearest value.
        window: x0, y0, x1, y1: that part of the image alone.
    """
    step_x, step_y = _steps(model_map, sidecar, shape)
    covered_x, covered_y = round(step_x * shape[1]), round(step_y * shape[0])
    whole = np.allclose([covered_x, covered_y], [step_x * shape[1], step_y * shape[0]], atol=1e-6)
    if window is None and whole:  # five times as fast as the warp below, and the same
        how = cv2.INTER_LINEAR if smooth else cv2.INTER_NEAREST_EXACT
        covered = np.ascontiguousarray(model_map[:covered_y, :covered_x])
        return np.asarray(cv2.resize(covered, (shape[1], shape[0]), interpolation=how))
    x0, y0, x1, y1 = window or (0, 0, shape[1], shape[0])
    # Pixel centres are at halves: u = (x + 1/2) step - 1/2.
    to_map = np.array(
        [
            [step_x, 0.0, (x0 + 0.5) * step_x - 0.5],
            [0.0, step_y, (y0 + 0.5) * step_y - 0.5],
        ]
    )
    how = cv2.INTER_LINEAR if smooth else cv2.INTER_NEAREST
    warped = cv2.warpAffine(
        np.ascontiguousarray(model_map),
        to_map,
        (x1 - x0, y1 - y0),
        flags=cv2.WARP_INVERSE_MAP | how,
        borderMode=cv2.BORDER_REPLICATE,
    )
    return np.asarray(warped)


def reach(
    model_map: Shaped[np.ndarray, "h w"], least: float, sidecar: Sidecar, shape: tuple[int, ...]
) -> tuple[int, int, int, int] | None:
    """The window of an image of ``shape`` outside of which the smooth map is below ``least``.

    x0, y0, x1, y1 as `to_image` takes them; None where the map never gets there.
    """
    high = model_map >= least
    if not high.any():
        return None
    window = []
    for axis, step in zip((1, 0), _steps(model_map, sidecar, shape), strict=True):
        cells = np.flatnonzero(high.any(1 - axis))
        # A pixel draws on the two cells next to it: u = (x + 1/2) step - 1/2.
        first = int(np.floor((cells[0] - 0.5) / step - 0.5))
        last = int(np.ceil((cells[-1] + 1.5) / step - 0.5))
        window.append((max(first, 0), min(last + 1, shape[axis])))
    (x0, x1), (y0, y1) = window
    return (x0, y0, x1, y1) if x1 > x0 and y1 > y0 else None


def _steps(model_map: np.ndarray, sidecar: Sidecar, shape: tuple[int, ...]) -> tuple[float, float]:
    """Cells of a map that covers the model's input per pixel of the image: x, y."""
    height, width = sidecar.input_size
    ratio_x, ratio_y = pixels_per_pixel(shape, sidecar)
    return ratio_x * model_map.shape[1] / width, ratio_y * model_map.shape[0] / height
