"""Made ``scenenn.csv``, once, from the files in which the figures came.

python -m experiments.published.gather FOLDER

FOLDER holds ``released_code_scenenn_raw.json`` and ``released_code_scenenn_76.json``, the two
result files of the released code's repository, and ``paper_table1.json``, Table I typed off.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import tyro

from .figures import (
    MEAN,
    PAPER,
    PAPER_VOXBLOX,
    POOLED,
    RELEASED,
    TABLE,
    PublishedFigure,
    write_published,
)

ANNOTATIONS = ("raw", "76")
_OURS = {"Backpack": "bag", "TV": "monitor", "Refrigerator": "fridge", "Couch": "sofa"}
"""Their names of classes that differ by more than a capital."""
_SCOPES = {"pano": "panoptic", "inst": "instance", "bbox": "box"}
_PAPER_SCOPES = {"mAP": "box", "mAP_re": "box"}


def gather(folder: Path) -> list[PublishedFigure]:
    """All figures of the three files."""
    return [*_paper(_json(folder / "paper_table1.json")), *_released(folder)]


def main(folder: tyro.conf.Positional[Path]) -> None:
    """Write the table anew from the files in a folder."""
    write_published(gather(folder), TABLE)


def _json(path: Path) -> dict[str, Any]:
    return json.loads(path.read_text("utf-8"))


def _paper(table: dict[str, Any]) -> Iterator[PublishedFigure]:
    for key, source in (("ours", PAPER), ("voxblox++", PAPER_VOXBLOX)):
        for sequence, values in table[key].items():
            # The rows of Voxblox++ end before mAP_re, which it does not have.
            for metric, percent in zip(table["columns"], values):
                scope = _PAPER_SCOPES.get(metric, "panoptic")
                yield PublishedFigure(source, sequence, "", scope, MEAN, metric, percent)


def _released(folder: Path) -> Iterator[PublishedFigure]:
    for annotation in ANNOTATIONS:
        results = _json(folder / f"released_code_scenenn_{annotation}.json")
        for sequence, scopes in results.items():
            name = POOLED if sequence == "average" else sequence
            for scope, classes in scopes.items():
                for theirs, metrics in classes.items():
                    for metric, percent in metrics.items():
                        yield _figure(name, annotation, scope, theirs, metric, percent)


def _figure(
    sequence: str, annotation: str, scope: str, theirs: str, metric: str, percent: float
) -> PublishedFigure:
    mean = theirs == "average"
    name = MEAN if mean else _OURS.get(theirs, theirs.lower())
    # Their means are called mPQ, mSQ, mRQ, mAP.
    metric = metric.removeprefix("m") if mean and metric != "mAP" else metric
    return PublishedFigure(
        RELEASED, sequence, annotation, _SCOPES[scope], name, metric, round(percent, 4)
    )


if __name__ == "__main__":
    tyro.cli(main)
