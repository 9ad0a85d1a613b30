"""Pinhole cameras of published depth sensors, after their lens distortion was taken out."""

from __future__ import annotations

from ...errors import SettingError
from ...types import Camera

_AT_640_X_480 = {
    "kinect": (585.0, 585.0, 320.0, 240.0),
    "kinect_depth": (591.1, 590.1, 331.0, 234.0),
    "kinect_color": (517.3, 516.5, 318.6, 255.3),
    "xtion": (535.4, 539.2, 320.1, 247.6),
    "structure": (577.870605, 577.870605, 319.5, 239.5),
}
"""fx, fy, cx, cy in pixels. ``kinect``: the maker's focal length (a field of view of 57 degrees),
the axis in the middle. ``kinect_depth``, ``kinect_color``, ``xtion``: calibrations of the TUM RGB-D
benchmark (Sturm et al., IROS 2012): infrared and colour camera of freiburg1, colour camera of
freiburg3. ``structure``: depth camera of ScanNet (Dai et al., CVPR 2017)."""
CAMERAS = tuple(_AT_640_X_480)
"""Names of the cameras."""


def named_camera(name: str, width: int, height: int) -> Camera:
    """A published camera, scaled from 640 x 480 to another size of image.

    Raises:
        SettingError: no camera has that name.
    """
    if name not in _AT_640_X_480:
        raise SettingError(f"no camera {name!r} is known", f"use one of: {', '.join(CAMERAS)}")
    fx, fy, cx, cy = _AT_640_X_480[name]
    across, down = width / 640, height / 480
    return Camera(fx * across, fy * down, cx * across, cy * down, width, height)


def default_camera(width: int, height: int) -> Camera:
    """A pinhole camera with a Kinect's field of view across; pixels are square."""
    focal = 585.0 * width / 640
    return Camera(focal, focal, width / 2, height / 2, width, height)
