"""Which predicted entity stands for which true one."""

from __future__ import annotations

import dataclasses
from typing import Literal

import numpy as np

from ..scene_file import EntityRecord
from .maps.boxes import box_iou_matrix
from .maps.segments import Comparison, observed_ids
from .result_files import Result, Truth, moved_box

FALLBACK_IOU = 0.25
"""Box IoU at which what no segment matches is still taken for the same entity."""


@dataclasses.dataclass(frozen=True)
class Match:
    """The predicted entity that stands for a true one."""

    truth: str
    predicted: str | None
    by: Literal["segments", "boxes", "none"]
    """IoU > 0.5 of segments; IoU >= 0.25 of boxes of one class; nothing."""
    iou: float


def match_entities(truth: Truth, result: Result, compared: Comparison) -> tuple[Match, ...]:
    """The predicted entity for every seen true thing: by segments, else by boxes of its class."""
    quality, true, predicted = compared.quality, compared.true, compared.predicted
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
