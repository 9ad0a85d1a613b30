"""Terms of the matching distance for one entity and one rotated model."""

from __future__ import annotations

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Bool, Float

from ..geometry import rot_z, rotated_size
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
    """d_s."""
    upright: Float[Array, "*batch"]
    """d_b."""
    wall: Float[Array, "*batch"]
    """d_w."""
    plane_cost: Float[Array, "*batch rows columns"]
    """A summand of d_pi for each pair of planes; inf where f may not map so."""


def pair_terms(
    entity: EntityFeatures,
    model: ModelFeatures,
    rotation: Float[Array, "3 3"],
    up_cosine: Float[Array, ""],
) -> PairTerms:
    """Terms of the matching distance (Section V-B) for one of the 24 rotations R of the model.

    d_s = || s_x/||s_x|| - s_y/||s_y|| ||          d_b = 1 + g . z(y) = 1 - R[z, z]
    d_pi summand = | d(T_x^T pi_i)/||s_x|| - d(pi_j)/||s_y|| | + 1 - n(T_x^T pi_i) . n(pi_j)

    s_y and pi_j are those of the model after R. T_x^T pi is the plane seen from the frame of B_x:
    n_b = R_x^T n, d_b = d + n . p_x. Beyond the paper, as its released code has it, backs go to
    walls: with the front -y of a model and the normal n_w of the wall that x is at,

    d_w = 1 - n_w . R_x R (-y),   0 where x is at no wall.

    f keeps supporting planes supporting: a plane of x that
    faces up goes only to planes that face up after R, whatever they did before it.

    Args:
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
