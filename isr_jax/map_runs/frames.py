"""A sequence becomes one panoptic map: frames are read, segmented, integrated; bad ones skipped.

While the mapper integrates a frame in the caller's thread, another thread finds the masks and
segments of the next ones, and others decode those after it. Each frame's segments depend on that
frame alone and the mapper takes them in order, so the map is bit for bit that of one thread.
"""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Callable, Generator, Iterable, Iterator
from contextlib import closing
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float

from .. import datasets, mapping, segmentation
from ..config import Settings
from ..errors import FrameError, MapError, SegmenterError, SequenceError
from ..runtime.prefetch import prefetch_results
from ..runtime.reporter import Reporter
from ..runtime.stage_runner import StageRunner
from ..types import Frame, FrameSegments, MappingResult, RgbdSequence

_TRIED_FRAMES = 5
"""Of the frames that must be good, about so many are tried; the first with masks is enough."""
_AHEAD = 2
"""Frames segmented before the mapper asks for them."""


@dataclasses.dataclass(eq=False)
class FramesDone:
    """How far a run has come through its frames."""

    count: int = 0
    """Frames that are done, skipped ones included."""
    skipped: list[str] = dataclasses.field(default_factory=list)
    """What was wrong with each frame that was left out."""


def integrate_sequence(
    sequence: RgbdSequence,
    segmenter: segmentation.Segmenter,
    settings: Settings,
    runner: StageRunner,
) -> MappingResult:
    """Segment every frame and integrate it into one panoptic map; bad ones are skipped and counted.

    The map is saved every ``mapping.checkpoint_every`` frames, and when it cannot go on; a run
    that was broken off goes on from there.

    Raises:
        SegmenterError: no sampled frame has masks.
        SequenceError: too many frames cannot be used.
        MapError: the map cannot go on; the error names the file in which it is kept.
    """
    indices = frame_indices(sequence, settings)
    mapper, done = _resume(sequence, settings, runner)

    def save() -> Path | None:
        return runner.checkpoint("mapping", mapper.save, _state(done))

    def after_frame() -> None:
        every = settings.mapping.checkpoint_every
        if every and done.count % every == 0 and done.count < len(indices):
            save()

    try:
        integrate_frames(
            mapper, sequence, indices, segmenter, settings, runner.reporter, done, after_frame
        )
    except MapError as error:
        path = save()
        kept = f"; the map of {mapper.frames} frames is kept in {path}" if path else ""
        raise MapError(error.problem, error.hint + kept) from error
    used = len(indices) - len(done.skipped)
    return MappingResult(mapper.surface(), used, tuple(done.skipped))


def integrate_frames(
    mapper: mapping.PanopticMapper,
    sequence: RgbdSequence,
    indices: list[int],
    segmenter: segmentation.Segmenter,
    settings: Settings,
    reporter: Reporter,
    done: FramesDone,
    after_frame: Callable[[], None] = lambda: None,
) -> None:
    """Read frames, segment them and integrate them into a map, in order.

    Poses are brought into the world of the map (`PanopticMapper.T_world_dataset`).

    Args:
        mapper: The map that grows.
        sequence: Of the same camera.
        indices: Frames of it, those that are done included.
        segmenter: Finds the masks of a frame.
        settings: Of the run: ``input`` and ``segmentation`` are used.
        reporter: Is told of progress and of frames that are skipped.
        done: Where the run stands; kept up to date after each frame.
        after_frame: Called after each frame.

    Raises:
        SegmenterError: no sampled frame has masks; nothing was integrated.
        SequenceError: too many frames cannot be used.
        MapError: the map cannot go on; what was integrated is kept.
    """
    if not done.count:
        try_segmenter(sequence, segmenter, indices, settings)
    T_map_sequence = mapper.T_world_dataset @ np.linalg.inv(sequence.T_world_dataset)

    def integrate(frame: Frame, segments: FrameSegments) -> None:
        mapper.integrate(_moved(frame, T_map_sequence), segments)

    rest, total = indices[done.count :], len(indices)
    with closing(segmented_frames(sequence, rest, segmenter, settings)) as frames:
        for _ in integrate_usable(frames, integrate, done.skipped, total, settings, reporter):
            done.count += 1
            after_frame()
            reporter.progress("mapping", done.count, total)


def _moved(frame: Frame, T: Float[np.ndarray, "4 4"]) -> Frame:
    if np.allclose(T, np.eye(4), atol=1e-9):
        return frame
    pose = (T @ frame.T_world_camera.astype(np.float64)).astype(np.float32)
    return dataclasses.replace(frame, T_world_camera=pose)


def integrate_usable(
    frames: Iterable[tuple[Frame, FrameSegments] | FrameError],
    integrate: Callable[[Frame, FrameSegments], None],
    skipped: list[str],
    total: int,
    settings: Settings,
    reporter: Reporter,
) -> Iterator[None]:
    """Integrate frames as they come, and skip those that cannot be used; yields after each.

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
                reporter.note(f"frame {frame[0].name} has no depth: nothing to integrate")
        yield


def try_segmenter(
    sequence: RgbdSequence,
    segmenter: segmentation.Segmenter,
    indices: list[int],
    settings: Settings,
) -> None:
    """Stop before the first frame is integrated where no sampled frame has masks.

    Raises:
        SegmenterError: none of them has.
    """
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
    return prefetch_results(segment, frames, workers=1, ahead=_AHEAD, name="segment")


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
    """Frames that are read, from ``start`` on.

    Raises:
        SequenceError: there are none.
    """
    indices = list(range(start, len(sequence), settings.input.stride))
    if start and not indices:
        raise SequenceError(
            f"{sequence.name} has {len(sequence)} frames: none from {start} on", "lower --start"
        )
    return indices[: settings.input.max_frames or None]


def _resume(
    sequence: RgbdSequence, settings: Settings, runner: StageRunner
) -> tuple[mapping.PanopticMapper, FramesDone]:
    """An empty map, or the one that a killed run left behind."""
    found = runner.resume("mapping")
    if found is None:
        T_world_dataset = np.asarray(sequence.T_world_dataset, np.float64)
        mapper = mapping.PanopticMapper(sequence.camera, settings.mapping, T_world_dataset)
        return mapper, FramesDone()
    path, state = found
    mapper = mapping.PanopticMapper.load(path)
    runner.reporter.note(f"mapping resumes after {state['done']} frames")
    return mapper, FramesDone(state["done"], list(state["skipped"]))


def _state(done: FramesDone) -> dict[str, Any]:
    """What the runner keeps beside a saved map."""
    return {"done": done.count, "skipped": done.skipped}


def _refuse_too_many(skipped: list[str], total: int, settings: Settings, last: FrameError) -> None:
    if len(skipped) > settings.input.max_bad_fraction * total:
        raise SequenceError(
            f"{len(skipped)} of {total} frames cannot be read; the last: {last.problem}",
            f"{last.hint}; `isr inspect` lists what is wrong; or raise input.max_bad_fraction",
        )
