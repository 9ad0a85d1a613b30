"""Average precision of ranked predictions, with both kinds of interpolation.

A prediction is a hit if its IoU with a true one that no better-ranked prediction took reaches the
threshold; it takes the free one of the largest IoU. (The VOC kit does not look for another when
the best is taken; it counts a false alarm.) With p_k and r_k, precision and recall of the first k:

all points (VOC from 2010 on):  AP = sum_k (r_k - r_(k-1)) max_(j >= k) p_j
11 points (VOC 2007, Everingham et al. 2010, Eq. 1-2):
    AP = 1/11 sum_(r in 0, 0.1, ..., 1) max_(j: r_j >= r) p_j,  0 where no r_j reaches r
"""

from __future__ import annotations

import dataclasses

import numpy as np
from jaxtyping import Bool, Float

_RECALL_SLACK = 1e-9
"""3 of 10 reaches the recall 0.3 whatever the rounding."""


@dataclasses.dataclass(frozen=True, eq=False)
class PrecisionRecall:
    """After each prediction, by falling score."""

    precision: Float[np.ndarray, " predicted"]
    recall: Float[np.ndarray, " predicted"]

    @property
    def all_point(self) -> float:
        """Area under the curve, precision made non-increasing."""
        steps = np.diff(self.recall, prepend=0.0)
        return float(np.sum(steps * np.maximum.accumulate(self.precision[::-1])[::-1]))

    @property
    def eleven_point(self) -> float:
        """Mean of the best precision at or beyond eleven recalls."""
        best = [
            self.precision[self.recall >= level - _RECALL_SLACK].max(initial=0.0)
            for level in np.arange(11) / 10
        ]
        return float(np.mean(best))


def precision_recall(
    iou: Float[np.ndarray, "predicted truth"],
    score: Float[np.ndarray, " predicted"],
    threshold: float,
    ignored: Bool[np.ndarray, " predicted"] | None = None,
) -> PrecisionRecall:
    """Rank the predictions and count.

    Args:
        iou: Of every pair.
        score: Confidence; of equal ones the first comes first.
        threshold: IoU from which on a pair counts.
        ignored: Predictions that are left out unless they hit (they lie on truth that is not
            asked for).
    """
    truth_count = iou.shape[1]
    free = np.ones(truth_count, bool)
    hits: list[bool] = []
    for row in np.argsort(-score, kind="stable"):
        best = int(np.argmax(np.where(free, iou[row], -1.0))) if free.any() else -1
        if best >= 0 and iou[row, best] >= threshold:
            free[best] = False
            hits.append(True)
        elif ignored is None or not ignored[row]:
            hits.append(False)
    found = np.cumsum(np.array(hits, float))
    return PrecisionRecall(found / np.arange(1, len(hits) + 1), found / max(truth_count, 1))


def average_precision(
    iou: Float[np.ndarray, "predicted truth"],
    score: Float[np.ndarray, " predicted"],
    threshold: float,
) -> float:
    """All-point average precision."""
    return precision_recall(iou, score, threshold).all_point
