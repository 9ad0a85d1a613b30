"""Figures of our own runs, in rows that stand beside the published ones."""

from __future__ import annotations

import csv
import dataclasses
from collections.abc import Iterable
from pathlib import Path

from isr_jax.errors import OutputError
from isr_jax.evaluation import BoxScores, InstanceScores, PanopticScores
from isr_jax.evaluation.maps.released_code import ReleasedCodeScores, released_class

from ..published import MEAN, PublishedFigure

ALL, THEIRS, RELEASED_WAY = "all classes", "the paper's classes", "counted as the released code"
"""How figures of ours were counted: exactly, over all classes in truth or prediction; exactly, over
the ten classes of the paper alone; as the released code counts, traps included."""


@dataclasses.dataclass(frozen=True)
class Failure:
    """A sequence that gave no figures."""

    source: str
    sequence: str
    problem: str


@dataclasses.dataclass(frozen=True)
class ExactScores:
    """Of one sequence and preset."""

    panoptic: PanopticScores
    instances: InstanceScores
    boxes: BoxScores
    """Before supports refined them (mAP)."""
    refined: BoxScores
    """After (mAP_re)."""

    def of_the_paper(self) -> ExactScores:
        """The same over the paper's classes alone."""
        return ExactScores(
            PanopticScores.over(tuple(c for c in self.panoptic.classes if _known(c.class_name))),
            InstanceScores.over(tuple(r for r in self.instances.rows if _known(r.class_name))),
            BoxScores.over(tuple(r for r in self.boxes.rows if _known(r.class_name))),
            BoxScores.over(tuple(r for r in self.refined.rows if _known(r.class_name))),
        )


def _known(class_name: str) -> bool:
    return released_class(class_name) is not None


def source_name(preset: str, counting: str) -> str:
    """``isr_jax default, all classes``."""
    return f"isr_jax {preset}, {counting}"


def exact_rows(
    preset: str, sequence: str, annotation: str, scores: ExactScores
) -> list[PublishedFigure]:
    """Means over all classes and over the paper's, and every class."""
    rows = []
    for counting, of in ((ALL, scores), (THEIRS, scores.of_the_paper())):
        values = [
            ("panoptic", MEAN, "PQ", of.panoptic.pq),
            ("panoptic", MEAN, "SQ", of.panoptic.sq),
            ("panoptic", MEAN, "RQ", of.panoptic.rq),
            ("instance", MEAN, "mAP", of.instances.map50),
            ("box", MEAN, "mAP", of.boxes.map50),
            ("box", MEAN, "mAP_re", of.refined.map50),
        ]
        if counting == ALL:
            for c in of.panoptic.classes:
                pairs = (("PQ", c.pq), ("SQ", c.sq), ("RQ", c.rq))
                values += [("panoptic", c.class_name, metric, v) for metric, v in pairs]
            values += [("instance", r.class_name, "AP", r.ap50) for r in of.instances.rows]
            values += [("box", r.class_name, "AP", r.ap50) for r in of.boxes.rows]
        rows += _figures(source_name(preset, counting), sequence, annotation, values)
    return rows


def released_rows(
    preset: str,
    sequence: str,
    annotation: str,
    scores: ReleasedCodeScores,
    refined: ReleasedCodeScores,
) -> list[PublishedFigure]:
    """The same in the released code's counting; ``refined`` is with refined boxes."""
    values = [
        ("panoptic", MEAN, "PQ", scores.pq),
        ("panoptic", MEAN, "SQ", scores.sq),
        ("panoptic", MEAN, "RQ", scores.rq),
        ("instance", MEAN, "mAP", scores.instance_map),
        ("box", MEAN, "mAP", scores.box_map),
        ("box", MEAN, "mAP_re", refined.box_map),
    ]
    for c in scores.classes:
        pairs = (("PQ", c.pq), ("SQ", c.sq), ("RQ", c.rq))
        values += [("panoptic", c.class_name, metric, v) for metric, v in pairs]
        values += [("instance", c.class_name, "AP", c.instance_ap)]
        values += [("box", c.class_name, "AP", c.box_ap)]
    return _figures(source_name(preset, RELEASED_WAY), sequence, annotation, values)


def _figures(
    source: str,
    sequence: str,
    annotation: str,
    values: Iterable[tuple[str, str, str, float | None]],
) -> list[PublishedFigure]:
    return [
        PublishedFigure(source, sequence, annotation, scope, name, metric, 100 * value)
        for scope, name, metric, value in values
        if value is not None
    ]


def write_rows(path: Path, figures: Iterable[PublishedFigure], failures: Iterable[Failure]) -> None:
    """All figures as CSV; a failure is a row with its problem and no figure."""
    columns = [field.name for field in dataclasses.fields(PublishedFigure)]
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with path.open("w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow([*columns, "problem"])
            for f in figures:
                writer.writerow([*dataclasses.astuple(f)[:-1], f"{f.percent:.4f}", ""])
            for f in failures:
                empty = [""] * (len(columns) - 2)
                writer.writerow([f.source, f.sequence, *empty, f.problem])
    except OSError as error:
        raise OutputError(f"{path}: {error.strerror}", "give another --out") from None
