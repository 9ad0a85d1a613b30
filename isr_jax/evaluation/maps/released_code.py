"""How the code that was released with the paper counts, traps included. For comparison only.

Figures of this module compare with those that the released code printed, and with nothing else;
`panoptic` and `boxes` count as the field does. What sets it apart, each from that code
(`map_proc/src/eval_node.cpp` and `eval_node.h` of Interactive-Scene-Reconstruction):

- a map vertex takes the label of the nearest true point, however far that is, and IoUs are taken
  over map vertices: true surface that the map lacks costs nothing;
- predictions of fewer than 1000 vertices are dropped; its meshes have three vertices a triangle;
- all true floors are one, all true walls are one, but the vertices of the second and of all others
  never count as shared: they only enlarge the union;
- classes without a prediction are left out of every average, those without a match count 0, and so
  do classes that are not in the truth at all;
- AP is the mean of 11 precisions, with the number of vertices as confidence; at and beyond the
  recall that is reached, the precision of all predictions stands instead of 0;
- true boxes are fitted to the map's vertices with the label, not to the truth, and only boxes that
  share a vertex are compared.

Its box IoU counts a footprint grid of 5 mm; here footprints are clipped exactly.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable, Mapping

import numpy as np
from jaxtyping import Float, Int
from scipy.spatial import KDTree

from ...geometry.tight_box import tight_box
from ...types import Box
from ..figures import mean
from .boxes import box_iou_matrix

MIN_VERTICES = 1000
_MATCH_IOU = 0.5
_STUFF = ("floor", "wall")
_OF_TRUTH = (
    "floor",
    "wall",
    "bag",
    "chair",
    "table",
    "monitor",
    "bed",
    "fridge",
    "cabinet",
    "sofa",
    "desk",
)
"""Searched for, in this order, anywhere in an annotation's text."""
_COUNTED_AS = {"desk": "table", "wall_cabinet": "cabinet"}
"""Desks count as tables. What hangs is a class of our own that the released code does not have."""


def released_class(class_name: str) -> str | None:
    """The class as which a predicted class counts; None where it is not counted."""
    name = _COUNTED_AS.get(class_name, class_name)
    return name if name in _OF_TRUTH else None


def released_true_class(annotation: str) -> str | None:
    """The class that an annotation's text is taken for; None where it is not counted.

    The first known word inside the text decides: "garbage bin" holds "bag", "tv" holds none.
    """
    name = next((word for word in _OF_TRUTH if word in annotation), None)
    return None if name is None else _COUNTED_AS.get(name, name)


@dataclasses.dataclass(frozen=True)
class ReleasedCounts:
    """What was counted for one predicted class, of one sequence or of several together."""

    iou_sum: float
    true_positives: int
    predicted: int
    true: int
    instances: tuple[tuple[int, bool], ...]
    """(vertices, matched by segments) of every predicted thing; empty for stuff."""
    boxes: tuple[tuple[int, bool], ...]
    """(vertices, matched by boxes) of the same."""

    def plus(self, other: ReleasedCounts) -> ReleasedCounts:
        pairs = zip(dataclasses.astuple(self), dataclasses.astuple(other), strict=True)
        return ReleasedCounts(*(a + b for a, b in pairs))


@dataclasses.dataclass(frozen=True)
class ReleasedClassScores:
    """Of one predicted class, 0 to 1."""

    class_name: str
    pq: float
    sq: float
    rq: float
    instance_ap: float | None
    """None for stuff."""
    box_ap: float | None


@dataclasses.dataclass(frozen=True)
class ReleasedCodeScores:
    """Averages over the predicted classes, 0 to 1; None where there is none."""

    pq: float | None
    sq: float | None
    rq: float | None
    instance_map: float | None
    box_map: float | None
    classes: tuple[ReleasedClassScores, ...]

    @staticmethod
    def over(counts: Mapping[str, ReleasedCounts]) -> ReleasedCodeScores:
        """The scores of these counts."""
        rows = tuple(_class_scores(name, count) for name, count in counts.items())
        return ReleasedCodeScores(
            _mean_of(r.pq for r in rows),
            _mean_of(r.sq for r in rows),
            _mean_of(r.rq for r in rows),
            _mean_of(r.instance_ap for r in rows),
            _mean_of(r.box_ap for r in rows),
            rows,
        )


def pooled(sequences: Iterable[Mapping[str, ReleasedCounts]]) -> dict[str, ReleasedCounts]:
    """Counts of several sequences together, as in the released code's "average"."""
    total: dict[str, ReleasedCounts] = {}
    for counts in sequences:
        for name, count in counts.items():
            total[name] = total[name].plus(count) if name in total else count
    return total


def count_as_released_code(
    vertices: Float[np.ndarray, "vertices 3"],
    instance: Int[np.ndarray, " vertices"],
    predicted_class: Mapping[int, str],
    truth_points: Float[np.ndarray, "points 3"],
    truth_label: Int[np.ndarray, " points"],
    true_class: Mapping[int, str],
    *,
    boxes: Mapping[int, Box] | None = None,
    min_vertices: int = MIN_VERTICES,
) -> dict[str, ReleasedCounts]:
    """Count one sequence; scores are `ReleasedCodeScores.over` the result.

    Args:
        vertices: Of the map, three a triangle (`triangle_soup`); world frame, z up, metres.
        instance: Predicted instance of each; those of 0 are in no segment and left out.
        predicted_class: Of each predicted instance, from `released_class`; others are not counted,
            though their vertices are part of the map.
        truth_points: Of the whole true mesh, in the same frame.
        truth_label: Annotated label of each.
        true_class: Of each label, from `released_true_class`, in the order of the annotation.
        boxes: Predicted boxes by instance (refined ones for mAP_re); by default fitted to the
            vertices.
        min_vertices: Smaller predictions are dropped.
    """
    vertices, instance = vertices[instance > 0], instance[instance > 0]
    if len(truth_points) == 0 or len(vertices) == 0:
        label = np.zeros(len(vertices), np.int64)
    else:
        label = truth_label[KDTree(truth_points).query(vertices, workers=-1)[1]]
    size = dict(zip(*(v.tolist() for v in np.unique(instance, return_counts=True)), strict=True))
    counts: dict[str, ReleasedCounts] = {}
    for name in dict.fromkeys(predicted_class.values()):
        # Ids are the keys of a JSON object, which the released code reads in the order of strings.
        of_class = [i for i, c in predicted_class.items() if c == name]
        ids = sorted((i for i in of_class if size.get(i, 0) >= min_vertices), key=str)
        if ids:
            true = _true_segments(label, [k for k, c in true_class.items() if c == name], name)
            counts[name] = _count_class(name, ids, vertices, instance, label, true, boxes)
    return counts


def triangle_soup(
    vertices: Float[np.ndarray, "vertices 3"],
    faces: Int[np.ndarray, "faces 3"],
    instance: Int[np.ndarray, " vertices"],
) -> tuple[Float[np.ndarray, "corners 3"], Int[np.ndarray, " corners"]]:
    """A mesh as the released code stores it: three vertices a triangle, an instance each.

    A triangle between instances is of none.
    """
    of_face = instance[faces]
    inner = (of_face == of_face[:, :1]).all(1)
    return vertices[faces.ravel()], np.repeat(np.where(inner, of_face[:, 0], 0), 3)


def _true_segments(label: np.ndarray, labels: list[int], name: str) -> dict[int, int]:
    """Map vertices of each true label; of stuff, all under the first label."""
    size = {k: int(np.count_nonzero(label == k)) for k in labels}
    return {labels[0]: sum(size.values())} if name in _STUFF and labels else size


def _count_class(
    name: str,
    ids: list[int],
    vertices: np.ndarray,
    instance: np.ndarray,
    label: np.ndarray,
    true: dict[int, int],
    boxes: Mapping[int, Box] | None,
) -> ReleasedCounts:
    ious: list[float] = []
    instances, boxed = [], []
    free, free_boxes = set(true), set(true)
    for id in ids:
        own = instance == id
        candidates = _candidates(label[own], true)
        count = int(np.count_nonzero(own))
        of = {k: shared / (count + true[k] - shared) for k, shared in candidates.items()}
        match = _first_match(of, free)
        ious += [] if match is None else [of[match]]
        if name in _STUFF:
            continue
        instances.append((count, match is not None))
        box = boxes[id] if boxes is not None else tight_box(vertices[own])
        fitted = [tight_box(vertices[label == k]) for k in candidates]
        near = box_iou_matrix([box], fitted)[0].tolist()
        boxed.append((count, _first_match(dict(zip(candidates, near)), free_boxes) is not None))
    return ReleasedCounts(
        float(sum(ious)), len(ious), len(ids), len(true), tuple(instances), tuple(boxed)
    )


def _candidates(label: np.ndarray, true: dict[int, int]) -> dict[int, int]:
    """True segments that share vertices, and how many; the most first."""
    labels, shared = np.unique(label, return_counts=True)
    order = np.argsort(-shared, kind="stable")
    return {int(labels[i]): int(shared[i]) for i in order if int(labels[i]) in true}


def _first_match(iou: dict[int, float], free: set[int]) -> int | None:
    """The first free candidate above the limit; it is free no more."""
    found = next((k for k, value in iou.items() if value > _MATCH_IOU and k in free), None)
    if found is not None:
        free.remove(found)
    return found


def _class_scores(name: str, count: ReleasedCounts) -> ReleasedClassScores:
    tp = count.true_positives
    sq = count.iou_sum / tp if tp else 0.0
    rq = 2 * tp / (count.predicted + count.true) if tp else 0.0
    if name in _STUFF:
        return ReleasedClassScores(name, sq * rq, sq, rq, None, None)
    ap = released_ap(count.instances, count.true), released_ap(count.boxes, count.true)
    return ReleasedClassScores(name, sq * rq, sq, rq, *ap)


def released_ap(predictions: Iterable[tuple[int, bool]], true: int) -> float:
    """The released code's 11-point precision.

    At recall r = 0, 0.1, ..., 1: the largest precision from the first prediction that reaches r on,
    but, where r is at least the recall of all predictions together, their precision. One match of
    ten true things, and nothing else, thus has AP 1.

    Args:
        predictions: (confidence, whether it matched).
        true: Number of true things.
    """
    hit = np.array([h for _, h in sorted(predictions, key=lambda p: -p[0])], bool)
    if len(hit) == 0 or true == 0:
        return 0.0
    found = np.cumsum(hit, dtype=np.float32)
    precision = found / np.arange(1, len(hit) + 1, dtype=np.float32)
    recall = found / np.float32(true)
    best_from = np.maximum.accumulate(precision[::-1])[::-1]
    # In single precision, as there: 3 * 0.1 is above 0.3 in double precision.
    levels = np.arange(11, dtype=np.float32) * np.float32(0.1)
    first = np.minimum(np.searchsorted(recall, levels), len(hit) - 1)
    at = np.where(levels >= recall[-1], precision[-1], best_from[first])
    return float(at.mean())


def _mean_of(values: Iterable[float | None]) -> float | None:
    return mean(v for v in values if v is not None)
