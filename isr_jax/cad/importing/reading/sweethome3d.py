"""Furniture catalogues of Sweet Home 3D: ``.sh3f`` archives of OBJ models with a table.

``PluginFurnitureCatalog.properties`` numbers its entries: ``id#1``, ``name#1``, ``model#1``, ...
Lengths are centimetres: ``width`` x, ``depth`` z, ``height`` y of the model once
``modelRotation`` (rows of a matrix) has turned it; then y is up and it faces +z. Models are
stretched to the stated size, so the file's own unit means nothing.
"""

from __future__ import annotations

import posixpath

import numpy as np

from ....errors import LibraryError
from ..found import FoundModel
from ..names import shown
from .files import Files, ZipFiles, within
from .limits import ReadLimits
from .mesh_headers import MESH_ENDINGS
from .mesh_parts import Shape, moved
from .mesh_shapes import read_shape
from .properties import read_properties
from .rigid import rigid_robot

CATALOGUE = "PluginFurnitureCatalog.properties"
_CATALOGUE_KEYS = ("license", "name", "provider")
_SIZE_KEYS = ("width", "depth", "height")


def catalogue_entries(files: Files) -> list[dict[str, str]]:
    """One table an entry, in the catalogue's order; catalogue-wide values are under ``catalogue.``.

    Raises:
        LibraryError: There is no catalogue, or no entry in it.
    """
    table = read_properties(files.read(CATALOGUE))
    wide = {f"catalogue.{key}": table[key] for key in _CATALOGUE_KEYS if key in table}
    entries: dict[int, dict[str, str]] = {}
    for key, value in table.items():
        name, _, number = key.partition("#")
        if number.isdigit() and len(number) < 9:
            entries.setdefault(int(number), dict(wide))[name] = value
    if not entries:
        raise LibraryError(f"the catalogue of {files.label} lists nothing", "give another archive")
    return [entries[number] for number in sorted(entries)]


def entry_name(entry: dict[str, str]) -> str:
    """What an entry is called: the last part of its id, else its model's file, else its name."""
    named = entry.get("id", "").rpartition("#")[2]
    stem = posixpath.splitext(posixpath.basename(entry.get("model", "")))[0]
    return named or stem or entry.get("name", "model")


def read_entry(files: Files, entry: dict[str, str], limits: ReadLimits) -> FoundModel:
    """The model of one entry; raises `LibraryError`."""
    name = entry_name(entry)
    source = f"{files.label}/{shown(name)}"
    model = within("", entry.get("model", "").lstrip("/"))
    if not model:
        raise LibraryError(f"{source} names no model", "repair the catalogue")
    shape, notes = _turned(_model_shape(files, model, limits), entry.get("modelRotation"))
    opening = entry.get("doorOrWindow", "").lower() == "true"
    return FoundModel(
        name=name,
        source=source,
        robot=rigid_robot(shape, name),
        up=np.array([0.0, 1.0, 0.0]),
        front=np.array([0.0, 0.0, 1.0]),
        size_m=_size_m(entry, source),
        tags=_tags(entry, model),
        licence=entry.get("license") or entry.get("catalogue.license"),
        creator=entry.get("creator") or entry.get("catalogue.provider"),
        mount="opening" if opening else None,
        elevation_m=_elevation_m(entry),
        notes=(*shape.notes, *notes),
    )


def _model_shape(files: Files, model: str, limits: ReadLimits) -> Shape:
    """The mesh of an entry, which may be in an archive of its own."""
    if not model.lower().endswith(".zip"):
        if not model.lower().endswith(MESH_ENDINGS):
            problem = f"{shown(model)} is of a format that is not read"
            raise LibraryError(problem, f"give one of {', '.join(MESH_ENDINGS)}")
        return read_shape(files, model, limits)
    inner = ZipFiles(files.read(model), f"{files.label}/{model}", limits)
    meshes = [name for name in inner.names if name.lower().endswith(MESH_ENDINGS)]
    if not meshes:
        raise LibraryError(f"{inner.label} holds no mesh", "pack the model's file into it")
    return read_shape(inner, min(meshes, key=lambda name: (name.count("/"), name)), limits)


def _turned(shape: Shape, rotation: str | None) -> tuple[Shape, tuple[str, ...]]:
    """The shape as the catalogue turns it: y up, facing +z."""
    if not rotation:
        return shape, ()
    try:
        R = np.array([float(v) for v in rotation.split()]).reshape(3, 3)
        u, size, vt = np.linalg.svd(R)
    except ValueError:
        return shape, (f"modelRotation {rotation!r} is no matrix: not turned",)
    if not np.all(np.isfinite(size)) or np.ptp(size) > 0.01 or abs(size[0] - 1) > 0.01:
        return shape, (f"modelRotation {rotation!r} is no rotation: not turned",)
    T = np.eye(4)
    T[:3, :3] = u @ vt
    return moved(shape, T), ()


def _number(entry: dict[str, str], key: str) -> float | None:
    try:
        value = float(entry[key])
    except (KeyError, ValueError):
        return None
    return value if np.isfinite(value) else None


def _size_m(entry: dict[str, str], source: str) -> np.ndarray | None:
    sizes = [_number(entry, key) for key in _SIZE_KEYS]
    if any(size is None for size in sizes):
        return None
    size_m = np.array(sizes, np.float64) / 100.0
    if np.any(size_m <= 0) or np.any(size_m > 1000):
        problem = f"{source} states a size of {size_m.tolist()} m"
        raise LibraryError(problem, "repair width, depth and height of the catalogue")
    return size_m


def _elevation_m(entry: dict[str, str]) -> float | None:
    value = _number(entry, "elevation")
    return None if value is None else value / 100.0


def _tags(entry: dict[str, str], model: str) -> tuple[str, ...]:
    stem = posixpath.splitext(posixpath.basename(model))[0]
    stairs = ["stairs"] if "staircaseCutOutShape" in entry else []
    words = [word.strip() for word in entry.get("tags", "").split(",")]
    every = [*stairs, entry.get("name", ""), entry_name(entry), stem, *words]
    return tuple(dict.fromkeys(w for w in [*every, entry.get("category", "")] if w))
