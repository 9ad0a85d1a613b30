"""Checks of a whole recording on a few of its frames: resolution, depth unit, pose convention."""

from __future__ import annotations

import collections
import dataclasses

import numpy as np
from jaxtyping import Float

from ..config import InputSettings
from ..errors import FrameError, SequenceError
from ..types import Camera
from .recording import RecordedFrame, Recording, spread
from .reprojection import HOLDS_M, convention_errors_m, holding, moved_pair
from .world_frame import Cloud, sample_cloud

_SAMPLED = 30
"""Frames, spread over the sequence, that the checks and the world frame are taken from."""
_PAIRS = 8
_DEPTH_RANGE_M = (0.2, 20.0)
"""A median depth outside is no room: the unit is wrong."""
_UNITS = {1.0: "metres", 100.0: "centimetres", 1000.0: "millimetres", 5000.0: "TUM's 1/5000 m"}
_CENTRE_SHARE = 0.2
"""The principal point lies this near the middle of the image, as a share of its size."""


@dataclasses.dataclass(frozen=True, eq=False)
class Samples:
    """Frames spread over a recording, decoded once for all checks."""

    depth_m: tuple[np.ndarray, ...]
    """[height, width] each, not clipped; a bad frame may be of another size."""
    poses: tuple[Float[np.ndarray, "4 4"], ...]
    pairs: tuple[tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray], ...]
    """(depth a, depth b, pose a, pose b) of frames that see the same from elsewhere."""
    errors: tuple[FrameError, ...]


def read_samples(recording: Recording) -> Samples:
    """Decode depth of frames spread over the recording, and of partners that moved.

    Raises:
        SequenceError: none of the sampled frames can be read.
    """
    depth_m, poses, errors, readable = [], [], [], []
    for i in spread(len(recording.frames), _SAMPLED):
        try:
            pose, depth = pose_of(recording.frames[i]), recording.depth_m(recording.frames[i])
        except FrameError as error:
            errors.append(error)
            continue
        depth_m.append(depth)
        poses.append(pose)
        readable.append(i)
    if not readable:
        raise SequenceError(
            f"{recording.path}: none of {len(errors)} sampled frames can be read; the first: "
            f"{errors[0].problem}",
            errors[0].hint,
        )
    pairs = _moved_pairs(recording, readable, depth_m, poses)
    return Samples(tuple(depth_m), tuple(poses), pairs, tuple(errors))


def _moved_pairs(
    recording: Recording,
    readable: list[int],
    depth_m: list[np.ndarray],
    poses: list[np.ndarray],
) -> tuple[tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray], ...]:
    usable = np.array([not isinstance(f.pose, FrameError) for f in recording.frames])
    every = np.stack(
        [np.eye(4) if isinstance(f.pose, FrameError) else f.pose for f in recording.frames]
    )
    pairs = []
    for k in spread(len(readable), _PAIRS):
        j = moved_pair(every, usable, readable[k])
        if j is None:
            continue
        try:
            partner = recording.depth_m(recording.frames[j])
        except FrameError:
            continue  # it is counted where the frames are read; here another pair will do
        if partner.shape == depth_m[k].shape:
            pairs.append((depth_m[k], partner, poses[k], every[j]))
    return tuple(pairs)


def recorded_camera(recording: Recording, samples: Samples) -> Camera:
    """The camera of the depth images.

    Raises:
        SequenceError: the intrinsics are of another resolution.
    """
    known = recording.intrinsics
    shapes = collections.Counter(d.shape for d in samples.depth_m)
    height, width = shapes.most_common(1)[0][0]
    given = known.width or width, known.height or height
    off = max(abs(known.cx / width - 0.5), abs(known.cy / height - 0.5))
    if given != (width, height) or off > _CENTRE_SHARE:
        sx, sy = (width / given[0], height / given[1]) if given != (width, height) else (1.0, 1.0)
        scaled = (known.fx * sx, known.fy * sy, known.cx * sx, known.cy * sy)
        raise SequenceError(
            f"intrinsics ({known.source}) are of another resolution than the depth images: "
            f"they say {given[0]}x{given[1]} with cx = {known.cx:g}, cy = {known.cy:g}, depth is "
            f"{width}x{height}",
            "give those of the depth image"
            + (
                ": by size alone fx, fy, cx, cy = " + ", ".join(f"{v:g}" for v in scaled)
                if sx != 1.0 or sy != 1.0
                else ""
            ),
        )
    return Camera(known.fx, known.fy, known.cx, known.cy, width, height)


def check_depth_unit(recording: Recording, samples: Samples) -> float:
    """Median depth in metres, which must be a room's.

    Raises:
        SequenceError: the median is no room's, with the likely unit; or depth is empty.
    """
    values = np.concatenate([d[::8, ::8].ravel() for d in samples.depth_m])
    values = values[values > 0]
    if len(values) == 0:
        raise SequenceError(
            f"{recording.path}: the depth images are empty", "record it again with depth"
        )
    median = float(np.median(values))
    low, high = _DEPTH_RANGE_M
    if low <= median <= high:
        return median
    raw = median * recording.units_per_metre
    likely = min(_UNITS, key=lambda units: abs(np.log(raw / units / 2.0)))
    raise SequenceError(
        f"{recording.path}: the median depth is {median:.4g} m with {recording.units_per_metre:g} "
        f"units per metre, outside {low} to {high} m; the values look like {_UNITS[likely]}",
        f"set depth_scale to {likely:g} (units per metre)",
    )


def check_convention_holds(
    recording: Recording, samples: Samples, camera: Camera
) -> tuple[str, ...]:
    """Check the declared pose convention against how well depth reprojects.

    Returns a note where the poses could not be confirmed, else nothing.

    Raises:
        SequenceError: depth reprojects clearly better under another convention.
    """
    declared = recording.convention
    errors_m = convention_errors_m(list(samples.pairs), camera, declared)
    found = holding(errors_m, declared)
    if found is None:
        return (
            f"poses could not be confirmed: between sampled frames depth reprojects to no better "
            f"than {HOLDS_M * 1e3:.0f} mm under any convention (frames too far apart, a camera "
            "that hardly moves, or poses that do not belong to the images)",
        )
    if found != declared:
        raise SequenceError(
            f"{recording.path}: poses do not fit {declared}: depth reprojects to "
            f"{errors_m[declared] * 1e3:.0f} mm, with {found} to {errors_m[found] * 1e3:.0f} mm",
            f'set "pose_convention": "{found}" in intrinsics.json (plain layout); '
            "`isr inspect` shows all",
        )
    return ()


def sampled_cloud(samples: Samples, camera: Camera, settings: InputSettings) -> Cloud:
    """Points and normals of the sampled frames within the believed depth."""
    clouds = []
    for depth_m, pose in zip(samples.depth_m, samples.poses, strict=True):
        if depth_m.shape != (camera.height, camera.width):
            continue
        inside = (depth_m >= settings.depth_min_m) & (depth_m <= settings.depth_max_m)
        clouds.append(sample_cloud(np.where(inside, depth_m, np.float32(0)), camera, pose))
    points, normals = (np.concatenate(c) for c in zip(*clouds, strict=True))
    return Cloud(points, normals, np.stack([p[:3, 1] for p in samples.poses]))


def pose_of(recorded: RecordedFrame) -> np.ndarray:
    """The pose of a frame.

    Raises:
        FrameError: the frame has no pose; it says why.
    """
    if isinstance(recorded.pose, FrameError):
        raise FrameError(recorded.pose.problem, recorded.pose.hint)
    return recorded.pose
