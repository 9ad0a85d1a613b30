"""Instance segmentation in 3D: average precision of the masks of things over true points.

As the ScanNet benchmark scores it (Dai et al. 2017): masks are sets of points of the true scene,
class by class, at IoU 0.5, at 0.25, and averaged over 0.5, 0.55, ..., 0.95 (their benchmark
stops at 0.9). What differs: points are the 2 cm grid of the surface that the camera saw instead
of mesh vertices; the confidence of a prediction is its vertex count, since a map holds no other,
where theirs comes from the network; the curve is all-point precision instead of their own
integration; a prediction finds one true instance at most; and what a prediction has far from all
truth makes its mask larger.
"""

from __future__ import annotations

import dataclasses

import numpy as np

from ...classes import classes
from ..figures import Headline, mean, percent
from .average_precision import average_precision
from .segments import Comparison, thing_classes

STRICT_IOUS = tuple(k / 100 for k in range(50, 100, 5))
"""Thresholds of the mean AP."""


@dataclasses.dataclass(frozen=True)
class InstanceRow:
    """Average precision of one class."""

    class_name: str
    true: int
    """Seen true instances."""
    predicted: int
    ap: float
    """Mean over `STRICT_IOUS`."""
    ap50: float
    ap25: float


@dataclasses.dataclass(frozen=True)
class InstanceScores:
    """Average precision of instance masks, and its mean over the classes of seen true things."""

    map: float | None
    """Mean over `STRICT_IOUS`."""
    map50: float | None
    map25: float | None
    rows: tuple[InstanceRow, ...]

    @staticmethod
    def over(rows: tuple[InstanceRow, ...]) -> InstanceScores:
        """Average the classes."""
        return InstanceScores(
            mean(r.ap for r in rows), mean(r.ap50 for r in rows), mean(r.ap25 for r in rows), rows
        )

    def headline(self) -> Headline:
        return (
            ("instance mAP@0.5 / 0.25", percent(self.map50, self.map25)),
            ("instance mAP@0.5:0.95", percent(self.map)),
        )


def score_instances(compared: Comparison) -> InstanceScores:
    """AP of the instance masks. Segments too small to count are on neither side."""
    true_kept, kept = compared.true_size > 0, compared.predicted_size > 0
    union = compared.true_size[:, None] + compared.predicted_size - compared.shared
    iou = (compared.shared / np.maximum(union, 1)).T
    vertex_row = compared.predicted.row
    vertices = np.bincount(vertex_row[vertex_row >= 0], minlength=len(kept)).astype(float)
    thing, rows = thing_classes(), []
    for info in classes():
        t = true_kept & (compared.true.class_id == info.id)
        if not thing[info.id] or not t.any():
            continue
        p = kept & (compared.predicted.class_id == info.id)
        table, score = iou[p][:, t], vertices[p]
        strict = mean(average_precision(table, score, x) for x in STRICT_IOUS)
        ap50, ap25 = (average_precision(table, score, x) for x in (0.5, 0.25))
        rows.append(InstanceRow(info.name, int(t.sum()), int(p.sum()), strict or 0.0, ap50, ap25))
    return InstanceScores.over(tuple(rows))
