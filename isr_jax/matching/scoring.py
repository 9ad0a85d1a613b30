"""Matching errors D of every query with its models, in blocks of one size (host)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float, Int

from ..config import MatchingSettings
from ..geometry import stack_boxes, stack_planes
from ..library import CadLibrary
from ..library.arrays import MAX_MODEL_PLANES
from ..runtime.batches import in_blocks, take_rows
from .distance import EntityFeatures, ModelFeatures, matching_errors
from .queries import MAX_ENTITY_PLANES, Query

BLOCK = 32
"""Pairs per call: 768 lanes, whose 2^8 sets stay in the cache (measured: 2x the speed of 1536)."""
_ROWS = np.array([4, 6, MAX_ENTITY_PLANES])
_COLUMNS = np.array([MAX_MODEL_PLANES // 2, MAX_MODEL_PLANES])
"""Numbers of planes of entities and of models that kernels are compiled for."""


def all_errors(
    queries: Sequence[Query],
    library: CadLibrary,
    settings: MatchingSettings,
    up_cosine: float,
) -> list[Float[np.ndarray, "_ 24"]]:
    """D of every (query, model, rotation); inf where the model is rejected.

    Pairs are grouped by the padded numbers of planes, since the assignment's cost doubles with
    each plane of the entity.
    """
    counts = [len(query.models) for query in queries]
    owner = np.repeat(np.arange(len(queries)), counts)
    model = np.concatenate([np.zeros(0, np.int32), *(query.models for query in queries)])
    error = np.full((len(owner), 24), np.inf, np.float32)
    height = _padded_size(np.array([len(query.rows) for query in queries], int), _ROWS)[owner]
    width = _padded_size(library.arrays.plane_count, _COLUMNS)[model]
    numbers = _numbers(settings, up_cosine)
    for shape in np.unique(np.stack([height, width], 1), axis=0):
        pairs = np.flatnonzero((height == shape[0]) & (width == shape[1]))
        entities, x_row = np.unique(owner[pairs], return_inverse=True)
        models, y_row = np.unique(model[pairs], return_inverse=True)
        x = entity_features([queries[number] for number in entities.tolist()], int(shape[0]))
        y = model_features(library, models, int(shape[1]))
        error[pairs] = _pair_errors(x, x_row, y, y_row, numbers)
    return np.split(error, np.cumsum(counts)[:-1]) if queries else []


def _pair_errors(
    x: EntityFeatures,
    x_row: Int[np.ndarray, " pairs"],
    y: ModelFeatures,
    y_row: Int[np.ndarray, " pairs"],
    numbers: tuple[np.ndarray, ...],
) -> Float[np.ndarray, "pairs 24"]:
    """D of pairs of rows of ``x`` and ``y``."""

    def arguments(pairs):
        return take_rows(x, x_row[pairs]), take_rows(y, y_row[pairs]), *numbers

    return in_blocks(matching_errors, arguments, len(x_row), BLOCK)


def _padded_size(
    count: Int[np.ndarray, " sets"], sizes: Int[np.ndarray, " sizes"]
) -> Int[np.ndarray, " sets"]:
    """The least of the sizes that holds each count."""
    return sizes[np.searchsorted(sizes, count)]


def entity_features(queries: Sequence[Query], width: int) -> EntityFeatures:
    """Features [queries] of entities, their planes that count padded to ``width``."""
    planes = stack_planes([take_rows(q.entity.planes, q.rows) for q in queries], width)
    carries = np.zeros((len(queries), width), bool)
    for row, query in zip(carries, queries, strict=True):
        row[: len(query.rows)] = query.carries
    return EntityFeatures(
        box=stack_boxes([query.box for query in queries]),
        normal=planes.normal,
        offset=planes.offset,
        valid=planes.valid,
        carries=carries,
        wall_normal=np.stack([query.wall_normal for query in queries]),
    )


def model_features(
    library: CadLibrary, models: Int[np.ndarray, " models"], width: int
) -> ModelFeatures:
    """Features [models] of models of a library, their planes that count cut to ``width``."""
    arrays = library.arrays
    normal, offset = arrays.normal[models, :width], arrays.offset[models, :width]
    return ModelFeatures(arrays.size[models], normal, offset, arrays.valid[models, :width])


def _numbers(settings: MatchingSettings, up_cosine: float) -> tuple[np.ndarray, ...]:
    """Settings as arrays, so that sweeping them recompiles nothing."""
    weights = [
        settings.weight_size,
        settings.weight_planes,
        settings.weight_upright,
        settings.weight_wall,
    ]
    values = (weights, settings.unmatched_cost, up_cosine)
    return tuple(np.asarray(value, np.float32) for value in values)
