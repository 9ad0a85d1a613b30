"""Reader of 7-Scenes folders: frame-NNNNNN.{color.jpg|png, depth.png, pose.txt} side by side."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from ..errors import SequenceError
from .conventions import pose_or_reason
from .images import ColorCamera
from .recording import Intrinsics, RecordedFrame, Recording, unit_gravity

_FILE = re.compile(r"(frame-\d+)\.(color\.jpg|color\.png|depth\.png|pose\.txt)$")
_INTRINSICS, _GRAVITY = "camera-intrinsics.txt", "gravity-direction.txt"
_MILLIMETRES = 1000.0
_COLOR_CAMERA = ColorCamera(fx=526.9, fy=526.9, cx=323.0, cy=238.3, x_m=-0.0321)
"""7-Scenes leaves colour and depth of its Kinect unregistered. Fitted to the depth edges and image
gradients of 25 kitchen frames; as recorded, a cup's colour lies 20-38 pixels off its depth."""


def matches(names: set[str]) -> bool:
    """Whether a folder with these entries is one."""
    return any(_FILE.match(name) for name in names)


def read(path: Path, names: set[str]) -> Recording:
    """All frames of the folder, sorted; a frame that misses a file is kept and says so.

    Raises:
        SequenceError: intrinsics are missing or cannot be read.
    """
    parts: dict[str, dict[str, Path]] = {}
    for name in names:
        if found := _FILE.match(name):
            parts.setdefault(found[1], {})[found[2].split(".")[0]] = path / name
    frames = tuple(_frame(name, parts[name]) for name in sorted(parts))
    intrinsics_file = _beside(path, _INTRINSICS)
    if intrinsics_file is None:
        raise SequenceError(
            f"{path} has no {_INTRINSICS}",
            "write the 3x3 matrix there (7-Scenes as published: fx = fy = 585, cx = 320, cy = 240)",
        )
    gravity_file = _beside(path, _GRAVITY)
    return Recording(
        path=path,
        format="7scenes",
        frames=frames,
        intrinsics=_intrinsics(intrinsics_file),
        units_per_metre=_MILLIMETRES,
        gravity=None
        if gravity_file is None
        else unit_gravity(_numbers(gravity_file, 3), gravity_file),
        convention="opencv_camera_to_world",
        settings_files=tuple(f for f in (intrinsics_file, gravity_file) if f is not None),
        notes=("colour is moved onto the depth camera's pixels (7-Scenes records them apart)",),
        color_camera=_COLOR_CAMERA,
    )


def _frame(name: str, parts: dict[str, Path]) -> RecordedFrame:
    pose = pose_or_reason(name, parts.get("pose"))
    return RecordedFrame(name, parts.get("color"), parts.get("depth"), pose)


def _beside(path: Path, name: str) -> Path | None:
    """The file in the folder or in the one above, where 7-Scenes keeps what all share."""
    return next((p for p in (path / name, path.parent / name) if p.is_file()), None)


def _numbers(path: Path, count: int) -> list[float]:
    try:
        values = [float(v) for v in path.read_text("utf-8").split()]
    except ValueError as error:
        raise SequenceError(f"{path}: {error}", f"write {count} numbers") from None
    if len(values) != count or not np.isfinite(values).all():
        raise SequenceError(f"{path} holds {len(values)} numbers", f"write {count} finite numbers")
    return values


def _intrinsics(path: Path) -> Intrinsics:
    fx, _, cx, _, fy, cy, *_ = _numbers(path, 9)
    return Intrinsics(fx, fy, cx, cy, None, None, str(path))
