"""Reader of SceneNN scenes: image/, depth/ and ``trajectory.log``, as its playback tool extracts.

``image/imageNNNNN.png`` and ``depth/depthNNNNN.png`` (16 bits, millimetres) count from 1
(PlaybackSync.cpp). A block of ``trajectory.log`` is a line ``i i i+1`` and the pose of frame i,
counted from 0, as 4x4 camera to world (the authors, SceneNN issue 3): the third number is the
image's. Where tracking was lost the rotation is zero (issue 4); such frames are skipped. The frames
are y up, but only the later release calls its meshes aligned with the floor: gravity is estimated.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
from jaxtyping import Float

from ..errors import FrameError, SequenceError
from .conventions import checked_pose
from .recording import Intrinsics, RecordedFrame, Recording

_TRAJECTORY = "trajectory.log"
_COLOR_FOLDERS = ("image", "rgb", "color")
_COLOR_ENDINGS, _DEPTH_ENDINGS = (".png", ".jpg", ".jpeg"), (".png",)
_NUMBER = re.compile(r"\D*(\d{1,9})$")
_MILLIMETRES = 1000.0
_INI = "asus.ini"
_PUBLISHED = Intrinsics(
    544.47329, 544.47329, 320.0, 240.0, 640, 480, "SceneNN's intrinsic/asus.ini as published"
)
_BLOCK_LINES = 5


def matches(names: set[str]) -> bool:
    """Whether a folder with these entries is one (or is meant to be)."""
    return _trajectory_name(names) is not None and "intrinsics.json" not in names


def read(path: Path, names: set[str]) -> Recording:
    """All frames that have an image, by number; one without a pose is kept and says so.

    Raises:
        SequenceError: trajectory, images or intrinsics are missing or cannot be read.
    """
    log = _trajectory_name(names)
    if log is None:
        raise SequenceError(f"{path} has no {_TRAJECTORY}", "SceneNN keeps it beside the mesh")
    color_folder = next((f for f in _COLOR_FOLDERS if f in names), None)
    if color_folder is None or "depth" not in names:
        raise SequenceError(
            f"{path} has a {log} but no images",
            "extract image/ and depth/ from the .oni file with SceneNN's playback tool",
        )
    poses = _trajectory(path / log)
    colors = _by_number(path / color_folder, _COLOR_ENDINGS)
    depths = _by_number(path / "depth", _DEPTH_ENDINGS)
    numbers = sorted(colors.keys() | depths.keys())
    unused = len(poses.keys() - set(numbers))
    intrinsics, ini = _intrinsics(path)
    notes = [f"intrinsics: {intrinsics.source}", "gravity is estimated: SceneNN does not give it"]
    if unused:
        notes.append(f"{unused} of {len(poses)} poses in {log} have no image")
    return Recording(
        path=path,
        format="scenenn",
        frames=tuple(
            RecordedFrame(f"{n:05d}", colors.get(n), depths.get(n), _pose(poses, n, path / log))
            for n in numbers
        ),
        intrinsics=intrinsics,
        units_per_metre=_MILLIMETRES,
        gravity=None,
        convention="opencv_camera_to_world",
        settings_files=() if ini is None else (ini,),
        notes=tuple(notes),
    )


def _trajectory_name(names: set[str]) -> str | None:
    return next((n for n in sorted(names) if re.fullmatch(r"(\d+_)?trajectory\.log", n)), None)


def _by_number(folder: Path, endings: tuple[str, ...]) -> dict[int, Path]:
    files: dict[int, Path] = {}
    for file in sorted(folder.iterdir()) if folder.is_dir() else ():
        found = _NUMBER.match(file.stem)
        if found is None or file.suffix.lower() not in endings:
            continue
        number = int(found[1])
        if number in files:
            raise SequenceError(
                f"{folder} has two images of number {number}: {files[number].name}, {file.name}",
                "keep one of them",
            )
        files[number] = file
    return files


def _trajectory(path: Path) -> dict[int, Float[np.ndarray, "4 4"]]:
    """Camera to dataset by image number, as stored."""
    hint = "each block is a line `i i i+1` and 4 rows of 4 numbers"
    try:
        lines = [line.split() for line in path.read_text("utf-8").splitlines() if line.strip()]
    except (OSError, ValueError) as error:
        raise SequenceError(f"{path}: {error}", hint) from None
    poses: dict[int, np.ndarray] = {}
    for at in range(0, len(lines), _BLOCK_LINES):
        block = lines[at : at + _BLOCK_LINES]
        try:
            _, first, number = (int(v) for v in block[0])
            pose = np.array([[float(v) for v in row] for row in block[1:]])
            bad = pose.shape != (4, 4) or number != first + 1 or number in poses
        except ValueError:
            bad, number, pose = True, -1, np.eye(4)
        if bad:
            text = " ".join(block[0])
            raise SequenceError(f"{path}: block {at // _BLOCK_LINES} ({text!r}) is none", hint)
        poses[number] = pose
    return poses


def _pose(
    poses: dict[int, np.ndarray], number: int, source: Path
) -> Float[np.ndarray, "4 4"] | FrameError:
    if number not in poses:
        return FrameError(
            f"{source} has no pose of image {number}", "SceneNN's trajectory ends earlier: skip it"
        )
    try:
        return checked_pose(poses[number], f"{source}, image {number}")
    except FrameError as error:
        return error


def _intrinsics(path: Path) -> tuple[Intrinsics, Path | None]:
    """From ``asus.ini`` in the scene, its ``intrinsic/`` or that beside it; else as published."""
    places = (path / _INI, path / "intrinsic" / _INI, path.parent / "intrinsic" / _INI)
    ini = next((p for p in places if p.is_file()), None)
    if ini is None:
        return _PUBLISHED, None
    values: dict[str, float] = {}
    try:
        for line in ini.read_text("utf-8").splitlines():
            words = line.replace("=", " ").split()
            if len(words) == 2 and words[0][0].isalpha():
                values[words[0].lower()] = float(words[1])
        width, height = int(values["depth_width"]), int(values["depth_height"])
        K = values["fx"], values["fy"]
    except (OSError, ValueError, KeyError, OverflowError) as error:
        raise SequenceError(
            f"{ini}: {type(error).__name__} {error}",
            "it needs lines fx, fy, depth_width, depth_height and, optionally, cx, cy; "
            f"as published fx = fy = {_PUBLISHED.fx}",
        ) from None
    center = values.get("cx", width / 2), values.get("cy", height / 2)
    if not (np.isfinite([*K, *center]).all() and min(*K, width, height) > 0):
        raise SequenceError(f"{ini}: {values}", "give positive numbers")
    return Intrinsics(*K, *center, width, height, str(ini)), ini
