"""Matching errors D of (entity, model) pairs in all 24 rotations, in blocks of one size."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Sequence

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Float, Int

from ..config import MatchingSettings
from ..geometry import CUBE_ROTATIONS
from ..library import CadLibrary
from ..library.arrays import MAX_MODEL_PLANES
from ..types import Array, ContactGraph, Entity
from .assignment import assignment_cost
from .costs import EntityFeatures, ModelFeatures, pair_terms
from .features import MAX_ENTITY_PLANES, entity_features, model_features

BLOCK = 32
"""Pairs a call: 768 lanes, whose 2^8 sets stay in the cache (measured: 2x the speed of 1536)."""
_ROWS = (4, 6, MAX_ENTITY_PLANES)
_COLUMNS = (MAX_MODEL_PLANES // 2, MAX_MODEL_PLANES)


@dataclasses.dataclass(frozen=True, eq=False)
class Query:
    """One entity that looks for models."""

    scene: int
    position: int
    entity: Entity
    graph: ContactGraph
    models: Int[np.ndarray, " models"]
    """Positions in the library."""
    rows: Int[np.ndarray, " rows"]
    """Its planes that count."""
    wall_normal: Float[np.ndarray, "3"]

    def features(self, width: int) -> EntityFeatures:
        return entity_features(
            self.entity, self.graph, self.position, self.rows, width, self.wall_normal
        )


def all_errors(
    queries: Sequence[Query],
    library: CadLibrary,
    settings: MatchingSettings,
    up_cosine: float,
) -> list[Float[np.ndarray, "models 24"]]:
    """D of every (query, model, rotation); inf where the model is rejected.

    Pairs are grouped by the padded number of planes, since the assignment's cost doubles with
    each plane of the entity.
    """
    results = [np.full((len(q.models), 24), np.inf, np.float32) for q in queries]
    numbers = _numbers(settings, up_cosine)
    for (height, width), members in _by_shape(queries, library).items():
        number, slot, model = np.array(members).T
        askers, x_row = np.unique(number, return_inverse=True)
        asked, y_row = np.unique(model, return_inverse=True)
        x = stack([queries[n].features(height) for n in askers.tolist()])
        y = model_features(library.arrays, asked, width)
        for rows, count in blocks(len(members)):
            error = matching_errors(take(x, x_row[rows]), take(y, y_row[rows]), *numbers)
            for row, each in zip(rows[:count], np.asarray(error), strict=False):
                results[number[row]][slot[row]] = each
    return results


def _by_shape(
    queries: Sequence[Query], library: CadLibrary
) -> dict[tuple[int, int], list[tuple[int, int, int]]]:
    """(query, slot, model) of every pair, by the padded numbers of planes of both."""
    groups: dict[tuple[int, int], list[tuple[int, int, int]]] = {}
    columns = [_width(count, _COLUMNS) for count in library.arrays.plane_count.tolist()]
    for number, query in enumerate(queries):
        for slot, model in enumerate(query.models.tolist()):
            shape = _width(len(query.rows), _ROWS), columns[model]
            groups.setdefault(shape, []).append((number, slot, model))
    return groups


def _width(count: int, buckets: tuple[int, ...]) -> int:
    return next(b for b in buckets if b >= count)


def blocks(total: int) -> Iterator[tuple[np.ndarray, int]]:
    """Rows `BLOCK` at a time and how many of them are new: every call has one shape."""
    for first in range(0, total, BLOCK):
        rows = np.arange(first, first + BLOCK)
        yield np.where(rows < total, rows, first), min(BLOCK, total - first)


def stack(rows: list):
    """Feature rows as one batch."""
    return jax.tree.map(lambda *leaves: np.stack(leaves), *rows)


def take(batch, rows: np.ndarray):
    """The same rows of every array of a batch."""
    return jax.tree.map(lambda leaf: leaf[rows], batch)


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


@jax.jit
def matching_errors(
    x: EntityFeatures,
    y: ModelFeatures,
    weights: Float[Array, "4"],
    unmatched_cost: Float[Array, ""],
    up_cosine: Float[Array, ""],
) -> Float[Array, "pairs 24"]:
    """D(x, y) = w_s d_s + w_pi d_pi + w_b d_b + w_w d_w of pairs, in all 24 rotations of y.

    Args:
        x: [pairs] entities.
        y: [pairs] models.
        weights: w_s, w_pi, w_b, w_w.
        unmatched_cost: Of a plane of x without partner; inf rejects the model.
        up_cosine: A plane is supporting if its normal's z is at least this.
    """
    rotations = jnp.asarray(CUBE_ROTATIONS)
    one_pair = jax.vmap(pair_terms, (None, None, 0, None))
    terms = jax.vmap(one_pair, (0, 0, None, None))(x, y, rotations, up_cosine)
    pairs, turns, rows, columns = terms.plane_cost.shape
    cost = jnp.moveaxis(terms.plane_cost.reshape(pairs * turns, rows, columns), 0, -1)
    price = jnp.repeat(unmatched_price(x, unmatched_cost), turns, axis=0).T
    planes = assignment_cost(cost, price).reshape(pairs, turns)
    total = weights[0] * terms.size + weights[1] * planes
    total += weights[2] * terms.upright + weights[3] * terms.wall
    return jnp.where(jnp.isfinite(planes), total, jnp.inf)  # a weight of 0 times inf is NaN


def unmatched_price(
    x: EntityFeatures, unmatched_cost: Float[Array, ""]
) -> Float[Array, "*batch rows"]:
    """What it costs to leave a plane without partner; inf where a child stands on it."""
    return jnp.where(x.valid, jnp.where(x.carries, jnp.inf, unmatched_cost), 0.0)
