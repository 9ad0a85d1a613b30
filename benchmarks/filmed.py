"""The frames that benchmarks map: a furnished room, filmed once and read back into memory."""

from __future__ import annotations

import dataclasses
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from isr_jax.cad import default_library
from isr_jax.config import SegmentationSettings
from isr_jax.datasets import open_sequence
from isr_jax.mapping import PanopticMapper
from isr_jax.mapping.pool import VoxelPool
from isr_jax.segmentation import Segmenter, open_segmenter, segment_frame
from isr_jax.synthetic import make_room, render_sequence
from isr_jax.types import Frame, FrameSegments, RgbdSequence

SegmentedFrames = list[tuple[Frame, FrameSegments]]
"""Frames with their segments: what a mapper takes."""


@dataclasses.dataclass(frozen=True, eq=False)
class Filmed:
    """A film on disk and its frames in memory, with the segments that true masks give."""

    sequence: RgbdSequence
    segmenter: Segmenter
    frames: SegmentedFrames


@contextmanager
def filmed_room(seed: int, frames: int, width: int, height: int) -> Iterator[Filmed]:
    """A furnished room as a structured-light camera sees it, noise and all.

    Args:
        seed: Of the room, the walk and the noise.
        frames: Length of the film.
        width: Of the images, pixels.
        height: Of the images, pixels.
    """
    room = make_room(seed, default_library())
    with tempfile.TemporaryDirectory() as folder:
        render_sequence(room, Path(folder), frames=frames, width=width, height=height, seed=seed)
        yield read_film(Path(folder), frames)


def read_film(folder: Path, frames: int) -> Filmed:
    """The first frames of a film that has its true masks beside it."""
    sequence, settings = open_sequence(folder), SegmentationSettings()
    segmenter = open_segmenter("simulated:perfect", folder)
    read = [sequence[i] for i in range(min(frames, len(sequence)))]
    segmented = [(frame, segment_frame(frame, segmenter(frame), settings)) for frame in read]
    return Filmed(sequence, segmenter, segmented)


def integrated(mapper: PanopticMapper, frames: SegmentedFrames) -> VoxelPool:
    """Integrate frames, labels and all; the voxels, perhaps still being computed.

    Those of the last step: `PanopticMapper.pool` would integrate what waits for its step first.
    """
    for frame, segments in frames:
        mapper.integrate(frame, segments)
    return mapper.integrator.pool


def without_segments(frames: SegmentedFrames) -> SegmentedFrames:
    """The same with nothing to label: what is left to integrate is geometry and colour."""
    none = np.zeros(1, np.int32)
    return [(f, FrameSegments(np.zeros_like(s.segment), none, none)) for f, s in frames]


def moved(frame: Frame, offset_m: tuple[float, float, float]) -> Frame:
    """The frame as taken elsewhere."""
    T = frame.T_world_camera.copy()
    T[:3, 3] += offset_m
    return dataclasses.replace(frame, T_world_camera=T)
