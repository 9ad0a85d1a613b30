"""Ground truth of a ScanNet scan: mesh, segments of its vertices, and groups of segments.

``<scan>_vh_clean_2.ply``; ``<scan>_vh_clean_2.0.010000.segs.json`` (segIndices: a segment a
vertex); ``<scan>.aggregation.json`` (segGroups: objectId, label, segments); ``<scan>.txt``
(axisAlignment); and, beside the scan or above it, ``scannetv2-labels.combined.tsv``, which says the
NYU40 id of every label (raw_category, nyu40id) [ScanNet's README].
"""

from __future__ import annotations

import csv
import json
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float, Int

from ..errors import SequenceError
from .annotated_mesh import AnnotatedInstance, AnnotatedMesh, annotation_notes, read_mesh
from .annotation_names import class_of_name, class_of_nyu40

ANNOTATION = "ScanNet v2"
_MESH = "_vh_clean_2.ply"
_SEGMENTS = "_vh_clean_2.0.010000.segs.json"
_GROUPS = (".aggregation.json", "_vh_clean.aggregation.json")
_TABLE = "scannetv2-labels.combined.tsv"
_MAX_JSON_BYTES = 1 << 29
_HINT = "download the scan's annotation again"


def read_scannet_truth(folder: str | Path) -> AnnotatedMesh:
    """Read the mesh and annotation of a scan; ids are objectId + 1.

    A label is looked up by its own name first, which is finer than its NYU40 id.

    Raises:
        SequenceError: a file of the annotation is missing or damaged.
    """
    folder = Path(folder)
    ply = _one(folder, _MESH)
    scan = ply.name.removesuffix(_MESH)
    mesh, _ = read_mesh(ply)
    segments_file = _existing(folder, (scan + _SEGMENTS,))
    segment = _segments(segments_file, ply, len(mesh.vertices))
    groups_file = _existing(folder, tuple(scan + end for end in _GROUPS))
    groups = _groups(groups_file)
    table, table_note = _label_table(folder)
    instance, shared = _instances_of(groups, segment, groups_file)
    instances = tuple(
        AnnotatedInstance(id, label, class_of_name(label) or table.get(label), None)
        for id, label, _ in groups
    )
    notes = (*table_note, *shared, *annotation_notes(instances, instance))
    aligned = _axis_alignment(folder / f"{scan}.txt")
    return AnnotatedMesh(scan, ANNOTATION, mesh, instance, instances, notes, aligned)


def _one(folder: Path, ending: str) -> Path:
    found = sorted(folder.glob(f"*{ending}"))
    if len(found) != 1:
        names = ", ".join(p.name for p in found) or "none"
        raise SequenceError(
            f"{folder}: need one *{ending}, found {names}", "give the folder of one scan"
        )
    return found[0]


def _existing(folder: Path, names: tuple[str, ...]) -> Path:
    found = next((folder / n for n in names if (folder / n).is_file()), None)
    if found is None:
        raise SequenceError(f"{folder} has no {' or '.join(names)}", _HINT)
    return found


def _json(path: Path) -> dict[str, Any]:
    try:
        if path.stat().st_size > _MAX_JSON_BYTES:
            raise SequenceError(
                f"{path} is {path.stat().st_size} bytes long (at most {_MAX_JSON_BYTES})", _HINT
            )
        data = json.loads(path.read_text("utf-8"))
    except OSError as error:
        raise SequenceError(f"{path}: {error.strerror}", _HINT) from None
    except (ValueError, RecursionError) as error:
        raise SequenceError(f"{path} is not JSON: {error}", _HINT) from None
    if not isinstance(data, dict):
        raise SequenceError(f"{path} holds a {type(data).__name__}, not an object", _HINT)
    return data


def _segments(path: Path, ply: Path, count: int) -> Int[np.ndarray, " vertices"]:
    values = _json(path).get("segIndices")
    if not isinstance(values, list) or not all(_whole(v) for v in values):
        raise SequenceError(f"{path}: segIndices is no list of whole numbers", _HINT)
    if len(values) != count:
        raise SequenceError(
            f"{path} has {len(values)} segIndices, {ply.name} has {count} vertices",
            "take both of the same mesh (_vh_clean_2)",
        )
    return np.array(values, np.int64)


def _whole(value: Any) -> bool:
    return isinstance(value, int) and not isinstance(value, bool) and 0 <= value < 1 << 31


def _groups(path: Path) -> list[tuple[int, str, list[int]]]:
    """(instance id, label, segments) of every group."""
    found = _json(path).get("segGroups")
    groups = found if isinstance(found, list) else [None]
    checked = []
    for i, group in enumerate(groups):
        data = group if isinstance(group, dict) else {}
        id, label, segments = data.get("objectId"), data.get("label"), data.get("segments")
        listed = isinstance(segments, list) and all(_whole(v) for v in segments)
        if not (isinstance(id, int) and _whole(id) and isinstance(label, str) and listed):
            raise SequenceError(
                f"{path}: segGroups entry {i} is no {{objectId, label, segments}}", _HINT
            )
        checked.append((id + 1, label, segments))
    ids = [id for id, _, _ in checked]
    if len(set(ids)) != len(ids):
        twice = sorted({id - 1 for id in ids if ids.count(id) > 1})
        raise SequenceError(f"{path}: objectId {twice} stands more than once", _HINT)
    return checked


def _instances_of(
    groups: list[tuple[int, str, list[int]]], segment: np.ndarray, source: Path
) -> tuple[Int[np.ndarray, " vertices"], tuple[str, ...]]:
    """The instance of each vertex; a segment of several groups goes to the last."""
    known, row = np.unique(segment, return_inverse=True)
    place = {int(s): i for i, s in enumerate(known)}
    owner = np.zeros(len(known), np.int64)
    shared, absent = 0, 0
    for id, _, segments in groups:
        for s in set(segments):
            if s not in place:
                absent += 1
                continue
            shared += bool(owner[place[s]])
            owner[place[s]] = id
    notes = []
    if shared:
        notes.append(f"{source.name}: {shared} segments are in several groups; the last has them")
    if absent:
        notes.append(f"{source.name} names {absent} segments that the mesh does not have")
    return owner[row.reshape(-1)], tuple(notes)


def _label_table(folder: Path) -> tuple[dict[str, str | None], tuple[str, ...]]:
    """Our class of each raw category, from the table in the folder or in one of the two above."""
    places = (folder / _TABLE, folder.parent / _TABLE, folder.parent.parent / _TABLE)
    path = next((p for p in places if p.is_file()), None)
    if path is None:
        return {}, (f"no {_TABLE} beside the scan or above it: labels are known by name alone",)
    try:
        with path.open(encoding="utf-8", newline="") as file:
            rows = list(csv.DictReader(file, delimiter="\t"))
        table = {r["raw_category"]: class_of_nyu40(int(r["nyu40id"] or 0)) for r in rows}
    except (OSError, ValueError, KeyError, TypeError, csv.Error) as error:
        raise SequenceError(
            f"{path}: {type(error).__name__} {error}",
            "it needs the tab-separated columns raw_category and nyu40id",
        ) from None
    return table, ()


def _axis_alignment(path: Path) -> Float[np.ndarray, "4 4"] | None:
    try:
        lines = path.read_text("utf-8").splitlines()
    except FileNotFoundError:
        return None
    except (OSError, ValueError) as error:
        raise SequenceError(f"{path}: {error}", _HINT) from None
    pairs = dict(line.split("=", 1) for line in lines if "=" in line)
    text = next((v for k, v in pairs.items() if k.strip() == "axisAlignment"), None)
    if text is None:
        return None
    try:
        values = np.array([float(v) for v in text.split()])
    except ValueError:
        values = np.zeros(0)
    if len(values) != 16 or not np.isfinite(values).all():
        raise SequenceError(f"{path}: axisAlignment = {text.strip()[:80]!r}", "it is 16 numbers")
    return values.reshape(4, 4)
