"""A row of the tidy table, and reports as rows: every number by its dotted path."""

from __future__ import annotations

import dataclasses
import functools
import math
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from isr_jax.classes import classes
from isr_jax.evaluation import EvaluationReport
from isr_jax.stability import StabilityReport


@dataclasses.dataclass(frozen=True)
class Row:
    """One value of one run. ``tuple(Row.__annotations__)`` are the columns of the table."""

    room: str
    kind: str
    """Of the room: kitchen, office, ..."""
    split: str
    """``in-library`` or ``held-out``."""
    seed: int
    preset: str
    level: str
    """Of the simulated masks; empty where the truth stands in for what follows them."""
    truth_up_to: str
    """The last stage whose result was replaced by the truth; ``none`` end to end."""
    stage: str
    metric: str
    class_name: str
    """Empty where the value is over all classes."""
    value: float | None
    note: str = ""
    """Of a failed run: what went wrong, and the file with the traceback."""


@dataclasses.dataclass(frozen=True)
class Value:
    """A number of a report."""

    stage: str
    metric: str
    class_name: str
    value: float


_STAGE_OF = {
    "panoptic": "mapping",
    "instances": "mapping",
    "surface": "mapping",
    "observed_boxes": "entities",
    "matches": "entities",
    "unseen": "entities",
    "boxes": "contact_graph",
    "supports": "contact_graph",
    "proximal": "contact_graph",
    "attachments": "contact_graph",
    "support_planes": "contact_graph",
    "retrieval": "matching",
    "scan2cad": "alignment",
    "cad": "alignment",
    "chamfer": "alignment",
    "standing": "stability",
}
"""Parts of `EvaluationReport` and the stage that each judges most: that of the first name on a
path that is listed. What is not listed is judged of the whole scene."""
WHOLE = "scene"
_LIMIT = "limit_m"
"""What each row of a list has that gives one value per limit."""
_SETTINGS = frozenset({"limits", _LIMIT})
"""Fields that say how was measured, not what."""
_ENTITY_FIELDS = frozenset({"truth", "name", "entity", "id"})
"""What a row of one entity has, and a row of one class has not."""
_Path = tuple[str, ...]


def flatten(report: EvaluationReport, stability: StabilityReport) -> list[Value]:
    """Every number of both reports; measures that are added there appear by themselves."""
    settled = [
        Value("stability", ".".join(path), class_name, value)
        for path, class_name, value in _numbers(stability, ())
    ]
    return [*scored(report), *settled]


def scored(report: Any) -> list[Value]:
    """Every number of an `EvaluationReport`, or of a record with some parts of one.

    Fields and derived properties are walked. A list with one row per class gives one value
    per class, with one row per limit one value per limit; a list of entities or bodies gives their
    count, mean and maximum. None is left out.
    """
    return [
        Value(_stage(path), ".".join(path), class_name, value)
        for path, class_name, value in _numbers(report, ())
    ]


def _stage(path: _Path) -> str:
    return next((_STAGE_OF[name] for name in path if name in _STAGE_OF), WHOLE)


def _numbers(value: Any, path: _Path) -> Iterator[tuple[_Path, str, float]]:
    """(path, class, number) of everything below a value."""
    if isinstance(value, (bool, int, float, np.number, np.bool_)):
        if math.isfinite(value):
            yield path, "", float(value)
    elif _is_record(value):
        for name in _names(type(value)):
            yield from _numbers(getattr(value, name), (*path, name))
    elif isinstance(value, Mapping):
        yield from _of_mapping(value, path)
    elif isinstance(value, (tuple, list)):
        yield from _of_list(value, path)


@functools.cache
def _names(kind: type) -> tuple[str, ...]:
    """Fields, then properties, but for settings and identities."""
    fields = [f.name for f in dataclasses.fields(kind)]
    derived = [k for k, v in vars(kind).items() if isinstance(v, property)]
    return tuple(n for n in (*fields, *derived) if n not in _SETTINGS and n[0] != "_")


def _of_mapping(values: Mapping[Any, Any], path: _Path) -> Iterator[tuple[_Path, str, float]]:
    known = {info.name for info in classes()}
    if values and all(key in known for key in values):
        for key, value in values.items():
            for found, _, number in _numbers(value, path):
                yield found, str(key), number
    else:
        yield from _summary(list(values.values()), path)


def _of_list(
    values: tuple[Any, ...] | list[Any], path: _Path
) -> Iterator[tuple[_Path, str, float]]:
    if values and all(_is_of_class(value) for value in values):
        for value in values:
            for found, _, number in _numbers(value, path):
                yield found, value.class_name, number
    elif values and all(hasattr(value, _LIMIT) for value in values):
        for value in values:
            yield from _numbers(value, (*path, f"{getattr(value, _LIMIT):g}"))
    else:
        yield from _summary(values, path)


def _is_of_class(value: Any) -> bool:
    fields = {f.name for f in dataclasses.fields(value)} if _is_record(value) else set()
    return "class_name" in fields and not fields & _ENTITY_FIELDS


def _is_record(value: Any) -> bool:
    return dataclasses.is_dataclass(value) and not isinstance(value, type)


def _summary(
    values: tuple[Any, ...] | list[Any], path: _Path
) -> Iterator[tuple[_Path, str, float]]:
    """Count, and mean and maximum of each number that the items have."""
    yield (*path, "count"), "", float(len(values))
    gathered: dict[_Path, list[float]] = {}
    for value in values:
        for found, _, number in _numbers(value, ()):
            gathered.setdefault(found, []).append(number)
    for found, numbers in gathered.items():
        yield (*path, *found, "mean"), "", float(np.mean(numbers))
        yield (*path, *found, "max"), "", float(np.max(numbers))
