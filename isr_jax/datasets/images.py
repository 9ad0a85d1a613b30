"""Border: OpenCV. Colour and depth images from files, with damage told from content."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import cv2
import numpy as np
from jaxtyping import Float, UInt8

from ..errors import FrameError
from ..types import Camera
from .image_slice import ImageSlice

_TAIL_BYTES = 64
"""An end marker stands this near the end; some cameras append a few bytes of padding."""
_NO_RETURN = 65535
"""Kinect recordings mark missing depth with the largest value as well as with 0."""


@dataclasses.dataclass(frozen=True)
class ColorCamera:
    """A colour camera that stands beside the depth camera, or in it, axes parallel."""

    fx: float
    """Focal length, pixels."""
    fy: float
    cx: float
    cy: float
    x_m: float = 0.0
    """Where the depth camera's origin lies along the colour camera's x axis, metres."""
    width: int | None = None
    """Of the colour images, pixels; None: the depth camera's."""
    height: int | None = None

    def resized(self, width: int, height: int) -> ColorCamera:
        """The camera of the same images at another size; centres of pixels are whole numbers."""
        x = width / (self.width or width)
        y = height / (self.height or height)
        cx, cy = (self.cx + 0.5) * x - 0.5, (self.cy + 0.5) * y - 0.5
        return ColorCamera(self.fx * x, self.fy * y, cx, cy, self.x_m, width, height)


def read_color(path: Path | ImageSlice) -> UInt8[np.ndarray, "height width 3"]:
    """An RGB image, from a file or a place in one.

    Raises:
        FrameError: the file is missing, cut off or no image.
    """
    if isinstance(path, ImageSlice) and path.coding == "raw_rgb":
        return path.rgb()
    image = _decode(path, cv2.IMREAD_COLOR_RGB)
    return np.ascontiguousarray(image)


def read_depth(
    path: Path | ImageSlice, units_per_metre: float
) -> Float[np.ndarray, "height width"]:
    """Depth in metres, 0 = no return; the file holds ``units_per_metre`` as 16-bit integers.

    Raises:
        FrameError: the file is missing, cut off or no 16-bit image of one channel.
    """
    sliced = isinstance(path, ImageSlice)
    image = path.depth() if sliced else _decode(path, cv2.IMREAD_UNCHANGED)
    if image.dtype != np.uint16 or image.ndim != 2:
        channels = 1 if image.ndim == 2 else image.shape[2]
        raise FrameError(
            f"{path} holds {channels} channel(s) of {image.dtype}, not one of uint16",
            "write depth as a 16-bit single-channel PNG",
        )
    depth_m = image.astype(np.float32) / np.float32(units_per_metre)
    depth_m[image == _NO_RETURN] = 0.0
    return depth_m


def register_color(
    color: UInt8[np.ndarray, "height width 3"],
    depth_m: Float[np.ndarray, "height width"],
    depth_camera: Camera,
    color_camera: ColorCamera,
) -> UInt8[np.ndarray, "height width 3"]:
    """Colour as the depth camera sees it; a pixel without return takes its neighbour's depth.

    u' = cx' + fx' (x + x_m) / z,  v' = cy' + fy' y / z  for the point (x, y, z) of pixel (u, v).
    """
    missing = (depth_m <= 0).astype(np.uint8)
    if missing.all():
        return color
    labels = cv2.distanceTransformWithLabels(
        missing, cv2.DIST_L2, 3, labelType=cv2.DIST_LABEL_PIXEL
    )[1]
    nearest = np.asarray(labels, np.int32)
    depth_of_label = np.zeros(nearest.max() + 1, np.float32)
    depth_of_label[nearest[missing == 0]] = depth_m[missing == 0]
    z = depth_of_label[nearest]
    v, u = np.indices(depth_m.shape, np.float32)
    x_over_z = (u - depth_camera.cx) / depth_camera.fx + color_camera.x_m / z
    y_over_z = (v - depth_camera.cy) / depth_camera.fy
    map_u = np.asarray(color_camera.cx + color_camera.fx * x_over_z, np.float32)
    map_v = np.asarray(color_camera.cy + color_camera.fy * y_over_z, np.float32)
    moved = cv2.remap(color, map_u, map_v, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    return np.asarray(moved, np.uint8)


def resize_color(
    color: UInt8[np.ndarray, "height width 3"], width: int, height: int
) -> UInt8[np.ndarray, "new_height new_width 3"]:
    """The image at another size, averaged where it shrinks."""
    shrinks = width < color.shape[1]
    method = cv2.INTER_AREA if shrinks else cv2.INTER_LINEAR
    return np.asarray(cv2.resize(color, (width, height), interpolation=method), np.uint8)


def _decode(path: Path | ImageSlice, flags: int) -> np.ndarray:
    try:
        data = path.read_bytes()
    except OSError as error:
        raise FrameError(f"{path}: {error.strerror}", "restore the file or skip it") from None
    _check_end(path, data[:2], data[-_TAIL_BYTES:], len(data))
    try:
        image = cv2.imdecode(np.frombuffer(data, np.uint8), flags)
    except cv2.error as error:
        raise FrameError(f"{path} cannot be decoded: {error.err}", "write it again") from None
    if image is None:
        raise FrameError(f"{path} is damaged or no image", "write it again as JPEG or PNG")
    return image


def check_complete(path: Path | ImageSlice) -> None:
    """Check that a file is not cut off, without decoding it.

    Raises:
        FrameError: the file is missing or cut.
    """
    if isinstance(path, ImageSlice):
        data = path.read_bytes()
        if path.coding == "encoded":
            _check_end(path, data[:2], data[-_TAIL_BYTES:], len(data))
        return
    try:
        with path.open("rb") as file:
            start = file.read(2)
            size = file.seek(0, 2)
            file.seek(max(0, size - _TAIL_BYTES))
            tail = file.read()
    except OSError as error:
        raise FrameError(f"{path}: {error.strerror}", "restore the file or skip it") from None
    _check_end(path, start, tail, size)


def _check_end(path: Path | ImageSlice, start: bytes, tail: bytes, size: int) -> None:
    """OpenCV fills what is missing of a cut JPEG with grey; only the end marker tells."""
    marker = {b"\xff\xd8": b"\xff\xd9", b"\x89P": b"IEND"}.get(start)
    if size == 0 or (marker is not None and marker not in tail):
        raise FrameError(
            f"{path} is cut off: it ends after {size} bytes without its end marker",
            "copy or record the file again",
        )
