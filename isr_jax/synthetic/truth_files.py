"""Border: trimesh. Writes the truth about a room: scene, meshes, parts, joints, what was seen."""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path
from typing import Any

import numpy as np
import trimesh
from trimesh.exchange.ply import export_ply

from ..classes import class_named
from ..errors import OutputError
from ..robot_model import Joint, link_transforms
from ..scene_file import write_scene
from ..types import Mesh
from .film.film import SeenSurface
from .openings import rectangle_corners
from .room import LayoutPatch, PlacedModel, Room
from .surface import room_parts
from .truth import scene_of_entities, true_entities

_IN_OPENING_M = 0.05
"""A frame is in an opening if its middle is that near to the opening's, along the wall."""


def write_truth(room: Room, out_dir: Path, seen: SeenSurface | None = None) -> None:
    """Write ``scene.json``, ``meshes/``, ``room.json``, ``parts.json`` and ``observed.npz``.

    Args:
        room: Made.
        out_dir: Created.
        seen: What the frames show, for ``observed.npz``: points, normals, entity and class; without
            frames there is no such file.

    Raises:
        OutputError: the folder cannot be written.
    """
    out_dir = Path(out_dir)
    try:
        (out_dir / "meshes").mkdir(parents=True, exist_ok=True)
        surfaces = true_entities(room, with_stuff=True)
        for entity in surfaces:
            _write_ply(out_dir / "meshes" / f"{entity.name}.ply", entity.mesh)
        if seen is not None:
            _write_observed(room, out_dir / "observed.npz", seen)
        parts = [
            {"id": part.id, "entity": part.entity_id, "link": part.link}
            for part in room_parts(room)
        ]
        _write_json(out_dir / "parts.json", parts)
        _write_json(out_dir / "room.json", room_record(room))
        kept = tuple(e for e in surfaces if class_named(e.class_name).kind != "stuff")
        entities = dataclasses.replace(surfaces, items=kept)
        write_scene(scene_of_entities(room, entities), out_dir / "scene.json")
    except OSError as error:
        raise OutputError(
            f"{out_dir}: {error.strerror}", "give an output folder that can be written"
        ) from None


def room_record(room: Room) -> dict[str, Any]:
    """The whole room as plain data: metres, radians, world frame; stuff is among the items.

    A model's point p is at T_world_cad (scale p). Joints are at zero: ``anchor`` is a point of
    the axis, and the range runs from there.
    """
    return {
        "name": room.name,
        "kind": room.kind,
        "seed": room.seed,
        "size_m": _floats(room.size),
        "T_world_room": _floats(room.T_world_room),
        "T_world_dataset": _floats(room.T_world_dataset),
        "openings": [
            _opening_record(room, patch, opening)
            for patch in room.layout
            for opening in patch.openings
        ],
        "items": [_item_record(item) for item in room.items],
        "notes": list(room.notes),
    }


def _opening_record(room: Room, patch: LayoutPatch, opening: np.ndarray) -> dict[str, Any]:
    """Where an opening is, and the item that fills it; None where one can walk through."""
    corners = rectangle_corners(patch, opening)
    middle = corners.mean(0)
    fills = [item.name for item in room.items if _fills(item, patch, middle)]
    return {
        "wall": patch.name,
        "rectangle_m": _floats(opening),
        "corners": _floats(corners),
        "item": fills[0] if fills else None,
    }


def _fills(item: PlacedModel, patch: LayoutPatch, middle: np.ndarray) -> bool:
    if class_named(item.model.class_name).mount != "opening" or item.attachment != "wall":
        return False
    step = item.center - middle
    return bool(np.linalg.norm(step - patch.normal * (step @ patch.normal)) < _IN_OPENING_M)


def _item_record(item: PlacedModel) -> dict[str, Any]:
    return {
        "id": item.id,
        "name": item.name,
        "class": item.model.class_name,
        "kind": item.kind,
        "model": item.model.id,
        "source": item.model.source,
        "scale": float(item.scale),
        "T_world_cad": _floats(item.T_world_cad),
        "parent": item.parent,
        "parent_plane": None if item.parent_plane is None else int(item.parent_plane),
        "attachment": item.attachment,
        "tint": _floats(item.tint),
        "joints": joint_records(item),
    }


def joint_records(item: PlacedModel) -> list[dict[str, Any]]:
    """The joints of an item in the world: fixed ones have no axis, endless ones no range."""
    poses = link_transforms(item.model.robot)
    return [_joint_record(item, joint, poses[joint.child]) for joint in item.model.robot.joints]


def _joint_record(item: PlacedModel, joint: Joint, T_model_child: np.ndarray) -> dict[str, Any]:
    turn = np.asarray(item.T_world_cad[:3, :3], np.float64) @ T_model_child[:3, :3]
    length = item.scale if joint.kind == "prismatic" else 1.0
    limited = joint.kind in ("revolute", "prismatic")
    return {
        "name": joint.name,
        "kind": joint.kind,
        "axis": None if joint.kind == "fixed" else _floats(turn @ joint.axis),
        "anchor": _floats(item.to_world(T_model_child[None, :3, 3])[0]),
        "range": [length * joint.lower, length * joint.upper] if limited else None,
        "parent": joint.parent,
        "child": joint.child,
    }


def _write_observed(room: Room, path: Path, seen: SeenSurface) -> None:
    class_of = {patch.id: patch.class_name for patch in room.layout}
    class_of |= {item.id: item.model.class_name for item in room.items}
    table = np.zeros(max(class_of) + 1, np.int32)
    for entity_id, name in class_of.items():
        table[entity_id] = class_named(name).id
    np.savez_compressed(
        path,
        points=seen.points.astype(np.float32),
        normals=seen.normals.astype(np.float32),
        instance=seen.instance.astype(np.int32),
        class_id=table[seen.instance],
    )


def _write_ply(path: Path, mesh: Mesh) -> None:
    whole = trimesh.Trimesh(
        mesh.vertices,
        mesh.faces,
        vertex_normals=mesh.normals,
        vertex_colors=mesh.colors,
        process=False,
    )
    path.write_bytes(export_ply(whole, vertex_normal=True))


def _write_json(path: Path, data: Any) -> None:
    path.write_text(json.dumps(data, indent=1, allow_nan=False) + "\n", "utf-8")


def _floats(values: np.ndarray) -> list[Any]:
    return np.asarray(values, np.float64).tolist()
