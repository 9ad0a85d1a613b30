"""From labelled points to segments, and what those of truth and prediction share.

Points are those of the true surface that the camera saw. What the map has farther than 5 cm from
them is false surface, counted on the same grid. Truth of which the camera saw too little is
ignored: its points count for nobody.
"""

from __future__ import annotations

import dataclasses

import numpy as np
from jaxtyping import Bool, Int

from ...classes import class_named, classes
from ...runtime.batches import bucket
from ..result_files import Result, Truth
from .labels import REACH_M, Transfer, false_cells
from .panoptic import PanopticQuality, contingency, panoptic_quality

_LEAST = 8
"""Segments, or points, that a call is padded to at least."""
MIN_POINTS = 10
"""True segments of which the camera saw less (0.4 dm^2 on the 2 cm grid) are not asked for, and
predicted segments with less are not counted."""


@dataclasses.dataclass(frozen=True, eq=False)
class Segments:
    """Segments of one side: things by instance, layout and stuff by class."""

    row: Int[np.ndarray, " points"]
    """Segment of each point; -1 = none."""
    ids: Int[np.ndarray, " segments"]
    """Instance of a thing; minus the class of the others."""
    class_id: Int[np.ndarray, " segments"]


@dataclasses.dataclass(frozen=True, eq=False)
class Comparison:
    """True and predicted segments, and what they share."""

    true: Segments
    predicted: Segments
    """Its points are the vertices of the map."""
    shared: Int[np.ndarray, "true predicted"]
    """True points in both."""
    true_size: Int[np.ndarray, " true"]
    predicted_size: Int[np.ndarray, " predicted"]
    """True points, and grid cells far from all; 0 below `MIN_POINTS`."""
    quality: PanopticQuality


def thing_classes() -> Bool[np.ndarray, " classes"]:
    """Which rows of the class table have instances."""
    return np.array([info.kind == "thing" for info in classes()])


def make_segments(
    instance: Int[np.ndarray, " points"], class_id: Int[np.ndarray, " points"]
) -> Segments:
    """Group points; class 0 is none, and so is a thing of instance 0. Most points of a thing say
    its class."""
    thing = thing_classes()
    key = np.where(thing[class_id], np.maximum(instance, 0), -class_id)
    ids, row = np.unique(key, return_inverse=True)
    votes = np.zeros((len(ids), len(thing)), np.int64)
    np.add.at(votes, (row, class_id), 1)
    kept = ids != 0
    rank = np.where(kept, np.cumsum(kept) - 1, -1)
    return Segments(rank[row], ids[kept], votes.argmax(1)[kept])


def observed_ids(truth: Truth) -> set[int]:
    """Ids of the entities that the camera saw enough of."""
    ids, counts = np.unique(truth.instance[truth.instance > 0], return_counts=True)
    return {int(i) for i, n in zip(ids, counts, strict=True) if n >= MIN_POINTS}


def true_segments(truth: Truth) -> Segments:
    """Segments of the true points: entities, and stuff that is none."""
    thing = thing_classes()
    listed = np.array([e.id for e in truth.scene.entities], np.int64)
    named = np.array([class_named(e.class_name).id for e in truth.scene.entities], np.int64)
    order = np.argsort(listed)
    place = np.clip(np.searchsorted(listed[order], truth.instance), 0, max(len(listed) - 1, 0))
    is_entity = np.isin(truth.instance, listed) & (truth.instance > 0)
    stated = np.zeros_like(truth.instance) if truth.class_id is None else truth.class_id
    # A thing that is no entity has no name to be found by, so it is asked of nobody.
    class_id = np.where(thing[stated], 0, stated)
    if len(listed):
        class_id = np.where(is_entity, named[order][place], class_id)
    seen = np.isin(truth.instance, list(observed_ids(truth))) | ~is_entity
    return make_segments(truth.instance, np.where(seen, class_id, 0))


def compare_segments(truth: Truth, result: Result, near: Transfer) -> Comparison:
    """What the segments share over the points that the camera saw, and their panoptic quality."""
    true, predicted = true_segments(truth), make_segments(result.instance, result.class_id)
    row = np.where(true.row >= 0, np.append(predicted.row, -1)[near.nearest], -1)
    size = np.bincount(row[row >= 0], minlength=len(predicted.ids))
    far = near.to_truth_m > REACH_M
    size = size + false_cells(result.points, predicted.row, far, len(predicted.ids))
    size = np.where(size >= MIN_POINTS, size, 0)
    true_size = np.bincount(true.row[true.row >= 0], minlength=len(true.ids))
    true_size = np.where(true_size >= MIN_POINTS, true_size, 0)
    return _compared(true, predicted, row, true_size, size)


def _compared(
    true: Segments,
    predicted: Segments,
    row: Int[np.ndarray, " points"],
    true_size: Int[np.ndarray, " true"],
    size: Int[np.ndarray, " predicted"],
) -> Comparison:
    """In buckets of powers of two, so that another scene compiles nothing."""
    t, p, n = (bucket(v, _LEAST) for v in (len(true.ids), len(predicted.ids), len(row)))

    def pad(values: np.ndarray, length: int, fill: int) -> np.ndarray:
        return np.pad(values, (0, length - len(values)), constant_values=fill).astype(np.int32)

    rows = pad(true.row, n, -1), pad(row, n, -1)
    shared = contingency(*rows, truth_count=t, predicted_count=p)
    quality = panoptic_quality(
        shared,
        pad(true_size, t, 0),
        pad(size, p, 0),
        pad(true.class_id, t, 0),
        pad(predicted.class_id, p, 0),
        class_count=len(classes()),
    )
    counts = np.asarray(shared)[: len(true.ids), : len(predicted.ids)]
    return Comparison(true, predicted, counts, true_size, size, quality)
