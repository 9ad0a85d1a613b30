"""Surfaces of a room: the whole ones that rays meet, and those that a perfect map would have."""

from __future__ import annotations

import dataclasses

import numpy as np
from jaxtyping import Float

from ..robot_model import link_transforms
from ..types import Mesh
from .cutting import cut_edges, faceted
from .exterior import exterior_parts
from .room import LayoutPatch, PlacedModel, merge_meshes

_LAYOUT_RGB = {
    "floor": (0.62, 0.50, 0.38),
    "wall": (0.82, 0.80, 0.74),
    "ceiling": (0.93, 0.93, 0.92),
}


@dataclasses.dataclass(frozen=True, eq=False)
class Surface:
    """The surface of one entity, world frame."""

    mesh: Mesh
    face_rgb: Float[np.ndarray, "faces 3"]
    """Albedo in [0, 1]."""


def layout_surface(patch: LayoutPatch, spacing_m: float) -> Surface:
    """A grid over the rectangle, faces towards the room."""
    a, b, d = patch.corners[0], patch.corners[1], patch.corners[3]
    nu = max(1, int(np.ceil(np.linalg.norm(b - a) / spacing_m)))
    nv = max(1, int(np.ceil(np.linalg.norm(d - a) / spacing_m)))
    u, v = np.meshgrid(np.linspace(0, 1, nu + 1), np.linspace(0, 1, nv + 1))
    points = a + u.reshape(-1, 1) * (b - a) + v.reshape(-1, 1) * (d - a)
    corner = (np.arange(nv)[:, None] * (nu + 1) + np.arange(nu)).ravel()
    quads = np.stack([corner, corner + 1, corner + nu + 2, corner + nu + 1], 1)
    faces = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]]).astype(np.int32)
    rgb = np.array(_LAYOUT_RGB[patch.class_name], np.float32)
    mesh = Mesh(
        points.astype(np.float32),
        faces,
        np.tile(np.rint(rgb * 255).astype(np.uint8), (len(points), 1)),
        np.tile(patch.normal, (len(points), 1)),
    )
    return Surface(mesh, np.tile(rgb, (len(faces), 1)))


def whole_surface(item: PlacedModel) -> Surface:
    """All visuals of a model where it stands, inside and out, as they come."""
    poses = link_transforms(item.model.robot)
    meshes, colors = [], []
    for link in item.model.robot.links:
        T = poses[link.name]
        for visual in link.visuals:
            moved = visual.mesh.vertices @ T[:3, :3].T + T[:3, 3]
            meshes.append(Mesh(item.to_world(moved), visual.mesh.faces))
            colors.append(_tinted(item, visual.rgba[:3], len(visual.mesh.faces)))
    return Surface(merge_meshes(meshes), np.concatenate(colors))


def open_surface(item: PlacedModel, spacing_m: float) -> Surface:
    """What can be seen of a model from outside, no edge longer than ``spacing_m``."""
    meshes, colors = [], []
    for mesh, rgb in exterior_parts(item.model):
        meshes.append(cut_edges(item.to_world(mesh.vertices), mesh.faces, spacing_m))
        colors.append(_tinted(item, rgb, len(meshes[-1].faces)))
    face_rgb = np.concatenate(colors)
    return Surface(faceted(merge_meshes(meshes), face_rgb), face_rgb)


def _tinted(item: PlacedModel, rgb: tuple[float, ...], faces: int) -> np.ndarray:
    return np.tile(np.clip(np.array(rgb, np.float32) * item.tint, 0.02, 0.98), (faces, 1))
