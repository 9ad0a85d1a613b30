"""Oriented boxes: all IoUs at once, and average precision of the boxes of things."""

from __future__ import annotations

import dataclasses

import jax
import numpy as np
from jaxtyping import Float

from ...geometry import box_iou
from ...runtime.batches import bucket
from ...scene_file import EntityRecord
from ...types import Array, Box
from ..figures import Headline, mean, percent
from ..result_files import Result, Truth, moved_box
from .average_precision import precision_recall
from .segments import observed_ids

_all_pairs = jax.jit(jax.vmap(jax.vmap(box_iou, (None, 0)), (0, None)))
_LEAST = 16
"""Boxes that a call is padded to at least."""


def box_iou_matrix(a: list[Box], b: list[Box]) -> Float[np.ndarray, "a b"]:
    """IoU of every pair of gravity-aligned oriented boxes."""
    if not a or not b:
        return np.zeros((len(a), len(b)), np.float32)
    # One bucket for both, so that few shapes are compiled.
    size = bucket(max(len(a), len(b)), _LEAST)
    iou = _all_pairs(_stacked(a, size), _stacked(b, size))
    return np.asarray(iou)[: len(a), : len(b)]


def _stacked(boxes: list[Box], size: int) -> Box:
    """One batched box, padded with copies of the last."""

    def stack(*leaves: Array) -> np.ndarray:
        return np.stack([np.asarray(v, np.float32) for v in leaves])

    return jax.tree.map(stack, *boxes, *[boxes[-1]] * (size - len(boxes)))


@dataclasses.dataclass(frozen=True)
class BoxRow:
    """Average precision of the boxes of one class; see `average_precision`."""

    class_name: str
    true: int
    """Seen true things."""
    predicted: int
    ap50: float
    """At IoU 0.5, all-point precision."""
    ap25: float
    ap50_11point: float
    ap25_11point: float


@dataclasses.dataclass(frozen=True)
class BoxScores:
    """Average precision of oriented boxes, and its mean over the classes of seen true things."""

    map50: float | None
    """At IoU 0.5, all-point precision."""
    map25: float | None
    map50_11point: float | None
    """At IoU 0.5, 11-point precision."""
    map25_11point: float | None
    rows: tuple[BoxRow, ...]

    @staticmethod
    def over(rows: tuple[BoxRow, ...]) -> BoxScores:
        """Average the classes."""
        return BoxScores(
            mean(r.ap50 for r in rows),
            mean(r.ap25 for r in rows),
            mean(r.ap50_11point for r in rows),
            mean(r.ap25_11point for r in rows),
            rows,
        )

    def headline(self, name: str) -> Headline:
        """``name`` is ``mAP`` of boxes as they were found, ``mAP_re`` as supports refined them."""
        return (
            (f"box {name}@0.5 / 0.25, all-point", percent(self.map50, self.map25)),
            (f"box {name}@0.5 / 0.25, 11-point", percent(self.map50_11point, self.map25_11point)),
        )


def score_boxes(truth: Truth, result: Result, *, observed: bool = False) -> BoxScores:
    """AP of the boxes of things, class by class, at IoU 0.5 and 0.25.

    The confidence of a prediction is its vertex count, since a map holds no other. Predictions
    of a class that no seen true thing has are in no mean. A prediction that hits nothing but the
    box of a true thing of its class which the camera hardly saw is left out.

    Args:
        truth: The true boxes are those of its scene.
        result: The boxes are those of its scene, which supports refined (mAP_re).
        observed: Take the boxes as they were before that (mAP), where the scene keeps them.
    """
    seen = observed_ids(truth)
    true = [e for e in truth.scene.entities if e.type != "layout"]
    found = [e for e in result.scene.entities if e.type != "layout"]
    counts = dict(zip(*(v.tolist() for v in np.unique(result.instance, return_counts=True))))
    rows = []
    for name in sorted({e.class_name for e in true if e.id in seen}):
        of_class = [e for e in found if e.class_name == name]
        boxes = [moved_box(_box(e, observed), result.T_truth_result) for e in of_class]
        score = np.array([counts.get(e.id, 0) for e in of_class], float)
        named = [e for e in true if e.class_name == name]
        asked = [e for e in named if e.id in seen]
        unasked = [e for e in named if e.id not in seen]
        rows.append(_row(name, score, _iou(boxes, asked), _iou(boxes, unasked)))
    return BoxScores.over(tuple(rows))


def _box(record: EntityRecord, observed: bool) -> Box:
    return record.observed_box if observed and record.observed_box is not None else record.box


def _iou(boxes: list[Box], true: list[EntityRecord]) -> Float[np.ndarray, "boxes true"]:
    return box_iou_matrix(boxes, [e.box for e in true])


def _row(
    name: str,
    score: Float[np.ndarray, " boxes"],
    iou: Float[np.ndarray, "boxes asked"],
    unasked_iou: Float[np.ndarray, "boxes unasked"],
) -> BoxRow:
    nearest = unasked_iou.max(1, initial=0.0)
    half, quarter = (precision_recall(iou, score, t, nearest >= t) for t in (0.5, 0.25))
    return BoxRow(
        name,
        iou.shape[1],
        len(score),
        half.all_point,
        quarter.all_point,
        half.eleven_point,
        quarter.eleven_point,
    )
