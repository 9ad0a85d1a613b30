"""What a segmenter really gives against true masks, in the terms of `NoiseRates`."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable

import numpy as np

from ..classes import classes
from ..types import Frame, PanopticFrame
from .noise_rates import MIN_PIXELS, NoiseRates
from .segmenter import Segmenter
from .simulated import TrueMasks

_Number = float | int | np.integer
_COVERED = 0.5
"""A mask covers a thing, and is a piece of it, by so much of the pixels of the one or the other."""
_PIECE = 0.1
"""Smaller parts of a thing are no piece of a split mask."""


@dataclasses.dataclass(frozen=True)
class MeasuredRates:
    """Rates over all frames together; None where there was nothing to count."""

    frames: int
    things: int
    """True things of `MIN_PIXELS`, once per frame."""
    hits: int
    """Of these, those with a mask of IoU > 0.5, whatever its class."""
    recall: float | None
    """Share of hits."""
    right_class: float | None
    """Share of the hits."""
    mean_iou: float | None
    """Of the hits."""
    false_masks: float | None
    """Masks of things per frame that no true thing matches."""
    merges: float | None
    """Masks per frame that cover at least half of each of two true things."""
    splits: float | None
    """Things a frame that two masks share, each with a tenth of it and mostly within it."""
    layout_recall: float | None
    """Share of the pixels of layout and stuff that carry their class."""
    class_recall: tuple[tuple[str, float], ...]
    """The same for each class."""

    def beside(self, stated: NoiseRates) -> list[tuple[str, float, float | None]]:
        """(rate, stated, measured) of what both know."""
        names = ["recall", "right_class", "mean_iou", "false_masks"]
        names += [] if stated.class_recall else ["layout_recall"]
        rows = [(name, getattr(stated, name), getattr(self, name)) for name in names]
        measured = dict(self.class_recall)
        return rows + [(f"pixels of {n}", v, measured.get(n)) for n, v in stated.class_recall]


def measured_rates(
    segmenter: Segmenter, truth: TrueMasks, frames: Iterable[Frame]
) -> MeasuredRates:
    """Match the masks of ``segmenter`` with the true ones, frame by frame, and count.

    A pair with IoU > 0.5 is a hit; there can be only one for a thing and for a mask.
    """
    counts = [_count(truth.read(frame)[0], segmenter(frame)) for frame in frames]
    total = {name: sum(c.numbers[name] for c in counts) for name in _NUMBERS}
    layout = np.array([info.kind in ("layout", "stuff") for info in classes()])
    pixels = sum((c.pixels for c in counts), np.zeros(len(layout), np.int64))
    kept = sum((c.kept for c in counts), np.zeros(len(layout), np.int64))
    return MeasuredRates(
        frames=len(counts),
        things=int(total["things"]),
        hits=int(total["hits"]),
        recall=_ratio(total["hits"], total["things"]),
        right_class=_ratio(total["right"], total["hits"]),
        mean_iou=_ratio(total["iou"], total["hits"]),
        false_masks=_ratio(total["false"], len(counts)),
        merges=_ratio(total["merges"], len(counts)),
        splits=_ratio(total["splits"], len(counts)),
        layout_recall=_ratio(kept[layout].sum(), pixels[layout].sum()),
        class_recall=tuple(
            (info.name, float(kept[info.id] / pixels[info.id]))
            for info in classes()
            if pixels[info.id] and info.kind != "none"
        ),
    )


_NUMBERS = ("things", "hits", "right", "iou", "false", "merges", "splits")


@dataclasses.dataclass(frozen=True, eq=False)
class _Counts:
    """Of one frame."""

    numbers: dict[str, float]
    pixels: np.ndarray
    """True pixels of each class."""
    kept: np.ndarray
    """Those that carry their class."""


def _count(true: PanopticFrame, found: PanopticFrame) -> _Counts:
    shape = len(true.class_id), len(found.class_id)
    cell = true.mask.astype(np.int64).ravel() * shape[1] + found.mask.ravel()
    shared = np.bincount(cell, minlength=shape[0] * shape[1]).reshape(shape).astype(float)
    of_true, of_found = shared.sum(1, keepdims=True), shared.sum(0, keepdims=True)
    rows = np.flatnonzero(_is_thing(true) & (of_true[:, 0] >= MIN_PIXELS))
    iou = (shared / np.maximum(of_true + of_found - shared, 1))[rows][:, 1:]
    best = iou.argmax(1) if iou.size else np.zeros(len(rows), int)
    top = iou.max(1, initial=0.0)
    hit = top > 0.5
    kinds = found.class_id[1:]
    false = _is_thing(found)[1:] & (of_found[0, 1:] > 0) & (iou.max(0, initial=0.0) <= 0.5)
    cover = (shared / np.maximum(of_true, 1))[rows][:, 1:]
    inside = (shared / np.maximum(of_found, 1))[rows][:, 1:]
    numbers = {
        "things": len(rows),
        "hits": hit.sum(),
        "right": (kinds[best[hit]] == true.class_id[rows[hit]]).sum(),
        "iou": top[hit].sum(),
        "false": false.sum(),
        "merges": ((cover >= _COVERED).sum(0) >= 2)[_is_thing(found)[1:]].sum(),
        "splits": (((cover >= _PIECE) & (inside > _COVERED)).sum(1) >= 2).sum(),
    }
    kind, count = true.class_id[true.mask].ravel(), len(classes())
    same = kind == found.class_id[found.mask].ravel()
    return _Counts(
        {name: float(number) for name, number in numbers.items()},
        np.bincount(kind, minlength=count),
        np.bincount(kind[same], minlength=count),
    )


def _is_thing(frame: PanopticFrame) -> np.ndarray:
    things = np.array([info.kind in ("thing", "dynamic") for info in classes()])
    return things[frame.class_id]


def _ratio(part: _Number, whole: _Number) -> float | None:
    return float(part / whole) if whole else None
