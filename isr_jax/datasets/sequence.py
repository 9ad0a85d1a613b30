"""`open_sequence`: checks a recording where it is opened and delivers frames in the world."""

from __future__ import annotations

import dataclasses
import functools
import hashlib
from pathlib import Path

import numpy as np
from jaxtyping import Float

from ..config import InputSettings
from ..errors import FrameError, SequenceError
from ..types import Camera, Frame
from .checks import (
    check_convention_holds,
    check_depth_unit,
    pose_of,
    read_samples,
    recorded_camera,
    sampled_cloud,
)
from .images import ColorCamera, read_color, register_color, resize_color
from .layouts import read_recording
from .recording import RecordedFrame, Recording, present
from .world_frame import WorldFrame, degrees_between, find_world_frame

_ASPECT_TOLERANCE = 0.02


@dataclasses.dataclass(frozen=True, eq=False)
class RecordedSequence:
    """A `types.RgbdSequence` over a recording. Made by `open_sequence`."""

    name: str
    source: Path
    """The folder."""
    camera: Camera
    T_world_dataset: Float[np.ndarray, "4 4"]
    world: WorldFrame
    recording: Recording
    settings: InputSettings
    notes: tuple[str, ...]
    """What was assumed or changed, for the user."""

    def __len__(self) -> int:
        return len(self.recording.frames)

    def __getitem__(self, index: int) -> Frame:
        """Decode a frame; safe to call from several threads."""
        if not -len(self) <= index < len(self):
            raise IndexError(f"frame {index} of {len(self)}")
        index %= len(self)
        recorded = self.recording.frames[index]
        pose = pose_of(recorded)
        depth_m = self._depth_m(recorded)
        color = self._color(recorded, depth_m)
        low, high = self.settings.depth_min_m, self.settings.depth_max_m
        depth_m[(depth_m < low) | (depth_m > high)] = 0.0
        return Frame(
            index=index,
            name=recorded.name,
            color=color,
            depth_m=depth_m,
            T_world_camera=(self.T_world_dataset @ pose).astype(np.float32),
            camera=self.camera,
        )

    def content_hash(self) -> str:
        """Hex digest of files, poses, the world frame and the depth that is believed."""
        limits = self.settings.depth_min_m, self.settings.depth_max_m
        text = f"{self._recording_hash} {limits} {self.T_world_dataset.tobytes().hex()}"
        return hashlib.blake2b(text.encode(), digest_size=16).hexdigest()

    @functools.cached_property
    def _recording_hash(self) -> str:
        return self.recording.content_hash()

    def _depth_m(self, recorded: RecordedFrame) -> np.ndarray:
        depth_m = self.recording.depth_m(recorded)
        expected = (self.camera.height, self.camera.width)
        if depth_m.shape != expected:
            raise FrameError(
                f"{recorded.depth} is {depth_m.shape[1]}x{depth_m.shape[0]}, the others are "
                f"{expected[1]}x{expected[0]}",
                "drop the frame",
            )
        return depth_m

    def _color(self, recorded: RecordedFrame, depth_m: np.ndarray) -> np.ndarray:
        color = read_color(present(recorded, recorded.color, "colour"))
        width, height = self.camera.width, self.camera.height
        own = self.recording.color_camera
        if color.shape[:2] != (height, width):
            _check_size(recorded, color, self.camera, own)
            color = resize_color(color, width, height)
        if own is None:
            return color
        return register_color(color, depth_m, self.camera, own.resized(width, height))


def open_sequence(
    path: str | Path, settings: InputSettings | None = None, *, format: str | None = None
) -> RecordedSequence:
    """Open a posed RGB-D sequence; its frames come in the world frame (z up, floor at 0).

    Args:
        path: Folder of a 7-Scenes, TUM RGB-D, SceneNN, ScanNet or plain sequence.
        settings: Which depth is believed; picking frames is left to who iterates.
        format: ``7scenes``, ``tum``, ``scenenn``, ``scannet`` or ``plain``; by default found
            from the folder's entries.

    Raises:
        SequenceError: what would spoil every frame: no frames, no intrinsics or those of another
            resolution, depth in another unit, poses of another convention, no floor.
    """
    settings = settings or InputSettings()
    recording = read_recording(Path(path), format)
    samples = read_samples(recording)
    camera = recorded_camera(recording, samples)
    check_depth_unit(recording, samples)
    unconfirmed = check_convention_holds(recording, samples, camera)
    world = find_world_frame(sampled_cloud(samples, camera, settings), recording.gravity)
    return RecordedSequence(
        name=Path(path).resolve().name,
        source=Path(path),
        camera=camera,
        T_world_dataset=world.T_world_dataset,
        world=world,
        recording=recording,
        settings=settings,
        notes=(
            *recording.notes,
            *unconfirmed,
            *color_notes(recording, camera),
            *_unusable_note(recording),
            *_levelled_note(recording, world),
        ),
    )


def color_notes(recording: Recording, camera: Camera) -> tuple[str, ...]:
    """Says so where colour is resized.

    Raises:
        SequenceError: it cannot be of the same view.
    """
    for recorded in recording.frames[:5]:
        try:
            color = read_color(present(recorded, recorded.color, "colour"))
        except FrameError:
            continue
        if color.shape[:2] == (camera.height, camera.width):
            return ()
        try:
            _check_size(recorded, color, camera, recording.color_camera)
        except FrameError as error:
            raise SequenceError(error.problem, error.hint) from None
        by = "" if recording.color_camera is None else ", by the intrinsics of both"
        return (
            f"colour is {color.shape[1]}x{color.shape[0]}; it is resized to the depth's "
            f"{camera.width}x{camera.height}{by}",
        )
    return ()


def _unusable_note(recording: Recording) -> tuple[str, ...]:
    bad = [f for f in recording.frames if not (f.color and f.depth) or _is_error(f.pose)]
    count = len(recording.frames)
    return (f"{len(bad)} of {count} frames lack a file or a pose",) if bad else ()


def _is_error(pose: np.ndarray | FrameError) -> bool:
    return isinstance(pose, FrameError)


def _check_size(
    recorded: RecordedFrame, color: np.ndarray, camera: Camera, own: ColorCamera | None
) -> None:
    """Colour of another size: of its own camera's, or of the same view as depth."""
    width, height = camera.width, camera.height
    if own is not None and own.width is not None:
        if color.shape[:2] != (own.height, own.width):
            raise FrameError(
                f"{recorded.color} is {color.shape[1]}x{color.shape[0]}, the colour camera's "
                f"images are {own.width}x{own.height}",
                "drop the frame",
            )
        return
    ratio = color.shape[1] / color.shape[0] / (width / height)
    if abs(ratio - 1) > _ASPECT_TOLERANCE:
        raise FrameError(
            f"{recorded.color} is {color.shape[1]}x{color.shape[0]}, depth is {width}x{height}: "
            "these cannot be of one view",
            "register colour to depth first",
        )


def _levelled_note(recording: Recording, world: WorldFrame) -> tuple[str, ...]:
    if recording.gravity is None or np.array_equal(world.gravity, recording.gravity):
        return ()
    angle = degrees_between(recording.gravity, world.gravity)
    return (f"gravity as given is {angle:.1f} degrees off floors and walls: levelled by them",)
