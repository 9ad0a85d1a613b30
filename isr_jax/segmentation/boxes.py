"""Border: boxes from the raw output of a YOLOX head (OpenCV's suppression)."""

from __future__ import annotations

import dataclasses

import cv2
import numpy as np
from jaxtyping import Bool, Float, Int

from .model_image import pixels_per_pixel
from .sidecar import Sidecar

_MAX_IOU = 0.45
"""Of two boxes with a larger overlap the weaker goes."""


@dataclasses.dataclass(frozen=True, eq=False)
class Boxes:
    """Detections, best first."""

    xyxy: Float[np.ndarray, "boxes 4"]
    """Pixels of the image."""
    class_id: Int[np.ndarray, " boxes"]
    score: Float[np.ndarray, " boxes"]
    masks: Bool[np.ndarray, "boxes height width"] | None = None
    """The pixels of each, where the model knows them."""

    def select(self, keep: Bool[np.ndarray, " boxes"]) -> Boxes:
        """The boxes where ``keep`` is True."""
        masks = None if self.masks is None else self.masks[keep]
        return Boxes(self.xyxy[keep], self.class_id[keep], self.score[keep], masks)


def no_boxes() -> Boxes:
    """Nothing detected."""
    empty = np.zeros(0, np.float32)
    return Boxes(empty.reshape(0, 4), empty.astype(np.int32), empty)


def decode_yolox(
    output: Float[np.ndarray, "cells channels"],
    sidecar: Sidecar,
    shape: tuple[int, int],
    *,
    min_score: float,
) -> Boxes:
    """Centre = (raw + cell) stride, size = exp(raw) stride, score = objectness x class score.

    Suppression is over all classes at once: two names for one thing are one thing.
    """
    cell, stride = _grid(sidecar)
    # No score exceeds its objectness; few cells of the thousands are left to look at.
    likely = output[:, 4] >= min_score
    raw, cell, stride = output[likely].astype(np.float32), cell[likely], stride[likely]
    score = raw[:, 4:5] * raw[:, 5:]
    class_id, best = best_class(score, sidecar)
    keep = (best >= min_score) & (class_id > 0)
    center = (raw[keep, :2] + cell[keep]) * stride[keep]
    size = np.exp(np.minimum(raw[keep, 2:4], 20.0)) * stride[keep]
    xyxy = to_pixels(center, size, sidecar, shape)
    order = suppress(xyxy, best[keep])
    return Boxes(xyxy[order], class_id[keep][order], best[keep][order].astype(np.float32))


def best_class(
    score: Float[np.ndarray, "boxes labels"], sidecar: Sidecar
) -> tuple[Int[np.ndarray, " boxes"], Float[np.ndarray, " boxes"]]:
    """Our class with the highest score, 0 where it is none of ours, and that score."""
    label = score.argmax(1)
    class_id = np.array(sidecar.class_of, np.int32)[label]
    return class_id, score[np.arange(len(score)), label]


def to_pixels(
    center: Float[np.ndarray, "boxes 2"],
    size: Float[np.ndarray, "boxes 2"],
    sidecar: Sidecar,
    shape: tuple[int, int],
) -> Float[np.ndarray, "boxes 4"]:
    """Boxes in pixels of the model's input become x0, y0, x1, y1 within an image of ``shape``."""
    ratio = np.array(pixels_per_pixel(shape, sidecar) * 2)
    xyxy = np.hstack([center - size / 2, center + size / 2]) / ratio
    return np.clip(xyxy, 0, np.array([shape[1], shape[0]] * 2)).astype(np.float32)


def suppress(
    xyxy: Float[np.ndarray, "boxes 4"], score: Float[np.ndarray, " boxes"]
) -> Int[np.ndarray, " kept"]:
    """The boxes that no better one overlaps by more than `_MAX_IOU`, best first."""
    if not len(xyxy):
        return np.zeros(0, np.int64)
    xywh = np.hstack([xyxy[:, :2], xyxy[:, 2:] - xyxy[:, :2]])
    kept = cv2.dnn.NMSBoxes(xywh.tolist(), score.tolist(), 0.0, _MAX_IOU)
    return np.asarray(kept, np.int64).ravel()


def _grid(sidecar: Sidecar) -> tuple[np.ndarray, np.ndarray]:
    height, width = sidecar.input_size
    cells, strides = [], []
    for stride in sidecar.outputs["output"].strides:
        y, x = np.mgrid[: height // stride, : width // stride]
        cells.append(np.stack([x.ravel(), y.ravel()], 1))
        strides.append(np.full((x.size, 1), stride))
    return np.concatenate(cells).astype(np.float32), np.concatenate(strides).astype(np.float32)
