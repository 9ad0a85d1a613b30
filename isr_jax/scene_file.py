"""``scene.json``: the one file format of scenes, for results and for truth alike.

The schema ships with the package (``schema/scene.schema.json``); what is written is checked
against it, and what is read too.
"""

from __future__ import annotations

import dataclasses
import functools
import json
from collections.abc import Callable
from importlib import resources
from pathlib import Path
from typing import Any, Literal

import jsonschema
import numpy as np

from .errors import SceneError
from .geometry import box_at, stack_boxes, support_heights
from .library import CadLibrary
from .types import (
    ROOM,
    UNSUPPORTED,
    Attachment,
    Box,
    Candidate,
    ContactGraph,
    Entities,
    Entity,
    Mesh,
    Placement,
    PlaneSet,
)

SCHEMA_VERSION = "1.1"
EntityType = Literal["layout", "rigid", "articulated", "scan"]
"""What stands for an entity: planes of the room, a model without or with joints, its own mesh."""
ROOM_NAME = "room"
NOT_ANNOTATED = "not annotated"
"""In the ``settings`` of a true scene, of ``supports`` and ``cad`` that nobody wrote down."""


@dataclasses.dataclass(frozen=True, eq=False)
class CadRecord:
    """The model that stands for an entity: p_world = T_world_cad diag(scale) p_cad."""

    id: str
    T_world_cad: np.ndarray
    scale: np.ndarray
    matching_error: float | None = None
    alignment_error_m: float | None = None


@dataclasses.dataclass(frozen=True, eq=False)
class PlaneRecord:
    """A plane n . v + d = 0 with its rectangle, world frame."""

    normal: np.ndarray
    offset: float
    corners: np.ndarray
    area_m2: float


@dataclasses.dataclass(frozen=True, eq=False)
class EntityRecord:
    """One entity of a scene as stored."""

    id: int
    name: str
    class_name: str
    type: EntityType
    box: Box
    planes: tuple[PlaneRecord, ...]
    parent: str | None
    """Name of the supporting parent, `ROOM_NAME`, or None."""
    attachment: Attachment
    support_plane: int | None
    mesh: str | None
    """Relative to the folder of the scene file."""
    cad: CadRecord | None
    candidates: tuple[Candidate, ...] = ()
    reason: str | None = None
    observed_box: Box | None = None
    """Before its bottom was moved onto what carries the entity; None in files that do not say."""
    support_score: float | None = None
    """S of the supporting parent; None in files that do not say."""
    merged_ids: tuple[int, ...] = ()


@dataclasses.dataclass(frozen=True)
class LibraryRecord:
    """Which CAD models stand in a scene."""

    source: str
    content_hash: str


@dataclasses.dataclass(frozen=True, eq=False)
class SceneFile:
    """A whole scene as stored."""

    entities: tuple[EntityRecord, ...]
    T_world_dataset: np.ndarray
    proximal: tuple[tuple[str, str, float], ...] = ()
    """(name, name, depth in metres)."""
    metrics: dict[str, Any] = dataclasses.field(default_factory=dict)
    settings: dict[str, Any] = dataclasses.field(default_factory=dict)
    versions: dict[str, str] = dataclasses.field(default_factory=dict)
    library: LibraryRecord | None = None
    """None in files that do not say."""

    def entity(self, name: str) -> EntityRecord:
        return next(e for e in self.entities if e.name == name)


@functools.cache
def scene_schema() -> dict[str, Any]:
    """The JSON Schema of ``scene.json``."""
    text = resources.files("isr_jax").joinpath("schema/scene.schema.json").read_text("utf-8")
    return json.loads(text)


def scene_from_stages(
    entities: Entities,
    graph: ContactGraph,
    placements: tuple[Placement, ...],
    library: CadLibrary,
    mesh_paths: dict[int, str],
    **rest: Any,
) -> SceneFile:
    """Gather what the stages found. ``mesh_paths`` maps entity ids to relative paths."""
    records = tuple(
        _entity_record(i, entities, graph, placements[i], library, mesh_paths)
        for i in range(len(entities))
    )
    proximal = tuple(
        (entities[a].name, entities[b].name, depth)
        for (a, b), depth in zip(
            graph.proximal.tolist(), graph.proximal_depth_m.tolist(), strict=True
        )
    )
    models = LibraryRecord(library.source, library.content_hash)
    return SceneFile(records, entities.T_world_dataset, proximal, library=models, **rest)


def _entity_record(
    i: int,
    entities: Entities,
    graph: ContactGraph,
    placement: Placement,
    library: CadLibrary,
    mesh_paths: dict[int, str],
) -> EntityRecord:
    entity = entities[i]
    parent = int(graph.parent[i])
    names = {ROOM: ROOM_NAME, UNSUPPORTED: None}
    cad = None
    if placement.cad_id is not None:
        assert placement.T_world_cad is not None and placement.scale is not None
        cad = CadRecord(
            placement.cad_id,
            placement.T_world_cad,
            placement.scale,
            placement.matching_error,
            placement.alignment_error_m,
        )
    return EntityRecord(
        id=entity.id,
        name=entity.name,
        class_name=entity.class_name,
        type=_entity_type(entity, placement, library),
        box=box_at(graph.refined_box, i),
        planes=plane_records(entity),
        parent=names[parent] if parent in names else entities[parent].name,
        attachment=graph.attachment[i],
        support_plane=int(graph.support_plane[i]) if graph.support_plane[i] >= 0 else None,
        mesh=mesh_paths.get(entity.id),
        cad=cad,
        candidates=placement.candidates,
        reason=placement.reason,
        observed_box=entity.box,
        support_score=float(graph.score[i]),
        merged_ids=entity.merged_ids,
    )


def _entity_type(entity: Entity, placement: Placement, library: CadLibrary) -> EntityType:
    if entity.is_layout:
        return "layout"
    if placement.cad_id is None:
        return "scan"
    return "articulated" if library.by_id(placement.cad_id).articulated else "rigid"


def plane_records(entity: Entity) -> tuple[PlaneRecord, ...]:
    """The valid planes of an entity."""
    planes = entity.planes
    return tuple(
        PlaneRecord(
            np.asarray(planes.normal[k]),
            float(planes.offset[k]),
            np.asarray(planes.corners[k]),
            float(planes.area_m2[k]),
        )
        for k in np.flatnonzero(np.asarray(planes.valid))
    )


def graph_of_scene(scene: SceneFile, entities: Entities) -> ContactGraph:
    """The contact graph that a scene file states, by position in its ``entities``.

    Where the file states no score, S is 1 for what something carries, else 0.
    """
    place = {record.name: i for i, record in enumerate(scene.entities)}
    special = {ROOM_NAME: ROOM, None: UNSUPPORTED}
    planes = [record.support_plane for record in scene.entities]
    pairs = [(place[a], place[b]) for a, b, _ in scene.proximal]
    parents = [special.get(r.parent, place.get(r.parent or "", ROOM)) for r in scene.entities]
    parent = np.array(parents, np.int32)
    plane = np.array([-1 if p is None else p for p in planes], np.int32)
    box = stack_boxes([record.box for record in scene.entities])
    return ContactGraph(
        parent=parent,
        support_plane=plane,
        score=np.array([_score(r, p) for r, p in zip(scene.entities, parents)], np.float32),
        attachment=tuple(record.attachment for record in scene.entities),
        refined_box=box,
        support_height_m=support_heights(entities.items, parent, plane, box),
        proximal=np.array(pairs, np.int32).reshape(-1, 2),
        proximal_depth_m=np.array([depth for _, _, depth in scene.proximal], np.float32),
    )


def _score(record: EntityRecord, parent: int) -> float:
    return float(parent >= 0) if record.support_score is None else record.support_score


def entities_of_scene(
    scene: SceneFile, meshes: Callable[[EntityRecord], Mesh], voxel_size_m: float
) -> Entities:
    """The entities that a scene file states.

    Args:
        scene: As read.
        meshes: Gives the mesh of each, world frame.
        voxel_size_m: Of the map that they came from.
    """
    items = tuple(
        Entity(
            record.id,
            record.name,
            record.class_name,
            record.observed_box or record.box,
            _plane_set(record.planes),
            meshes(record),
            record.type == "layout",
            record.merged_ids,
        )
        for record in scene.entities
    )
    return Entities(items, scene.T_world_dataset, voxel_size_m)


def _plane_set(records: tuple[PlaneRecord, ...]) -> PlaneSet:
    count = len(records)
    return PlaneSet(
        np.array([r.normal for r in records], np.float32).reshape(count, 3),
        np.array([r.offset for r in records], np.float32),
        np.array([r.corners for r in records], np.float32).reshape(count, 4, 3),
        np.array([r.area_m2 for r in records], np.float32),
        np.ones(count, bool),
    )


def placements_of_scene(scene: SceneFile) -> tuple[Placement, ...]:
    """What stands for each entity, as the file states it."""
    return tuple(_placement(record) for record in scene.entities)


def _placement(record: EntityRecord) -> Placement:
    cad = record.cad
    if cad is None:
        return Placement(record.id, None, None, None, None, None, record.candidates, record.reason)
    return Placement(
        record.id,
        cad.id,
        cad.T_world_cad,
        cad.scale,
        cad.matching_error,
        cad.alignment_error_m,
        record.candidates,
        record.reason,
    )


def write_scene(scene: SceneFile, path: Path) -> None:
    """Write ``scene.json``, checked against the schema first.

    Raises:
        SceneError: the scene breaks the schema; nothing is written.
    """
    data = _scene_to_json(scene)
    _validate(data, path)
    text = json.dumps(data, indent=1, allow_nan=False) + "\n"
    path.write_text(text, "utf-8")


def read_scene(path: Path) -> SceneFile:
    """Read ``scene.json``; raises `SceneError` naming the place that breaks the schema."""
    try:
        data = json.loads(path.read_text("utf-8"))
    except OSError as error:
        raise SceneError(
            f"{path}: {error.strerror}", "give a folder that `isr run` wrote"
        ) from None
    except ValueError as error:
        raise SceneError(f"{path} is not JSON: {error}", "write it again with `isr run`") from None
    _validate(data, path)
    return _scene_from_json(data)


def _validate(data: Any, path: Path) -> None:
    errors = jsonschema.Draft202012Validator(scene_schema()).iter_errors(data)
    error = next(iter(errors), None)
    if error is not None:
        where = "/".join(str(p) for p in error.absolute_path) or "the top level"
        raise SceneError(
            f"{path} breaks the scene schema at {where}: {error.message[:300]}",
            f"this package writes and reads schema version {SCHEMA_VERSION}",
        )


def _numbers(values: Any) -> Any:
    """Nested lists of floats, at float32's own precision."""
    array = np.asarray(values)
    if array.ndim == 0:
        return float(np.format_float_positional(np.float32(array), unique=True))
    return [_numbers(v) for v in array]


def _scene_to_json(scene: SceneFile) -> dict[str, Any]:
    return {
        "schema_version": SCHEMA_VERSION,
        "T_world_dataset": np.asarray(scene.T_world_dataset, np.float64).tolist(),
        "entities": [_entity_to_json(e) for e in scene.entities],
        "proximal": [{"a": a, "b": b, "depth_m": _numbers(d)} for a, b, d in scene.proximal],
        "metrics": scene.metrics,
        "settings": scene.settings,
        "versions": scene.versions,
        **({} if scene.library is None else {"library": dataclasses.asdict(scene.library)}),
    }


def _box_to_json(box: Box) -> dict[str, Any]:
    return {name: _numbers(getattr(box, name)) for name in ("center", "yaw", "size")}


def _box_from_json(box: dict[str, Any]) -> Box:
    return Box(*(np.array(box[name], np.float32) for name in ("center", "yaw", "size")))


def _entity_to_json(entity: EntityRecord) -> dict[str, Any]:
    cad, more = entity.cad, {}
    if entity.observed_box is not None:
        more["observed_box"] = _box_to_json(entity.observed_box)
    if entity.support_score is not None:
        more["support_score"] = _numbers(entity.support_score)
    if entity.merged_ids:
        more["merged_ids"] = [int(i) for i in entity.merged_ids]
    return {
        "id": int(entity.id),
        "name": entity.name,
        "class": entity.class_name,
        "type": entity.type,
        "box": _box_to_json(entity.box),
        "planes": [
            {
                "normal": _numbers(p.normal),
                "offset": _numbers(p.offset),
                "corners": _numbers(p.corners),
                "area_m2": _numbers(p.area_m2),
            }
            for p in entity.planes
        ],
        "parent": entity.parent,
        "attachment": entity.attachment,
        "support_plane": entity.support_plane,
        "mesh": entity.mesh,
        "cad": None
        if cad is None
        else {
            "id": cad.id,
            "T_world_cad": _numbers(cad.T_world_cad),
            "scale": _numbers(cad.scale),
            "matching_error": cad.matching_error,
            "alignment_error_m": cad.alignment_error_m,
        },
        "candidates": [dataclasses.asdict(c) for c in entity.candidates],
        "reason": entity.reason,
        **more,
    }


def _scene_from_json(data: dict[str, Any]) -> SceneFile:
    return SceneFile(
        entities=tuple(_entity_from_json(e) for e in data["entities"]),
        T_world_dataset=np.array(data["T_world_dataset"], np.float64),
        proximal=tuple((p["a"], p["b"], p["depth_m"]) for p in data["proximal"]),
        metrics=data["metrics"],
        settings=data["settings"],
        versions=data["versions"],
        library=LibraryRecord(**data["library"]) if "library" in data else None,
    )


def _entity_from_json(data: dict[str, Any]) -> EntityRecord:
    cad = data["cad"]

    def array(values: Any) -> np.ndarray:
        return np.array(values, np.float32)

    return EntityRecord(
        id=data["id"],
        name=data["name"],
        class_name=data["class"],
        type=data["type"],
        box=_box_from_json(data["box"]),
        planes=tuple(
            PlaneRecord(array(p["normal"]), p["offset"], array(p["corners"]), p["area_m2"])
            for p in data["planes"]
        ),
        parent=data["parent"],
        attachment=data["attachment"],
        support_plane=data["support_plane"],
        mesh=data["mesh"],
        cad=None
        if cad is None
        else CadRecord(
            cad["id"],
            array(cad["T_world_cad"]),
            array(cad["scale"]),
            cad["matching_error"],
            cad["alignment_error_m"],
        ),
        candidates=tuple(Candidate(**c) for c in data["candidates"]),
        reason=data["reason"],
        observed_box=_box_from_json(data["observed_box"]) if "observed_box" in data else None,
        support_score=data.get("support_score"),
        merged_ids=tuple(data.get("merged_ids", ())),
    )
