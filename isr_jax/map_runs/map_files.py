"""The files of a panoptic map: one mesh of the scene, one per instance, and what each is called.

panoptic.ply       the whole mesh: colour, normal, instance and class of each vertex
panoptic.glb       the same, one node per instance, named as its files
instances/         chair_1.ply and chair_1.glb, and so on: chair_1 has the largest box of all chairs
instances.json     names, classes, boxes and files of the instances
"""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Bool, Float, Int

from ..borders.ply import write_ply
from ..classes import classes, number_by_class
from ..config import EntitySettings
from ..entities import thing_box
from ..export.glb import GlbFile
from ..export.glb_scene import T_GLTF_WORLD
from ..robot_model.mesh_files import write_file
from ..types import Box, Mesh, PanopticSurface

UNLABELLED = "unlabelled"
"""Node of the faces that belong to no instance."""
_WHITE, _MATT = (1.0, 1.0, 1.0, 1.0), 1.0


@dataclasses.dataclass(frozen=True, eq=False)
class MapInstance:
    """One instance of a map, with the faces that are its own."""

    id: int
    name: str
    """``class_k``, as entities are named: by the volume of the box, largest first."""
    class_id: int
    mesh: Mesh
    box: Box
    """Gravity-aligned, robust to strays."""
    area_m2: float
    """Of the mesh."""


def map_instances(
    surface: PanopticSurface, settings: EntitySettings | None = None
) -> list[MapInstance]:
    """The instances of a map by name. A face belongs to the instance of most of its corners.

    So the faces of all instances, and of none, add up to the surface: at the border between two
    there is neither gap nor overlap.

    Args:
        surface: Of the map, with normals.
        settings: How boxes leave out strays.
    """
    settings = settings or EntitySettings()
    owner = _face_instances(surface)
    found = []
    for id, class_id in zip(surface.instance_ids.tolist(), surface.class_ids.tolist()):
        mesh = _part(surface.mesh, owner == id)
        if len(mesh.faces):
            box = thing_box(mesh, surface.voxel_size_m, settings)
            found.append(MapInstance(id, "", class_id, mesh, box, _area_m2(mesh)))
    sizes = [(classes()[f.class_id].name, float(np.prod(f.box.size)), f.id) for f in found]
    return [dataclasses.replace(found[i], name=name) for i, name in number_by_class(sizes)]


def _face_instances(surface: PanopticSurface) -> Int[np.ndarray, " faces"]:
    """The middle of a face's three instances: where two are equal, that is theirs."""
    corners = surface.instance[surface.mesh.faces]
    return np.sort(corners, 1)[:, 1]


def _part(mesh: Mesh, which: Bool[np.ndarray, " faces"]) -> Mesh:
    used, faces = np.unique(mesh.faces[which], return_inverse=True)
    colors = None if mesh.colors is None else mesh.colors[used]
    normals = None if mesh.normals is None else mesh.normals[used]
    return Mesh(mesh.vertices[used], faces.reshape(-1, 3).astype(np.int32), colors, normals)


def _area_m2(mesh: Mesh) -> float:
    a, b, c = (mesh.vertices[column].astype(np.float64) for column in mesh.faces.T)
    return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2)


def write_map(
    surface: PanopticSurface,
    out_dir: Path,
    *,
    T_world_dataset: Float[np.ndarray, "4 4"],
    settings: EntitySettings | None = None,
    about: dict[str, Any] | None = None,
) -> list[MapInstance]:
    """Write the files of a map; those of instances of an earlier map go.

    Args:
        surface: Of the map.
        out_dir: Created.
        T_world_dataset: From the frame of the frames' poses to the world of the mesh.
        settings: As for `map_instances`.
        about: More for instances.json.

    Returns:
        The instances, as they were written.

    Raises:
        OutputError: the folder cannot be written.
    """
    instances = map_instances(surface, settings)
    class_of = np.zeros(int(surface.instance_ids.max(initial=0)) + 1, np.int32)
    class_of[surface.instance_ids] = surface.class_ids
    extra = {"instance": surface.instance, "class": class_of[surface.instance]}
    write_ply(out_dir / "panoptic.ply", surface.mesh, extra)
    rest = _part(surface.mesh, _face_instances(surface) == 0)
    _write_glb(out_dir / "panoptic.glb", {i.name: i.mesh for i in instances} | {UNLABELLED: rest})
    for old in (out_dir / "instances").glob("*_*.*"):
        if old.suffix in (".ply", ".glb"):
            old.unlink()
    for one in instances:
        columns = {"instance": one.id, "class": one.class_id}
        extra = {k: np.full(len(one.mesh.vertices), v) for k, v in columns.items()}
        write_ply(out_dir / "instances" / f"{one.name}.ply", one.mesh, extra)
        _write_glb(out_dir / "instances" / f"{one.name}.glb", {one.name: one.mesh})
    said = (about or {}) | {
        "voxel_size_m": surface.voxel_size_m,
        "T_world_dataset": np.asarray(T_world_dataset, np.float64).tolist(),
        "instances": [_described(one) for one in instances],
    }
    write_file(out_dir / "instances.json", (json.dumps(said, indent=2) + "\n").encode())
    return instances


def _described(one: MapInstance) -> dict[str, Any]:
    low, high = one.mesh.vertices.min(0), one.mesh.vertices.max(0)
    return {
        "name": one.name,
        "instance": one.id,
        "class": classes()[one.class_id].name,
        "class_id": one.class_id,
        "kind": classes()[one.class_id].kind,
        "vertices": len(one.mesh.vertices),
        "area_m2": round(one.area_m2, 4),
        "box_size_m": np.asarray(one.box.size).round(4).tolist(),
        "low": low.round(4).tolist(),
        "high": high.round(4).tolist(),
        "ply": f"instances/{one.name}.ply",
        "glb": f"instances/{one.name}.glb",
    }


def _write_glb(path: Path, meshes: dict[str, Mesh]) -> None:
    """Nodes by name below ``room``, which turns our z up to glTF's y."""
    file = GlbFile()
    room = file.add_node("room", None, T_GLTF_WORLD)
    for name, mesh in meshes.items():
        if len(mesh.faces):
            file.set_mesh(file.add_node(name, room, np.eye(4)), mesh, _WHITE, None, _MATT)
    write_file(path, file.content())


__all__ = ["UNLABELLED", "MapInstance", "map_instances", "write_map"]
