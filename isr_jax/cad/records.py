"""``model.json``: what is said of one model, as plain data."""

from __future__ import annotations

import functools
import json
from collections.abc import Callable
from importlib import resources
from pathlib import Path
from typing import Any, get_args

import jsonschema
import numpy as np
from jaxtyping import Bool

from ..classes import Mount, class_named
from ..errors import ClassError, LibraryError
from ..geometry.surface_samples import SurfaceSamples
from ..library import CadModel, Collision, Handle
from ..robot_model import RobotModel
from ..robot_model.obj import numbers
from ..types import Array, PlaneSet

SCHEMA_VERSION = "1.1"
_ALLOWED = {
    "mount": get_args(Mount),
    "symmetry": (0, 1, 2, 4),
    "collision": get_args(Collision),
}

Record = dict[str, Any]


@functools.cache
def record_schema() -> Record:
    """The JSON Schema of ``model.json``."""
    text = resources.files("isr_jax.cad").joinpath("schema/model.schema.json").read_text("utf-8")
    return json.loads(text)


def validate_record(record: Any, path: Path | str = "model.json") -> None:
    """Raise `LibraryError` naming the first entry that breaks the schema."""
    validator = jsonschema.Draft202012Validator(record_schema())
    error = next(iter(validator.iter_errors(record)), None)
    if error is not None:
        where = "/".join(str(part) for part in error.absolute_path) or "the top level"
        problem = f"{path} breaks the model schema at {where}: {error.message[:300]}"
        raise LibraryError(problem, f"this package reads and writes version {SCHEMA_VERSION}")


def record_of(model: CadModel) -> Record:
    """What ``model.json`` says, without what the files say: ``files`` and ``content_hash``."""
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
        "moving_joints": list(model.moving_joints),
        "handles": [
            {
                "joint": handle.joint,
                "link": handle.link,
                "position": _table(handle.position),
                "estimated": handle.estimated,
            }
            for handle in model.handles
        ],
        "collision": model.collision,
        "swelling_m": float(model.swelling_m),
        "licence": model.licence,
        "creator": model.creator,
        "source": model.source,
        "notes": list(model.notes),
    }


def _table(values: Array) -> list:
    """Nested lists of floats with the fewest digits of the array's own precision."""
    texts = numbers(np.asarray(values))
    return np.asarray(texts, np.float64).tolist()


def planes_of(record: Record) -> tuple[PlaneSet, tuple[str, ...], Bool[np.ndarray, " planes"]]:
    """Planes of a record, the links that own them, and which of them carry things."""
    rows = record["planes"]
    planes = PlaneSet(
        np.array([p["normal"] for p in rows], np.float32).reshape(-1, 3),
        np.array([p["offset"] for p in rows], np.float32),
        np.array([p["corners"] for p in rows], np.float32).reshape(-1, 4, 3),
        np.array([p["area_m2"] for p in rows], np.float32),
        np.ones(len(rows), bool),
    )
    return planes, tuple(p["link"] for p in rows), np.array([p["supporting"] for p in rows], bool)


def check_record(record: Record, path: Path) -> None:
    """Raise `LibraryError` for values that no model can have.

    Also KeyError for what is missing, TypeError or ValueError for what is no number.
    """
    if record["schema_version"] != SCHEMA_VERSION:
        problem = f"{path}: schema version {record['schema_version']!r}"
        raise LibraryError(problem, f"this package reads version {SCHEMA_VERSION}; build it again")
    try:
        class_named(record["class"])
    except ClassError as error:
        raise LibraryError(f"{path}: {error.problem}", error.hint) from None
    for key, allowed in _ALLOWED.items():
        if record[key] not in allowed:
            raise LibraryError(f"{path}: {key} {record[key]!r}", f"it is one of {allowed}")
    size = np.array(record["size"], np.float64)
    if size.shape != (3,) or not np.all((size > 0) & np.isfinite(size)):
        raise LibraryError(f"{path}: size {record['size']}", "give three positive lengths, metres")
    unknown = {h["joint"] for h in record["handles"]} - set(record["moving_joints"])
    if unknown:
        hint = "name joints of moving_joints"
        raise LibraryError(f"{path}: handles of unknown joints {sorted(unknown)}", hint)
    planes_of(record)


def check_links(record: Record, robot: RobotModel, path: Path) -> None:
    """Raise `LibraryError` where record and URDF name different links or joints."""
    owners = {p["link"] for p in record["planes"]} | {h["link"] for h in record["handles"]}
    unknown = owners - {link.name for link in robot.links}
    if unknown:
        problem = f"{path}: planes or handles of unknown links {sorted(unknown)}"
        raise LibraryError(problem, "name the owners as model.urdf does")
    joints = [joint.name for joint in robot.moving_joints]
    if joints != record["moving_joints"]:
        problem = f"{path}: moving_joints {record['moving_joints']}; model.urdf has {joints}"
        raise LibraryError(problem, "name the joints that move, in the order of model.urdf")


def model_of(
    record: Record,
    cad_id: str,
    content_hash: str,
    planes: tuple[PlaneSet, tuple[str, ...], Bool[np.ndarray, " planes"]],
    load_robot: Callable[[], RobotModel],
    load_samples: Callable[[], SurfaceSamples] | None = None,
) -> CadModel:
    """The model of a checked record; its own ``planes`` are not read, they may be elsewhere."""
    plane_set, plane_link, supporting = planes
    return CadModel(
        id=cad_id,
        class_name=record["class"],
        load_robot=load_robot,
        moving_joints=tuple(record["moving_joints"]),
        size=np.array(record["size"], np.float32),
        planes=plane_set,
        plane_link=plane_link,
        plane_supporting=supporting,
        symmetry=record["symmetry"],
        mount=record["mount"],
        licence=record["licence"],
        content_hash=content_hash,
        handles=tuple(
            Handle(h["joint"], h["link"], np.array(h["position"], np.float64), h["estimated"])
            for h in record["handles"]
        ),
        collision=record["collision"],
        swelling_m=float(record["swelling_m"]),
        creator=record["creator"],
        source=record["source"],
        notes=tuple(record["notes"]),
        load_samples=load_samples,
    )
