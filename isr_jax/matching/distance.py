"""The matching distance D of entities and models: Eq. 4 to 7, and what we add to them."""

from __future__ import annotations

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Bool, Float

from ..geometry import CUBE_ROTATIONS, rot_z, rotated_size
from ..types import Array, Box


class EntityFeatures(eqx.Module):
    """What matching reads of an entity x."""

    box: Box
    """B_x, with its bottom on the supporting plane."""
    normal: Float[Array, "*batch rows 3"]
    """World frame, unit, outward."""
    offset: Float[Array, "*batch rows"]
    valid: Bool[Array, "*batch rows"]
    carries: Bool[Array, "*batch rows"]
    """A child stands on this plane: it must find a partner."""
    wall_normal: Float[Array, "*batch 3"]
    """Of the wall that x stands or hangs at, world frame; 0 where there is none."""


class ModelFeatures(eqx.Module):
    """What matching reads of a model y, canonical frame."""

    size: Float[Array, "*batch 3"]
    normal: Float[Array, "*batch columns 3"]
    offset: Float[Array, "*batch columns"]
    valid: Bool[Array, "*batch columns"]


class PairTerms(eqx.Module):
    """Terms of D(x, y) before the planes are assigned."""

    size: Float[Array, "*batch"]
    """d_s (Eq. 5)."""
    upright: Float[Array, "*batch"]
    """d_b (Eq. 7)."""
    wall: Float[Array, "*batch"]
    """d_w, ours."""
    plane_cost: Float[Array, "*batch rows columns"]
    """A summand of d_pi (Eq. 6) for each pair of planes; inf where f may not map so."""


@jax.jit
def matching_errors(
    x: EntityFeatures,
    y: ModelFeatures,
    weights: Float[Array, "4"],
    unmatched_cost: Float[Array, ""],
    up_cosine: Float[Array, ""],
) -> Float[Array, "pairs 24"]:
    """D of pairs in all 24 rotations of y (Eq. 4); inf where y is rejected.

    D(x, y) = w_s d_s + w_pi d_pi + w_b d_b + w_w d_w

    The paper has no d_w; with w_w = 0 it is the paper's. Where the paper's f is a bijection, a
    plane of x may stay without partner at a price, unless a child stands on it.

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


def pair_terms(
    entity: EntityFeatures,
    model: ModelFeatures,
    rotation: Float[Array, "3 3"],
    up_cosine: Float[Array, ""],
) -> PairTerms:
    """Terms of the matching distance for one of the 24 rotations R of the model.

    d_s = || s_x/||s_x|| - s_y/||s_y|| ||                                                (Eq. 5)
    d_pi = min over f of the sum over i, with j = f(i), of                               (Eq. 6)
           | d(T_x^T pi_i)/||s_x|| - d(pi_j)/||s_y|| | + 1 - n(T_x^T pi_i) . n(pi_j)
    d_b = 1 + g . z(y) = 1 - R[z, z]                                                     (Eq. 7)

    s_y and pi_j are those of the model after R. T_x^T pi is the plane seen from the frame of B_x:
    n_b = R_x^T n, d_b = d + n . p_x. f keeps supporting planes supporting: a plane of x that faces
    up goes only to planes that face up after R, whatever they did before it.

    Beyond the paper, as its released code has it, backs go to walls: with the front -y of a model
    and the normal n_w of the wall that x is at,

    d_w = 1 - n_w . R_x R (-y),   0 where x is at no wall.

    Args:
        entity: x.
        model: y, canonical frame.
        rotation: R.
        up_cosine: A plane faces up if its normal's z is at least this.
    """
    normal_x = entity.normal @ rot_z(entity.box.yaw)
    offset_x = entity.offset + entity.normal @ entity.box.center
    normal_y, size_y = model.normal @ rotation.T, rotated_size(rotation, model.size)
    diagonal_x, diagonal_y = _norm(entity.box.size), _norm(size_y)

    relative = offset_x[:, None] / diagonal_x - model.offset[None, :] / diagonal_y
    cost = jnp.abs(relative) + 1.0 - normal_x @ normal_y.T
    supporting_x, supporting_y = normal_x[:, 2] >= up_cosine, normal_y[:, 2] >= up_cosine
    allowed = supporting_y[None, :] | ~supporting_x[:, None]
    allowed &= entity.valid[:, None] & model.valid[None, :]
    front = rot_z(entity.box.yaw) @ -rotation[:, 1]
    at_wall = jnp.any(entity.wall_normal != 0)
    return PairTerms(
        size=jnp.linalg.norm(entity.box.size / diagonal_x - size_y / diagonal_y),
        upright=1.0 - rotation[2, 2],
        wall=jnp.where(at_wall, 1.0 - entity.wall_normal @ front, 0.0),
        plane_cost=jnp.where(allowed, jnp.maximum(cost, 0.0), jnp.inf),
    )


def _norm(size: Float[Array, "3"]) -> Float[Array, ""]:
    return jnp.maximum(jnp.linalg.norm(size), 1e-6)


def unmatched_price(
    x: EntityFeatures, unmatched_cost: Float[Array, ""]
) -> Float[Array, "*batch rows"]:
    """What it costs to leave a plane without partner; inf where a child stands on it."""
    return jnp.where(x.valid, jnp.where(x.carries, jnp.inf, unmatched_cost), 0.0)


def assignment_cost(
    cost: Float[Array, "rows columns batch"], unmatched: Float[Array, "rows batch"]
) -> Float[Array, " batch"]:
    """Least total cost of giving every row its own column, or none at that row's price.

    A dynamic programme over the 2^rows sets of assigned rows, one column at a time:

        best(S) <- min(best(S), min over i in S of best(S - i) + cost[i, column])

    which starts from best(S) = what it costs to leave all of S unmatched. The problems lie along
    the last axis, since the programme is the same for each: every step is one elementwise pass.

    Args:
        cost: inf where a pair is forbidden.
        unmatched: inf where a row must find a partner; inf comes back where it cannot. Rows of
            padding cost 0 unmatched and inf in every column.
    """
    rows = cost.shape[0]
    best = jnp.zeros((1, cost.shape[-1]), cost.dtype)
    for i in range(rows):  # bit i of a set's number says whether row i is in it
        best = jnp.concatenate([best, best + unmatched[i]])

    def offer(best, column):
        return _with_column(best, column), None

    best, _ = jax.lax.scan(offer, best, jnp.moveaxis(cost, 1, 0))
    return best[-1]


def _with_column(
    best: Float[Array, "sets batch"], column: Float[Array, "rows batch"]
) -> Float[Array, "sets batch"]:
    """One more column offered to every set of rows."""
    sets = np.arange(best.shape[0])
    improved = best
    for i in range(column.shape[0]):
        without = sets & ~(1 << i)
        taken = jnp.where((sets != without)[:, None], best[without] + column[i], jnp.inf)
        improved = jnp.minimum(improved, taken)
    return improved
