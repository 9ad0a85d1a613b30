"""The table: sequence by sequence, one row per source, one column per figure."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
from rich.table import Table

from ..published import MEAN, PAPER, PAPER_VOXBLOX, POOLED, RELEASED, PublishedFigure

PAPER_SEQUENCES = ("061", "086", "096", "223", "225", "231", "249", "322")
_METRICS = (
    ("PQ", "panoptic", "PQ"),
    ("SQ", "panoptic", "SQ"),
    ("RQ", "panoptic", "RQ"),
    ("box mAP", "box", "mAP"),
    ("box mAP_re", "box", "mAP_re"),
    ("instance mAP", "instance", "mAP"),
)
_PUBLISHED = ((PAPER, ""), (PAPER_VOXBLOX, ""), (RELEASED, "raw"), (RELEASED, "76"))

Values = dict[str, dict[str, float]]
"""Percent by sequence, by figure."""


def table(
    figures: Iterable[PublishedFigure],
    ours: Sequence[str] = (),
    sequences: Sequence[str] | None = None,
) -> Table:
    """Percent; our sources first in every sequence, then what was published on it.

    Means are of the sequences for which a source has the figure; a number in brackets says how
    many, where these are not all of the heading.

    Args:
        figures: All of them.
        ours: Sources of our own, in order.
        sequences: By default all that any source has.
    """
    listed = [f for f in figures if f.class_name == MEAN]
    sources = [(source, None) for source in ours] + list(_PUBLISHED)
    values = {_title(*source): _values(listed, *source) for source in sources}
    known = sorted({f.sequence for f in listed if f.sequence != POOLED})
    shown = known if sequences is None else list(sequences)
    result = Table("sequence", "source", title="panoptic mapping on SceneNN, percent")
    for name, _, _ in _METRICS:
        result.add_column(name, justify="right")
    for sequence in shown:
        _add_section(result, sequence, values, (sequence,))
    _add_section(result, f"mean of these {len(shown)}", values, shown)
    if set(shown) != set(PAPER_SEQUENCES):
        _add_section(result, "mean of the paper's 8", values, PAPER_SEQUENCES)
    _add_section(result, "matches pooled", values, (POOLED,))
    return result


def _title(source: str, annotation: str | None) -> str:
    return f"{source}, {annotation}" if annotation else source


def _values(figures: list[PublishedFigure], source: str, annotation: str | None) -> Values:
    own = [f for f in figures if f.source == source and annotation in (None, f.annotation)]
    return {
        name: {f.sequence: f.percent for f in own if (f.scope, f.metric) == (scope, metric)}
        for name, scope, metric in _METRICS
    }


def _add_section(
    result: Table, heading: str, values: dict[str, Values], sequences: Sequence[str]
) -> None:
    """A row for each source that has any of these sequences."""
    for source, by_metric in values.items():
        cells = [_mean(by_metric[name], sequences) for name, _, _ in _METRICS]
        if any(cell != "-" for cell in cells):
            result.add_row(heading, source, *cells)
            heading = ""
    if heading:
        result.add_row(heading, "no figure")
    result.add_section()


def _mean(values: dict[str, float], sequences: Sequence[str]) -> str:
    found = [values[s] for s in sequences if s in values]
    if not found:
        return "-"
    return f"{np.mean(found):.1f}" + ("" if len(found) == len(sequences) else f" ({len(found)})")
