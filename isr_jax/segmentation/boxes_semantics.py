"""Panoptic masks from a model of boxes and a model of semantics, with the depth image's help."""

from __future__ import annotations

import dataclasses
import hashlib
from collections.abc import Iterator

import numpy as np

from ..classes import class_named, classes
from ..config import SegmentationSettings
from ..types import Frame, PanopticFrame
from .box_shapes import heights, plausible_layout, shape_in_box
from .boxes import Boxes, decode_yolox
from .components import connected_components
from .depth_segments import segment_depth
from .onnx_model import OnnxModel, class_maps
from .semantic_votes import vote

_OUTLINED = ("table", "desk", "sofa", "bed", "cabinet", "counter", "bookshelf", "wardrobe")
"""Things whose outline comes from semantics: large, and seldom in front of their surroundings."""
_ALIKE = (("table", "desk"), ("chair", "stool", "bench"), ("sofa", "chair"))
"""Classes that semantics and boxes call by each other's name."""
_MIN_COMPONENT_RATIO = 0.005
"""A thing that only semantics see covers at least this share of the image."""
_MIN_CONFIDENCE = 0.5
"""Mean confidence of the semantics in a thing that no box shows, at least; they are wrong more
often than boxes of that score."""
_MIN_PIXELS = 50


@dataclasses.dataclass(frozen=True, eq=False)
class _Mask:
    pixels: np.ndarray
    class_id: int
    score: float


class BoxesAndSemantics:
    """Boxes give instances, semantics layout and large things, depth their outlines.

    Uses the frame's pose: "floor" is kept only where the world's height is about 0. Masks lie
    over each other in this order: layout and stuff, then things from large to small.
    """

    def __init__(
        self,
        boxes: OnnxModel | None,
        semantics: OnnxModel | None,
        settings: SegmentationSettings,
    ) -> None:
        self._models = [m for m in (boxes, semantics) if m is not None]
        self._boxes, self._semantics = boxes, semantics
        self._settings, self._min_score = settings, settings.min_score
        self.name = "+".join(m.path.stem for m in self._models)

    def __call__(self, frame: Frame) -> PanopticFrame:
        boxes = self._detect(frame)
        class_map, confidence = self._classify(frame, boxes)
        things = list(self._box_masks(frame, boxes, class_map))
        things += self._component_masks(class_map, confidence, things)
        things.sort(key=lambda m: -np.count_nonzero(m.pixels))
        stuff = self._stuff_masks(class_map, confidence)
        return _paint([*stuff, *things], frame.depth_m.shape)

    def _detect(self, frame: Frame) -> Boxes:
        if self._boxes is None:
            empty = np.zeros(0, np.float32)
            return Boxes(empty.reshape(0, 4), empty.astype(np.int32), empty)
        output = self._boxes(frame.color)
        shape = frame.depth_m.shape
        return decode_yolox(output, self._boxes.sidecar, shape, min_score=self._min_score)

    def _classify(self, frame: Frame, boxes: Boxes) -> tuple[np.ndarray, np.ndarray]:
        """Our class and its confidence a pixel, as voted by depth segments."""
        shape = frame.depth_m.shape
        if self._semantics is None:
            return np.zeros(shape, np.int32), np.zeros(shape, np.float32)
        output = self._semantics(frame.color)
        class_map, confidence = class_maps(output, self._semantics.sidecar, shape)
        floor, ceiling = class_named("floor").id, class_named("ceiling").id
        height_m = heights(frame.depth_m, frame.camera.K, frame.T_world_camera)
        seen = frame.depth_m > 0
        class_map = plausible_layout(class_map, height_m, seen, floor=floor, ceiling=ceiling)
        segment = segment_depth(frame.depth_m, frame.camera, self._settings)
        outlined = [class_named(n).id for n in _OUTLINED]
        known = boxes.select(np.isin(boxes.class_id, outlined))
        min_ratio = self._settings.majority_ratio
        return vote(class_map, confidence, segment, known, min_ratio=min_ratio)

    def _box_masks(self, frame: Frame, boxes: Boxes, class_map: np.ndarray) -> Iterator[_Mask]:
        for box, class_id, score in zip(boxes.xyxy, boxes.class_id, boxes.score, strict=True):
            name = classes()[class_id].name
            alike = [class_named(n).id for group in _ALIKE if name in group for n in group]
            agrees = np.isin(class_map, [*alike, class_id])
            pixels = shape_in_box(box, frame.depth_m, agrees, by_semantics=name in _OUTLINED)
            yield _Mask(pixels, int(class_id), float(score))

    def _component_masks(
        self, class_map: np.ndarray, confidence: np.ndarray, found: list[_Mask]
    ) -> list[_Mask]:
        """Things that semantics see: they widen the one box mask they touch, or stand alone."""
        masks = []
        kinds = {info.id: info.kind for info in classes()}
        for class_id in np.unique(class_map):
            if kinds[int(class_id)] not in ("thing", "dynamic"):
                continue
            label, area = connected_components(class_map == class_id)
            for k in np.flatnonzero(area >= _MIN_COMPONENT_RATIO * class_map.size):
                pixels = label == k
                score = float(confidence[pixels].mean())
                free = _widen(pixels, int(class_id), found)
                if score >= _MIN_CONFIDENCE and free is not None:
                    masks.append(_Mask(free, int(class_id), score))
        return masks

    def _stuff_masks(self, class_map: np.ndarray, confidence: np.ndarray) -> Iterator[_Mask]:
        for info in classes():
            pixels = class_map == info.id
            if info.kind in ("layout", "stuff") and np.count_nonzero(pixels) >= _MIN_PIXELS:
                score = float(confidence[pixels].mean())
                if score >= self._min_score:
                    yield _Mask(pixels, info.id, score)

    def content_hash(self) -> str:
        key = "+".join([*(m.content_hash() for m in self._models), repr(self._settings)])
        return hashlib.sha256(key.encode()).hexdigest()

    def describe(self) -> str:
        return " + ".join(m.describe() for m in self._models)


def _widen(pixels: np.ndarray, class_id: int, found: list[_Mask]) -> np.ndarray | None:
    """Give a component to the one box mask of its class that holds most of it.

    Returns what is left of the component to be a mask of its own, None if little is.
    """
    area = np.count_nonzero(pixels)
    same = [m for m in found if m.class_id == class_id and np.any(m.pixels & pixels)]
    if len(same) == 1 and np.count_nonzero(same[0].pixels & pixels) >= 0.5 * area:
        same[0].pixels[pixels] = True
        return None
    free = pixels.copy()
    for mask in found:
        free &= ~mask.pixels
    return free if np.count_nonzero(free) >= 0.5 * area else None


def _paint(masks: list[_Mask], shape: tuple[int, ...]) -> PanopticFrame:
    """One label a pixel; later masks lie over earlier ones, hidden ones are left out."""
    label = np.zeros(shape, np.int32)
    for k, mask in enumerate(masks, 1):
        label[mask.pixels] = k
    visible = np.bincount(label.ravel(), minlength=len(masks) + 1) >= _MIN_PIXELS
    visible[0] = False
    number = np.where(visible, np.cumsum(visible), 0).astype(np.int32)
    kept = [m for m, v in zip(masks, visible[1:], strict=True) if v]
    return PanopticFrame(
        number[label],
        np.array([0, *(m.class_id for m in kept)], np.int32),
        np.array([0.0, *(m.score for m in kept)], np.float32),
    )
