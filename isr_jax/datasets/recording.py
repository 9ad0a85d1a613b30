"""What a reader of one folder layout hands over: files, poses, intrinsics. Nothing decoded yet."""

from __future__ import annotations

import dataclasses
import hashlib
import json
import os
from pathlib import Path
from typing import Any, Literal

import numpy as np
from jaxtyping import Float

from ..errors import FrameError, SequenceError
from .conventions import PoseConvention
from .image_slice import ImageSlice
from .images import ColorCamera, read_depth

SequenceFormat = Literal["tum", "7scenes", "scenenn", "scannet", "plain"]
_HASHED_WHOLE = 8
"""Frames whose images enter the content hash whole; of the others, name and size do."""


@dataclasses.dataclass(frozen=True, eq=False)
class Intrinsics:
    """Pinhole parameters of the depth image, as recorded."""

    fx: float
    fy: float
    cx: float
    cy: float
    width: int | None
    height: int | None
    source: str
    """The file, or where else they come from; for messages."""


@dataclasses.dataclass(frozen=True, eq=False)
class RecordedFrame:
    """The images of one frame, files or parts of one; None where one is missing."""

    name: str
    color: Path | ImageSlice | None
    depth: Path | ImageSlice | None
    pose: Float[np.ndarray, "4 4"] | FrameError
    """Camera to dataset, OpenCV axes; or why there is none."""


@dataclasses.dataclass(frozen=True, eq=False)
class Recording:
    """One sequence on disk."""

    path: Path
    format: SequenceFormat
    frames: tuple[RecordedFrame, ...]
    intrinsics: Intrinsics
    units_per_metre: float
    """Depth values per metre."""
    gravity: Float[np.ndarray, "3"] | None
    """Unit vector, down, dataset frame; None where the recording does not say."""
    convention: PoseConvention
    """How the poses are stored (those above are converted)."""
    settings_files: tuple[Path, ...]
    """Small files that say how to read the rest."""
    notes: tuple[str, ...] = ()
    """What had to be assumed, for the user."""
    color_camera: ColorCamera | None = None
    """None where colour is already on the depth camera's pixels."""
    header: bytes = b""
    """What a file too large to hash says of how to read the rest."""

    def depth_m(self, frame: RecordedFrame) -> Float[np.ndarray, "height width"]:
        """Depth of a frame, metres, not clipped.

        Raises:
            FrameError: the frame has no depth, or it cannot be read.
        """
        return read_depth(present(frame, frame.depth, "depth"), self.units_per_metre)

    def content_hash(self) -> str:
        """Hex digest over poses, small files, names and sizes of images, and a few images whole."""
        digest = hashlib.blake2b(digest_size=16)
        plain = [self.format, self.convention, repr(self.units_per_metre), repr(self.color_camera)]
        digest.update(json.dumps(plain).encode())
        for path in self.settings_files:
            digest.update(path.read_bytes())
        digest.update(self.header)
        whole = set(spread(len(self.frames), _HASHED_WHOLE))
        for i, frame in enumerate(self.frames):
            pose = frame.pose
            text = pose.problem if isinstance(pose, FrameError) else pose.tobytes().hex()
            digest.update(f"{frame.name} {text};".encode())
            for path in (frame.color, frame.depth):
                digest.update(f"{path.name if path else None} {_size(path)};".encode())
                if path is not None and i in whole:
                    digest.update(_contents(path))
        return digest.hexdigest()


def _size(path: Path | ImageSlice | None) -> int:
    """Bytes; -1 for a file that is not there, which is an error only where its frame is read."""
    if isinstance(path, ImageSlice):
        return path.size
    try:
        return -1 if path is None else os.stat(path).st_size
    except OSError:
        return -1


def _contents(path: Path | ImageSlice) -> bytes:
    try:
        return path.read_bytes()
    except (OSError, FrameError):
        return b""


def present(frame: RecordedFrame, path: Path | ImageSlice | None, kind: str) -> Path | ImageSlice:
    """``path``, where the frame has that file.

    Raises:
        FrameError: the frame lacks that file.
    """
    if path is None:
        raise FrameError(f"frame {frame.name} has no {kind} file", f"add its {kind} or drop it")
    return path


def spread(count: int, wanted: int) -> list[int]:
    """At most ``wanted`` positions, evenly spread over ``range(count)``, both ends included."""
    return sorted({round(v) for v in np.linspace(0, count - 1, min(count, wanted))})


def unit_gravity(values: Any, source: Path) -> Float[np.ndarray, "3"]:
    """A given gravity direction made unit.

    Raises:
        SequenceError: the values are no direction.
    """
    try:
        gravity = np.array(values, np.float64)
    except (TypeError, ValueError):
        gravity = np.zeros(0)
    length = float(np.linalg.norm(gravity)) if gravity.shape == (3,) else 0.0
    if not np.isfinite(length) or length < 1e-6:
        raise SequenceError(
            f"{source}: gravity {values!r} is no direction",
            "give three numbers, pointing down, in the frame of the poses; or leave it out",
        )
    return gravity / length
