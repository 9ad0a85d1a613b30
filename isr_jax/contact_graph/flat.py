"""All entities of all scenes on one flat axis (host)."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence

import numpy as np
from jaxtyping import Bool, Float, Int

from ..classes import class_named
from ..geometry import stack_boxes, stack_planes
from ..types import Box, Entities, Entity, PlaneSet


@dataclasses.dataclass(frozen=True, eq=False)
class FlatEntities:
    """Entities of many scenes, end to end."""

    items: tuple[Entity, ...]
    scene: Int[np.ndarray, " entities"]
    """Scene of each entity."""
    start: Int[np.ndarray, " scenes1"]
    """Where each scene starts, and where the last one ends."""
    voxel_m: Float[np.ndarray, " entities"]
    box: Box
    bottom: Float[np.ndarray, " entities"]
    planes: PlaneSet
    """[entities, planes], padded to the most that any entity has."""
    is_layout: Bool[np.ndarray, " entities"]
    mount: np.ndarray
    """Mount of each entity's class."""
    rank: Int[np.ndarray, " entities"]
    """Order from the lowest bottom up, ties by id; a thing carries only things of higher rank."""

    def slice(self, scene: int) -> range:
        """Positions of one scene."""
        return range(int(self.start[scene]), int(self.start[scene + 1]))


def flatten(scenes: Sequence[Entities]) -> FlatEntities:
    """Lay the entities of ``scenes`` end to end."""
    items = tuple(entity for scene in scenes for entity in scene)
    counts = [len(scene) for scene in scenes]
    box = stack_boxes([entity.box for entity in items])
    bottom = np.asarray(box.center[:, 2] - box.size[:, 2] / 2)
    ids = np.array([entity.id for entity in items], np.int64)
    rank = np.empty(len(items), np.int32)
    rank[np.lexsort((ids, bottom))] = np.arange(len(items), dtype=np.int32)
    return FlatEntities(
        items=items,
        scene=np.repeat(np.arange(len(scenes), dtype=np.int32), counts),
        start=np.cumsum([0, *counts]).astype(np.int32),
        voxel_m=np.repeat(np.array([s.voxel_size_m for s in scenes], np.float32), counts),
        box=box,
        bottom=bottom,
        planes=stack_planes([entity.planes for entity in items]),
        is_layout=np.array([entity.is_layout for entity in items], bool),
        mount=np.array([class_named(entity.class_name).mount for entity in items], "U8"),
        rank=rank,
    )
