"""Border: one CAD model as files: ``model.json``, ``model.urdf`` and ``meshes/``."""

from __future__ import annotations

import dataclasses
import functools
import hashlib
import json
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from ..errors import LibraryError, OutputError, SceneError
from ..library import CadModel, held
from ..robot_model import RobotModel, read_urdf, urdf_files
from ..robot_model.mtl import IMAGE_ENDINGS
from .records import (
    Record,
    check_links,
    check_record,
    model_of,
    planes_of,
    record_of,
)

_MESH_ENDINGS = (".obj", ".mtl", *IMAGE_ENDINGS)


def model_files(model: CadModel) -> dict[str, bytes]:
    """Contents by relative path, with the hash of all the rest in ``model.json``."""
    files, record = _described(model)
    files["model.json"] = (json.dumps(record, indent=1) + "\n").encode()
    return files


def with_content_hash(model: CadModel) -> CadModel:
    """The model, its ``content_hash`` computed from what would be written."""
    return dataclasses.replace(model, content_hash=_described(model)[1]["content_hash"])


def _described(model: CadModel) -> tuple[dict[str, bytes], Record]:
    files, record = urdf_files(model.robot), record_of(model)
    record["files"] = _digests(files)
    record["content_hash"] = content_hash(files, record)
    return files, record


def content_hash(files: dict[str, bytes], record: Record) -> str:
    """SHA-256 over geometry files and ``model.json``, its own entry left out."""
    digest = hashlib.sha256()
    rest = {k: v for k, v in record.items() if k != "content_hash"}
    for name, content in [*sorted(files.items()), ("", json.dumps(rest, sort_keys=True).encode())]:
        digest.update(f"{name}\0{len(content)}\0".encode() + content)
    return digest.hexdigest()


def _digests(files: dict[str, bytes]) -> dict[str, str]:
    """Which of the files changed, in case one did."""
    return {name: hashlib.sha256(files[name]).hexdigest()[:16] for name in sorted(files)}


def save_model(model: CadModel, root: Path) -> Path:
    """Write a model into ``root/<class>/<name>/``; returns that folder.

    Mesh files of an older model in that folder go.

    Raises:
        OutputError: The folder cannot be written.
    """
    folder, files = root / model.id, model_files(model)
    path = folder
    try:
        for path in _mesh_paths(folder):
            if path.relative_to(folder).as_posix() not in files:
                path.unlink()
        for name, content in files.items():
            path = folder / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(content)
    except OSError as error:
        problem = f"{path}: {error.strerror}"
        raise OutputError(problem, "give a library folder that can be written") from None
    return folder


def load_model(folder: Path, root: Path) -> CadModel:
    """Read one model folder whole; raises `LibraryError` naming the file that cannot be used."""
    record, robot = read_model(folder)
    cad_id = folder.relative_to(root).as_posix()
    return model_of(record, cad_id, record["content_hash"], planes_of(record), held(robot))


def read_model(folder: Path) -> tuple[Record, RobotModel]:
    """Record and robot of a model folder, held against each other and the content hash.

    Raises:
        LibraryError: A file is missing or damaged, or one says other than the rest.
    """
    record = read_record(folder)
    path = folder / "model.json"
    with _unusable(folder, path):
        record["content_hash"] = _verified(record, folder)
        robot = read_urdf(folder / "model.urdf")
        check_links(record, robot, path)
    return record, robot


def read_record(folder: Path) -> Record:
    """``model.json`` of a folder, checked by itself; no other file is read.

    Raises:
        LibraryError: It is missing, is no JSON, or says what no model can be.
    """
    path = folder / "model.json"
    with _unusable(folder, path):
        record = json.loads(path.read_text("utf-8"))
        check_record(record, path)
    return record


def robot_loader(folder: Path, expected_hash: str) -> functools.partial[RobotModel]:
    """A ``load_robot`` that reads the folder when it is called, also in another process."""
    return functools.partial(_read_robot, folder, expected_hash)


def _read_robot(folder: Path, expected_hash: str) -> RobotModel:
    record, robot = read_model(folder)
    if record["content_hash"] != expected_hash:
        problem = f"{folder / 'model.json'} was changed while its library was in use"
        raise LibraryError(problem, "load the library again")
    return robot


@contextmanager
def _unusable(folder: Path, record_path: Path) -> Iterator[None]:
    """Whatever is wrong with a model, as a `LibraryError` that names the file."""
    hint = "repair or remove that model's folder, or build the library again"
    try:
        yield
    except OSError as error:
        raise LibraryError(f"{error.filename}: {error.strerror}", hint) from None
    except SceneError as error:
        said = error.problem if str(folder) in error.problem else f"{folder}: {error.problem}"
        raise LibraryError(said, hint) from None
    except (KeyError, TypeError, ValueError) as error:
        said = f"{error} is missing" if isinstance(error, KeyError) else str(error)
        raise LibraryError(f"{record_path}: {said}", hint) from None


def _verified(record: Record, folder: Path) -> str:
    """The content hash of what is there; raises where another one is stated."""
    paths = [folder / "model.urdf", *_mesh_paths(folder)]
    files = {path.relative_to(folder).as_posix(): path.read_bytes() for path in paths}
    stated, found = record.get("content_hash"), content_hash(files, record)
    if stated is None or stated == found:
        return found
    told, true = record.get("files", {}), _digests(files)
    wrong = [name for name in sorted({*told, *true}) if told.get(name) != true.get(name)]
    problem = f"{folder / (wrong or ['model.json'])[0]} differs from its content hash"
    hint = "restore it, or delete content_hash from model.json if the change is meant"
    raise LibraryError(problem, hint)


def _mesh_paths(folder: Path) -> list[Path]:
    return sorted(p for p in folder.glob("meshes/*") if p.suffix.lower() in _MESH_ENDINGS)
