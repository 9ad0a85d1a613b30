"""Entities and models as padded feature rows for the kernels (host)."""

from __future__ import annotations

import jax
import numpy as np
from jaxtyping import Int

from ..library import CadModel
from ..library.arrays import LibraryArrays, counted_planes
from ..types import ContactGraph, Entity, PlaneSet
from .costs import EntityFeatures, ModelFeatures

MAX_ENTITY_PLANES = 8
"""The assignment visits 2^planes sets; of an entity with more planes these many count."""


def entity_rows(planes: PlaneSet, carrying: np.ndarray) -> Int[np.ndarray, " rows"]:
    """Planes of an entity that count, ascending: carrying ones first, then by area."""
    valid = np.flatnonzero(planes.valid)
    keys = (-np.asarray(planes.area_m2)[valid], ~np.isin(valid, carrying))
    return np.sort(valid[np.lexsort(keys)][:MAX_ENTITY_PLANES])


def model_columns(model: CadModel) -> Int[np.ndarray, " columns"]:
    """Planes of a model that count, ascending: supporting ones first, then by area."""
    return counted_planes(model.planes, model.plane_supporting)


def carrying_planes(graph: ContactGraph, position: int) -> Int[np.ndarray, " planes"]:
    """Planes of an entity on which a child stands."""
    return np.unique(graph.support_plane[graph.children(position)])


def entity_features(
    entity: Entity,
    graph: ContactGraph,
    position: int,
    rows: np.ndarray,
    width: int,
    wall_normal: np.ndarray,
) -> EntityFeatures:
    """Feature row of one entity, padded to ``width`` planes.

    The box is the refined one: its bottom rests on the supporting plane, also where the lower
    part of the entity was never seen, and s_x would otherwise be too short.
    """
    carries = np.zeros(width, bool)
    carries[: len(rows)] = np.isin(rows, carrying_planes(graph, position))
    box = jax.tree.map(lambda leaf: np.asarray(leaf[position], np.float32), graph.refined_box)
    normal, offset, valid = _pad(entity.planes, rows, width)
    return EntityFeatures(box, normal, offset, valid, carries, wall_normal)


def model_features(arrays: LibraryArrays, rows: np.ndarray, width: int) -> ModelFeatures:
    """Features [rows] of models of a library, cut or padded to ``width`` planes."""
    normal, offset = arrays.normal[rows, :width], arrays.offset[rows, :width]
    return ModelFeatures(arrays.size[rows], normal, offset, arrays.valid[rows, :width])


def _pad(
    planes: PlaneSet, rows: np.ndarray, width: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Normals, offsets and mask of the chosen planes; padding faces up with offset 0."""
    normal, offset = np.zeros((width, 3), np.float32), np.zeros(width, np.float32)
    normal[:, 2] = 1.0
    normal[: len(rows)] = np.asarray(planes.normal)[rows]
    offset[: len(rows)] = np.asarray(planes.offset)[rows]
    return normal, offset, np.arange(width) < len(rows)
