"""What `align` reads and returns: flat arrays over (entity, candidate) pairs."""

from __future__ import annotations

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Bool, Float, Int

from ..config import AlignmentSettings
from ..geometry import rotated_size
from ..types import Array, Box

DEFAULT_SETTINGS = AlignmentSettings()


class AlignmentWeights(eqx.Module):
    """Weights of the residuals, linear: the cost holds their squares (Sigma in the paper)."""

    support: Float[Array, ""]
    """Of heights of supporting planes, 1/m."""
    normal: Float[Array, ""]
    """Of plane normals."""
    offset: Float[Array, ""]
    """Of plane offsets, 1/m."""
    footprint: Float[Array, ""]
    """Of the footprint inside the entity's box, 1/m."""
    height: Float[Array, ""]
    """Of equal half heights, 1/m."""
    scale: Float[Array, ""]
    """Of log alpha."""
    prior: Float[Array, ""]
    """Of the start; keeps the system regular."""

    @classmethod
    def of(cls, settings: AlignmentSettings) -> AlignmentWeights:
        """The weights that the settings give."""
        return cls(
            support=np.asarray(settings.weight_support, np.float32),
            normal=np.asarray(settings.weight_normal, np.float32),
            offset=np.asarray(settings.weight_offset, np.float32),
            footprint=np.asarray(settings.weight_footprint, np.float32),
            height=np.asarray(settings.weight_height, np.float32),
            scale=np.asarray(settings.weight_scale, np.float32),
            prior=np.asarray(settings.prior_weight, np.float32),
        )


class AlignmentProblem(eqx.Module):
    """Pairs of an entity x and a candidate y; row k of the planes is a matched pair."""

    box: Box
    """B_x, world frame."""
    support_height_m: Float[Array, "*batch"]
    """Height of the plane that carries x, where x stands."""
    entity_normal: Float[Array, "*batch planes 3"]
    """Of pi_k of x, world frame."""
    entity_offset: Float[Array, "*batch planes"]
    model_size: Float[Array, "*batch 3"]
    """s_y, canonical frame, before the rotation."""
    model_normal: Float[Array, "*batch planes 3"]
    """Of f(pi_k) of y, canonical frame."""
    model_offset: Float[Array, "*batch planes"]
    plane_valid: Bool[Array, "*batch planes"]
    """False where x's plane has no partner, and for padding."""
    plane_supporting: Bool[Array, "*batch planes"]
    """Both pi_k and f(pi_k) carry: n . g <= a_th (Eq. 1). A turn about z leaves that as it is."""
    rotation: Float[Array, "*batch 3 3"]
    """One of `geometry.CUBE_ROTATIONS`, applied to y first."""
    start: Float[Array, "*batch 4"]
    """Scale, yaw off the box (radians), shift off the box centre along the box's x and y (m)."""
    valid: Bool[Array, "*batch"]
    """False for padding."""


class AlignmentSolution(eqx.Module):
    """What `align` found, on the axis of its problem. Always finite."""

    scale: Float[Array, "*batch"]
    """alpha."""
    yaw: Float[Array, "*batch"]
    """World yaw of the rotated model, radians."""
    translation: Float[Array, "*batch 3"]
    """p: where the centre of the model's box goes, world frame, metres."""
    T_world_cad: Float[Array, "*batch 4 4"]
    """[Rot(z, yaw) R, p] without the scale, R the rotation of the problem."""
    cost: Float[Array, "*batch"]
    """J at the solution, the prior left out; 0 for padding."""
    status: Int[Array, "*batch"]
    """`AlignmentStatus`."""
    num_steps: Int[Array, "*batch"]


def default_start(box: Box, model_size: Array, rotation: Array) -> Float[Array, "*batch 4"]:
    """Equal heights, no turn, centred: where `align` starts when nothing better is known."""
    up = rotated_size(rotation, model_size)[..., 2]
    scale = box.size[..., 2] / jnp.where(up > 0, up, 1.0)
    zero = jnp.zeros_like(scale)
    return jnp.stack([scale, zero, zero, zero], -1)


def unit_problem(like: AlignmentProblem) -> AlignmentProblem:
    """A solved problem of the shapes of the unbatched ``like``: stands in for lanes without one."""
    zeros = jax.tree.map(jnp.zeros_like, like)
    one = jnp.ones(3, like.model_size.dtype)
    return AlignmentProblem(
        box=Box(zeros.box.center, zeros.box.yaw, one),
        support_height_m=zeros.support_height_m - 0.5,
        entity_normal=zeros.entity_normal,
        entity_offset=zeros.entity_offset,
        model_size=one,
        model_normal=zeros.model_normal,
        model_offset=zeros.model_offset,
        plane_valid=zeros.plane_valid,
        plane_supporting=zeros.plane_supporting,
        rotation=jnp.eye(3, dtype=like.rotation.dtype),
        start=jnp.eye(4, dtype=like.start.dtype)[0],
        valid=zeros.valid,
    )
