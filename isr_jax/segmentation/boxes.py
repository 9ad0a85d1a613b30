"""Border: boxes from the raw output of a YOLOX head (OpenCV's suppression)."""

from __future__ import annotations

import dataclasses

import cv2
import numpy as np
from jaxtyping import Bool, Float, Int

from .onnx_model import letterbox_ratio
from .sidecar import Sidecar


@dataclasses.dataclass(frozen=True, eq=False)
class Boxes:
    """Detections, best first."""

    xyxy: Float[np.ndarray, "boxes 4"]
    """Pixels of the image."""
    class_id: Int[np.ndarray, " boxes"]
    score: Float[np.ndarray, " boxes"]

    def select(self, keep: Bool[np.ndarray, " boxes"]) -> Boxes:
        """The boxes where ``keep`` is True."""
        return Boxes(self.xyxy[keep], self.class_id[keep], self.score[keep])


def decode_yolox(
    output: Float[np.ndarray, "1 cells channels"],
    sidecar: Sidecar,
    shape: tuple[int, int],
    *,
    min_score: float,
    max_iou: float = 0.45,
) -> Boxes:
    """Centre = (raw + cell) stride, size = exp(raw) stride, score = objectness x class score.

    Suppression is over all classes at once: two names for one thing are one thing.
    """
    cell, stride = _grid(sidecar)
    # No score exceeds its objectness; few cells of the thousands are left to look at.
    likely = output[0, :, 4] >= min_score
    raw, cell, stride = output[0][likely], cell[likely], stride[likely]
    score = raw[:, 4:5] * raw[:, 5:]
    label = score.argmax(1)
    best = score[np.arange(len(score)), label]
    class_id = np.array(sidecar.class_of, np.int32)[label]
    keep = (best >= min_score) & (class_id > 0)
    center = (raw[keep, :2] + cell[keep]) * stride[keep]
    size = np.exp(np.minimum(raw[keep, 2:4], 20.0)) * stride[keep]
    xyxy = np.hstack([center - size / 2, center + size / 2]) / letterbox_ratio(shape, sidecar)
    limit = np.array([shape[1], shape[0]] * 2, np.float32)
    xyxy = np.clip(xyxy, 0, limit).astype(np.float32)
    order = _suppress(xyxy, best[keep], max_iou)
    return Boxes(xyxy[order], class_id[keep][order], best[keep][order].astype(np.float32))


def _grid(sidecar: Sidecar) -> tuple[np.ndarray, np.ndarray]:
    height, width = sidecar.input_size
    cells, strides = [], []
    for stride in sidecar.strides:
        y, x = np.mgrid[: height // stride, : width // stride]
        cells.append(np.stack([x.ravel(), y.ravel()], 1))
        strides.append(np.full((x.size, 1), stride))
    return np.concatenate(cells).astype(np.float32), np.concatenate(strides).astype(np.float32)


def _suppress(xyxy: np.ndarray, score: np.ndarray, max_iou: float) -> np.ndarray:
    if not len(xyxy):
        return np.zeros(0, np.int64)
    xywh = np.hstack([xyxy[:, :2], xyxy[:, 2:] - xyxy[:, :2]])
    kept = cv2.dnn.NMSBoxes(xywh.tolist(), score.tolist(), 0.0, max_iou)
    return np.asarray(kept, np.int64).ravel()
