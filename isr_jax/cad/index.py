"""Border: the models below a folder, read once and kept in the user's cache.

The cache holds all but links and meshes: records, planes, surface samples. It is named by root,
and by path, time and size of every ``model.json`` and ``model.urdf``: what did not change is not
opened. Where some did, those alone are read; samples go by content hash, so that moved and copied
models keep theirs. A mesh that was changed by itself is noticed when its model is used.
"""

from __future__ import annotations

import contextlib
import dataclasses
import functools
import hashlib
import json
import logging
import os
import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np

from ..geometry.surface_samples import SurfaceSamples, surface_samples
from ..library import CadModel
from ..robot_model import merged_mesh
from ..runtime.caches import user_cache_dir
from ..types import PlaneSet
from .model_files import read_model, read_record, robot_loader
from .packed_file import read_packed, write_packed
from .records import Record, model_of, planes_of

Progress = Callable[[int, int], None]
Stamp = tuple[int, int, int, int]

INDEX_VERSION = 1
"""Raised when what is kept or how it is computed changes."""
SAMPLES = 512
"""Points on the surface of each model."""
_SAMPLE_ARRAYS = ("points", "point_normals")
_LOG = logging.getLogger(__name__)


@dataclasses.dataclass(frozen=True, eq=False)
class _Entry:
    """One model as the index keeps it."""

    stamp: Stamp
    content_hash: str
    record: Record
    """Without its planes and the digests of its files."""
    planes: tuple[PlaneSet, tuple[str, ...], np.ndarray]
    samples: SurfaceSamples | None
    """None where the model shows no surface."""


def models_below(root: Path, progress: Progress | None = None) -> tuple[CadModel, ...]:
    """Every model in ``root/<class>/<name>/``, by id; links and meshes are read when used.

    Args:
        root: Of the library.
        progress: Told (done, total) while models are read that the cache does not hold.

    Raises:
        LibraryError: a model that cannot be used.
    """
    stamps = _stamps(root)
    if not stamps:
        return ()
    path = _cache_of(root) / f"{_digest([INDEX_VERSION, stamps])}.index"
    entries = _read(path)
    if entries is None or list(entries) != list(stamps):
        entries = _refreshed(root, stamps, _latest(path.parent), progress)
        _write(path, root, entries)
    return tuple(_model(root, path, row, name, e) for row, (name, e) in enumerate(entries.items()))


def _stamps(root: Path) -> dict[str, Stamp]:
    """What the file system says of each model, by id."""
    found = {}
    for kind in sorted(e.name for e in os.scandir(root) if e.is_dir()):
        for name in sorted(e.name for e in os.scandir(root / kind) if e.is_dir()):
            folder = os.path.join(root, kind, name)
            record = _time_and_size(os.path.join(folder, "model.json"))
            if record != (0, 0):
                links = _time_and_size(os.path.join(folder, "model.urdf"))
                found[f"{kind}/{name}"] = (*record, *links)
    return found


def _time_and_size(path: str) -> tuple[int, int]:
    try:
        stat = os.stat(path)
    except FileNotFoundError:
        return 0, 0
    return stat.st_mtime_ns, stat.st_size


def _cache_of(root: Path) -> Path:
    return user_cache_dir() / "library" / _digest(str(root.resolve()))


def _digest(data) -> str:
    return hashlib.sha256(json.dumps(data).encode()).hexdigest()[:24]


def _latest(folder: Path) -> dict[str, _Entry]:
    """Entries of the newest index in a folder that can be read, or none."""
    files = sorted(folder.glob("*.index"), key=lambda file: -_time_and_size(str(file))[0])
    return next((found for file in files if (found := _read(file)) is not None), {})


def _refreshed(
    root: Path, stamps: dict[str, Stamp], known: dict[str, _Entry], progress: Progress | None
) -> dict[str, _Entry]:
    """Entries of all models: known ones where nothing changed, the others read."""
    same = {n: known[n] for n, stamp in stamps.items() if n in known and known[n].stamp == stamp}
    by_hash = {entry.content_hash: entry for entry in known.values()}
    total, done, entries = len(stamps) - len(same), 0, {}
    _LOG.info("reading %d of %d models of %s for the first time", total, len(stamps), root)
    for name, stamp in stamps.items():
        if name not in same:
            entry = _entry(root / name, stamp, by_hash)
            by_hash[entry.content_hash] = same[name] = entry
            done += 1
            if progress is not None:
                progress(done, total)
        entries[name] = same[name]
    return entries


def _entry(folder: Path, stamp: Stamp, by_hash: dict[str, _Entry]) -> _Entry:
    record = read_record(folder)
    twin = by_hash.get(record.get("content_hash", ""))
    if twin is not None:
        samples = twin.samples
    else:
        record, robot = read_model(folder)
        mesh = merged_mesh(robot)
        found = surface_samples(mesh.vertices, mesh.faces, SAMPLES)
        samples = found if len(found.points) else None
    kept = {k: v for k, v in record.items() if k not in ("planes", "files")}
    return _Entry(stamp, record["content_hash"], kept, planes_of(record), samples)


def _model(root: Path, path: Path, row: int, name: str, entry: _Entry) -> CadModel:
    robot, samples = robot_loader(root / name, entry.content_hash), None
    if entry.samples is not None:
        samples = functools.partial(_kept_samples, path, row, robot)
    return model_of(entry.record, name, entry.content_hash, entry.planes, robot, samples)


def _kept_samples(path: Path, row: int, load_robot) -> SurfaceSamples:
    """Samples of a model out of an index, or made again if that is gone."""
    try:
        points, normals = _kept_arrays(path)
    except (OSError, ValueError):
        mesh = merged_mesh(load_robot())
        return surface_samples(mesh.vertices, mesh.faces, SAMPLES)
    return SurfaceSamples(points[row], normals[row].astype(np.float32))


@functools.lru_cache(maxsize=8)
def _kept_arrays(path: Path) -> tuple[np.ndarray, np.ndarray]:
    arrays = read_packed(path)[1]
    return arrays["points"], arrays["point_normals"]


def _write(path: Path, root: Path, entries: dict[str, _Entry]) -> None:
    """Keep the entries, and drop older indices and those of libraries that are gone."""
    planes = [entry.planes[0] for entry in entries.values()]
    none = SurfaceSamples(*np.zeros((2, SAMPLES, 3), np.float32))
    samples = [entry.samples or none for entry in entries.values()]
    rows = [
        [name, e.stamp, e.record, e.planes[1], e.samples is not None] for name, e in entries.items()
    ]
    arrays = {
        "count": np.array([len(p.offset) for p in planes], np.int64),
        "normal": np.concatenate([p.normal for p in planes]),
        "offset": np.concatenate([p.offset for p in planes]),
        "corners": np.concatenate([p.corners for p in planes]),
        "area_m2": np.concatenate([p.area_m2 for p in planes]),
        "supporting": np.concatenate([e.planes[2] for e in entries.values()]),
        "points": np.stack([s.points for s in samples]),
        "point_normals": np.stack([s.normals for s in samples]).astype(np.float16),
    }
    try:
        write_packed(path, [INDEX_VERSION, rows], arrays, _SAMPLE_ARRAYS)
        (path.parent / "root.txt").write_text(str(root.resolve()), "utf-8")
        for old in path.parent.glob("*.index"):
            if old != path:
                with contextlib.suppress(OSError):  # Windows keeps files that are mapped
                    old.unlink()
        _drop_orphans(path.parent.parent)
    except OSError as error:
        _LOG.warning("%s is not kept for the next time: %s", root, error)


def _drop_orphans(cache: Path) -> None:
    for said in cache.glob("*/root.txt"):
        if not Path(said.read_text("utf-8")).is_dir():
            shutil.rmtree(said.parent, ignore_errors=True)


def _read(path: Path) -> dict[str, _Entry] | None:
    """Entries of an index; None where there is none, or (said in the log) a damaged one."""
    try:
        (version, rows), arrays = read_packed(path)
        if version != INDEX_VERSION:
            raise ValueError(f"{path} is of version {version}")
        return _entries(rows, arrays)
    except FileNotFoundError:
        return None
    except (OSError, ValueError, KeyError) as error:
        _LOG.warning("the kept index of a CAD library is made again: %s", error)
        return None


def _entries(rows: list, arrays: dict[str, np.ndarray]) -> dict[str, _Entry]:
    ends = np.cumsum(arrays["count"]).tolist()
    valid = np.ones(max([0, *ends]), bool)
    found, start = {}, 0
    for row, ((name, stamp, record, links, sampled), end) in enumerate(zip(rows, ends)):
        own = slice(start, end)
        planes = PlaneSet(
            arrays["normal"][own],
            arrays["offset"][own],
            arrays["corners"][own],
            arrays["area_m2"][own],
            valid[own],
        )
        samples = None
        if sampled:
            samples = SurfaceSamples(arrays["points"][row], arrays["point_normals"][row])
        owned = planes, tuple(links), arrays["supporting"][own]
        found[name] = _Entry(tuple(stamp), record["content_hash"], record, owned, samples)
        start = end
    return found
