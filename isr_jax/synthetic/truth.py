"""The truth about a room, as the stages would state it: entities, supports, models."""

from __future__ import annotations

import numpy as np

from ..scene_file import ROOM_NAME, CadRecord, EntityRecord, SceneFile, plane_records
from ..types import Entities, Entity, PlaneSet
from .exterior import open_planes
from .placement import overlap_depths
from .room import LayoutPatch, PlacedModel, Room
from .surface import layout_surface, open_surface

MAX_PLANES = 8
"""Planes kept an entity, as many as are extracted from a map."""
SURFACE_SPACING_M = 0.025


def true_entities(room: Room, *, spacing_m: float = SURFACE_SPACING_M) -> Entities:
    """The room as a perfect map would give it: whole surfaces, boxes and planes.

    Meshes have vertices at most ``spacing_m`` apart, like a map's, since contact areas are taken
    over the vertices near a plane; what no view from outside shows is left out.
    """
    layout = [_layout_entity(patch, spacing_m) for patch in room.layout]
    items = [_item_entity(room, item, spacing_m) for item in room.items]
    return Entities((*layout, *items), room.T_world_dataset, spacing_m)


def _layout_entity(patch: LayoutPatch, spacing_m: float) -> Entity:
    sides = patch.corners[1] - patch.corners[0], patch.corners[3] - patch.corners[0]
    area = np.linalg.norm(sides[0]) * np.linalg.norm(sides[1])
    planes = PlaneSet(
        patch.normal[None],
        np.array([-patch.normal @ patch.corners.mean(0)], np.float32),
        patch.corners[None],
        np.array([area], np.float32),
        np.ones(1, bool),
    )
    mesh = layout_surface(patch, spacing_m).mesh
    return Entity(patch.id, patch.name, patch.class_name, patch.box, planes, mesh, True)


def _item_entity(room: Room, item: PlacedModel, spacing_m: float) -> Entity:
    planes, rows = item.model.planes, kept_planes(room, item)
    corners = item.to_world(np.asarray(planes.corners)[rows].reshape(-1, 3)).reshape(-1, 4, 3)
    normal = (planes.normal[rows] @ item.T_world_cad[:3, :3].T).astype(np.float32)
    offset = -np.einsum("pi,pi->p", normal, corners.mean(1))
    area = (planes.area_m2[rows] * item.scale**2).astype(np.float32)
    moved = PlaneSet(normal, offset.astype(np.float32), corners, area, np.ones(len(rows), bool))
    mesh = open_surface(item, spacing_m).mesh
    return Entity(item.id, item.name, item.model.class_name, item.box, moved, mesh, False)


def kept_planes(room: Room, item: PlacedModel) -> np.ndarray:
    """Rows of the model's planes that its entity keeps, at most `MAX_PLANES`.

    Those that carry something, then those that could and can be seen, then the largest that can
    be seen: the inner shelves of a closed cabinet are in no map.
    """
    carried = [other for other in room.items if other.parent == item.name]
    carrying = [c.parent_plane for c in carried if c.parent_plane is not None]
    supporting, seen = np.asarray(item.model.plane_supporting), open_planes(item.model)
    carries = np.isin(np.arange(len(seen)), carrying)
    order = np.lexsort((-item.model.planes.area_m2, ~supporting, ~carries))
    order = order[(seen | carries)[order]]
    return np.sort(order[:MAX_PLANES])


def truth_scene(room: Room) -> SceneFile:
    """What a result is compared with: true parents, planes, models and poses."""
    return scene_of_entities(room, true_entities(room, spacing_m=1.0))


def scene_of_entities(room: Room, entities: Entities) -> SceneFile:
    """As `truth_scene`, for entities that `true_entities` has already made."""
    items = {item.name: item for item in room.items}
    records = tuple(_record(room, entity, items.get(entity.name)) for entity in entities)
    return SceneFile(
        records,
        room.T_world_dataset,
        _proximal(room),
        settings={"synthetic": {"seed": room.seed, "size_m": [float(v) for v in room.size]}},
    )


def _record(room: Room, entity: Entity, item: PlacedModel | None) -> EntityRecord:
    kind, parent, cad = "layout", ROOM_NAME, None
    if item is not None:
        kind = "articulated" if item.model.articulated else "rigid"
        parent = item.parent
        cad = CadRecord(item.model.id, item.T_world_cad, np.full(3, item.scale, np.float32))
    return EntityRecord(
        id=entity.id,
        name=entity.name,
        class_name=entity.class_name,
        type=kind,
        box=entity.box,
        planes=plane_records(entity),
        parent=parent,
        attachment="none" if item is None else item.attachment,
        support_plane=None if item is None else support_plane(room, item),
        mesh=f"meshes/{entity.name}.ply",
        cad=cad,
    )


def support_plane(room: Room, item: PlacedModel) -> int | None:
    """Which plane of its parent's entity carries an item."""
    carriers = {other.name: other for other in room.items}
    if item.parent in carriers:
        rows = kept_planes(room, carriers[item.parent])
        return int(np.flatnonzero(rows == item.parent_plane)[0])
    return item.parent_plane


def _proximal(room: Room) -> tuple[tuple[str, str, float], ...]:
    """Pairs whose boxes overlap though neither carries the other."""
    boxes = [item.box for item in room.items]
    depth = overlap_depths(boxes, boxes)
    pairs = np.argwhere(np.triu(depth > 1e-6, 1))
    named = [(room.items[a], room.items[b], float(depth[a, b])) for a, b in pairs]
    return tuple(
        (a.name, b.name, d) for a, b, d in named if a.name != b.parent and b.name != a.parent
    )
