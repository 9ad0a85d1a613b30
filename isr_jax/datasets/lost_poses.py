"""Poses that are no place in a room: of a tracker that jumped, or in a map of the whole earth."""

from __future__ import annotations

import dataclasses

import numpy as np

from ..errors import FrameError, SequenceError
from .recording import RecordedFrame, Recording

ROOM_M = 500.0
"""Cameras lie this near to each other and to the origin; float32 is too coarse beyond."""


def without_lost_poses(recording: Recording) -> Recording:
    """The recording; a camera far from the others has a `FrameError` instead of its pose.

    One such pose would put the floor, and so the world's origin, where it is.

    Raises:
        SequenceError: most cameras lie far from the origin.
    """
    poses = [frame.pose for frame in recording.frames if not isinstance(frame.pose, FrameError)]
    if not poses:
        return recording
    middle = np.median([pose[:3, 3] for pose in poses], axis=0)
    if np.abs(middle).max() > ROOM_M:
        raise SequenceError(
            f"{recording.path}: the cameras are around {_metres(middle)}, beyond {ROOM_M:g} m from "
            "the origin of the poses",
            "subtract the first camera's position from all poses",
        )
    frames = tuple(_checked(frame, middle) for frame in recording.frames)
    return dataclasses.replace(recording, frames=frames)


def _checked(frame: RecordedFrame, middle: np.ndarray) -> RecordedFrame:
    if isinstance(frame.pose, FrameError):
        return frame
    position = frame.pose[:3, 3]
    if np.linalg.norm(position - middle) <= ROOM_M:
        return frame
    lost = FrameError(
        f"frame {frame.name}: the camera is at {_metres(position)}, the others are around "
        f"{_metres(middle)}",
        "tracking was lost here: drop the frame",
    )
    return dataclasses.replace(frame, pose=lost)


def _metres(position: np.ndarray) -> str:
    return "(" + ", ".join(f"{v:.6g}" for v in position) + ") m"
