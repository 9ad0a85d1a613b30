"""From labelled points to segments and their panoptic quality; who is whom."""

from __future__ import annotations

import dataclasses

import numpy as np
from jaxtyping import Int

from ..classes import class_named, classes
from ..scene_file import EntityRecord
from .boxes import box_iou_matrix
from .labels import REACH_M, Transfer, false_cells
from .panoptic import PanopticQuality, contingency, panoptic_quality
from .report import ClassQuality, Match, PanopticScores
from .result_files import Result, Truth, moved_box

MIN_POINTS = 10
"""True entities of which the camera saw less (0.4 dm^2 on the 2 cm grid) are not asked for, and
predicted segments with less are not counted."""
FALLBACK_IOU = 0.25
"""Box IoU at which what no segment matches is still taken for the same entity."""


@dataclasses.dataclass(frozen=True, eq=False)
class Segments:
    """Segments of one side: things by instance, layout and stuff by class."""

    row: Int[np.ndarray, " points"]
    """Segment of each point; -1 = none."""
    ids: Int[np.ndarray, " segments"]
    """Instance of a thing; minus the class of the others."""
    class_id: Int[np.ndarray, " segments"]


def make_segments(
    instance: Int[np.ndarray, " points"], class_id: Int[np.ndarray, " points"]
) -> Segments:
    """Group points; instance 0 and class 0 are none. Most points of a thing say its class."""
    thing = np.array([info.kind == "thing" for info in classes()])
    known = (instance > 0) & (class_id > 0)
    key = np.where(known, np.where(thing[class_id], instance, -class_id), 0)
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


def compare_segments(
    truth: Truth, result: Result, near: Transfer
) -> tuple[PanopticQuality, Segments, Segments]:
    """Panoptic quality of the map over the points that the camera saw."""
    seen = observed_ids(truth)
    class_of = {e.id: class_named(e.class_name).id for e in truth.scene.entities}
    point_class = np.array([class_of.get(i, 0) for i in range(max(class_of, default=0) + 1)])
    asked = np.isin(truth.instance, list(seen)) & (truth.instance < len(point_class))
    instance = np.where(asked, truth.instance, 0)
    true = make_segments(instance, point_class[instance])
    predicted = make_segments(result.instance, result.class_id)
    row = np.where(asked, np.append(predicted.row, -1)[near.nearest], -1)
    size = np.bincount(row[row >= 0], minlength=len(predicted.ids))
    far = near.to_truth_m > REACH_M
    size = size + false_cells(result.points, predicted.row, far, len(predicted.ids))
    size = np.where(size >= MIN_POINTS, size, 0)
    return _padded_quality(true, predicted, row, size), true, predicted


def _padded_quality(
    true: Segments, predicted: Segments, row: np.ndarray, size: np.ndarray
) -> PanopticQuality:
    """`panoptic_quality` in buckets of powers of two, so that another scene compiles nothing."""
    t, p, n = (_bucket(v) for v in (len(true.ids), len(predicted.ids), len(row)))

    def pad(values: np.ndarray, length: int, fill: int) -> np.ndarray:
        return np.pad(values, (0, length - len(values)), constant_values=fill).astype(np.int32)

    rows = pad(true.row, n, -1), pad(row, n, -1)
    shared = contingency(*rows, truth_count=t, predicted_count=p)
    true_size = np.bincount(true.row[true.row >= 0], minlength=len(true.ids))
    return panoptic_quality(
        shared,
        pad(true_size, t, 0),
        pad(size, p, 0),
        pad(true.class_id, t, 0),
        pad(predicted.class_id, p, 0),
        class_count=len(classes()),
    )


def _bucket(count: int) -> int:
    return 1 << max(count - 1, 7).bit_length()


def panoptic_scores(quality: PanopticQuality) -> PanopticScores:
    """Scores a class and their averages."""
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


def match_entities(
    truth: Truth,
    result: Result,
    quality: PanopticQuality,
    true: Segments,
    predicted: Segments,
) -> tuple[Match, ...]:
    """The predicted entity for every seen true thing: by segments, else by boxes of its class."""
    by_id = {e.id: e for e in result.scene.entities if e.type != "layout"}
    partner = np.asarray(quality.partner)
    found: dict[int, Match] = {}
    for row, id in enumerate(true.ids):
        other = int(predicted.ids[partner[row]]) if partner[row] >= 0 else 0
        if id > 0 and other in by_id:
            found[int(id)] = Match("", by_id[other].name, "segments", float(quality.iou[row]))
    seen = observed_ids(truth)
    things = [e for e in truth.scene.entities if e.type != "layout" and e.id in seen]
    used = {m.predicted for m in found.values()}
    free = [e for e in by_id.values() if e.name not in used]
    found |= _match_boxes([e for e in things if e.id not in found], free, result)
    missing = Match("", None, "none", 0.0)
    return tuple(dataclasses.replace(found.get(e.id, missing), truth=e.name) for e in things)


def _match_boxes(
    things: list[EntityRecord], free: list[EntityRecord], result: Result
) -> dict[int, Match]:
    """Greedy by falling IoU."""
    boxes = [moved_box(e.box, result.T_truth_result) for e in free]
    iou = box_iou_matrix([e.box for e in things], boxes)
    same = [[a.class_name == b.class_name for b in free] for a in things]
    iou = np.where(np.array(same, bool).reshape(iou.shape), iou, 0.0)
    found: dict[int, Match] = {}
    while iou.size and iou.max() >= FALLBACK_IOU:
        i, j = np.unravel_index(int(np.argmax(iou)), iou.shape)
        found[things[i].id] = Match("", free[j].name, "boxes", float(iou[i, j]))
        iou[i], iou[:, j] = 0.0, 0.0
    return found
