"""Surfaces of a room: the whole ones that rays meet, and those that a perfect map would have."""

from __future__ import annotations

import dataclasses

import numpy as np
from jaxtyping import Float, Int

from ..robot_model import Texture, Visual, link_transforms
from ..types import Mesh
from .cutting import cut_edges, faceted
from .exterior import exterior_parts
from .openings import WALL_M, joints_filled, solid_mesh
from .room import LayoutPatch, PlacedModel, Room, merge_meshes

_LAYOUT_RGB = {
    "floor": (0.62, 0.50, 0.38),
    "wall": (0.82, 0.80, 0.74),
    "ceiling": (0.93, 0.93, 0.92),
}


@dataclasses.dataclass(frozen=True)
class Part:
    """A link of an item, or a piece of layout as a whole: what part images tell apart."""

    id: int
    """From 1; 0 is nothing."""
    entity_id: int
    link: str | None
    """Of the item's model; None for layout."""


@dataclasses.dataclass(frozen=True, eq=False)
class Surface:
    """The surface of one entity, world frame."""

    mesh: Mesh
    face_rgb: Float[np.ndarray, "faces 3"]
    """Albedo in [0, 1]; with a texture, its mean colour. The item's tint is in it."""
    face_part: Int[np.ndarray, " faces"]
    """Position of the link in ``item.model.robot.links``; 0 for layout."""
    uv: Float[np.ndarray, "faces 3 2"] | None = None
    """Texture coordinates of each corner, of textured faces; None without textures."""
    face_texture: Int[np.ndarray, " faces"] | None = None
    """Row of ``textures``; -1 = none. None without textures."""
    textures: tuple[Texture, ...] = ()
    """Without the tint."""


def room_parts(room: Room) -> tuple[Part, ...]:
    """All parts of a room in the order of their ids: the layout, then each item's links."""
    owners = [(patch.id, None) for patch in room.layout]
    for item in room.items:
        owners += [(item.id, link.name) for link in item.model.robot.links]
    return tuple(Part(i, entity, link) for i, (entity, link) in enumerate(owners, 1))


def first_parts(room: Room) -> dict[int, int]:
    """Id of the first part of each entity id: ``face_part`` is added to it."""
    first: dict[int, int] = {}
    for part in room_parts(room):
        first.setdefault(part.entity_id, part.id)
    return first


def room_surfaces(room: Room) -> dict[int, Surface]:
    """The surface of all that is in a room by entity id: the layout, then the items."""
    layout = {p.id: layout_surface(p, np.inf, WALL_M) for p in room.layout}
    return layout | {item.id: whole_surface(item) for item in room.items}


def layout_surface(patch: LayoutPatch, spacing_m: float, reveal_m: float = 0.0) -> Surface:
    """A grid over what is solid of the rectangle, faces towards the room.

    Args:
        patch: With its openings.
        spacing_m: No cell is longer.
        reveal_m: Depth of the faces of the wall in its openings, for what is looked at: the joints
            around frames are filled too. 0 leaves both out.
    """
    mesh = solid_mesh(joints_filled(patch) if reveal_m > 0 else patch, spacing_m, reveal_m)
    rgb = np.array(_LAYOUT_RGB[patch.class_name], np.float32)
    colors = np.tile(np.rint(rgb * 255).astype(np.uint8), (len(mesh.vertices), 1))
    faces = len(mesh.faces)
    return Surface(
        dataclasses.replace(mesh, colors=colors), np.tile(rgb, (faces, 1)), np.zeros(faces, int)
    )


def whole_surface(item: PlacedModel) -> Surface:
    """All visuals of a model where it stands, inside and out, as they come."""
    poses = link_transforms(item.model.robot)
    meshes, colors, visuals, links = [], [], [], []
    for i, link in enumerate(item.model.robot.links):
        T = poses[link.name]
        for visual in link.visuals:
            moved = visual.mesh.vertices @ T[:3, :3].T + T[:3, 3]
            meshes.append(Mesh(item.to_world(moved), visual.mesh.faces))
            colors.append(_tinted(item, _face_colors(visual)))
            visuals.append(visual)
            links.append(i)
    part = np.repeat(np.array(links, int), [len(mesh.faces) for mesh in meshes])
    plain = Surface(merge_meshes(meshes), np.concatenate(colors), part)
    return _textured(plain, visuals)


def _textured(plain: Surface, visuals: list[Visual]) -> Surface:
    """The surface of these visuals, one after the other, with their textures, each held once."""
    rows: dict[bytes, int] = {}
    textures: list[Texture] = []
    uv, face_texture = [], []
    for visual in visuals:
        faces, row = len(visual.mesh.faces), -1
        if visual.texture is not None and visual.mesh.uv is not None:
            row = rows.setdefault(visual.texture.content, len(rows))
            textures += [visual.texture] if row == len(textures) else []
        known = row >= 0 and visual.mesh.uv is not None
        uv.append(visual.mesh.uv if known else np.zeros((faces, 3, 2), np.float32))
        face_texture.append(np.full(faces, row))
    if not textures:
        return plain
    return dataclasses.replace(
        plain,
        uv=np.concatenate(uv).astype(np.float32),
        face_texture=np.concatenate(face_texture),
        textures=tuple(textures),
    )


def _face_colors(visual: Visual) -> Float[np.ndarray, "faces 3"]:
    """Of its vertices where a visual has such, else of its material."""
    if visual.mesh.colors is not None:
        return visual.mesh.colors[visual.mesh.faces].mean(1).astype(np.float32) / 255
    return np.tile(np.array(visual.rgba[:3], np.float32), (len(visual.mesh.faces), 1))


def open_surface(item: PlacedModel, spacing_m: float) -> Surface:
    """What can be seen of a model from outside, no edge longer than ``spacing_m``.

    Its parts are not told apart.
    """
    meshes, colors = [], []
    for mesh, rgb in exterior_parts(item.model):
        meshes.append(cut_edges(item.to_world(mesh.vertices), mesh.faces, spacing_m))
        face_rgb = np.tile(np.array(rgb, np.float32), (len(meshes[-1].faces), 1))
        colors.append(_tinted(item, face_rgb))
    face_rgb = np.concatenate(colors)
    mesh = faceted(merge_meshes(meshes), face_rgb)
    return Surface(mesh, face_rgb, np.zeros(len(mesh.faces), int))


def _tinted(item: PlacedModel, rgb: Float[np.ndarray, "faces 3"]) -> Float[np.ndarray, "faces 3"]:
    return np.clip(rgb * item.tint, 0.02, 0.98).astype(np.float32)
