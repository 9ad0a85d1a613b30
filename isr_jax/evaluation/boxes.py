"""Oriented boxes: all IoUs at once, and average precision."""

from __future__ import annotations

import jax
import numpy as np
from jaxtyping import Float

from ..geometry import box_iou
from ..types import Array, Box

_all_pairs = jax.jit(jax.vmap(jax.vmap(box_iou, (None, 0)), (0, None)))


def box_iou_matrix(a: list[Box], b: list[Box]) -> Float[np.ndarray, "a b"]:
    """IoU of every pair of gravity-aligned oriented boxes."""
    if not a or not b:
        return np.zeros((len(a), len(b)), np.float32)
    iou = _all_pairs(_stacked(a), _stacked(b))
    return np.asarray(iou)[: len(a), : len(b)]


def _stacked(boxes: list[Box]) -> Box:
    """One batched box, padded with copies of the last to a power of two."""
    padded = boxes + [boxes[-1]] * ((1 << (len(boxes) - 1).bit_length()) - len(boxes))

    def stack(*leaves: Array) -> np.ndarray:
        return np.stack([np.asarray(v, np.float32) for v in leaves])

    return jax.tree.map(stack, *padded)


def average_precision(
    iou: Float[np.ndarray, "predicted truth"],
    score: Float[np.ndarray, " predicted"],
    threshold: float,
) -> float:
    """Area under the precision-recall curve, all points, precision made non-increasing.

    Predictions are taken by falling score; each takes the free true box of the largest IoU, if
    that reaches ``threshold``. Recalls that are never reached count 0.
    """
    truth_count = iou.shape[1]
    if truth_count == 0 or len(score) == 0:
        return 0.0
    free = np.ones(truth_count, bool)
    hit = np.zeros(len(score), bool)
    for rank, row in enumerate(np.argsort(-score, kind="stable")):
        best = int(np.argmax(np.where(free, iou[row], -1.0)))
        if free[best] and iou[row, best] >= threshold:
            free[best], hit[rank] = False, True
    found = np.cumsum(hit)
    precision = found / np.arange(1, len(hit) + 1)
    envelope = np.maximum.accumulate(precision[::-1])[::-1]
    return float(envelope[hit].sum() / truth_count)
