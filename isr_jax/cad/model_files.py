"""Border: one CAD model as files, ``model.urdf``, ``meshes/*.obj`` and ``model.json``."""

from __future__ import annotations

import dataclasses
import hashlib
import json
from pathlib import Path
from typing import Any

import numpy as np

from ..cad_types import CadModel, held
from ..classes import class_named
from ..errors import ClassError, LibraryError, OutputError, SceneError
from ..robot_model import RobotModel, read_urdf, urdf_files
from ..robot_model.obj import numbers
from ..types import Array, PlaneSet

SCHEMA_VERSION = "1.0"
MOUNTS = ("floor", "surface", "wall", "opening")
SYMMETRIES = (0, 1, 2, 4)


def model_files(model: CadModel) -> dict[str, bytes]:
    """Contents by relative path, with the hash of all the rest in ``model.json``."""
    files = urdf_files(model.robot)
    record = _record(model)
    record["content_hash"] = content_hash(files, record)
    files["model.json"] = (json.dumps(record, indent=1) + "\n").encode()
    return files


def with_content_hash(model: CadModel) -> CadModel:
    """The model, its ``content_hash`` computed from what would be written."""
    digest = content_hash(urdf_files(model.robot), _record(model))
    return dataclasses.replace(model, content_hash=digest)


def content_hash(files: dict[str, bytes], record: dict[str, Any]) -> str:
    """SHA-256 over geometry files and ``model.json``, its own entry left out."""
    digest = hashlib.sha256()
    rest = {k: v for k, v in record.items() if k != "content_hash"}
    for name, content in [*sorted(files.items()), ("", json.dumps(rest, sort_keys=True).encode())]:
        digest.update(f"{name}\0{len(content)}\0".encode() + content)
    return digest.hexdigest()


def save_model(model: CadModel, root: Path) -> Path:
    """Write a model into ``root/<class>/<name>/``; returns that folder."""
    folder = root / model.id
    for name, content in model_files(model).items():
        path = folder / name
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(content)
        except OSError as error:
            problem = f"{path}: {error.strerror}"
            raise OutputError(problem, "give a library folder that can be written") from None
    return folder


def load_model(folder: Path, root: Path) -> CadModel:
    """Read one model folder; raises `LibraryError` naming the file that cannot be used."""
    path = folder / "model.json"
    try:
        record = json.loads(path.read_text("utf-8"))
        robot = read_urdf(folder / "model.urdf")
        return _model(record, robot, folder, folder.relative_to(root).as_posix())
    except OSError as error:
        raise _unusable(error.filename, str(error.strerror)) from None
    except SceneError as error:
        raise _unusable(folder, error.problem) from None
    except (KeyError, TypeError, ValueError) as error:
        said = f"{error} is missing" if isinstance(error, KeyError) else str(error)
        raise _unusable(path, said) from None


def _unusable(path: Path | str, problem: str) -> LibraryError:
    hint = "repair or remove that model's folder, or build the library again"
    return LibraryError(problem if str(path) in problem else f"{path}: {problem}", hint)


def _table(values: Array) -> list:
    """Nested lists of floats with the fewest digits of the array's own precision."""
    texts = numbers(np.asarray(values))
    return np.asarray(texts, np.float64).tolist()


def _record(model: CadModel) -> dict[str, Any]:
    planes = model.planes
    return {
        "schema_version": SCHEMA_VERSION,
        "class": model.class_name,
        "size": _table(model.size),
        "symmetry": model.symmetry,
        "mount": model.mount,
        "planes": [
            {
                "normal": _table(planes.normal[k]),
                "offset": _table(planes.offset[k : k + 1])[0],
                "corners": _table(planes.corners[k]),
                "area_m2": _table(planes.area_m2[k : k + 1])[0],
                "link": model.plane_link[k],
                "supporting": bool(model.plane_supporting[k]),
            }
            for k in range(len(model.plane_link))
        ],
        "licence": model.licence,
    }


def _model(record: dict, robot: RobotModel, folder: Path, cad_id: str) -> CadModel:
    path, planes = folder / "model.json", record["planes"]
    if record["schema_version"] != SCHEMA_VERSION:
        problem = f"{path}: schema version {record['schema_version']!r}"
        raise LibraryError(problem, f"this package reads version {SCHEMA_VERSION}; build it again")
    try:
        class_named(record["class"])
    except ClassError as error:
        raise LibraryError(f"{path}: {error.problem}", error.hint) from None
    if record["mount"] not in MOUNTS or record["symmetry"] not in SYMMETRIES:
        allowed = f"mount is one of {MOUNTS}, symmetry one of {SYMMETRIES}"
        raise LibraryError(f"{path}: {record['mount']!r}, {record['symmetry']!r}", allowed)
    unknown = {p["link"] for p in planes} - {link.name for link in robot.links}
    if unknown:
        raise LibraryError(f"{path}: planes of unknown links {sorted(unknown)}", "name the owners")
    model = CadModel(
        id=cad_id,
        class_name=record["class"],
        load_robot=held(robot),
        moving_joints=tuple(joint.name for joint in robot.moving_joints),
        size=np.array(record["size"], np.float32),
        planes=PlaneSet(
            np.array([p["normal"] for p in planes], np.float32).reshape(-1, 3),
            np.array([p["offset"] for p in planes], np.float32),
            np.array([p["corners"] for p in planes], np.float32).reshape(-1, 4, 3),
            np.array([p["area_m2"] for p in planes], np.float32),
            np.ones(len(planes), bool),
        ),
        plane_link=tuple(p["link"] for p in planes),
        plane_supporting=np.array([p["supporting"] for p in planes], bool),
        symmetry=record["symmetry"],
        mount=record["mount"],
        licence=record["licence"],
        content_hash=_checked_hash(record, folder),
    )
    if model.size.shape != (3,) or not np.all(model.size > 0):
        raise LibraryError(f"{path}: size {record['size']}", "give three positive lengths, metres")
    return model


def _checked_hash(record: dict, folder: Path) -> str:
    names = ["model.urdf", *(f"meshes/{p.name}" for p in folder.glob("meshes/*.obj"))]
    found = content_hash({name: (folder / name).read_bytes() for name in names}, record)
    stated = record.get("content_hash", found)
    if stated != found:
        hint = "restore it, or delete content_hash from model.json if the change is meant"
        raise LibraryError(f"{folder}: a file differs from its content hash {stated[:12]}", hint)
    return found
