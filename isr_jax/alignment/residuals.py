"""The residuals of the alignment (Sec. V-C), for one pair."""

from __future__ import annotations

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Bool, Float

from ..config import NormalResidual
from ..geometry import plane_height_at, rot_z, rotated_size, transform_planes
from ..types import Array
from .problem import AlignmentProblem, AlignmentWeights

_CORNERS = np.array([(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)])
_START_MARGIN = 0.9
"""At a bound the sine is flat and LM would stay there, so no start is nearer to one."""


class ScaleBounds(eqx.Module):
    """Bounds of alpha, met by log alpha = mid + half sin(u).

    With a sine a solution at a bound lies at a finite u, where LM converges; with a sigmoid it
    lies at infinity. There d alpha / du = 0, so alpha rightly has no derivative.
    """

    low: Float[Array, ""]
    high: Float[Array, ""]

    def _middle(self):
        low, high = jnp.log(self.low), jnp.log(self.high)
        return (low + high) / 2, jnp.maximum((high - low) / 2, 1e-6)

    def scale(self, u: Float[Array, "*batch"]) -> Float[Array, "*batch"]:
        """alpha at ``u``."""
        middle, half = self._middle()
        return jnp.exp(middle + half * jnp.sin(u))

    def start(self, scale: Float[Array, "*batch"]) -> Float[Array, "*batch"]:
        """``u`` at ``scale``, kept off the bounds."""
        middle, half = self._middle()
        share = (jnp.log(jnp.maximum(scale, 1e-6)) - middle) / half
        return jnp.arcsin(jnp.clip(share, -_START_MARGIN, _START_MARGIN))


class Pose(eqx.Module):
    """T = [alpha Rot(z, yaw), p] (Eq. 8) in the frame of x's box."""

    scale: Float[Array, ""]
    yaw: Float[Array, ""]
    translation: Float[Array, "3"]


def pose_at(x: Float[Array, "4"], problem: AlignmentProblem, bounds: ScaleBounds) -> Pose:
    """The pose of the unknowns (u, yaw, t_x, t_y), standing on its support:

    T = [alpha Rot(z, theta), p; 0, 1],  p^g = -d^s + alpha s_y^g / 2  (Eq. 8 and below it)

    The height is met exactly, so four numbers are left; alpha, free in the paper, is bounded.
    """
    scale = bounds.scale(x[0])
    size_up = rotated_size(problem.rotation, problem.model_size)[2]
    up = problem.support_height_m + scale * size_up / 2 - problem.box.center[2]
    return Pose(scale, x[1], jnp.stack([x[2], x[3], up]))


def unknowns_at_start(problem: AlignmentProblem, bounds: ScaleBounds) -> Float[Array, "4"]:
    """The unknowns (u, yaw, t_x, t_y) of the problem's start."""
    return jnp.concatenate([bounds.start(problem.start[0])[None], problem.start[1:]])


def box_residuals(
    pose: Pose, problem: AlignmentProblem, weights: AlignmentWeights
) -> Float[Array, "10"]:
    """e_b: the moved footprint inside x's, and equal heights (Eq. 10); beyond the paper, size.

    e_b = [A(T y) - A(x, T y), alpha s_y^g - s_x^g]

    A(T y) - A(x, T y) has no derivative where it is 0 or where the footprints part, so each
    corner of the moved, turned footprint has a hinge to the sides of x's rectangle instead. A
    corner can lie beyond one of two opposite sides only: |c| serves both. Heights are compared
    by halves, as in the released code. log alpha is added: models come in true size, and a
    half-seen entity says too little about it.
    """
    size = rotated_size(problem.rotation, problem.model_size) * pose.scale
    corners = (
        jnp.asarray(_CORNERS, size.dtype) * size[:2] @ rot_z(pose.yaw)[:2, :2].T
        + pose.translation[:2]
    )
    beyond = jnp.maximum(jnp.abs(corners) - problem.box.size[:2] / 2, 0.0)
    height = (size[2] - problem.box.size[2]) / 2
    stretch = jnp.log(pose.scale)
    return jnp.concatenate(
        [
            weights.footprint * beyond.ravel(),
            weights.height * height[None],
            weights.scale * stretch[None],
        ]
    )


def plane_residuals(
    pose: Pose,
    problem: AlignmentProblem,
    weights: AlignmentWeights,
    normal_residual: NormalResidual,
) -> Float[Array, " residuals"]:
    """e_p: offsets and normals of matched planes (Eq. 11), and heights of supporting ones.

    Delta pi_i = [d(T^-T f(pi_i)) - d(pi_i), 1 - n(pi_i) . n(T^-T f(pi_i))]

    Planes are taken in the frame of x's box, where offsets are small: in the world frame a
    turn changes them by its distance from the origin. The paper's normal residual 1 - n . n'
    is quartic once squared; n - n' has the same minimum and |n - n'|^2 / 2 = 1 - n . n'.
    """
    R_box = rot_z(problem.box.yaw)
    normal = problem.entity_normal @ R_box
    offset = problem.entity_offset + problem.entity_normal @ problem.box.center
    moved_normal, moved_offset = transform_planes(
        pose.scale,
        rot_z(pose.yaw) @ problem.rotation,
        pose.translation,
        problem.model_normal,
        problem.model_offset,
    )
    live = problem.plane_valid
    supporting = live & problem.plane_supporting
    normal_gap = normal - moved_normal
    if normal_residual == "paper":
        normal_gap = 1.0 - jnp.sum(normal * moved_normal, -1, keepdims=True)
    center = jnp.zeros_like(pose.translation)
    height_gap = _heights(normal, offset, center, supporting)
    height_gap -= _heights(moved_normal, moved_offset, pose.translation, supporting)
    parts = [
        jnp.where(live[:, None], weights.normal * normal_gap, 0.0).ravel(),
        jnp.where(live, weights.offset * (offset - moved_offset), 0.0),
        jnp.where(supporting, weights.support * height_gap, 0.0),
    ]
    return jnp.concatenate(parts)


def _heights(
    normal: Float[Array, "planes 3"],
    offset: Float[Array, " planes"],
    at: Float[Array, "3"],
    supporting: Bool[Array, " planes"],
) -> Float[Array, " planes"]:
    """Heights of the supporting planes at ``at``'s horizontal position; finite for the others."""
    up = jnp.where(supporting[:, None], normal, jnp.array([0.0, 0.0, 1.0], normal.dtype))
    return jax.vmap(plane_height_at, (0, 0, None))(up, offset, at[:2])


def residuals(
    pose: Pose,
    problem: AlignmentProblem,
    weights: AlignmentWeights,
    normal_residual: NormalResidual,
) -> Float[Array, " residuals"]:
    """sqrt(Sigma) e, whose squares sum to J = e_b^T Sigma_b e_b + e_p^T Sigma_p e_p (Eq. 9)."""
    return jnp.concatenate(
        [
            box_residuals(pose, problem, weights),
            plane_residuals(pose, problem, weights, normal_residual),
        ]
    )


def prior_residuals(
    x: Float[Array, "4"],
    problem: AlignmentProblem,
    weights: AlignmentWeights,
    bounds: ScaleBounds,
) -> Float[Array, "4"]:
    """Pull to the start; decides what planes and hinges leave open."""
    return weights.prior * (x - unknowns_at_start(problem, bounds))
