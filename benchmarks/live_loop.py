"""Frames per second of the whole live loop, and where the time of a frame goes."""

from __future__ import annotations

import dataclasses
import os
import statistics
import time
from collections.abc import Iterable, Iterator
from pathlib import Path

import jax

from isr_jax.config import Settings, preset, with_overrides
from isr_jax.datasets import open_sequence
from isr_jax.errors import FrameError
from isr_jax.map_runs.frames import segmented_frames
from isr_jax.mapping import PanopticMapper
from isr_jax.segmentation import (
    Segmenter,
    label_segments,
    open_segmenter,
    segment_depth,
    segment_frame,
)
from isr_jax.types import Frame, FrameSegments, RgbdSequence

from .figures import Figure, Stopwatch
from .filmed import integrated, without_segments

FRAMES_PER_S, SEGMENTATION_MS = 20.0, 15.0
"""The promises: of the whole loop without inference, and of the depth segmentation of a frame."""
_PASSES = 3
_DECODE, _FOUND, _SEGMENTS = "decode colour and depth", "masks", "depth segmentation"
_MASKS, _OUTLIERS = "masks and segments", "outliers"
_VOXELS, _LABELS = "voxels", "labels"
_MODELS = ("yolox_nano_coco80.onnx", "deeplabv3_mnv2_ade20k32_logits.onnx")


def kitchen_figures(count: int) -> list[Figure]:
    """The loop with two networks on a real kitchen; nothing where the data is not there."""
    default = Path(__file__).resolve().parents[2] / "shared" / "data"
    data = Path(os.environ.get("ISR_SHARED_DATA", default))
    if not (data / "redkitchen").is_dir():
        return []
    sequence = open_sequence(data / "redkitchen")
    spec = "+".join(str(data / "models" / name) for name in _MODELS)
    segmenter = open_segmenter(spec, sequence.source)
    return live_figures(sequence, segmenter, min(count, len(sequence)), promised=None)


def live_figures(
    sequence: RgbdSequence,
    segmenter: Segmenter,
    count: int,
    *,
    promised: float | None = FRAMES_PER_S,
) -> list[Figure]:
    """Each part alone, then the loop in one thread and as `segmented_frames` overlaps it.

    Args:
        sequence: Read from disk.
        segmenter: Its masks.
        count: Frames of it.
        promised: Frames per second.
    """
    settings = with_overrides(preset("default"), ["mapping.voxel_size_m=0.02"])
    _timed_parts(sequence, segmenter, count, settings)  # compiles
    watch = _timed_parts(sequence, segmenter, count, settings)
    figures = _part_figures(watch, core=False) + _part_figures(watch, core=True)
    alone, overlapped = [], []
    for _ in range(_PASSES):
        one_by_one = _one_by_one(sequence, segmenter, count, settings)
        alone.append(_rate(one_by_one, sequence, settings))
        ahead = segmented_frames(sequence, list(range(count)), segmenter, settings)
        overlapped.append(_rate(ahead, sequence, settings))
    before, after = statistics.median(alone), statistics.median(overlapped)
    return [
        *figures,
        Figure("whole loop, one thread", before, "frames/s", "higher"),
        Figure("whole loop", after, "frames/s", "higher", promised),
        Figure("whole loop / one thread", after / before, "x", "higher"),
    ]


def _part_figures(watch: Stopwatch, *, core: bool) -> list[Figure]:
    ms = {name: watch.ms(name, core=core) for name in watch.wall_s}
    for part, below in ((_OUTLIERS, _MASKS), (_LABELS, _VOXELS)):
        ms[part] = watch.extra_ms(part, below, core=core)
    unit = "core ms per frame" if core else "ms per frame"
    bound = {} if core else {_SEGMENTS: SEGMENTATION_MS}
    return [Figure(name, value, unit, "lower", bound.get(name)) for name, value in ms.items()]


def _timed_parts(
    sequence: RgbdSequence, segmenter: Segmenter, count: int, settings: Settings
) -> Stopwatch:
    """Each frame through all parts, one after the other; outliers and labels with what is below."""
    watch, masks = Stopwatch(), settings.segmentation
    plain = dataclasses.replace(masks, remove_outliers=False)
    mapper, bare = (PanopticMapper(sequence.camera, settings.mapping) for _ in range(2))
    for index in range(count):
        frame = watch.time(_DECODE, lambda index=index: sequence[index])
        panoptic = watch.time(_FOUND, segmenter, frame)
        depth = watch.time(_SEGMENTS, segment_depth, frame.depth_m, frame.camera, masks)
        mask = panoptic.mask * (panoptic.score >= masks.min_score)[panoptic.mask]
        given = (frame, depth, mask, panoptic.class_id)
        watch.time(_MASKS, label_segments, *given, plain)
        segments = watch.time(_OUTLIERS, label_segments, *given, masks)
        segmented = [(frame, segments)]
        watch.time(_VOXELS, integrated, bare, without_segments(segmented))
        watch.time(_LABELS, integrated, mapper, segmented)
    return watch


def _one_by_one(
    sequence: RgbdSequence, segmenter: Segmenter, count: int, settings: Settings
) -> Iterator[tuple[Frame, FrameSegments]]:
    for index in range(count):
        frame = sequence[index]
        yield frame, segment_frame(frame, segmenter(frame), settings.segmentation)


def _rate(
    frames: Iterable[tuple[Frame, FrameSegments] | FrameError],
    sequence: RgbdSequence,
    settings: Settings,
) -> float:
    """Frames per second from the first frame asked for to the last one integrated."""
    mapper = PanopticMapper(sequence.camera, settings.mapping)
    count, start = 0, time.perf_counter()
    for item in frames:
        if not isinstance(item, FrameError):
            mapper.integrate(*item)
            count += 1
    jax.block_until_ready(mapper.pool)
    return count / (time.perf_counter() - start)
