"""The official labels of foreign data sets: ids and names, read from ``label_sets/``.

What each of them is to us stands in ``classes.csv`` alone; see `classes.label_table`.
"""

from __future__ import annotations

import csv
import dataclasses
import functools
from importlib import resources

from ..errors import ClassError

LABEL_SETS = (
    "coco80",
    "coco_panoptic",
    "ade20k",
    "ade32",
    "nyu40",
    "scannet",
    "scannet200",
    "scenenn",
)
_FILES = {"scenenn": "nyu40"}
"""Sets that share another's list."""


@dataclasses.dataclass(frozen=True)
class Label:
    """One label of a foreign set."""

    id: int
    name: str
    is_thing: bool
    """Its instances are told apart; False: all of it in an image is one segment."""


@functools.cache
def label_list(label_set: str) -> tuple[Label, ...]:
    """All labels of a set of `LABEL_SETS`, in official order.

    Raises:
        ClassError: There is no such set.
    """
    if label_set not in LABEL_SETS:
        raise ClassError(f"unknown label set {label_set!r}", f"use one of: {', '.join(LABEL_SETS)}")
    file = resources.files("isr_jax.classes").joinpath(
        "label_sets", f"{_FILES.get(label_set, label_set)}.csv"
    )
    lines = file.read_text("utf-8").splitlines()
    rows = csv.DictReader(line for line in lines if not line.startswith("#"))
    return tuple(Label(int(r["id"]), r["name"], r["thing"] == "1") for r in rows)
