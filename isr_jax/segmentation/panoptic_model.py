"""Panoptic masks from one model that gives instances, layout and stuff together."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence

from ..config import SegmentationSettings
from ..types import Frame, PanopticFrame
from .mask_queries import decode_queries
from .onnx_model import OnnxModel
from .painting import paint


class PanopticModel:
    """A model of ``panoptic`` kind; its masks are taken as they are, from colour alone."""

    def __init__(self, model: OnnxModel, settings: SegmentationSettings) -> None:
        self._model, self._min_score = model, settings.min_score
        self.name = model.path.stem

    def __call__(self, frame: Frame) -> PanopticFrame:
        return self.batch([frame])[0]

    def batch(self, frames: Sequence[Frame]) -> list[PanopticFrame]:
        """The masks of each frame."""
        outputs = self._model.batch([f.color for f in frames])
        return [
            self._decode(found, (f.depth_m.shape[0], f.depth_m.shape[1]))
            for f, found in zip(frames, outputs, strict=True)
        ]

    def _decode(self, outputs: dict, shape: tuple[int, int]) -> PanopticFrame:
        found = decode_queries(outputs, self._model.sidecar, shape, min_score=self._min_score)
        return paint(found, shape)

    def content_hash(self) -> str:
        key = f"{self._model.content_hash()}+{self._min_score}"
        return hashlib.sha256(key.encode()).hexdigest()

    def describe(self) -> str:
        return self._model.describe()
