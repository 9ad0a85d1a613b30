"""Which plane of a model goes with which of the entity, for the chosen candidates (host)."""

from __future__ import annotations

from collections.abc import Sequence

import jax
import numpy as np
from jaxtyping import Float, Int
from scipy.optimize import linear_sum_assignment

from ..geometry import CUBE_ROTATIONS
from ..library import CadLibrary
from ..library.arrays import MAX_MODEL_PLANES
from ..runtime.batches import in_blocks, take_rows
from .distance import pair_terms, unmatched_price
from .queries import MAX_ENTITY_PLANES, Query
from .scoring import BLOCK, entity_features, model_features
from .selection import Best

_terms = jax.jit(jax.vmap(pair_terms, (0, 0, 0, None)))


def plane_matches(
    queries: Sequence[Query],
    best: Best,
    library: CadLibrary,
    unmatched_cost: float,
    up_cosine: float,
) -> Int[np.ndarray, "best planes"]:
    """f (Eq. 6) of each candidate: the model's plane for each plane of the entity, else -1.

    The batched programme gives the values of d_pi only; the few candidates that were chosen are
    assigned again, one by one.
    """
    widths = [len(query.entity.planes.offset) for query in queries]
    matches = np.full((len(best.query), max([MAX_ENTITY_PLANES, *widths])), -1, np.int32)
    if not len(matches):
        return matches
    models, y_row = np.unique(best.model, return_inverse=True)
    x = entity_features(queries, MAX_ENTITY_PLANES)
    y = model_features(library, models, MAX_MODEL_PLANES)
    turn, up = CUBE_ROTATIONS[best.rotation], np.asarray(up_cosine, np.float32)

    def arguments(rows):
        return take_rows(x, best.query[rows]), take_rows(y, y_row[rows]), turn[rows], up

    cost = in_blocks(_terms, arguments, len(matches), BLOCK).plane_cost
    price = np.asarray(unmatched_price(x, np.asarray(unmatched_cost, np.float32)))
    for row, number in enumerate(best.query.tolist()):
        planes = queries[number].rows
        column = _assigned_columns(cost[row, : len(planes)], price[number, : len(planes)])
        found = column >= 0
        matches[row, planes[found]] = library.arrays.column[best.model[row], column[found]]
    return matches


def _assigned_columns(
    cost: Float[np.ndarray, "rows columns"], unmatched: Float[np.ndarray, " rows"]
) -> Int[np.ndarray, " rows"]:
    """The column of each row, -1 = none: one extra column per row stands for "without partner"."""
    alone = np.full((len(cost), len(cost)), np.inf)
    np.fill_diagonal(alone, unmatched)
    _, column = linear_sum_assignment(np.concatenate([cost, alone], axis=1))
    return np.where(column < cost.shape[1], column, -1)
