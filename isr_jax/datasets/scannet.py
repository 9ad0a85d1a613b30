"""Reader of ScanNet scans: ``<scan>.sens``, or its export to color/, depth/, pose/, intrinsic/.

Poses map the camera to the mesh's frame, whose z points up (ScanNet's README): gravity is -z.
Colour and depth are aligned, without an extrinsic between them (the authors, ScanNet issues 2 and
92), but not of one size: colour is resampled by the intrinsics of both.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from jaxtyping import Float

from ..errors import FrameError, SequenceError
from .conventions import checked_pose, pose_or_reason
from .images import ColorCamera, read_color
from .recording import Intrinsics, RecordedFrame, Recording
from .sens_file import SensFile, index_sens

_FOLDERS = {"color": (".jpg", ".jpeg", ".png"), "depth": (".png",), "pose": (".txt",)}
_INTRINSIC = "intrinsic"
_UP_Z = np.array([0.0, 0.0, -1.0])
_EXPORTED_UNITS = 1000.0
"""SensReader writes the stored values, millimetres in every published scan."""
_COLOR_SIZES = ((1296, 968), (640, 480))
"""Of the published scans."""
_NEAR_CENTRE = 0.05
"""A principal point this near the middle, as a share of the width, is of images of that size."""


def matches(names: set[str]) -> bool:
    """Whether a folder with these entries is one (or is meant to be)."""
    return (
        _sens_names(names) != []
        or len(names & set(_FOLDERS)) == 3
        or (_INTRINSIC in names and len(names & set(_FOLDERS)) >= 2)
    )


def read(path: Path, names: set[str]) -> Recording:
    """All frames, from the ``.sens`` file where there is one, else from the exported folders.

    Raises:
        SequenceError: several .sens files, one that cannot be read, or no intrinsics.
    """
    found = _sens_names(names)
    if len(found) > 1:
        raise SequenceError(
            f"{path} holds {len(found)} .sens files: {', '.join(found[:3])}",
            "keep each scan in a folder of its own",
        )
    return _read_sens(path, path / found[0]) if found else _read_folders(path)


def _sens_names(names: set[str]) -> list[str]:
    return sorted(n for n in names if n.lower().endswith(".sens"))


def _read_sens(path: Path, file: Path) -> Recording:
    sens = index_sens(file)
    frames = tuple(
        RecordedFrame(f"{i:06d}", f.color, f.depth, _pose(f.pose, f"{file}, frame {i}"))
        for i, f in enumerate(sens.frames)
    )
    notes = [f"gravity is -z: ScanNet's frames stand upright ({sens.sensor or 'sensor unnamed'})"]
    if len(sens.frames) < sens.declared:
        if not frames:
            raise SequenceError(
                f"{file} holds no whole frame of the {sens.declared} it declares",
                "download the scan again",
            )
        notes.append(
            f"{file.name} is cut off: {len(frames)} of {sens.declared} frames are whole and used"
        )
    notes += _extrinsic_note(sens)
    return Recording(
        path=path,
        format="scannet",
        frames=frames,
        intrinsics=_intrinsics(sens.depth_intrinsic, sens.depth_size, str(file)),
        units_per_metre=sens.units_per_metre,
        gravity=_UP_Z,
        convention="opencv_camera_to_world",
        settings_files=(),
        notes=tuple(notes),
        color_camera=_color_camera(sens.color_intrinsic, sens.color_size),
        header=sens.header,
    )


def _extrinsic_note(sens: SensFile) -> list[str]:
    apart = np.abs(sens.color_extrinsic - sens.depth_extrinsic).max() > 1e-4
    text = (
        f"{sens.path.name} states extrinsics between colour and depth; they are not applied, "
        "since ScanNet's images are aligned"
    )
    return [text] if apart else []


def _pose(matrix: np.ndarray, source: str) -> np.ndarray | FrameError:
    try:
        return checked_pose(matrix, source)
    except FrameError as error:
        return error


def _intrinsics(
    K: Float[np.ndarray, "4 4"], size: tuple[int, int] | None, source: str
) -> Intrinsics:
    width, height = size or (None, None)
    fx, fy, cx, cy = (float(v) for v in (K[0, 0], K[1, 1], K[0, 2], K[1, 2]))
    return Intrinsics(fx, fy, cx, cy, width, height, source)


def _color_camera(K: Float[np.ndarray, "4 4"], size: tuple[int, int]) -> ColorCamera:
    fx, fy, cx, cy = (float(v) for v in (K[0, 0], K[1, 1], K[0, 2], K[1, 2]))
    return ColorCamera(fx, fy, cx, cy, 0.0, *size)


def _read_folders(path: Path) -> Recording:
    files = {folder: _by_number(path / folder, ends) for folder, ends in _FOLDERS.items()}
    numbers = sorted(set().union(*files.values()))
    depth_file = _intrinsic_file(path, "intrinsic_depth.txt")
    if depth_file is None:
        raise SequenceError(
            f"{path} has no {_INTRINSIC}/intrinsic_depth.txt",
            "export it with SensReader's --export_intrinsics",
        )
    K = _matrix(depth_file)
    color_file = _intrinsic_file(path, "intrinsic_color.txt")
    notes = ["gravity is -z: ScanNet's frames stand upright"]
    color_camera = None
    if color_file is None:
        notes.append("no intrinsic_color.txt: colour is taken to show what depth shows")
    else:
        color_camera = _folder_color_camera(_matrix(color_file), files["color"], color_file)
    return Recording(
        path=path,
        format="scannet",
        frames=tuple(_frame(number, files) for number in numbers),
        intrinsics=_intrinsics(K, None, str(depth_file)),
        units_per_metre=_EXPORTED_UNITS,
        gravity=_UP_Z,
        convention="opencv_camera_to_world",
        settings_files=tuple(f for f in (depth_file, color_file) if f is not None),
        notes=tuple(notes),
        color_camera=color_camera,
    )


def _by_number(folder: Path, endings: tuple[str, ...]) -> dict[int, Path]:
    """SensReader numbers files without leading zeros: 2 comes before 10."""
    if not folder.is_dir():
        return {}
    return {
        int(f.stem): f
        for f in sorted(folder.iterdir())
        if f.suffix.lower() in endings and f.stem.isascii() and f.stem.isdigit()
    }


def _frame(number: int, files: dict[str, dict[int, Path]]) -> RecordedFrame:
    name = f"{number:06d}"
    pose = pose_or_reason(name, files["pose"].get(number))
    return RecordedFrame(name, files["color"].get(number), files["depth"].get(number), pose)


def _intrinsic_file(path: Path, name: str) -> Path | None:
    return next((p for p in (path / _INTRINSIC / name, path / name) if p.is_file()), None)


def _matrix(path: Path) -> Float[np.ndarray, "4 4"]:
    try:
        values = np.array([float(v) for v in path.read_text("utf-8").split()])
    except (OSError, ValueError) as error:
        raise SequenceError(f"{path}: {error}", "write a 4x4 matrix there") from None
    if len(values) not in (9, 16) or not np.isfinite(values).all() or values[0] <= 0:
        raise SequenceError(
            f"{path} holds {len(values)} numbers, or no camera's: {values[:3].tolist()}",
            "write the 4x4 matrix fx 0 cx 0, 0 fy cy 0, 0 0 1 0, 0 0 0 1",
        )
    side = 3 if len(values) == 9 else 4
    K = np.eye(4)
    K[:side, :side] = values.reshape(side, side)
    return K


def _folder_color_camera(
    K: Float[np.ndarray, "4 4"], colors: dict[int, Path], source: Path
) -> ColorCamera | None:
    """Intrinsics of the exported colour images, which may have been made smaller since."""
    size = next((s for p in list(colors.values())[:5] if (s := _size_or_none(p))), None)
    if size is None:
        return None  # the frames without readable colour say so themselves
    stated = _color_camera(K, size)
    full = next((s for s in (size, *_COLOR_SIZES) if _is_centred(stated, s)), None)
    if full is None:
        raise SequenceError(
            f"{source}: cx = {stated.cx:g}, cy = {stated.cy:g} is not near the middle of images "
            f"of {size[0]}x{size[1]}",
            "give the colour camera's intrinsics of the exported size, or take the file away",
        )
    return _color_camera(K, full).resized(*size)


def _is_centred(camera: ColorCamera, size: tuple[int, int]) -> bool:
    off = max(abs(camera.cx / size[0] - 0.5), abs(camera.cy / size[1] - 0.5))
    return off <= _NEAR_CENTRE


def _size_or_none(path: Path) -> tuple[int, int] | None:
    try:
        height, width, _ = read_color(path).shape
    except FrameError:
        return None
    return width, height
