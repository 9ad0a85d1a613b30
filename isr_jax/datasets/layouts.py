"""Which layout a folder has, and its reader."""

from __future__ import annotations

import os
from pathlib import Path
from types import ModuleType

from ..errors import SequenceError
from . import plain_folder, scannet, scenenn, seven_scenes, tum
from .lost_poses import without_lost_poses
from .recording import Recording, SequenceFormat

_READERS: dict[SequenceFormat, ModuleType] = {
    "tum": tum,
    "7scenes": seven_scenes,
    "scenenn": scenenn,
    "scannet": scannet,
    "plain": plain_folder,
}
_KNOWN = (
    "7scenes (frame-NNNNNN.color.jpg, .depth.png, .pose.txt), "
    "tum (rgb.txt, depth.txt, groundtruth.txt), "
    "scenenn (image/, depth/, trajectory.log), "
    "scannet (NAME.sens, or color/, depth/, pose/, intrinsic/), "
    "plain (rgb/, depth/, poses/, intrinsics.json)"
)


def detect_format(path: Path) -> SequenceFormat:
    """The layout's name, as `open_sequence` takes it.

    Raises:
        SequenceError: the folder is no sequence of a known layout.
    """
    names = _entries(path)
    for name, reader in _READERS.items():
        if reader.matches(names):
            return name
    below = sorted(n for n in names if (path / n).is_dir() and _looks_known(path / n))
    if below:
        raise SequenceError(f"{path} holds sequences", f"give one of them: {path / below[0]}")
    held = ", ".join(sorted(names)[:5]) or "nothing"
    raise SequenceError(
        f"{path} is no known sequence: it holds {held}", f"known layouts are: {_KNOWN}"
    )


def read_recording(path: Path, format: str | None) -> Recording:
    """Read a folder's file names, poses and intrinsics; at least one frame must be complete.

    Raises:
        SequenceError: unknown format, no frame, or a file that the layout needs is missing.
    """
    format = format or detect_format(path)
    if format not in _READERS:
        raise SequenceError(f"unknown format {format!r}", f"use one of: {', '.join(_READERS)}")
    recording = _READERS[format].read(path, _entries(path))
    if not recording.frames:
        raise SequenceError(f"{path} has no frames", f"known layouts are: {_KNOWN}")
    return without_lost_poses(recording)


def _entries(path: Path) -> set[str]:
    try:
        return set(os.listdir(path))
    except OSError as error:
        raise SequenceError(f"{path}: {error.strerror}", "give the folder of a sequence") from None


def _looks_known(path: Path) -> bool:
    return any(reader.matches(_entries(path)) for reader in _READERS.values())
