"""One published figure a row: ``scenenn.csv``, read and written."""

from __future__ import annotations

import csv
import dataclasses
from collections.abc import Iterable
from pathlib import Path

from isr_jax.errors import OutputError

TABLE = Path(__file__).with_name("scenenn.csv")

PAPER, PAPER_VOXBLOX, RELEASED = "paper", "paper: voxblox++", "released code"
"""Sources: Table I of the paper, its Voxblox++ rows, the result files of the released code."""
MEAN = "mean"
"""The class of an average over classes."""
POOLED = "pooled"
"""The sequence of figures whose matches were counted over all sequences together."""


@dataclasses.dataclass(frozen=True, order=True)
class PublishedFigure:
    """One figure of one sequence."""

    source: str
    sequence: str
    """SceneNN id, or `POOLED`."""
    annotation: str
    """``raw`` or ``76``, as the result files are named; empty where the source does not say."""
    scope: str
    """``panoptic``, ``instance`` (masks) or ``box``."""
    class_name: str
    """Ours, or `MEAN`."""
    metric: str
    """``PQ``, ``SQ``, ``RQ``, ``AP`` of a class; ``mAP`` and ``mAP_re`` of the mean."""
    percent: float


_COLUMNS = [field.name for field in dataclasses.fields(PublishedFigure)]


def read_published(path: Path = TABLE) -> tuple[PublishedFigure, ...]:
    """All rows, in the order of the file.

    Raises:
        OutputError: the file is not there or is no such table.
    """
    hint = "restore experiments/published/scenenn.csv"
    try:
        with path.open(newline="", encoding="utf-8") as file:
            rows = list(csv.reader(file))
        if not rows or rows[0] != _COLUMNS:
            raise ValueError(f"its columns are not {', '.join(_COLUMNS)}")
        return tuple(_figure(*row) for row in rows[1:])
    except (OSError, ValueError, TypeError) as error:
        raise OutputError(f"{path} cannot be read: {error}", hint) from None


def _figure(
    source: str,
    sequence: str,
    annotation: str,
    scope: str,
    class_name: str,
    metric: str,
    percent: str,
) -> PublishedFigure:
    value = float(percent)
    return PublishedFigure(source, sequence, annotation, scope, class_name, metric, value)


def write_published(figures: Iterable[PublishedFigure], path: Path = TABLE) -> None:
    """Write them, sorted; percent with four decimals."""
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(_COLUMNS)
        for figure in sorted(figures):
            writer.writerow([*dataclasses.astuple(figure)[:-1], f"{figure.percent:.4f}"])
