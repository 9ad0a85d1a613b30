"""A sequence becomes one panoptic map: frames are read, segmented, fused; bad ones skipped.

While the mapper fuses a frame in the caller's thread, another thread finds the masks and segments
of the next ones, and others decode those after it. Each frame's segments depend on that frame
alone and the mapper takes them in order, so the map is bit for bit that of one thread.
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Generator, Iterable, Iterator
from contextlib import closing
from typing import Any

from .. import datasets, mapping, segmentation
from ..config import Settings
from ..errors import FrameError, MapError, SegmenterError, SequenceError
from ..runtime.prefetch import map_ahead
from ..runtime.reporter import Reporter
from ..runtime.stage_runner import StageRunner
from ..types import Frame, FrameSegments, MappingResult, RgbdSequence

_TRIED_FRAMES = 5
"""Of the frames that must be good, about so many are tried; the first with masks is enough."""
_AHEAD = 2
"""Frames segmented before the mapper asks for them."""


def fuse(
    sequence: RgbdSequence,
    segmenter: segmentation.Segmenter,
    settings: Settings,
    runner: StageRunner,
) -> MappingResult:
    """Segment every frame and fuse it into one panoptic map; bad frames are skipped and counted."""
    indices = frame_indices(sequence, settings)
    mapper, start, skipped = _resume(sequence, settings, runner)
    if start == 0:
        try_segmenter(sequence, segmenter, indices, settings)
    done, every = start, settings.mapping.checkpoint_every
    with closing(segmented_frames(sequence, indices[start:], segmenter, settings)) as ready:
        fused = fuse_usable(
            ready, mapper.integrate, skipped, len(indices), settings, runner.reporter
        )
        try:
            for done, _ in enumerate(fused, start + 1):
                if every and done % every == 0 and done < len(indices):
                    state = {"done": done, "skipped": skipped}
                    runner.checkpoint("mapping", mapper.save, state)
                runner.reporter.progress("mapping", done, len(indices))
        except MapError as error:
            state = {"done": done, "skipped": skipped}
            raise _with_map_so_far(error, mapper, runner, state) from error
    used = len(indices) - len(skipped)
    return MappingResult(mapper.surface(), used, tuple(skipped))


def fuse_usable(
    frames: Iterable[tuple[Frame, FrameSegments] | FrameError],
    integrate: Callable[[Frame, FrameSegments], None],
    skipped: list[str],
    total: int,
    settings: Settings,
    reporter: Reporter,
) -> Iterator[None]:
    """Fuse frames as they come, and skip those that cannot be used; yields after each.

    Args:
        frames: Of `segmented_frames`.
        integrate: Takes each of them; may raise `FrameError`.
        skipped: What is wrong with each skipped frame is added here.
        total: Frames that there will be, those before these included.
        settings: ``input.max_bad_fraction`` of them may be skipped.
        reporter: Is told of each.

    Raises:
        SequenceError: more than that had to be skipped.
    """
    for frame in frames:
        try:
            if isinstance(frame, FrameError):
                raise frame
            integrate(*frame)
        except FrameError as error:
            skipped.append(error.problem)
            reporter.note(f"frame skipped: {error.problem}")
            _refuse_too_many(skipped, total, settings, error)
        else:
            if not frame[0].depth_m.any():
                reporter.note(f"frame {frame[0].name} has no depth: nothing to fuse")
        yield


def try_segmenter(
    sequence: RgbdSequence,
    segmenter: segmentation.Segmenter,
    indices: list[int],
    settings: Settings,
) -> None:
    """Stop before the first frame is fused where no sampled frame has masks."""
    failed, good = None, (1 - settings.input.max_bad_fraction) * len(indices)
    for index in indices[:: max(1, int(good) // _TRIED_FRAMES)]:
        try:
            frame = sequence[index]
        except FrameError:
            continue  # it is skipped and counted when its turn comes
        try:
            segmenter(frame)
        except FrameError as error:
            failed = failed or error
        else:
            return
    if failed is not None:
        raise SegmenterError(f"no sampled frame has masks: {failed.problem}", failed.hint)


def segmented_frames(
    sequence: RgbdSequence,
    indices: list[int],
    segmenter: segmentation.Segmenter,
    settings: Settings,
) -> Generator[tuple[Frame, FrameSegments] | FrameError, None, None]:
    """Frames and their segments in order, made ahead; one that cannot be used as its error.

    The segmenter is called in one thread, which is not the caller's.
    """
    frames = (frame for _, frame in datasets.prefetch(sequence, indices))
    segment = functools.partial(_segmented, segmenter=segmenter, settings=settings)
    return map_ahead(segment, frames, workers=1, ahead=_AHEAD, name="segment")


def _segmented(
    frame: Frame | FrameError, segmenter: segmentation.Segmenter, settings: Settings
) -> tuple[Frame, FrameSegments] | FrameError:
    if isinstance(frame, FrameError):
        return frame
    try:
        return frame, segmentation.segment_frame(frame, segmenter(frame), settings.segmentation)
    except FrameError as error:
        return error


def frame_indices(sequence: RgbdSequence, settings: Settings, start: int = 0) -> list[int]:
    """Frames that are read, from ``start`` on; raises `SequenceError` where there are none."""
    indices = list(range(start, len(sequence), settings.input.stride))
    if start and not indices:
        raise SequenceError(
            f"{sequence.name} has {len(sequence)} frames: none from {start} on", "lower --start"
        )
    return indices[: settings.input.max_frames or None]


def _resume(
    sequence: RgbdSequence, settings: Settings, runner: StageRunner
) -> tuple[mapping.PanopticMapper, int, list[str]]:
    """A fresh mapper, or the one that a killed run left behind."""
    found = runner.resume("mapping")
    if found is None:
        return mapping.PanopticMapper(sequence.camera, settings.mapping), 0, []
    path, state = found
    mapper = mapping.PanopticMapper.load(path)
    runner.reporter.note(f"mapping resumes after {state['done']} frames")
    return mapper, state["done"], list(state["skipped"])


def _with_map_so_far(
    error: MapError, mapper: mapping.PanopticMapper, runner: StageRunner, state: dict[str, Any]
) -> MapError:
    """The error, its map kept as a checkpoint that it names, if results are kept at all."""
    path = runner.checkpoint("mapping", mapper.save, state)
    kept = f"; the map of {mapper.frames} frames is kept in {path}" if path else ""
    return MapError(error.problem, error.hint + kept)


def _refuse_too_many(skipped: list[str], total: int, settings: Settings, last: FrameError) -> None:
    if len(skipped) > settings.input.max_bad_fraction * total:
        raise SequenceError(
            f"{len(skipped)} of {total} frames cannot be read; the last: {last.problem}",
            f"{last.hint}; `isr inspect` lists what is wrong; or raise input.max_bad_fraction",
        )
