"""Which entities look for models, among which, and what of them counts (host)."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence

import numpy as np
from jaxtyping import Bool, Float, Int

from ..classes import class_named
from ..geometry import WALL_COSINE, beside_wall, box_at, box_corners
from ..library import CadLibrary
from ..types import UNSUPPORTED, Box, ContactGraph, Entities, Entity, PlaneSet

MAX_ENTITY_PLANES = 8
"""The assignment visits 2^planes sets; of an entity with more planes these many count."""
_HUNG = ("wall", "opening")


@dataclasses.dataclass(frozen=True, eq=False)
class Query:
    """One entity that looks for models."""

    scene: int
    position: int
    """In the scene."""
    entity: Entity
    box: Box
    """B_x, refined: its bottom rests on the supporting plane, also where the lower part of the
    entity was never seen, and s_x would otherwise be too short."""
    rows: Int[np.ndarray, " rows"]
    """Its planes that count."""
    carries: Bool[np.ndarray, " rows"]
    """A child stands on this plane."""
    wall_normal: Float[np.ndarray, "3"]
    """Of the wall that it stands or hangs at, world frame; 0 where there is none."""
    models: Int[np.ndarray, " models"]
    """Positions in the library."""


def queries_of(
    scenes: Sequence[Entities],
    graphs: Sequence[ContactGraph],
    library: CadLibrary,
    wall_distance_m: float,
) -> list[Query]:
    """The functional entities of all scenes that have models to choose from, scene by scene."""
    found = []
    for number, (scene, graph) in enumerate(zip(scenes, graphs, strict=True)):
        for position, entity in enumerate(scene):
            if entity.is_layout or not class_named(entity.class_name).functional:
                continue
            models = mountable(library.matching_class(entity.class_name), library, graph, position)
            if not len(models):
                continue
            carrying = np.unique(graph.support_plane[graph.children(position)])
            rows = entity_rows(entity.planes, carrying)
            query = Query(
                scene=number,
                position=position,
                entity=entity,
                box=box_at(graph.refined_box, position),
                rows=rows,
                carries=np.isin(rows, carrying),
                wall_normal=wall_normal(scene, entity, wall_distance_m),
                models=models,
            )
            found.append(query)
    return found


def entity_rows(
    planes: PlaneSet, carrying: Int[np.ndarray, " carrying"]
) -> Int[np.ndarray, " rows"]:
    """Planes of an entity that count, ascending: carrying ones first, then by area."""
    valid = np.flatnonzero(planes.valid)
    keys = (-np.asarray(planes.area_m2)[valid], ~np.isin(valid, carrying))
    return np.sort(valid[np.lexsort(keys)][:MAX_ENTITY_PLANES])


def mountable(
    models: Int[np.ndarray, " models"],
    library: CadLibrary,
    graph: ContactGraph,
    position: int,
) -> Int[np.ndarray, " kept"]:
    """Of the models for an entity those that are mounted as it is held.

    A lamp stands, but some lamps hang on walls. Where a model is mounted on a wall while things
    of its class stand, it is for what the graph has on a wall or hanging, and there, on a wall,
    those that stand are left out if any hangs. One for an opening in furniture (an oven) is also
    for what nothing is known to carry: the furniture about it hides what holds it.

    Args:
        models: Positions in the library.
        library: Where they are.
        graph: What carries or holds the entity.
        position: Of the entity.
    """
    attachment = graph.attachment[position]
    held = attachment in ("wall", "hanging")
    hidden = attachment == "none" and graph.parent[position] == UNSUPPORTED
    allowed = {"wall": held, "opening": held or hidden}
    hung = np.array([_hung(library, i) for i in models.tolist()], bool)
    if attachment == "wall" and hung.any():
        return models[hung]
    fits = [not h or allowed[library[i].mount] for i, h in zip(models.tolist(), hung, strict=True)]
    return models[np.array(fits, bool)]


def _hung(library: CadLibrary, position: int) -> bool:
    """Whether a model is mounted on a wall or in an opening while things of its class stand."""
    model = library[position]
    return model.mount in _HUNG and class_named(model.class_name).mount not in _HUNG


def wall_normal(scene: Entities, entity: Entity, distance_m: float) -> Float[np.ndarray, "3"]:
    """Normal of the nearest wall within ``distance_m`` of an entity's box; 0 where none is.

    Only walls beside whose length the box lies count.
    """
    corners = np.asarray(box_corners(entity.box))
    nearest, best = distance_m, np.zeros(3, np.float32)
    for wall in scene:
        if not wall.is_layout or abs(wall.planes.normal[0, 2]) >= WALL_COSINE:
            continue
        normal = np.asarray(wall.planes.normal[0])
        gap = float(np.abs((corners @ normal + wall.planes.offset[0]).min()))
        # With openings, a wall has several rectangles in one plane.
        extent = np.asarray(wall.planes.corners)[np.asarray(wall.planes.valid)].reshape(-1, 3)
        if gap <= nearest and beside_wall(corners, normal, extent):
            nearest, best = gap, normal
    return best.astype(np.float32)
