"""From the surface of a map to the entities of a scene: meshes, boxes, planes, layout."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float

from ..classes import classes
from ..config import EntitySettings
from ..types import Entities, Entity, Mesh, PanopticSurface
from .layout import fallback_floor, level_layout, walls
from .planes import find_planes, plane_set
from .rectangles import facing_direction, gravity_box
from .submesh import main_pieces, submesh


def extract_entities(
    surface: PanopticSurface,
    T_world_dataset: Float[np.ndarray, "4 4"],
    settings: EntitySettings | None = None,
) -> Entities:
    """Entities of a map, layout first (floor, ceiling, walls), then things by class and size.

    Each carries its mesh, a gravity-aligned least box robust to strays, and its planes. Things
    are numbered in their class by the volume of their box, largest first. Where no floor was
    labelled, one at z = 0 stands in for it, with a warning on the log ``isr_jax``.
    """
    settings = settings or EntitySettings()
    layout = _layout_entities(surface, settings)
    things = []
    for id, class_id in zip(surface.instance_ids, surface.class_ids, strict=True):
        info = classes()[class_id]
        if info.kind == "thing":
            thing = _thing(surface, int(id), info.name, settings)
            things += [thing] if thing is not None else []
    return Entities(
        tuple(layout + _numbered(things)), np.asarray(T_world_dataset), surface.voxel_size_m
    )


def _thing(
    surface: PanopticSurface, id: int, class_name: str, settings: EntitySettings
) -> Entity | None:
    whole = submesh(surface.mesh, surface.instance == id)
    mesh = main_pieces(whole, settings.piece_link_m, settings.piece_min_ratio)
    if len(mesh.vertices) < settings.min_vertices:
        return None
    voxel_m = surface.voxel_size_m
    assert mesh.normals is not None
    box = gravity_box(
        mesh.vertices,
        settings.box_trim,
        2 * voxel_m,
        voxel_m,
        facing=facing_direction(mesh.normals),
        weight=settings.box_normal_weight,
    )
    found = find_planes(
        mesh,
        threshold_m=min(settings.plane_threshold_m, float(np.min(box.size)) / 4),
        min_ratio=settings.plane_min_ratio,
        max_planes=settings.max_planes,
        iterations=settings.plane_iterations,
        seed=settings.seed,
    )
    planes = plane_set(mesh, found, trim=settings.box_trim, margin_m=2 * voxel_m)
    return Entity(id, class_name, class_name, box, planes, mesh, False)


def _numbered(things: list[Entity]) -> list[Entity]:
    """Named ``class_k``: k counts the things of a class by the volume of their box."""
    ordered = sorted(things, key=lambda t: (t.class_name, -float(np.prod(t.box.size)), t.id))
    counts: dict[str, int] = {}
    named = []
    for t in ordered:
        counts[t.class_name] = k = counts.get(t.class_name, 0) + 1
        name = f"{t.class_name}_{k}"
        named.append(Entity(t.id, name, t.class_name, t.box, t.planes, t.mesh, False))
    return named


def _layout_entities(surface: PanopticSurface, settings: EntitySettings) -> list[Entity]:
    free_id = int(surface.instance_ids.max(initial=0)) + 1
    parts = {name: _class_mesh(surface, name) for name in ("floor", "ceiling", "wall")}
    found: list[Entity] = []
    for name in ("floor", "ceiling"):
        id, mesh = parts[name]
        entity = level_layout(surface, mesh, id, name, settings) if id else None
        if entity is None and name == "floor" and len(surface.mesh.vertices):
            entity, free_id = fallback_floor(surface, id or free_id, settings), free_id + 1
        found += [entity] if entity is not None else []
    id, mesh = parts["wall"]
    return found + (walls(surface, mesh, id, free_id, settings) if id else [])


def _class_mesh(surface: PanopticSurface, name: str) -> tuple[int, Mesh]:
    """Instance and mesh of a layout class; instance 0 where the map holds none."""
    rows = [i for i, c in enumerate(surface.class_ids) if classes()[c].name == name]
    keep = np.isin(surface.instance, surface.instance_ids[rows])
    id = int(surface.instance_ids[rows[0]]) if rows else 0
    return id, submesh(surface.mesh, keep)
