"""The default set: several sizes and styles of each class, by id."""

from __future__ import annotations

import difflib
import itertools

from ...errors import SettingError
from ...library import CadModel
from .appliances import catalogue as appliances
from .furniture import (
    catalogue_bedroom,
    catalogue_seating,
    catalogue_storage,
    catalogue_tables,
)
from .rows import Row
from .things import catalogue as things

_GROUPS = (
    appliances.ROWS,
    catalogue_bedroom.ROWS,
    catalogue_seating.ROWS,
    catalogue_storage.ROWS,
    catalogue_tables.ROWS,
    things.ROWS,
)


KIT: dict[str, Row] = {
    f"{class_name}/{row.name}": row
    for class_name, rows in itertools.chain.from_iterable(group.items() for group in _GROUPS)
    for row in rows
}
"""What makes each model, by its id."""


def row_of(cad_id: str) -> Row:
    """The row of an id; raises `SettingError` naming the nearest ids of the kit."""
    if cad_id not in KIT:
        near = difflib.get_close_matches(cad_id, KIT, n=3) or sorted(KIT)[:3]
        raise SettingError(f"the kit makes no {cad_id!r}", f"use one of: {', '.join(near)}, ...")
    return KIT[cad_id]


def make(cad_id: str, detail: str = "medium") -> CadModel:
    """Build one model of `KIT`.

    Args:
        cad_id: ``<class>/<name>``.
        detail: Round parts have 8 (``low``), 16 (``medium``) or 32 (``high``) sides.

    Raises:
        SettingError: the kit has no such model, or there is no such level of detail.
    """
    row = row_of(cad_id)
    return row.design(detail=detail).build(row.name)
