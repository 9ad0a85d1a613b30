"""A result counted as the released code would count it. For comparison with its figures only.

The seen true points stand for the annotated scan, our true classes for the text of annotations.
"""

from __future__ import annotations

import dataclasses

import numpy as np

from ...classes import classes
from ...types import Box
from ..figures import Headline, percent
from ..result_files import Result, Truth, moved_box
from .released_code import (
    ReleasedCodeScores,
    count_as_released_code,
    released_class,
    triangle_soup,
)
from .segments import make_segments


@dataclasses.dataclass(frozen=True)
class ReleasedCounting:
    """Scores by the released code's counting, traps included; see `released_code`."""

    fitted: ReleasedCodeScores
    """With boxes fitted to the map."""
    refined: ReleasedCodeScores
    """With the boxes of scene.json, which supports have refined."""

    def headline(self) -> Headline:
        f = self.fitted
        return (
            ("counted as the released code: PQ / SQ / RQ", percent(f.pq, f.sq, f.rq)),
            ("  instance mAP", percent(f.instance_map)),
            ("  box mAP / mAP_re", percent(f.box_map, self.refined.box_map)),
        )


def score_released_counting(truth: Truth, result: Result) -> ReleasedCounting:
    """Count a result twice: with fitted boxes, and with its own.

    The map's triangles are made single, so a map of 2 million takes some ten seconds.
    """
    predicted = make_segments(result.instance, result.class_id)
    label = np.append(_labels(predicted.ids), 0)[predicted.row]
    points, corner_label = triangle_soup(result.points, result.faces, label)
    boxes: dict[int, Box] = {
        e.id: moved_box(e.box, result.T_truth_result)
        for e in result.scene.entities
        if e.type != "layout"
    }
    true_class = {e.id: released_class(e.class_name) for e in truth.scene.entities}
    named = _released(predicted.ids, predicted.class_id)
    # A thing without an entity has no refined box.
    boxed = {k: name for k, name in named.items() if k in boxes or name in ("floor", "wall")}
    true = truth.points, truth.instance, {k: c for k, c in true_class.items() if c is not None}
    return ReleasedCounting(
        ReleasedCodeScores.over(count_as_released_code(points, corner_label, named, *true)),
        ReleasedCodeScores.over(
            count_as_released_code(points, corner_label, boxed, *true, boxes=boxes)
        ),
    )


def _labels(ids: np.ndarray) -> np.ndarray:
    """Positive labels: instances keep theirs, stuff (minus its class) comes after them."""
    return np.where(ids > 0, ids, int(ids.max(initial=0)) - ids)


def _released(ids: np.ndarray, class_id: np.ndarray) -> dict[int, str]:
    named = {}
    for label, row in zip(_labels(ids).tolist(), class_id.tolist(), strict=True):
        name = released_class(classes()[row].name)
        if name is not None:
            named[label] = name
    return named
