"""A sequence becomes one panoptic map: frames are read, segmented, fused; bad ones skipped."""

from __future__ import annotations

from . import datasets, mapping, segmentation
from .config import Settings
from .errors import FrameError, SegmenterError, SequenceError
from .stage_runner import StageRunner
from .types import Frame, FrameSegments, MappingResult, Sequence

_TRIED_FRAMES = 5
"""Of the frames that must be good, about so many are tried; the first with masks is enough."""


def fuse(
    sequence: Sequence,
    segmenter: segmentation.Segmenter,
    settings: Settings,
    runner: StageRunner,
) -> MappingResult:
    """Segment every frame and fuse it into one panoptic map; bad frames are skipped and counted."""
    indices = _frame_indices(sequence, settings)
    mapper, start, skipped = _resume(sequence, settings, runner)
    if start == 0:
        _try_segmenter(sequence, segmenter, indices, settings)
    for done, (_, frame) in enumerate(datasets.prefetch(sequence, indices[start:]), start + 1):
        try:
            if isinstance(frame, FrameError):
                raise frame
            mapper.integrate(frame, _segment(frame, segmenter, settings))
        except FrameError as error:
            skipped.append(error.problem)
            runner.reporter.note(f"frame skipped: {error.problem}")
            _refuse_too_many(skipped, len(indices), settings, error)
        every = settings.mapping.checkpoint_every
        if every and done % every == 0 and done < len(indices):
            runner.checkpoint("mapping", mapper.save, {"done": done, "skipped": skipped})
        runner.reporter.progress("mapping", done, len(indices))
    used = len(indices) - len(skipped)
    return MappingResult(mapper.surface(), used, tuple(skipped))


def _try_segmenter(
    sequence: Sequence, segmenter: segmentation.Segmenter, indices: list[int], settings: Settings
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


def _segment(frame: Frame, segmenter: segmentation.Segmenter, settings: Settings) -> FrameSegments:
    return segmentation.segment_frame(frame, segmenter(frame), settings.segmentation)


def _frame_indices(sequence: Sequence, settings: Settings) -> list[int]:
    indices = list(range(0, len(sequence), settings.input.stride))
    return indices[: settings.input.max_frames or None]


def _resume(
    sequence: Sequence, settings: Settings, runner: StageRunner
) -> tuple[mapping.PanopticMapper, int, list[str]]:
    """A fresh mapper, or the one that a killed run left behind."""
    found = runner.resume("mapping")
    if found is None:
        return mapping.PanopticMapper(sequence.camera, settings.mapping), 0, []
    path, state = found
    mapper = mapping.PanopticMapper.load(path)
    runner.reporter.note(f"mapping resumes after {state['done']} frames")
    return mapper, state["done"], list(state["skipped"])


def _refuse_too_many(skipped: list[str], total: int, settings: Settings, last: FrameError) -> None:
    if len(skipped) > settings.input.max_bad_fraction * total:
        raise SequenceError(
            f"{len(skipped)} of {total} frames cannot be read; the last: {last.problem}",
            "mend the sequence (`isr inspect` lists what is wrong), "
            "or raise input.max_bad_fraction",
        )
