"""Where the panoptic quality of one map is lost: every true segment, and what became of it."""

from __future__ import annotations

import dataclasses

import numpy as np
from jaxtyping import Bool, Float

from isr_jax.classes import classes
from isr_jax.evaluation.maps.panoptic import MATCH_IOU
from isr_jax.evaluation.maps.segments import Comparison, Segments

from .pq_gain import MOST, gain_if_found, gain_without, unmatched
from .scores import Judged

_PART = 0.1
"""A segment with this share of another one has a part of it."""
KINDS = {
    "found": "matched; what is lost are its borders",
    "wrong class": "IoU above 0.5 with a segment of another class",
    "dropped": "IoU above 0.5 in the map, but entities dropped or joined that instance",
    "split": "several predicted things lie on it",
    "merged": "what has most of it lies on others",
    "spilled": "what has most of it lies mostly on no true surface",
    "trimmed": "one predicted thing lies on it, and covers too little",
    "in stuff": "layout or stuff has most of it",
    "missed": "most of it has no label",
}
"""What can become of a true segment; the first that applies is named."""


@dataclasses.dataclass(frozen=True)
class Loss:
    """What became of one true segment."""

    name: str
    class_name: str
    seen: int
    """Its points that the camera saw."""
    best: str
    """The predicted segment of largest IoU, of any class; empty if none touches it."""
    best_class: str
    iou: float
    kind: str
    """Of `KINDS`."""
    pieces: int
    """Predicted things that lie on it and have a part of it."""
    detail: str
    """Which predicted segments have how much of it, and whose else they are."""
    pq_lost: float
    """By so much the mean PQ would rise if it alone were right."""


@dataclasses.dataclass(frozen=True)
class Surplus:
    """A predicted segment that matches nothing."""

    name: str
    class_name: str
    points: int
    detail: str
    """On which true segments it lies with how much of it; the rest is false surface."""
    pq_lost: float
    """By so much the mean PQ would rise without it."""


def losses(judged: Judged) -> list[Loss]:
    """Every true segment that counts, the dearest first."""
    case = _Case(judged)
    found = [case.loss(int(t)) for t in np.flatnonzero(judged.compared.true_size)]
    return sorted(found, key=lambda loss: (-loss.pq_lost, -loss.seen))


def surplus(judged: Judged) -> list[Surplus]:
    """Predicted segments that match nothing, the dearest first."""
    case = _Case(judged)
    found = [case.surplus(p) for p in unmatched(judged.compared)]
    return sorted(found, key=lambda s: (-s.pq_lost, -s.points))


class _Case:
    """The segments of both sides, how they overlap and what they are called."""

    def __init__(self, judged: Judged) -> None:
        self._compared = judged.compared
        self._iou, self._iou_before = _iou(judged.compared), _iou(judged.before)
        true, found = judged.truth.scene.entities, judged.mapped.entities
        self._true_names = {e.id: e.name for e in true if e.type != "layout"}
        self._found_names = {e.id: e.name for e in found if not e.is_layout}

    def loss(self, t: int) -> Loss:
        compared, iou = self._compared, self._iou[t]
        p = int(iou.argmax()) if iou.max(initial=0.0) > 0 else None
        return Loss(
            name=self._true(t),
            class_name=_class_name(compared.true, t),
            seen=int(compared.true_size[t]),
            best="" if p is None else self._predicted(p),
            best_class="" if p is None else _class_name(compared.predicted, p),
            iou=0.0 if p is None else float(iou[p]),
            kind=self._kind(t),
            pieces=int(self._own(t).sum()),
            detail=self._whereabouts(t),
            pq_lost=gain_if_found(compared, t),
        )

    def surplus(self, p: int) -> Surplus:
        compared = self._compared
        column, size = compared.shared[:, p], int(compared.predicted_size[p])
        told = [f"{column[t] / size:.0%} {self._true(t)}" for t in _parts(column, size)]
        return Surplus(
            name=self._predicted(p),
            class_name=_class_name(compared.predicted, p),
            points=size,
            detail=", ".join(told) or "false surface",
            pq_lost=gain_without(compared, p),
        )

    def _kind(self, t: int) -> str:
        compared, iou = self._compared, self._iou[t]
        if iou.max(initial=0.0) > MATCH_IOU:
            is_found = int(compared.quality.partner[t]) >= 0
            return "found" if is_found else "wrong class"
        if self._iou_before[t].max(initial=0.0) > MATCH_IOU:
            return "dropped"
        own = int(self._own(t).sum())
        if own:
            return "split" if own > 1 else "trimmed"
        return self._kind_of_taken(t)

    def _kind_of_taken(self, t: int) -> str:
        """Of a segment that no predicted thing is about."""
        compared = self._compared
        shared, size = compared.shared[t], int(compared.true_size[t])
        is_rival = compared.predicted.ids != -int(compared.true.class_id[t])
        rivals = np.where(is_rival & (compared.predicted.ids > 0), shared, 0)
        p = int(rivals.argmax()) if rivals.size else 0
        if rivals.max(initial=0) >= _PART * size:
            true = int(compared.shared[:, p].sum())
            return "merged" if true >= MOST * compared.predicted_size[p] else "spilled"
        stuff = shared[compared.predicted.ids < 0].sum()
        return "in stuff" if stuff >= MOST * size else "missed"

    def _own(self, t: int) -> Bool[np.ndarray, " predicted"]:
        """Predicted things that lie on ``t`` and have a part of it."""
        compared = self._compared
        shared, size = compared.shared[t], np.maximum(compared.predicted_size, 1)
        is_part = (shared >= _PART * compared.true_size[t]) & (compared.predicted_size > 0)
        return is_part & (shared > MOST * size) & (compared.predicted.ids > 0)

    def _whereabouts(self, t: int) -> str:
        """``60% chair_3 (with table_1), 25% wall, 15% nothing``."""
        shared, size = self._compared.shared[t], int(self._compared.true_size[t])
        told = [
            f"{shared[p] / size:.0%} {self._predicted(p)}{self._company(t, p)}"
            for p in _parts(shared, size)
        ]
        nothing = 1.0 - float(shared.sum()) / size
        return ", ".join([*told, f"{nothing:.0%} nothing"] if nothing >= _PART else told)

    def _company(self, t: int, p: int) -> str:
        """What else a predicted thing holds: true segments, false surface."""
        compared = self._compared
        if compared.predicted.ids[p] < 0:
            return ""
        column, mine = compared.shared[:, p].copy(), int(compared.shared[t, p])
        column[t] = 0
        words = [self._true(o) for o in _parts(column, mine)[:2]]
        if compared.predicted_size[p] - mine - column.sum() >= _PART * mine:
            words.append("false surface")
        return f" (with {', '.join(words)})" if words else ""

    def _true(self, t: int) -> str:
        return _name(self._true_names, self._compared.true, t)

    def _predicted(self, p: int) -> str:
        return _name(self._found_names, self._compared.predicted, p)


def _iou(compared: Comparison) -> Float[np.ndarray, "true predicted"]:
    """Over the points; 0 with segments that are too small to count."""
    true_size, size = compared.true_size[:, None], compared.predicted_size[None]
    iou = compared.shared / np.maximum(true_size + size - compared.shared, 1)
    return np.where((true_size > 0) & (size > 0), iou, 0.0)


def _parts(points: np.ndarray, of: int) -> list[int]:
    """Segments with a part of ``of`` points, the largest first."""
    order = np.argsort(-points, kind="stable").tolist()
    return [row for row in order if points[row] > 0 and points[row] >= _PART * of]


def _class_name(segments: Segments, row: int) -> str:
    return classes()[int(segments.class_id[row])].name


def _name(known: dict[int, str], segments: Segments, row: int) -> str:
    id, class_name = int(segments.ids[row]), _class_name(segments, row)
    return class_name if id < 0 else known.get(id, f"{class_name} #{id}")
