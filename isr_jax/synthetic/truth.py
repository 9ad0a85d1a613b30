"""The truth about a room, as the stages would state it: entities, supports, models."""

from __future__ import annotations

import numpy as np

from ..geometry import stack_boxes, support_heights
from ..scene_file import ROOM_NAME, CadRecord, EntityRecord, SceneFile, plane_records
from ..types import (
    ROOM,
    UNSUPPORTED,
    AlignmentStatus,
    Attachment,
    Candidate,
    ContactGraph,
    Entities,
    Entity,
    Placement,
    PlaneSet,
)
from .exterior import open_planes
from .furnishing.placement import overlap_depths
from .openings import WALL_M, rectangle_corners, solid_rectangles
from .room import LayoutPatch, PlacedModel, Room
from .surface import layout_surface, open_surface

MAX_PLANES = 8
"""Planes kept an entity, as many as are extracted from a map."""
SURFACE_SPACING_M = 0.025
_TOUCH_M = 1e-6
"""Boxes that overlap less only touch."""


def true_entities(
    room: Room, *, spacing_m: float = SURFACE_SPACING_M, with_stuff: bool = False
) -> Entities:
    """The room as a perfect map would give it: whole surfaces, boxes and planes.

    Meshes have vertices at most ``spacing_m`` apart, like a map's, since contact areas are taken
    over the vertices near a plane; what no view from outside shows is left out. A wall with
    openings has a plane for each rectangle between them, the largest first, and the faces of its
    thickness in them.

    Args:
        room: Made.
        spacing_m: Of the vertices.
        with_stuff: Also windows, pictures and the like, which are no entities of a map but stand
            in the way of things.
    """
    layout = [_layout_entity(patch, spacing_m) for patch in room.layout]
    kept = room.items if with_stuff else room.things
    items = [_item_entity(room, item, spacing_m) for item in kept]
    return Entities((*layout, *items), room.T_world_dataset, spacing_m)


def _layout_entity(patch: LayoutPatch, spacing_m: float) -> Entity:
    rectangles = solid_rectangles(patch)
    corners = np.stack([rectangle_corners(patch, rectangle) for rectangle in rectangles])
    count = len(rectangles)
    planes = PlaneSet(
        np.tile(patch.normal, (count, 1)),
        np.full(count, -patch.normal @ patch.corners.mean(0), np.float32),
        corners,
        np.prod(rectangles[:, 2:] - rectangles[:, :2], axis=1),
        np.ones(count, bool),
    )
    mesh = layout_surface(patch, spacing_m, WALL_M).mesh
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


def true_graph(room: Room, entities: Entities) -> ContactGraph:
    """Who carries whom, by position in ``entities`` (of `true_entities`).

    What stands on stuff (a rug) is carried by what carries that. What leans, hangs or is fixed
    to a wall has no parent. The score is that of an exact fit: the area of the footprint.
    """
    rows = {entity.name: i for i, entity in enumerate(entities)}
    items = {item.name: item for item in room.items}
    parent = np.where([e.is_layout for e in entities], ROOM, UNSUPPORTED).astype(np.int32)
    plane, score = np.full(len(rows), -1, np.int32), np.zeros(len(rows), np.float32)
    for i, entity in enumerate(entities):
        item = items.get(entity.name)
        carrier = None if item is None else _carrier(items, item, rows)
        if item is None or carrier is None:
            continue
        parent[i] = rows[carrier]
        row = support_plane(room, item) if carrier == item.parent else 0
        plane[i] = -1 if row is None else row
        score[i] = np.prod(np.asarray(entity.box.size)[:2])
    pairs, depth = _proximal(entities, parent)
    attachment: list[Attachment] = [
        items[e.name].attachment if e.name in items else "none" for e in entities
    ]
    box = stack_boxes([entity.box for entity in entities])
    return ContactGraph(
        parent=parent,
        support_plane=plane,
        score=score,
        attachment=tuple(attachment),
        refined_box=box,
        support_height_m=support_heights(entities.items, parent, plane, box),
        proximal=pairs,
        proximal_depth_m=depth,
    )


def _carrier(items: dict[str, PlacedModel], item: PlacedModel, rows: dict[str, int]) -> str | None:
    """The nearest of what carries an item that is an entity."""
    name = item.parent
    while name is not None and name not in rows:
        name = items[name].parent
    return name


def _proximal(entities: Entities, parent: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Pairs of things whose boxes overlap though neither carries the other, and how deep."""
    things = np.flatnonzero([not entity.is_layout for entity in entities])
    if not len(things):
        return np.zeros((0, 2), np.int32), np.zeros(0, np.float32)
    boxes = [entities[int(i)].box for i in things]
    depth = overlap_depths(boxes, boxes)
    found = np.argwhere(np.triu(depth > _TOUCH_M, 1))
    pairs = things[found]
    apart = (parent[pairs[:, 0]] != pairs[:, 1]) & (parent[pairs[:, 1]] != pairs[:, 0])
    depth = depth[found[:, 0], found[:, 1]]
    return pairs[apart].astype(np.int32), depth[apart].astype(np.float32)


def true_placements(room: Room, entities: Entities) -> tuple[Placement, ...]:
    """The model of each entity where it is: no error, and no candidate but itself."""
    items = {item.name: item for item in room.items}
    return tuple(_placement(entity, items.get(entity.name)) for entity in entities)


def _placement(entity: Entity, item: PlacedModel | None) -> Placement:
    if item is None:
        return Placement(entity.id, None, None, None, None, None, (), "layout")
    status = AlignmentStatus.CONVERGED.label
    return Placement(
        entity_id=entity.id,
        cad_id=item.model.id,
        T_world_cad=item.T_world_cad,
        scale=np.full(3, item.scale, np.float32),
        matching_error=0.0,
        alignment_error_m=0.0,
        candidates=(Candidate(item.model.id, 0, 0.0, 0.0, status, None),),
        reason=None,
    )


def truth_scene(room: Room) -> SceneFile:
    """What a result is compared with: true parents, planes, models and poses."""
    return scene_of_entities(room, true_entities(room, spacing_m=1.0))


def scene_of_entities(room: Room, entities: Entities) -> SceneFile:
    """As `truth_scene`, for entities that `true_entities` has already made."""
    graph, items = true_graph(room, entities), {item.name: item for item in room.items}
    records = tuple(
        _record(entities, graph, i, items.get(entity.name)) for i, entity in enumerate(entities)
    )
    proximal = tuple(
        (entities[int(a)].name, entities[int(b)].name, float(depth))
        for (a, b), depth in zip(graph.proximal, graph.proximal_depth_m, strict=True)
    )
    made = {"seed": room.seed, "kind": room.kind, "size_m": [float(v) for v in room.size]}
    return SceneFile(records, room.T_world_dataset, proximal, settings={"synthetic": made})


def _record(
    entities: Entities, graph: ContactGraph, i: int, item: PlacedModel | None
) -> EntityRecord:
    entity, kind, cad = entities[i], "layout", None
    if item is not None:
        kind = "articulated" if item.model.articulated else "rigid"
        cad = CadRecord(item.model.id, item.T_world_cad, np.full(3, item.scale, np.float32))
    names = {ROOM: ROOM_NAME, UNSUPPORTED: None}
    carrier, plane = int(graph.parent[i]), int(graph.support_plane[i])
    return EntityRecord(
        id=entity.id,
        name=entity.name,
        class_name=entity.class_name,
        type=kind,
        box=entity.box,
        planes=plane_records(entity),
        parent=names[carrier] if carrier in names else entities[carrier].name,
        attachment=graph.attachment[i],
        support_plane=plane if plane >= 0 else None,
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
