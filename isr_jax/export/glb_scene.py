"""Border: the scene as GLB. glTF is y up; the node ``room`` turns our z up to it."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np

from ..robot_model import link_transforms
from ..robot_model.mesh_files import write_file
from ..scene_file import ROOM_NAME
from ..types import Mesh
from .bodies import Body
from .glb import GlbFile
from .slabs import Slab

T_GLTF_WORLD = np.array([[1, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]], np.float64)
_WHITE = (1.0, 1.0, 1.0, 1.0)
_MATT, _FURNITURE = 1.0, 0.8
"""Roughness of scans, and of models."""


def write_glb(path: Path, slabs: tuple[Slab, ...], bodies: tuple[Body, ...]) -> None:
    """Write nodes named as the entities, below ``room``; links of a model below its entity.

    CAD models are shown by their visuals, all others by their scans with colours a vertex.
    """
    file = GlbFile()
    room = file.add_node(ROOM_NAME, None, T_GLTF_WORLD)
    for slab in slabs:
        _add_scan(file, file.add_node(slab.name, room, np.eye(4)), slab.scan)
    for body in bodies:
        root = file.add_node(body.name, room, body.T_world_root)
        if body.scan is None:
            _add_model(file, body, root)
        else:
            _add_scan(file, root, body.scan)
    write_file(path, file.content())


def _add_model(file: GlbFile, body: Body, root: int) -> None:
    for name, T in link_transforms(body.robot).items():
        node = root if name == body.name else file.add_node(name, root, T)
        for i, visual in enumerate(body.robot.link(name).visuals):
            shape = file.add_node(f"{name}_visual_{i}", node, np.eye(4))
            # Texture and vertex colours hold the colour; the visual's own is their mean.
            plain = visual.texture is None and visual.mesh.colors is None
            rgba = visual.rgba if plain else (1.0, 1.0, 1.0, visual.rgba[3])
            file.set_mesh(shape, visual.mesh, rgba, visual.texture, _FURNITURE)


def _add_scan(file: GlbFile, node: int, scan: Mesh) -> None:
    if len(scan.faces):
        file.set_mesh(node, dataclasses.replace(scan, normals=None), _WHITE, None, _MATT)
