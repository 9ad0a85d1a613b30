"""The one table of classes, read from ``classes.csv``.

Row 0 is "none". Every id in this package (`class_id`) is a row of this table. Its label columns say
what each label of a foreign data set is to us.
"""

from __future__ import annotations

import csv
import dataclasses
import difflib
import functools
from importlib import resources
from typing import Literal, cast

import numpy as np

from ..errors import ClassError
from .label_lists import LABEL_SETS, label_list

ClassKind = Literal["none", "thing", "layout", "stuff", "dynamic"]
"""What a class is to the map: nothing, things that can be told apart, floor, wall and ceiling, what
is in the map but never an entity, and what moves and is never mapped."""
Mount = Literal["floor", "surface", "wall", "opening"]
"""What such a thing is fixed to or stands on."""


@dataclasses.dataclass(frozen=True)
class ClassInfo:
    """One row of the table."""

    id: int
    name: str
    kind: ClassKind
    functional: bool
    """A CAD model may stand for it."""
    articulated: bool
    movable: bool
    """True: a free joint in simulation. False: it stands fixed."""
    mount: Mount
    density_kg_m3: float
    """Of the scan mesh's filled hull, when no CAD gives a mass."""
    match_group: str
    """Classes of one group may match each other's models."""
    hung_class: str
    """What such a thing is called where it hangs high on a wall; empty: the same."""
    min_diagonal_m: float
    """About 0.4 times the diagonal of a typical instance: what is smaller is a fragment."""
    labels: dict[str, tuple[int, ...]]
    """Ids in foreign label sets, keyed by `LABEL_SETS`; those of row 0 have no class here."""


@functools.cache
def classes() -> tuple[ClassInfo, ...]:
    """All rows, `classes()[i].id == i`."""
    text = resources.files("isr_jax.classes").joinpath("classes.csv").read_text("utf-8")
    rows = csv.DictReader(line for line in text.splitlines() if not line.startswith("#"))
    return tuple(_parse(i, row) for i, row in enumerate(rows))


def _parse(index: int, row: dict[str, str]) -> ClassInfo:
    return ClassInfo(
        id=index,
        name=row["name"],
        kind=cast(ClassKind, row["kind"]),
        functional=row["functional"] == "1",
        articulated=row["articulated"] == "1",
        movable=row["movable"] == "1",
        mount=cast(Mount, row["mount"]),
        density_kg_m3=float(row["density_kg_m3"]),
        match_group=row["match_group"] or row["name"],
        hung_class=row["hung_class"],
        min_diagonal_m=float(row["min_diagonal_m"]),
        labels={s: tuple(int(v) for v in row[s].split(";") if v) for s in LABEL_SETS},
    )


@functools.cache
def _by_name() -> dict[str, ClassInfo]:
    return {info.name: info for info in classes()}


def class_named(name: str) -> ClassInfo:
    """The row called ``name``; raises `ClassError` naming the nearest known classes."""
    info = _by_name().get(name)
    if info is None:
        near = difflib.get_close_matches(name, _by_name(), n=3) or sorted(_by_name())
        raise ClassError(f"unknown class {name!r}", f"use one of: {', '.join(near)}")
    return info


@functools.cache
def label_table(label_set: str) -> np.ndarray:
    """Lookup [max id + 1] from a foreign label set (`LABEL_SETS`) to rows; 0 where unmapped."""
    table = np.zeros(max(label.id for label in label_list(label_set)) + 1, np.int32)
    for info in classes():
        table[list(info.labels[label_set])] = info.id
    return table
