"""What `evaluate` found, as plain data, as JSON, and as tables. Scores are 0 to 1."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Group
from rich.table import Table

from ..errors import OutputError
from ..plain_text import plain_text
from .cad_alignment import AlignmentLimits, CadErrors


@dataclasses.dataclass(frozen=True)
class ClassQuality:
    """Panoptic quality of one class."""

    class_name: str
    kind: str
    """``thing``, or ``stuff`` (layout and stuff: one segment a class)."""
    pq: float
    sq: float
    rq: float
    true_positives: int
    false_positives: int
    false_negatives: int


@dataclasses.dataclass(frozen=True)
class PanopticScores:
    """Averages over classes.

    ``pq``, ``sq``, ``rq`` run over every class that occurs in the truth or in the prediction, a
    class without a match counting 0. ``*_matched`` run only over classes with a match; published
    SQ figures often do.
    """

    pq: float
    sq: float
    rq: float
    pq_things: float | None
    pq_stuff: float | None
    pq_matched: float | None
    sq_matched: float | None
    rq_matched: float | None
    classes: tuple[ClassQuality, ...]

    @staticmethod
    def over(classes: tuple[ClassQuality, ...]) -> PanopticScores:
        """Average the rows."""
        matched = [c for c in classes if c.true_positives]
        return PanopticScores(
            pq=_mean(c.pq for c in classes) or 0.0,
            sq=_mean(c.sq for c in classes) or 0.0,
            rq=_mean(c.rq for c in classes) or 0.0,
            pq_things=_mean(c.pq for c in classes if c.kind == "thing"),
            pq_stuff=_mean(c.pq for c in classes if c.kind == "stuff"),
            pq_matched=_mean(c.pq for c in matched),
            sq_matched=_mean(c.sq for c in matched),
            rq_matched=_mean(c.rq for c in matched),
            classes=classes,
        )


@dataclasses.dataclass(frozen=True)
class BoxScores:
    """Average precision of oriented boxes, over the classes of seen true things."""

    map50: float | None
    map25: float | None
    ap: dict[str, tuple[float, float]]
    """(AP at 0.5, AP at 0.25) by class."""

    @staticmethod
    def over(ap: dict[str, tuple[float, float]]) -> BoxScores:
        """Average the classes."""
        return BoxScores(_mean(a for a, _ in ap.values()), _mean(a for _, a in ap.values()), ap)


@dataclasses.dataclass(frozen=True)
class SupportScores:
    """Edges from things to what carries them."""

    correct: int
    predicted: int
    """Predicted edges; one of a thing that matches no true one is wrong."""
    true: int
    """Edges of seen true things."""
    reachable: int
    """Of these, edges whose both ends were found."""
    attached_correct: int
    """Found things that nothing carries, with the right attachment."""
    attached: int

    @property
    def precision(self) -> float | None:
        return self.correct / self.predicted if self.predicted else None

    @property
    def recall(self) -> float | None:
        return self.correct / self.true if self.true else None

    @property
    def recall_of_found(self) -> float | None:
        """Recall among the edges whose both ends were found: the contact graph by itself."""
        return self.correct / self.reachable if self.reachable else None


@dataclasses.dataclass(frozen=True)
class CadRow:
    """One true CAD and what stands for it."""

    truth: str
    class_name: str
    true_id: str
    id: str | None
    errors: CadErrors | None
    reason: str
    """Why there is nothing to compare; empty otherwise."""
    size_source: str
    """Where the compared sizes come from."""


@dataclasses.dataclass(frozen=True)
class CadScores:
    """CAD alignment accuracy over the seen true CADs."""

    accuracy: float | None
    """Share of the true CADs within all limits."""
    class_accuracy: float | None
    """The same, averaged over classes."""
    placed: float | None
    """Share for which any model stands."""
    same_model: float | None
    """Share for which the true model stands."""
    median_center_m: float | None
    median_rotation_deg: float | None
    median_size_ratio: float | None
    limits: AlignmentLimits
    rows: tuple[CadRow, ...]

    @staticmethod
    def over(rows: tuple[CadRow, ...], limits: AlignmentLimits) -> CadScores:
        """Average the rows."""
        aligned = {c: [_aligned(r) for r in rows if r.class_name == c] for c in _names(rows)}
        errors = [r.errors for r in rows if r.errors is not None]
        rotation_rad = _median(e.rotation_rad for e in errors)
        return CadScores(
            _mean(_aligned(r) for r in rows),
            _mean(_mean(v) or 0.0 for v in aligned.values()),
            _mean(float(r.id is not None) for r in rows),
            _mean(float(r.id == r.true_id) for r in rows),
            _median(e.center_m for e in errors),
            None if rotation_rad is None else float(np.rad2deg(rotation_rad)),
            _median(e.size_ratio for e in errors),
            limits,
            rows,
        )


def _aligned(row: CadRow) -> float:
    return float(row.errors is not None and row.errors.aligned)


def _names(rows: tuple[CadRow, ...]) -> list[str]:
    return sorted({row.class_name for row in rows})


@dataclasses.dataclass(frozen=True)
class SurfaceScores:
    """The map's surface against the seen true surface."""

    median_m: float | None
    """Distance from map vertices to the nearest true point, cut at 50 cm; the 2 cm grid alone
    gives up to 1 cm."""
    p90_m: float | None
    near_share: float
    """Map vertices within 5 cm of the truth."""
    completeness: float
    """True points with a map vertex within 5 cm."""


@dataclasses.dataclass(frozen=True)
class Match:
    """The predicted entity that stands for a true one."""

    truth: str
    predicted: str | None
    by: str
    """``segments`` (IoU > 0.5), ``boxes`` (IoU >= 0.25, same class) or ``none``."""
    iou: float


@dataclasses.dataclass(frozen=True)
class EvaluationReport:
    """All scores of one result."""

    panoptic: PanopticScores
    boxes: BoxScores
    """Of the boxes in scene.json, which supports have refined (mAP_re)."""
    unrefined_boxes: BoxScores | None
    """Before refinement (mAP), where given."""
    supports: SupportScores
    cad: CadScores
    surface: SurfaceScores
    matches: tuple[Match, ...]
    unseen: tuple[str, ...]
    """True entities that the camera hardly saw; nothing is asked of them."""

    def to_json(self) -> dict[str, Any]:
        """Plain data with the derived rates in it."""
        data = dataclasses.asdict(self)
        rates = ("precision", "recall", "recall_of_found")
        data["supports"] |= {name: getattr(self.supports, name) for name in rates}
        return data

    def write(self, path: str | Path) -> None:
        """Write `to_json` to a file."""
        try:
            text = json.dumps(self.to_json(), indent=1, allow_nan=False)
            Path(path).write_text(text + "\n", "utf-8")
        except OSError as error:
            raise OutputError(f"{path}: {error.strerror}", "choose another folder") from None

    def headline(self) -> tuple[tuple[str, str], ...]:
        """(name, value) of what is quoted first."""
        p, s, c, b = self.panoptic, self.supports, self.cad, self.boxes
        found = sum(m.predicted is not None for m in self.matches)
        return (
            ("things found", f"{found} of {len(self.matches)}"),
            ("PQ / SQ / RQ", " / ".join(map(_percent, (p.pq, p.sq, p.rq)))),
            ("PQ things / stuff", f"{_percent(p.pq_things)} / {_percent(p.pq_stuff)}"),
            *(
                [("box mAP@0.5 / 0.25", _pair(self.unrefined_boxes))]
                if self.unrefined_boxes
                else []
            ),
            ("box mAP_re@0.5 / 0.25", _pair(b)),
            ("support precision", f"{_percent(s.precision)} ({s.correct} of {s.predicted})"),
            ("support recall", f"{_percent(s.recall)} ({s.correct} of {s.true})"),
            ("CAD aligned (20 cm, 20 deg, 20 %)", _percent(c.accuracy)),
            ("CAD placed / same model", f"{_percent(c.placed)} / {_percent(c.same_model)}"),
            ("surface error, median", _millimetres(self.surface.median_m)),
            ("surface completeness", _percent(self.surface.completeness)),
        )

    def table(self) -> Group:
        """All of it for a terminal; print it with a rich console."""
        top = Table("score", "value", title="against the truth (percent)")
        for name, value in self.headline():
            top.add_row(name, value)
        return Group(top, self._class_table(), self._cad_table())

    def __str__(self) -> str:
        return plain_text(self.table())

    def _class_table(self) -> Table:
        table = Table("class", "PQ", "SQ", "RQ", "TP", "FP", "FN", "AP@0.5", "AP@0.25")
        rows = {c.class_name: c for c in self.panoptic.classes}
        for name, c in rows.items():
            counts = (str(v) for v in (c.true_positives, c.false_positives, c.false_negatives))
            ap = [_percent(v) for v in self.boxes.ap.get(name, (None, None))]
            table.add_row(name, *map(_percent, (c.pq, c.sq, c.rq)), *counts, *ap)
        return table

    def _cad_table(self) -> Table:
        table = Table("true entity", "true model", "model", "centre", "rotation", "size", "aligned")
        for row in self.cad.rows:
            e = row.errors
            if e is None:
                table.add_row(row.truth, row.true_id, row.reason, "", "", "", "no")
                continue
            table.add_row(
                row.truth,
                row.true_id,
                row.id,
                f"{e.center_m * 100:.1f} cm",
                f"{np.rad2deg(e.rotation_rad):.1f} deg",
                f"{e.size_ratio:.1%}",
                "yes" if e.aligned else "no",
            )
        return table


def _mean(values: Iterable[float]) -> float | None:
    listed = list(values)
    return float(np.mean(listed)) if listed else None


def _median(values: Iterable[float]) -> float | None:
    listed = list(values)
    return float(np.median(listed)) if listed else None


def _percent(value: float | None) -> str:
    return "-" if value is None else f"{100 * value:.1f}"


def _pair(boxes: BoxScores) -> str:
    return f"{_percent(boxes.map50)} / {_percent(boxes.map25)}"


def _millimetres(value: float | None) -> str:
    return "-" if value is None else f"{1000 * value:.1f} mm"
