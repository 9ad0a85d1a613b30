"""Border: the scene as GLB (trimesh). glTF is y up; the node ``room`` turns our z up to it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import trimesh
from trimesh.exchange.gltf import export_glb
from trimesh.visual import TextureVisuals
from trimesh.visual.material import PBRMaterial

from ..errors import OutputError
from ..robot_model import Visual, link_transforms
from ..scene_file import ROOM_NAME
from ..types import Mesh
from .bodies import Body, Slab

T_GLTF_WORLD = np.array([[1, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]], np.float64)


def write_glb(path: Path, slabs: tuple[Slab, ...], bodies: tuple[Body, ...]) -> None:
    """Write nodes named as the entities, below ``room``; links of a model below its entity.

    CAD models are shown by their visuals, all others by their scans with colours a vertex.
    """
    scene = trimesh.Scene()
    scene.graph.update(ROOM_NAME, scene.graph.base_frame, matrix=T_GLTF_WORLD)
    for slab in slabs:
        _add_mesh(scene, slab.name, ROOM_NAME, np.eye(4), _colored(slab.scan))
    for body in bodies:
        if body.scan is None:
            _add_model(scene, body)
        else:
            _add_mesh(scene, body.name, ROOM_NAME, body.T_world_root, _colored(body.scan))
    try:
        path.write_bytes(export_glb(scene, tree_postprocessor=_matt))
    except OSError as error:
        raise OutputError(
            f"{path}: {error.strerror}", "give a folder that can be written"
        ) from None


def _add_model(scene: trimesh.Scene, body: Body) -> None:
    scene.graph.update(body.name, ROOM_NAME, matrix=body.T_world_root)
    for name, T in link_transforms(body.robot).items():
        if name != body.name:
            scene.graph.update(name, body.name, matrix=T)
        for i, visual in enumerate(body.robot.link(name).visuals):
            _add_mesh(scene, f"{name}_visual_{i}", name, np.eye(4), _painted(visual))


def _add_mesh(scene, name: str, parent: str, T: np.ndarray, mesh: trimesh.Trimesh | None) -> None:
    if mesh is None:
        scene.graph.update(name, parent, matrix=T)
    else:
        scene.add_geometry(
            mesh, geom_name=name, node_name=name, parent_node_name=parent, transform=T
        )


def _colored(mesh: Mesh) -> trimesh.Trimesh | None:
    if len(mesh.faces) == 0:
        return None
    colors = None if mesh.colors is None else np.asarray(mesh.colors)
    return trimesh.Trimesh(mesh.vertices, mesh.faces, vertex_colors=colors, process=False)


def _matt(tree: dict[str, Any]) -> None:
    """Give what has no material a matt one: glTF takes it for metal, which viewers show black."""
    materials = tree.setdefault("materials", [])
    materials.append({"pbrMetallicRoughness": {"metallicFactor": 0.0, "roughnessFactor": 1.0}})
    for mesh in tree.get("meshes", ()):
        for primitive in mesh["primitives"]:
            primitive.setdefault("material", len(materials) - 1)


def _painted(visual: Visual) -> trimesh.Trimesh:
    material = PBRMaterial(
        baseColorFactor=[round(255 * c) for c in visual.rgba],
        metallicFactor=0.0,
        roughnessFactor=0.8,
    )
    return trimesh.Trimesh(
        visual.mesh.vertices,
        visual.mesh.faces,
        visual=TextureVisuals(material=material),
        process=False,
    )
