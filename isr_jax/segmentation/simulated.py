"""A segmenter that errs at stated rates, made from true masks."""

from __future__ import annotations

import hashlib
from typing import Protocol, runtime_checkable

import numpy as np

from ..errors import SegmenterError
from ..types import Frame, PanopticFrame
from .mask_errors import Mask, noisy_masks
from .noise_rates import LEVELS, NoiseRates, described
from .true_frame import TrueFrame
from .true_views import TrueViews


@runtime_checkable
class TrueMasks(Protocol):
    """A source of true masks that knows the lasting id of each."""

    def read(self, frame: Frame) -> tuple[PanopticFrame, np.ndarray]: ...

    def content_hash(self) -> str: ...


class SimulatedSegmenter:
    """True masks with misses, merges, splits, wrong classes, ragged edges and false masks.

    Their rates are stated (`NoiseRates`). Misses fall first on things that are small, cut by the
    image's border or, where ``views`` says so, occluded; misses, merges, splits and wrong classes
    last over neighbouring frames. Instances of layout and stuff become one mask per class. Rows
    change from frame to frame. The same frame name and seed give the same masks.

    Raises:
        SegmenterError: There is no such level.
    """

    def __init__(
        self,
        truth: TrueMasks,
        level: str = "strong",
        *,
        seed: int = 0,
        views: TrueViews | None = None,
    ) -> None:
        if level not in LEVELS:
            raise SegmenterError(f"unknown noise level {level!r}", f"use one of: {_names()}")
        self._truth, self._rates, self._seed = truth, LEVELS[level], seed
        self._views = views
        self.name = f"simulated:{level}"

    def __call__(self, frame: Frame) -> PanopticFrame:
        truth, ids = self._truth.read(frame)
        visible = {} if self._views is None else self._views.visible_shares(frame.name)
        scene = TrueFrame(truth, ids, frame, self._seed, visible)
        if self._rates is None:
            return _painted([(scene.pixels(k), _kind(scene, k), 1.0) for k in scene.rows], scene)
        return _painted(noisy_masks(scene, self._rates), scene)

    def rates(self) -> NoiseRates | None:
        """The stated rates; None for ``perfect``."""
        return self._rates

    def content_hash(self) -> str:
        views = "" if self._views is None else self._views.content_hash
        key = f"{self._truth.content_hash()} {self._rates} {self._seed} {views}"
        return hashlib.sha256(key.encode()).hexdigest()

    def describe(self) -> str:
        if self._rates is None:
            return f"{self.name}: the true masks"
        first = "small and cut" if self._views is None else "small, cut and occluded"
        unknown = " (occlusion is not known)" if self._views is None else ""
        return (
            f"{self.name}: {described(self._rates)}; misses fall first on {first} things{unknown} "
            f"(seed {self._seed})"
        )


def _names() -> str:
    return ", ".join(LEVELS)


def _kind(scene: TrueFrame, row: int) -> int:
    return int(scene.truth.class_id[row])


def _painted(masks: list[Mask], scene: TrueFrame) -> PanopticFrame:
    """One label per pixel, in an order of rows that changes from frame to frame."""
    order = scene.random.permutation(len(masks)) + 1
    label = np.zeros(scene.truth.mask.shape, np.int32)
    class_id, score = np.zeros(len(masks) + 1, np.int32), np.zeros(len(masks) + 1, np.float32)
    for row, (pixels, kind, certainty) in zip(order, masks, strict=True):
        label[pixels] = row
        class_id[row], score[row] = kind, certainty
    return PanopticFrame(label, class_id, score)
