"""Panoptic masks from a model of boxes (or instances) and one of semantics, with depth's help."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Sequence

import numpy as np

from ..classes import class_named, classes
from ..config import SegmentationSettings
from ..types import Frame, PanopticFrame
from .box_shapes import heights, plausible_layout, shape_in_box
from .boxes import Boxes, decode_yolox, no_boxes
from .class_maps import class_maps
from .components import connected_components
from .depth_segments import segment_depth
from .instance_masks import decode_yolo_seg
from .onnx_model import OnnxModel
from .painting import MIN_PIXELS, Mask, paint
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


class BoxesAndSemantics:
    """Boxes give instances, semantics layout and large things, depth their outlines.

    Uses the frame's pose: "floor" is kept only where the world's height is about 0. Masks lie
    over each other in this order: layout and stuff, then things from large to small. Boxes that
    come with masks (``instances``) keep them. Without boxes, things are connected components of a
    class: two chairs that touch in the image are one.
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
        return self.batch([frame])[0]

    def batch(self, frames: Sequence[Frame]) -> list[PanopticFrame]:
        """The masks of each frame."""
        images = [f.color for f in frames]
        none = [None] * len(frames)
        detected = self._boxes.batch(images) if self._boxes else none
        classified = self._semantics.batch(images) if self._semantics else none
        return [self._compose(*found) for found in zip(frames, detected, classified, strict=True)]

    def _compose(
        self, frame: Frame, detected: dict | None, classified: dict | None
    ) -> PanopticFrame:
        boxes = self._detect(frame, detected)
        class_map, confidence = self._classify(frame, boxes, classified)
        things = list(self._box_masks(frame, boxes, class_map))
        things += self._component_masks(class_map, confidence, things)
        things.sort(key=lambda m: -np.count_nonzero(m.pixels))
        stuff = self._stuff_masks(class_map, confidence)
        return paint([*stuff, *things], frame.depth_m.shape)

    def _detect(self, frame: Frame, outputs: dict[str, np.ndarray] | None) -> Boxes:
        if self._boxes is None or outputs is None:
            return no_boxes()
        shape, side = (frame.depth_m.shape[0], frame.depth_m.shape[1]), self._boxes.sidecar
        if side.decoder == "yolo_seg":
            return decode_yolo_seg(outputs, side, shape, min_score=self._min_score)
        return decode_yolox(outputs["output"], side, shape, min_score=self._min_score)

    def _classify(
        self, frame: Frame, boxes: Boxes, outputs: dict[str, np.ndarray] | None
    ) -> tuple[np.ndarray, np.ndarray]:
        """Our class and its confidence per pixel, as voted by depth segments."""
        shape = (frame.depth_m.shape[0], frame.depth_m.shape[1])
        if self._semantics is None or outputs is None:
            return np.zeros(shape, np.int32), np.zeros(shape, np.float32)
        class_map, confidence = class_maps(outputs["output"], self._semantics.sidecar, shape)
        floor, ceiling = class_named("floor").id, class_named("ceiling").id
        height_m = heights(frame.depth_m, frame.camera.K, frame.T_world_camera)
        seen = frame.depth_m > 0
        class_map = plausible_layout(class_map, height_m, seen, floor=floor, ceiling=ceiling)
        segment = segment_depth(frame.depth_m, frame.camera, self._settings)
        outlined = [class_named(n).id for n in _OUTLINED]
        known = boxes.select(np.isin(boxes.class_id, outlined))
        min_ratio = self._settings.majority_ratio
        return vote(class_map, confidence, segment, known, min_ratio=min_ratio)

    def _box_masks(self, frame: Frame, boxes: Boxes, class_map: np.ndarray) -> Iterator[Mask]:
        rows = zip(boxes.xyxy, boxes.class_id, boxes.score, strict=True)
        for k, (box, class_id, score) in enumerate(rows):
            if boxes.masks is not None:
                yield Mask(boxes.masks[k], int(class_id), float(score))
                continue
            name = classes()[class_id].name
            alike = [class_named(n).id for group in _ALIKE if name in group for n in group]
            agrees = np.isin(class_map, [*alike, class_id])
            pixels = shape_in_box(box, frame.depth_m, agrees, by_semantics=name in _OUTLINED)
            yield Mask(pixels, int(class_id), float(score))

    def _component_masks(
        self, class_map: np.ndarray, confidence: np.ndarray, found: list[Mask]
    ) -> list[Mask]:
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
                free = _widen(pixels, int(class_id), found, grow=self._boxes_are_coarse())
                if score >= _MIN_CONFIDENCE and free is not None:
                    masks.append(Mask(free, int(class_id), score))
        return masks

    def _boxes_are_coarse(self) -> bool:
        return self._boxes is not None and self._boxes.sidecar.kind == "boxes"

    def _stuff_masks(self, class_map: np.ndarray, confidence: np.ndarray) -> Iterator[Mask]:
        for info in classes():
            pixels = class_map == info.id
            if info.kind in ("layout", "stuff") and np.count_nonzero(pixels) >= MIN_PIXELS:
                score = float(confidence[pixels].mean())
                if score >= self._min_score:
                    yield Mask(pixels, info.id, score)

    def content_hash(self) -> str:
        key = "+".join([*(m.content_hash() for m in self._models), repr(self._settings)])
        return hashlib.sha256(key.encode()).hexdigest()

    def describe(self) -> str:
        note = "" if self._boxes else "; no boxes: things are connected components of a class"
        return " + ".join(m.describe() for m in self._models) + note


def _widen(
    pixels: np.ndarray, class_id: int, found: list[Mask], *, grow: bool
) -> np.ndarray | None:
    """Give a component to the one box mask of its class that holds most of it, if masks may grow.

    Returns what is left of the component to be a mask of its own, None if little is.
    """
    area = np.count_nonzero(pixels)
    same = [m for m in found if m.class_id == class_id and np.any(m.pixels & pixels)]
    if grow and len(same) == 1 and np.count_nonzero(same[0].pixels & pixels) >= 0.5 * area:
        same[0].pixels[pixels] = True
        return None
    free = pixels.copy()
    for mask in found:
        free &= ~mask.pixels
    return free if np.count_nonzero(free) >= 0.5 * area else None
