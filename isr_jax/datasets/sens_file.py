"""Index of a ScanNet ``.sens`` file, version 4: where each frame's images lie. Reads no image.

Little-endian, without padding (ScanNet's SensReader, 2017): version u32; length u64 and name of the
sensor; intrinsic and extrinsic 4x4 f32 of the colour camera, then of the depth camera; compression
of colour (0 raw, 1 png, 2 jpeg) and of depth (0 raw, 1 zlib, 2 occi), i32 each; width and height of
colour, then of depth, u32 each; depth units per metre f32; number of frames u64. A frame: camera to
world 4x4 f32; time stamps of colour and depth u64; bytes of colour and depth u64; the two images.
"""

from __future__ import annotations

import dataclasses
import struct
from pathlib import Path
from typing import BinaryIO

import numpy as np
from jaxtyping import Float

from ..errors import SequenceError
from .image_slice import Coding, ImageSlice

VERSION_READ = 4
_NAME_LENGTH = struct.Struct("<IQ")
_HEADER = struct.Struct("<64f2i4IfQ")
_FRAME = struct.Struct("<16f4Q")
_MAX_NAME_BYTES = 4096
_MAX_SIDE_PX = 16384
_SLACK_BYTES = 1 << 16
"""An image's file may be larger than its pixels by headers and by what does not compress."""
_COLOR_CODINGS: dict[int, Coding] = {0: "raw_rgb", 1: "encoded", 2: "encoded"}
_DEPTH_CODINGS: dict[int, Coding] = {0: "raw_ushort", 1: "zlib_ushort"}
_OCCI = 2


@dataclasses.dataclass(frozen=True, eq=False)
class SensFrame:
    """One frame, nothing decoded."""

    pose: Float[np.ndarray, "4 4"]
    """Camera to dataset as stored: minus infinity where tracking was lost."""
    color_time: int
    depth_time: int
    color: ImageSlice
    depth: ImageSlice


@dataclasses.dataclass(frozen=True, eq=False)
class SensFile:
    """What the file says, and where its frames are."""

    path: Path
    sensor: str
    color_intrinsic: Float[np.ndarray, "4 4"]
    color_extrinsic: Float[np.ndarray, "4 4"]
    depth_intrinsic: Float[np.ndarray, "4 4"]
    depth_extrinsic: Float[np.ndarray, "4 4"]
    color_size: tuple[int, int]
    """Width, height, pixels."""
    depth_size: tuple[int, int]
    units_per_metre: float
    declared: int
    """Frames that the header promises."""
    frames: tuple[SensFrame, ...]
    """Those that are whole."""
    header: bytes
    """Everything before the first frame."""


def index_sens(path: Path) -> SensFile:
    """Read the header and, seeking from frame to frame, the place of every image.

    A file that ends too early keeps its whole frames: fewer than `SensFile.declared`.

    Raises:
        SequenceError: another version, sizes that cannot be, depth compressed with OpenNI's own
            coding, or a header that is cut.
    """
    try:
        with path.open("rb") as file:
            return _index(file, path)
    except OSError as error:
        raise SequenceError(f"{path}: {error.strerror}", "give a ScanNet .sens file") from None


def _index(file: BinaryIO, path: Path) -> SensFile:
    version, length = _NAME_LENGTH.unpack(_exactly(file, _NAME_LENGTH.size, path))
    if version != VERSION_READ:
        raise SequenceError(
            f"{path}: version {version}, not {VERSION_READ}: no .sens file, or an older one",
            "download the scan again; ScanNet publishes version 4",
        )
    if length > _MAX_NAME_BYTES:
        raise SequenceError(
            f"{path}: the sensor's name is {length} bytes long (at most {_MAX_NAME_BYTES})",
            "download the scan again",
        )
    sensor = _exactly(file, length, path).decode("utf-8", "replace")
    values = _HEADER.unpack(_exactly(file, _HEADER.size, path))
    matrices = np.array(values[:64], np.float64).reshape(4, 4, 4)
    coding_of_color, coding_of_depth, *sizes, units, declared = values[64:]
    color, depth = (sizes[0], sizes[1]), (sizes[2], sizes[3])
    codings = _codings(path, coding_of_color, coding_of_depth)
    _check_header(path, matrices, color, depth, units)
    start = file.tell()
    file.seek(0)
    header = file.read(start)
    return SensFile(
        path=path,
        sensor=sensor,
        color_intrinsic=matrices[0],
        color_extrinsic=matrices[1],
        depth_intrinsic=matrices[2],
        depth_extrinsic=matrices[3],
        color_size=color,
        depth_size=depth,
        units_per_metre=units,
        declared=declared,
        frames=_frames(file, path, start, declared, codings, color, depth),
        header=header,
    )


def _exactly(file: BinaryIO, count: int, path: Path) -> bytes:
    data = file.read(count)
    if len(data) < count:
        raise SequenceError(
            f"{path} is cut off within its header, after {file.tell()} bytes",
            "download the scan again",
        )
    return data


def _codings(path: Path, color: int, depth: int) -> tuple[Coding, Coding]:
    if depth == _OCCI:
        raise SequenceError(
            f"{path}: depth is compressed by OpenNI's own coding (occi_ushort), which is not read",
            "export it with ScanNet's SensReader to color/, depth/, pose/ and intrinsic/",
        )
    if color not in _COLOR_CODINGS or depth not in _DEPTH_CODINGS:
        raise SequenceError(
            f"{path}: compression of colour {color}, of depth {depth}: unknown",
            "colour may be 0 (raw), 1 (png), 2 (jpeg), depth 0 (raw), 1 (zlib); "
            "download the scan again",
        )
    return _COLOR_CODINGS[color], _DEPTH_CODINGS[depth]


def _check_header(
    path: Path,
    matrices: np.ndarray,
    color: tuple[int, int],
    depth: tuple[int, int],
    units: float,
) -> None:
    for kind, (width, height) in (("colour", color), ("depth", depth)):
        if not (0 < width <= _MAX_SIDE_PX and 0 < height <= _MAX_SIDE_PX):
            raise SequenceError(
                f"{path}: {kind} images of {width}x{height} (sides of 1 to {_MAX_SIDE_PX})",
                "download the scan again",
            )
    if not (np.isfinite(units) and units > 0):
        raise SequenceError(f"{path}: depth has {units} units per metre", "download the scan again")
    for kind, matrix in (("colour", matrices[0]), ("depth", matrices[2])):
        if not np.isfinite(matrix).all() or matrix[0, 0] <= 0 or matrix[1, 1] <= 0:
            raise SequenceError(
                f"{path}: intrinsics of the {kind} camera {matrix[:3, :3].tolist()}",
                "download the scan again",
            )


def _frames(
    file: BinaryIO,
    path: Path,
    start: int,
    declared: int,
    codings: tuple[Coding, Coding],
    color: tuple[int, int],
    depth: tuple[int, int],
) -> tuple[SensFrame, ...]:
    """Whole frames, until the declared number or the end of the file."""
    end = file.seek(0, 2)
    limits = (4 * color[0] * color[1] + _SLACK_BYTES, 3 * depth[0] * depth[1] + _SLACK_BYTES)
    frames: list[SensFrame] = []
    at = start
    while len(frames) < declared and at + _FRAME.size <= end:
        file.seek(at)
        *pose, color_time, depth_time, color_bytes, depth_bytes = _FRAME.unpack(
            file.read(_FRAME.size)
        )
        _check_sizes(path, f"frame {len(frames)} (byte {at})", (color_bytes, depth_bytes), limits)
        at += _FRAME.size
        images = (
            ImageSlice(path, at, color_bytes, codings[0], *color),
            ImageSlice(path, at + color_bytes, depth_bytes, codings[1], *depth),
        )
        at += color_bytes + depth_bytes
        if at > end:
            break
        matrix = np.array(pose, np.float64).reshape(4, 4)
        frames.append(SensFrame(matrix, color_time, depth_time, *images))
    return tuple(frames)


def _check_sizes(path: Path, where: str, sizes: tuple[int, int], limits: tuple[int, int]) -> None:
    for kind, size, limit in zip(("colour", "depth"), sizes, limits, strict=True):
        if size > limit:
            raise SequenceError(
                f"{path}: {where} claims {size} bytes of {kind}, more than {limit}, which its "
                "size in pixels allows",
                "the file is damaged from there on: download the scan again",
            )
