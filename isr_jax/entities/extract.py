"""From the surface of a map to the entities of a scene: meshes, boxes, planes, layout."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence

import numpy as np
from jaxtyping import Float

from ..classes import classes, number_by_class
from ..config import EntitySettings
from ..types import Entities, Entity, Mesh, PanopticSurface
from .boards import find_boards
from .instances import Instance, thing_instances
from .layout import fallback_floor, level_layout, walls
from .planes import find_planes, plane_area, plane_set
from .submesh import submesh


def extract_entities(
    surface: PanopticSurface,
    T_world_dataset: Float[np.ndarray, "4 4"],
    settings: EntitySettings | None = None,
) -> Entities:
    """Entities of a map, layout first (floor, ceiling, walls), then things by class and size.

    Each carries its mesh, a gravity-aligned least box robust to strays, and its planes. Things
    are numbered in their class by the volume of their box, largest first. Parts of one thing that
    the map holds apart are joined, and fragments left out (`thing_instances`). Where no floor was
    labelled, one at z = 0 stands in for it, with a warning on the log ``isr_jax``.
    """
    settings = settings or EntitySettings()
    layout = _layout_entities(surface, settings)
    things = [_thing(one, surface, settings) for one in thing_instances(surface, settings)]
    return Entities(
        tuple(layout + _numbered(things)), np.asarray(T_world_dataset), surface.voxel_size_m
    )


def extract_scenes(
    surfaces: Sequence[PanopticSurface],
    T_world_dataset: Sequence[Float[np.ndarray, "4 4"]],
    settings: EntitySettings,
) -> list[Entities]:
    """`extract_entities` of several maps."""
    return [
        extract_entities(surface, T, settings)
        for surface, T in zip(surfaces, T_world_dataset, strict=True)
    ]


def _thing(one: Instance, surface: PanopticSurface, settings: EntitySettings) -> Entity:
    name, size = one.info.name, np.asarray(one.box.size)
    threshold_m = min(settings.plane_threshold_m, float(size.min()) / 4)
    found = find_planes(
        one.mesh,
        threshold_m=threshold_m,
        min_ratio=settings.plane_min_ratio,
        max_planes=settings.max_planes,
        iterations=settings.plane_iterations,
        seed=settings.seed,
    )
    found = [f for f in found if plane_area(one.mesh, f) >= settings.plane_min_area_m2]
    if not one.info.movable and np.isfinite(settings.board_min_area_m2):
        found += find_boards(one.mesh, found, threshold_m, settings)
    planes = plane_set(one.mesh, found, trim=settings.box_trim, margin_m=2 * surface.voxel_size_m)
    return Entity(one.id, name, name, one.box, planes, one.mesh, False, one.merged_ids)


def _numbered(things: list[Entity]) -> list[Entity]:
    """Named ``class_k`` by the volume of their box (`number_by_class`)."""
    sizes = [(t.class_name, float(np.prod(t.box.size)), t.id) for t in things]
    return [dataclasses.replace(things[i], name=name) for i, name in number_by_class(sizes)]


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
