"""Reader of TUM RGB-D folders: rgb.txt, depth.txt and groundtruth.txt, joined by time stamps."""

from __future__ import annotations

import bisect
from pathlib import Path

import numpy as np
from jaxtyping import Float

from ..errors import FrameError, SequenceError
from .conventions import checked_pose
from .recording import Intrinsics, RecordedFrame, Recording

_FILES = ("rgb.txt", "depth.txt", "groundtruth.txt")
_UNITS_PER_METRE = 5000.0
_MAX_GAP_S = 0.02
"""Images and poses farther apart in time do not belong together."""
_MAX_BRACKET_S = 0.1
"""A pose is interpolated only between two that are no farther apart."""
_FREIBURG = {
    "freiburg1": (517.3, 516.5, 318.6, 255.3),
    "freiburg2": (520.9, 521.0, 325.1, 249.7),
    "freiburg3": (535.4, 539.2, 320.1, 247.6),
}
_DEFAULT = (525.0, 525.0, 319.5, 239.5)
_CALIBRATION = "calibration.txt"


def matches(names: set[str]) -> bool:
    """Whether a folder with these entries is one (or is meant to be)."""
    return len(names & set(_FILES)) >= 2


def read(path: Path, names: set[str]) -> Recording:
    """A frame for every colour image that has a depth image within 20 ms.

    Raises:
        SequenceError: a list of the archive is missing or cannot be read.
    """
    absent = [name for name in _FILES if name not in names]
    if absent:
        raise SequenceError(f"{path} has no {', '.join(absent)}", "unpack the whole TUM archive")
    color, depth = (_image_list(path / name) for name in _FILES[:2])
    times, poses = _trajectory(path / _FILES[2])
    depth_times = [t for t, _ in depth]
    frames = []
    for time, name in color:
        found = _nearest(depth_times, time)
        if found is None:
            continue
        depth_time, depth_name = depth[found]
        pose = _pose_at(depth_time, times, poses, path / _FILES[2])
        frames.append(
            RecordedFrame(f"{time:.6f}", _existing(path / name), _existing(path / depth_name), pose)
        )
    intrinsics, note = _intrinsics(path, names)
    unpaired = len(color) - len(frames)
    notes = (note, f"{unpaired} of {len(color)} colour images have no depth within 20 ms")
    return Recording(
        path=path,
        format="tum",
        frames=tuple(frames),
        intrinsics=intrinsics,
        units_per_metre=_UNITS_PER_METRE,
        gravity=None,
        convention="opencv_camera_to_world",
        settings_files=tuple(path / n for n in (*_FILES, _CALIBRATION) if n in names),
        notes=notes if unpaired else notes[:1],
    )


def _rows(path: Path, columns: int) -> list[list[str]]:
    try:
        text = path.read_text("utf-8")
    except OSError as error:
        raise SequenceError(f"{path}: {error.strerror}", "TUM RGB-D folders hold it") from None
    rows = [line.split() for line in text.splitlines() if line and not line.startswith("#")]
    rows = [row for row in rows if row]
    short = next((row for row in rows if len(row) < columns), None)
    if short is not None or not rows:
        what = f"a row {' '.join(short)!r}" if short else "no rows"
        raise SequenceError(f"{path} has {what}", f"each row needs {columns} columns")
    return rows


def _image_list(path: Path) -> list[tuple[float, str]]:
    try:
        return sorted((float(row[0]), row[1]) for row in _rows(path, 2))
    except ValueError as error:
        raise SequenceError(f"{path}: {error}", "each row is: time stamp, file") from None


def _trajectory(path: Path) -> tuple[list[float], np.ndarray]:
    """Times, and rows of x y z qx qy qz qw."""
    try:
        rows = np.array([[float(v) for v in row[:8]] for row in _rows(path, 8)])
    except ValueError as error:
        hint = "each row is: time x y z qx qy qz qw"
        raise SequenceError(f"{path}: {error}", hint) from None
    rows = rows[np.argsort(rows[:, 0], kind="stable")]
    return rows[:, 0].tolist(), rows[:, 1:]


def _nearest(times: list[float], time: float) -> int | None:
    """Position of the nearest time within `_MAX_GAP_S`."""
    after = bisect.bisect_left(times, time)
    near = [i for i in (after - 1, after) if 0 <= i < len(times)]
    best = min(near, key=lambda i: abs(times[i] - time))
    return best if abs(times[best] - time) <= _MAX_GAP_S else None


def _pose_at(
    time: float, times: list[float], poses: np.ndarray, source: Path
) -> Float[np.ndarray, "4 4"] | FrameError:
    """The pose at a time, interpolated between its neighbours, else the nearest one."""
    after = bisect.bisect_left(times, time)
    if 0 < after < len(times) and times[after] - times[after - 1] <= _MAX_BRACKET_S:
        share = (time - times[after - 1]) / max(times[after] - times[after - 1], 1e-9)
        row = _interpolate(poses[after - 1], poses[after], share)
    else:
        found = _nearest(times, time)
        if found is None:
            return FrameError(
                f"{source} has no pose within 20 ms of {time:.6f}",
                "tracking was lost here: the frame is skipped",
            )
        row = poses[found]
    try:
        return checked_pose(_matrix(row), f"{source} at {time:.6f}")
    except FrameError as error:
        return error


def _interpolate(a: np.ndarray, b: np.ndarray, share: float) -> np.ndarray:
    """Linear in position, normalised linear in rotation (steps of 10 ms are tiny)."""
    sign = 1.0 if a[3:] @ b[3:] >= 0 else -1.0
    return (1 - share) * a + share * np.concatenate([b[:3], sign * b[3:]])


def _matrix(row: np.ndarray) -> Float[np.ndarray, "4 4"]:
    length = np.linalg.norm(row[3:])
    x, y, z, w = row[3:] / (length if length > 0 else np.nan)
    T = np.eye(4)
    T[:3, :3] = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    T[:3, 3] = row[:3]
    return T


def _existing(path: Path) -> Path | None:
    return path if path.is_file() else None


def _intrinsics(path: Path, names: set[str]) -> tuple[Intrinsics, str]:
    """From ``calibration.txt`` (fx fy cx cy), else those of the sensor in the folder's name."""
    if _CALIBRATION in names:
        file = path / _CALIBRATION
        try:
            fx, fy, cx, cy = (float(v) for v in _rows(file, 4)[0][:4])
        except ValueError as error:
            raise SequenceError(f"{file}: {error}", "write fx fy cx cy") from None
        return Intrinsics(fx, fy, cx, cy, None, None, str(file)), f"intrinsics from {file.name}"
    sensor = next((s for s in _FREIBURG if s in str(path.resolve()).lower()), None)
    values = _FREIBURG[sensor] if sensor else _DEFAULT
    source = f"those published for {sensor}" if sensor else "TUM's default, 525 px"
    note = f"intrinsics are {source}; lens distortion is left as it is; {_CALIBRATION} overrides"
    return Intrinsics(*values, 640, 480, source), note
