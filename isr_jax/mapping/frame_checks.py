"""What the map asks of a camera, and of every frame and its segments, before it integrates them.

Readers of recordings check files (`datasets.checks`); this is the border for frames from anywhere:
a live camera, a simulator, a segmenter of one's own.
"""

from __future__ import annotations

import functools

import numpy as np
from jaxtyping import Bool, Float, Float32, Int32

from ..classes import classes
from ..errors import FrameError, MapError
from ..types import Camera, Frame, FrameSegments
from .packing import MAX_SEGMENTS

MAX_COORDINATE_M = 500.0
"""At this distance float32 steps are 0.03 mm, below the step in which depth is packed."""
SATURATED_M = 65.535
"""What 65535, the largest 16-bit value, means in millimetres: a sensor's mark of no return."""
_SATURATED_TOLERANCE_M = 1e-3
_ROOM_M = (0.01, 20.0)
"""A frame that lies nearer throughout, or farther throughout, is not in metres."""
_BAD_SHARE = 0.5
"""A frame with more pixels that are no depth (0 is) says nothing of its sensor's unit or state."""
_ROTATION_TOLERANCE = 1e-2
"""Largest entry of R R^T - I that counts as rounding of a recorded pose."""
_CENTRE_SHARE = 0.2
"""The principal point lies this near the middle of the image, as a share of its size."""
_FOCAL_SHARE = (0.2, 10.0)
"""Focal length over image side: fields of view from 136 to 6 degrees."""


def check_camera(camera: Camera) -> None:
    """Refuse a camera that cannot be that of its images.

    Raises:
        MapError: its focal lengths or principal point do not fit the size of its images.
    """
    sides = (("fx", camera.fx, "cx", camera.cx, camera.width),)
    sides += (("fy", camera.fy, "cy", camera.cy, camera.height),)
    for focal, f, centre, c, side in sides:
        low, high = _FOCAL_SHARE
        if side < 1 or not low * side <= f <= high * side:
            raise MapError(
                f"camera of {camera.width}x{camera.height} pixels with {focal} = {f:g}: a focal "
                f"length is {low:g} to {high:g} times the image's side",
                "give the intrinsics of the depth image, in pixels",
            )
        if not abs(c / side - 0.5) <= _CENTRE_SHARE:
            raise MapError(
                f"camera of {camera.width}x{camera.height} pixels with {centre} = {c:g}: the "
                f"principal point lies within {_CENTRE_SHARE:.0%} of the middle, {side / 2:g}",
                "give intrinsics of this resolution: halving an image halves fx, fy, cx and cy",
            )


def checked(
    frame: Frame, segments: FrameSegments, camera: Camera
) -> tuple[Float32[np.ndarray, "height width"], Int32[np.ndarray, "height width"]]:
    """Depth and segments to integrate: no return is 0, and dynamic classes are left out.

    NaN, infinite, negative and saturated depth is no return. People and animals would leave ghosts
    in the map, so they are no return and no segment.

    Args:
        frame: Depth in metres; its pose within `MAX_COORDINATE_M` of the origin.
        segments: Of the same pixels.
        camera: The map's; every frame's is the same.

    Raises:
        FrameError: this frame cannot be used; the map is as before and goes on with others.
    """
    _check_images(frame, segments, camera)
    check_pose(frame.T_world_camera, f"frame {frame.name}")
    _check_tables(frame, segments)
    depth_m = _returns(frame)
    segment = segments.segment.astype(np.int32, copy=False)
    dynamic = _dynamic()[segments.class_id]
    dynamic[0] = False  # row 0 stands for nothing, whatever class it says
    if dynamic.any():
        hidden = dynamic[segment]
        depth_m = np.where(hidden, np.float32(0), depth_m)
        segment = np.where(hidden, np.int32(0), segment)
    return depth_m, segment


def _check_images(frame: Frame, segments: FrameSegments, camera: Camera) -> None:
    shape = (camera.height, camera.width)
    images = (
        ("depth", frame.depth_m, shape, "f", "metres as floating point; divide by its unit"),
        ("colour", frame.color, (*shape, 3), "u", "8-bit RGB"),
        ("segments", segments.segment, shape, "iu", "rows of the segments' tables as integers"),
    )
    for name, image, expected, kinds, meaning in images:
        if image.shape != expected:
            raise FrameError(
                f"frame {frame.name}: {name} of {image.shape} pixels, the camera has {expected}",
                "make all images of a sequence one size, and the camera's intrinsics of that size",
            )
        if image.dtype.kind not in kinds or (kinds == "u" and image.dtype != np.uint8):
            raise FrameError(
                f"frame {frame.name}: {name} is {image.dtype}", f"give {name} as {meaning}"
            )
    if frame.camera is camera:
        return
    own, theirs = (np.array([c.fx, c.fy, c.cx, c.cy], float) for c in (camera, frame.camera))
    if not np.allclose(theirs, own, rtol=1e-3, atol=0.1):
        raise FrameError(
            f"frame {frame.name}: fx, fy, cx, cy = {_numbers(theirs)}, the map's camera has "
            f"{_numbers(own)}",
            "give all frames of a map one camera, or map them apart",
        )


def check_pose(T_world_camera: np.ndarray, name: str) -> None:
    """Refuse what is no pose, or one too far from the origin for float32.

    Args:
        T_world_camera: What should be a 4x4 transform from camera to world, metres.
        name: Whose pose it is, for the message.

    Raises:
        FrameError: it is no finite 4x4 rigid transform within `MAX_COORDINATE_M` of the origin.
    """
    T = np.asarray(T_world_camera)
    if T.shape != (4, 4) or T.dtype.kind != "f" or not np.all(np.isfinite(T)):
        raise FrameError(
            f"{name}: the pose is no finite 4x4 matrix", "drop frames without tracking"
        )
    R, t = T[:3, :3].astype(float), T[:3, 3]
    off = np.abs(R @ R.T - np.eye(3)).max()
    if off > _ROTATION_TOLERANCE or np.linalg.det(R) < 0 or not np.allclose(T[3], [0, 0, 0, 1]):
        raise FrameError(
            f"{name}: the pose is no rotation and translation (R R^T is {off:.2g} off I, "
            f"det R = {np.linalg.det(R):.2g}, last row {_numbers(T[3])})",
            "give T_world_camera, from camera to world, without scale",
        )
    if np.abs(t).max() > MAX_COORDINATE_M:
        raise FrameError(
            f"{name}: the camera is at {_numbers(t)} m; float32 places voxels within "
            f"{MAX_COORDINATE_M:g} m of the origin",
            "subtract the first camera's position from all poses",
        )


def _check_tables(frame: Frame, segments: FrameSegments) -> None:
    tables = ("class_id", segments.class_id), ("instance", segments.instance)
    count = len(segments.class_id)
    for name, table in tables:
        if table.shape != (count,) or table.dtype.kind not in "iu" or not count:
            raise FrameError(
                f"frame {frame.name}: {name} is {table.dtype} of {table.shape}",
                "give one integer per segment, row 0 for nothing",
            )
    if count > MAX_SEGMENTS:
        raise FrameError(
            f"frame {frame.name} has {count} segments, at most {MAX_SEGMENTS}",
            "raise SegmentationSettings.min_segment_px",
        )
    limits = ("segment", segments.segment, count), (*tables[0], len(classes()))
    for name, values, end in (*limits, (*tables[1], 1 << 31)):
        if values.min() < 0 or values.max() >= end:
            raise FrameError(
                f"frame {frame.name}: {name} runs from {values.min()} to {values.max()}, the table "
                f"has rows 0 to {end - 1}",
                "give rows of the tables; 0 stands for none",
            )


def _returns(frame: Frame) -> Float32[np.ndarray, "height width"]:
    """Depth with 0 where there is no return.

    Raises:
        FrameError: it is not a room's in metres.
    """
    with np.errstate(over="ignore", invalid="ignore"):
        depth_m = frame.depth_m.astype(np.float32, copy=False)
        nearest, farthest = depth_m.min(), depth_m.max()
    if not (nearest >= 0 and farthest <= _ROOM_M[1]):  # seldom: a NaN fails both
        depth_m = _without_bad(frame, depth_m)
        farthest = depth_m.max()
    if 0 < farthest < _ROOM_M[0]:
        raise _wrong_unit(frame, depth_m)
    if farthest > _ROOM_M[1] and depth_m[depth_m > 0].min() > _ROOM_M[1]:
        raise _wrong_unit(frame, depth_m)
    return depth_m


def _without_bad(frame: Frame, depth_m) -> Float32[np.ndarray, "height width"]:
    saturated = np.abs(depth_m - np.float32(SATURATED_M)) < _SATURATED_TOLERANCE_M
    usable = (depth_m >= 0) & (depth_m < SATURATED_M)
    bad = ~usable & ~saturated
    if bad.mean() > _BAD_SHARE:
        far = np.isfinite(depth_m) & (depth_m > SATURATED_M)
        if far.mean() > _BAD_SHARE / 2:
            raise _wrong_unit(frame, depth_m)
        raise FrameError(
            f"frame {frame.name}: {bad.mean():.0%} of its depth is NaN, infinite or negative",
            "write 0 where there is no return, and drop frames that the sensor lost",
        )
    return np.where(usable, depth_m, np.float32(0))


def _wrong_unit(frame: Frame, depth_m: Float32[np.ndarray, "height width"]) -> FrameError:
    values = depth_m[np.isfinite(depth_m) & (depth_m > 0)]
    low, high = _ROOM_M
    return FrameError(
        f"frame {frame.name}: depth runs from {values.min():.3g} to {values.max():.3g} m, a room's "
        f"lies within {low:g} to {high:g} m",
        "give depth in metres: a 16-bit image of millimetres divided by 1000, once",
    )


@functools.cache
def _dynamic() -> Bool[np.ndarray, " classes"]:
    return np.array([info.kind == "dynamic" for info in classes()])


def _numbers(values: Float[np.ndarray, " n"]) -> str:
    return ", ".join(f"{v:.6g}" for v in values)
