"""What the mean PQ would be if one segment were right: the price of a mistake."""

from __future__ import annotations

import numpy as np

from isr_jax.evaluation.maps.segments import Comparison

MOST = 0.5
"""A segment lies on another one with more than this share of its points."""


def unmatched(compared: Comparison) -> list[int]:
    """Predicted segments that count and match nothing."""
    matched = set(np.asarray(compared.quality.partner).tolist())
    return [p for p in np.flatnonzero(compared.predicted_size).tolist() if p not in matched]


def gain_if_found(compared: Comparison, t: int) -> float:
    """Rise of the mean PQ if true segment ``t`` had IoU 1 and what lies on it were gone."""
    counts, c = _Counts(compared), int(compared.true.class_id[t])
    before = counts.mean_pq()
    if int(compared.quality.partner[t]) >= 0:
        counts.iou[c] += 1.0 - float(compared.quality.iou[t])
        return counts.mean_pq() - before
    counts.tp[c] += 1
    counts.fn[c] -= 1
    counts.iou[c] += 1.0
    for p in unmatched(compared):
        if compared.shared[t, p] > MOST * compared.predicted_size[p]:
            counts.fp[compared.predicted.class_id[p]] -= 1
    return counts.mean_pq() - before


def gain_without(compared: Comparison, p: int) -> float:
    """Rise of the mean PQ if predicted segment ``p``, which matches nothing, were gone."""
    counts = _Counts(compared)
    before = counts.mean_pq()
    counts.fp[compared.predicted.class_id[p]] -= 1
    return counts.mean_pq() - before


class _Counts:
    """What the mean PQ is made of, one item per class."""

    def __init__(self, compared: Comparison) -> None:
        quality = compared.quality
        self.tp, self.fp, self.fn = (
            np.array(v, np.float64)
            for v in (quality.true_positives, quality.false_positives, quality.false_negatives)
        )
        self.iou = self.tp * np.asarray(quality.sq, np.float64)
        """Sum over the matches."""

    def mean_pq(self) -> float:
        """Over the classes that occur."""
        weight = self.tp + (self.fp + self.fn) / 2
        occurs = weight > 0
        return float(np.mean(self.iou[occurs] / weight[occurs])) if occurs.any() else 0.0
