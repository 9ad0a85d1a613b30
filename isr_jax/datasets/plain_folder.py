"""Reader of the plain folder: rgb/, depth/, poses/ and intrinsics.json.

``intrinsics.json`` holds fx, fy, cx, cy, width, height (of the depth image), depth_scale (units a
metre) and, optionally, gravity (unit vector, down, frame of the poses) and pose_convention.
"""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import SequenceError
from .conventions import CONVENTIONS, PoseConvention, check_convention, pose_or_reason
from .recording import Intrinsics, RecordedFrame, Recording, unit_gravity

_FOLDERS = {"rgb": (".jpg", ".jpeg", ".png"), "depth": (".png",), "poses": (".txt",)}
_FILE = "intrinsics.json"
_REQUIRED = ("fx", "fy", "cx", "cy", "width", "height", "depth_scale")
_EXAMPLE = (
    '{"fx": 525.0, "fy": 525.0, "cx": 319.5, "cy": 239.5, '
    '"width": 640, "height": 480, "depth_scale": 1000.0}'
)


def matches(names: set[str]) -> bool:
    """Whether a folder with these entries is one (or is meant to be)."""
    return _FILE in names or len(names & set(_FOLDERS)) >= 2


def read(path: Path, names: set[str]) -> Recording:
    """All frames whose name occurs in any of the three folders, sorted.

    Raises:
        SequenceError: intrinsics are missing or cannot be read.
    """
    if _FILE not in names:
        raise SequenceError(f"{path} has no {_FILE}", f"write it, for example: {_EXAMPLE}")
    data = _settings(path / _FILE)
    convention = check_convention(data.get("pose_convention", CONVENTIONS[0]), path / _FILE)
    files = {folder: _by_stem(path / folder, ends) for folder, ends in _FOLDERS.items()}
    stems = sorted(set().union(*files.values()))
    gravity = data.get("gravity")
    return Recording(
        path=path,
        format="plain",
        frames=tuple(_frame(stem, files, convention) for stem in stems),
        intrinsics=Intrinsics(
            float(data["fx"]),
            float(data["fy"]),
            float(data["cx"]),
            float(data["cy"]),
            int(data["width"]),
            int(data["height"]),
            str(path / _FILE),
        ),
        units_per_metre=float(data["depth_scale"]),
        gravity=None if gravity is None else unit_gravity(gravity, path / _FILE),
        convention=convention,
        settings_files=(path / _FILE,),
    )


def _by_stem(folder: Path, endings: tuple[str, ...]) -> dict[str, Path]:
    if not folder.is_dir():
        return {}
    names = (os.path.splitext(name) for name in os.listdir(folder))
    return {stem: folder / (stem + end) for stem, end in names if end.lower() in endings}


def _frame(
    stem: str, files: dict[str, dict[str, Path]], convention: PoseConvention
) -> RecordedFrame:
    pose = pose_or_reason(stem, files["poses"].get(stem), convention)
    return RecordedFrame(stem, files["rgb"].get(stem), files["depth"].get(stem), pose)


def _settings(path: Path) -> dict[str, Any]:
    try:
        data = json.loads(path.read_text("utf-8"))
    except (OSError, ValueError) as error:
        raise SequenceError(f"{path}: {error}", f"for example: {_EXAMPLE}") from None
    missing = [k for k in _REQUIRED if k not in data] if isinstance(data, dict) else _REQUIRED
    if missing:
        raise SequenceError(f"{path} lacks {', '.join(missing)}", f"for example: {_EXAMPLE}")
    bad = [k for k in _REQUIRED if not _positive(data[k])]
    if bad:
        raise SequenceError(
            f"{path}: {', '.join(f'{k} = {data[k]!r}' for k in bad)}", "give positive numbers"
        )
    return data


def _positive(value: Any) -> bool:
    number = isinstance(value, (int, float)) and not isinstance(value, bool)
    return number and bool(np.isfinite(value)) and value > 0
