"""Panoptic quality from the points that true and predicted segments share.

Two averages over classes are in use, and this module gives both: over every class that occurs in
the truth or in the prediction, where a class without a match counts 0 (the unmarked names), and
over the classes with a match alone (``*_matched``); published SQ figures often are of the second
kind.
"""

from __future__ import annotations

import dataclasses
import functools
from typing import Literal

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Float, Int

from ...classes import classes
from ...types import Array
from ..figures import Headline, mean, percent

MATCH_IOU = 0.5
"""Above it, at most one predicted segment can match a true one (Kirillov et al. 2019)."""


class PanopticQuality(eqx.Module):
    """Scores a class, and who matches whom."""

    pq: Float[Array, " classes"]
    """RQ times SQ; 0 for classes without matches."""
    sq: Float[Array, " classes"]
    """Mean IoU of the matches."""
    rq: Float[Array, " classes"]
    true_positives: Int[Array, " classes"]
    false_positives: Int[Array, " classes"]
    false_negatives: Int[Array, " classes"]
    partner: Int[Array, " truth"]
    """Predicted segment that matches each true one; -1 = none."""
    iou: Float[Array, " truth"]
    """IoU with the partner; 0 without."""


@functools.partial(jax.jit, static_argnames=("truth_count", "predicted_count"))
def contingency(
    truth: Int[Array, " points"],
    predicted: Int[Array, " points"],
    *,
    truth_count: int,
    predicted_count: int,
) -> Int[Array, "truth predicted"]:
    """Points that each pair of segments shares; a row of -1 belongs to no segment."""
    both = (truth >= 0) & (predicted >= 0)
    cell = jnp.where(both, truth * predicted_count + predicted, truth_count * predicted_count)
    counts = jnp.zeros(truth_count * predicted_count, jnp.int32).at[cell].add(1, mode="drop")
    return counts.reshape(truth_count, predicted_count)


@functools.partial(jax.jit, static_argnames="class_count")
def panoptic_quality(
    shared: Int[Array, "truth predicted"],
    truth_size: Int[Array, " truth"],
    predicted_size: Int[Array, " predicted"],
    truth_class: Int[Array, " truth"],
    predicted_class: Int[Array, " predicted"],
    *,
    class_count: int,
) -> PanopticQuality:
    """PQ, SQ and RQ of every class.

    PQ = sum_(t,p in TP) IoU(t, p) / (|TP| + |FP| / 2 + |FN| / 2)  (Kirillov et al. 2019, Eq. 1)
       = SQ * RQ,  SQ = sum IoU / |TP|,  RQ = |TP| / (|TP| + |FP| / 2 + |FN| / 2)

    TP are pairs of one class with IoU > 0.5. Segments of size 0 are padding.

    Args:
        shared: From `contingency`.
        truth_size: Points of each true segment.
        predicted_size: Points of each predicted segment, with those far from all truth.
        truth_class: Class of each true segment.
        predicted_class: Class of each predicted segment.
        class_count: Classes are 0 to this, exclusive.
    """
    union = truth_size[:, None] + predicted_size[None] - shared
    iou = shared / jnp.maximum(union, 1)
    live = (truth_size[:, None] > 0) & (predicted_size[None] > 0)
    match = live & (iou > MATCH_IOU) & (truth_class[:, None] == predicted_class[None])
    matched_iou = jnp.where(match, iou, 0.0)

    def by_class(values, classes):
        return jnp.zeros(class_count, values.dtype).at[classes].add(values, mode="drop")

    found, used = match.any(1), match.any(0)
    tp = by_class(found.astype(jnp.int32), truth_class)
    fn = by_class(((truth_size > 0) & ~found).astype(jnp.int32), truth_class)
    fp = by_class(((predicted_size > 0) & ~used).astype(jnp.int32), predicted_class)
    total = by_class(matched_iou.sum(1), truth_class)
    sq = total / jnp.maximum(tp, 1)
    rq = tp / jnp.maximum(tp + 0.5 * fp + 0.5 * fn, 0.5)
    partner = jnp.where(found, jnp.argmax(matched_iou, 1), -1).astype(jnp.int32)
    return PanopticQuality(sq * rq, sq, rq, tp, fp, fn, partner, matched_iou.max(1, initial=0.0))


@dataclasses.dataclass(frozen=True)
class ClassQuality:
    """Panoptic quality of one class."""

    class_name: str
    kind: Literal["thing", "stuff"]
    """Layout counts as stuff: one segment per class."""
    pq: float
    sq: float
    rq: float
    true_positives: int
    false_positives: int
    false_negatives: int


@dataclasses.dataclass(frozen=True)
class PanopticScores:
    """Averages over classes."""

    pq: float
    """Over all classes in truth or prediction, as `sq`, `rq`, `pq_things` and `pq_stuff`."""
    sq: float
    rq: float
    pq_things: float | None
    pq_stuff: float | None
    pq_matched: float | None
    """Over classes with a match alone, as `sq_matched` and `rq_matched`."""
    sq_matched: float | None
    rq_matched: float | None
    classes: tuple[ClassQuality, ...]

    @staticmethod
    def over(classes: tuple[ClassQuality, ...]) -> PanopticScores:
        """Average the rows."""
        matched = [c for c in classes if c.true_positives]
        return PanopticScores(
            pq=mean(c.pq for c in classes) or 0.0,
            sq=mean(c.sq for c in classes) or 0.0,
            rq=mean(c.rq for c in classes) or 0.0,
            pq_things=mean(c.pq for c in classes if c.kind == "thing"),
            pq_stuff=mean(c.pq for c in classes if c.kind == "stuff"),
            pq_matched=mean(c.pq for c in matched),
            sq_matched=mean(c.sq for c in matched),
            rq_matched=mean(c.rq for c in matched),
            classes=classes,
        )

    def headline(self) -> Headline:
        matched = sum(c.true_positives > 0 for c in self.classes)
        all_classes = f"all {len(self.classes)} classes"
        return (
            (f"PQ / SQ / RQ, {all_classes}", percent(self.pq, self.sq, self.rq)),
            (
                f"PQ / SQ / RQ, {matched} matched classes only",
                percent(self.pq_matched, self.sq_matched, self.rq_matched),
            ),
            (f"PQ things / stuff, {all_classes}", percent(self.pq_things, self.pq_stuff)),
        )


def panoptic_scores(quality: PanopticQuality) -> PanopticScores:
    """Scores of each class and their averages."""
    rows = []
    for info in classes():
        tp, fp, fn = (
            int(v[info.id])
            for v in (quality.true_positives, quality.false_positives, quality.false_negatives)
        )
        if tp + fp + fn:
            pq, sq, rq = (float(v[info.id]) for v in (quality.pq, quality.sq, quality.rq))
            kind = "thing" if info.kind == "thing" else "stuff"
            rows.append(ClassQuality(info.name, kind, pq, sq, rq, tp, fp, fn))
    return PanopticScores.over(tuple(rows))
