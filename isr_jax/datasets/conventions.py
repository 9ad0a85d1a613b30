"""Pose files and the conventions that poses come in.

Inside, a pose is camera to dataset with OpenCV axes (x right, y down, z forward); the other
conventions are converted here, at the border.
"""

from __future__ import annotations

from pathlib import Path
from typing import Literal, get_args

import numpy as np
from jaxtyping import Float

from ..errors import FrameError, SequenceError
from ..geometry import nearest_rotation

PoseConvention = Literal[
    "opencv_camera_to_world",
    "opencv_world_to_camera",
    "opengl_camera_to_world",
    "opengl_world_to_camera",
]
CONVENTIONS: tuple[PoseConvention, ...] = get_args(PoseConvention)
"""Axes of the camera (OpenGL: y up, z backward), and which way the matrix maps."""

_FLIP_YZ = np.diag([1.0, -1.0, -1.0, 1.0])
_LAST_ROW = np.array([0.0, 0.0, 0.0, 1.0])
_ROTATION_TOLERANCE = 1e-2
"""Largest entry of R R^T - I that counts as rounding; recordings with 4 digits reach 1e-3."""


def to_camera_to_dataset(
    matrix: Float[np.ndarray, "4 4"], convention: PoseConvention
) -> Float[np.ndarray, "4 4"]:
    """A recorded pose as camera to dataset with OpenCV axes."""
    pose = np.linalg.inv(matrix) if convention.endswith("world_to_camera") else matrix
    return pose @ _FLIP_YZ if convention.startswith("opengl") else pose


def from_camera_to_dataset(
    pose: Float[np.ndarray, "4 4"], convention: PoseConvention
) -> Float[np.ndarray, "4 4"]:
    """The inverse of `to_camera_to_dataset`."""
    matrix = pose @ _FLIP_YZ if convention.startswith("opengl") else pose
    return np.linalg.inv(matrix) if convention.endswith("world_to_camera") else matrix


def check_convention(name: str, source: Path) -> PoseConvention:
    """``name``, if it is one of `CONVENTIONS`.

    Raises:
        SequenceError: it is none of `CONVENTIONS`.
    """
    if name in CONVENTIONS:
        return name
    raise SequenceError(
        f"{source}: pose_convention = {name!r}", f"use one of: {', '.join(CONVENTIONS)}"
    )


def read_pose(path: Path) -> Float[np.ndarray, "4 4"]:
    """A 4x4 matrix from a pose file, checked by `checked_pose`.

    Raises:
        FrameError: the file cannot be read, holds no 16 numbers, or no rigid transform.
    """
    try:
        values = [float(v) for v in path.read_bytes().replace(b",", b" ").split()]
    except OSError as error:
        raise FrameError(f"{path}: {error.strerror}", "restore the file or skip it") from None
    except ValueError as error:
        raise FrameError(f"{path} is no pose: {error}", "write 4 rows of 4 numbers") from None
    if len(values) != 16:
        raise FrameError(f"{path} holds {len(values)} numbers, not 16", "write 4 rows of 4 numbers")
    return checked_pose(np.array(values).reshape(4, 4), str(path))


def pose_or_reason(
    name: str, path: Path | None, convention: PoseConvention = CONVENTIONS[0]
) -> Float[np.ndarray, "4 4"] | FrameError:
    """Camera to dataset of frame ``name`` from its pose file, or why the frame has none."""
    if path is None:
        return FrameError(f"frame {name} has no pose file", "add its pose or drop it")
    try:
        return to_camera_to_dataset(read_pose(path), convention)
    except FrameError as error:
        return error


def checked_pose(matrix: Float[np.ndarray, "4 4"], source: str) -> Float[np.ndarray, "4 4"]:
    """A rigid transform, its rotation made exact.

    Raises:
        FrameError: the matrix is no rigid transform, or not finite.
    """
    if not np.isfinite(matrix).all():
        raise FrameError(
            f"{source}: the pose holds NaN or infinity", "tracking was lost here: drop the frame"
        )
    rotation = matrix[:3, :3]
    error = float(np.abs(rotation @ rotation.T - np.eye(3)).max())
    mirrored = np.linalg.det(rotation) < 0
    if error > _ROTATION_TOLERANCE or mirrored or np.abs(matrix[3] - _LAST_ROW).max() > 1e-6:
        what = "mirrored" if mirrored and error <= _ROTATION_TOLERANCE else "no rotation"
        raise FrameError(
            f"{source}: the pose is {what} (R R^T differs from I by {error:.3g}, "
            f"last row {matrix[3].tolist()})",
            "write [R t; 0 0 0 1] with a right-handed rotation and metres",
        )
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = nearest_rotation(rotation), matrix[:3, 3]
    return pose
