"""ShapeNetSem: OBJ models beside a ``metadata.csv`` that says class, up, front and unit.

``up`` and ``front`` are three numbers joined by escaped commas (``0\\,0\\,1``), ``unit`` is metres
a unit of the OBJ, ``fullId`` is ``wss.<name of the OBJ>``. Categories that begin with an
underscore mark properties, not classes.
"""

from __future__ import annotations

import csv
import dataclasses
import io
import posixpath

import numpy as np

from ....errors import LibraryError
from ..found import FoundModel
from ..names import shown
from .files import Files
from .limits import ReadLimits
from .rigid import read_mesh_model

_COLUMNS = {"fullId", "category", "up", "front", "unit"}
_LICENCE = "ShapeNet terms of use: research and education, not to be passed on"


def metadata_rows(files: Files, name: str) -> dict[str, dict[str, str]] | None:
    """Rows of a metadata table by the OBJ's stem; None where a CSV is another table.

    Raises:
        LibraryError: It is no table that can be read.
    """
    content = files.read(name)
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = content.decode("latin-1")
    try:
        rows = csv.DictReader(io.StringIO(text))
        if not set(rows.fieldnames or ()) >= _COLUMNS:
            return None
        found = [{k: v for k, v in row.items() if k and isinstance(v, str)} for row in rows]
    except csv.Error as error:
        raise LibraryError(f"{shown(name)} is no table: {error}", "restore the file") from None
    return {row["fullId"].rpartition(".")[2]: row for row in found if row.get("fullId")}


def described_meshes(files: Files, rows: dict[str, dict[str, str]]) -> dict[str, dict[str, str]]:
    """Rows by the OBJ that they describe, of those OBJ files that are there."""
    stems = {name: posixpath.splitext(posixpath.basename(name))[0] for name in files.names}
    return {
        name: rows[stem]
        for name, stem in stems.items()
        if name.lower().endswith(".obj") and stem in rows
    }


def read_row(files: Files, name: str, row: dict[str, str], limits: ReadLimits) -> FoundModel:
    """The model of one row; raises `LibraryError`."""
    found = read_mesh_model(files, name, limits)
    notes = list(found.notes)
    unit = _unit_m(row, notes)
    kinds = [word.strip() for word in row.get("category", "").split(",")]
    lemmas = [word.strip() for word in row.get("wnlemmas", "").split(",")]
    tags = [word.strip() for word in row.get("tags", "").replace("\\,", ",").split(",")]
    words = [k for k in kinds if not k.startswith("_")] + lemmas + [row.get("name", ""), *tags]
    return dataclasses.replace(
        found,
        unit_m=unit,
        up=_direction(row, "up", notes),
        front=_direction(row, "front", notes),
        tags=tuple(dict.fromkeys(word for word in words if word)),
        licence=_LICENCE,
        notes=tuple(notes),
    )


def _unit_m(row: dict[str, str], notes: list[str]) -> float | None:
    text = row.get("unit", "").strip()
    try:
        value = float(text) if text else 0.0
    except ValueError:
        value = -1.0
    if not (np.isfinite(value) and value > 0):
        if text:
            notes.append(f"unit {text!r} of the table is no length")
        return None
    return value


def _direction(row: dict[str, str], key: str, notes: list[str]) -> np.ndarray | None:
    text = row.get(key, "").replace("\\", "").strip()
    if not text:
        return None
    try:
        direction = np.array([float(v) for v in text.split(",")])
    except ValueError:
        direction = np.zeros(0)
    if direction.shape != (3,) or not 1e-6 < np.linalg.norm(direction) < 1e6:
        notes.append(f"{key} {text!r} of the table is no direction")
        return None
    return direction / np.linalg.norm(direction)
