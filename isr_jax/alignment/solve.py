"""`align`: one batched Levenberg-Marquardt solve over all (entity, candidate) pairs."""

from __future__ import annotations

import functools

import jax
import jax.numpy as jnp
import lineax as lx
import optimistix as optx
from jaxtyping import Bool, Float

from ..config import AlignmentSettings
from ..geometry import make_T, rot_z, wrap_angle
from ..types import AlignmentStatus, Array
from .problem import (
    DEFAULT_SETTINGS,
    AlignmentProblem,
    AlignmentSolution,
    AlignmentWeights,
    unit_problem,
)
from .residuals import (
    Pose,
    ScaleBounds,
    pose_at,
    prior_residuals,
    residuals,
    unknowns_at_start,
)

_AT_BOUND_COSINE = 0.1
"""|cos u| below this is at a bound: within 0.5 % of the log range."""
_RANK_TOLERANCE = 1e-5
"""Smallest over largest singular value of the Jacobian; a few float32 roundings."""


def align(
    problem: AlignmentProblem,
    weights: AlignmentWeights,
    settings: AlignmentSettings = DEFAULT_SETTINGS,
) -> AlignmentSolution:
    """Move every candidate onto its entity (Eq. 8):

    min_T J(x, T y),  T = [alpha Rot(z, theta), p],  p^g = -d^s + alpha s_y^g / 2

    Solutions have implicit derivatives (forward and reverse) in boxes, planes, sizes, weights
    and the start, at the cost of one 4x4 solve per pair. A pair that cannot be solved says so in
    its status and has zero derivatives; it does not disturb the others.

    Args:
        problem: Pairs on one flat axis (`problem_of`); entities and scenes may repeat along it.
        weights: Scalars; `AlignmentWeights.of` takes them from settings.
        settings: Bounds of alpha, tolerance, normal residual and steps; of these only the last
            two compile anew when they change. The weights in them are not read.
    """
    dtype = problem.model_size.dtype
    bounds = ScaleBounds(*(jnp.asarray(b, dtype) for b in (settings.scale_min, settings.scale_max)))
    return _align(
        problem,
        weights,
        bounds,
        jnp.asarray(settings.tolerance, dtype),
        max_steps=settings.max_steps,
        normal_residual=settings.normal_residual,
    )


def cost_at(
    problem: AlignmentProblem,
    weights: AlignmentWeights,
    scale: Float[Array, " pairs"],
    yaw: Float[Array, " pairs"],
    translation: Float[Array, "pairs 3"],
    settings: AlignmentSettings = DEFAULT_SETTINGS,
) -> Float[Array, " pairs"]:
    """J (Eq. 9) of every pair at a given pose, the prior left out."""
    return _cost_at(problem, weights, scale, yaw, translation, settings.normal_residual)


@functools.partial(jax.jit, static_argnames="normal_residual")
def _cost_at(problem, weights, scale, yaw, translation, normal_residual):
    def one(problem, scale, yaw, translation):
        pose = _in_box(problem, scale, yaw, translation)
        return _cost(pose, problem, weights, normal_residual)

    return jax.vmap(one)(problem, scale, yaw, translation)


def _cost(pose, problem, weights, normal_residual):
    return jnp.sum(residuals(pose, problem, weights, normal_residual) ** 2)


@functools.partial(jax.jit, static_argnames=("max_steps", "normal_residual"))
def _align(problem, weights, bounds, tolerance, *, max_steps, normal_residual):
    one = functools.partial(_align_one, max_steps=max_steps, normal_residual=normal_residual)
    return jax.vmap(one, (0, None, None, None))(problem, weights, bounds, tolerance)


def _align_one(problem, weights, bounds, tolerance, *, max_steps, normal_residual):
    refused = problem.valid & ~_solvable(problem)
    live = problem.valid & ~refused
    problem = jax.tree.map(functools.partial(jnp.where, live), problem, unit_problem(problem))

    def all_residuals(x, args):
        problem, weights, bounds = args
        ours = residuals(pose_at(x, problem, bounds), problem, weights, normal_residual)
        return jnp.concatenate([ours, prior_residuals(x, problem, weights, bounds)])

    args = (problem, weights, bounds)
    solution = optx.least_squares(
        all_residuals,
        optx.LevenbergMarquardt(rtol=tolerance, atol=tolerance),  # pyright: ignore
        unknowns_at_start(problem, bounds),
        args,
        max_steps=max_steps,
        # Inactive hinges can leave the Hessian singular; a solver that takes it for regular
        # fails the whole batch when one pair is.
        adjoint=optx.ImplicitAdjoint(linear_solver=lx.AutoLinearSolver(well_posed=False)),
        throw=False,
    )
    # Of lanes without a problem not even the rounding depends on the weights.
    found = jnp.where(live, solution.value, unknowns_at_start(problem, bounds))
    jacobian = jax.jacfwd(all_residuals)(jax.lax.stop_gradient(found), args)
    status = _status(
        ~refused,
        found,
        jax.lax.stop_gradient(jacobian),
        solution.result == optx.RESULTS.successful,
    )
    pose = pose_at(found, problem, bounds)
    cost = jnp.where(live, _cost(pose, problem, weights, normal_residual), 0.0)
    steps = jnp.asarray(solution.stats["num_steps"], jnp.int32)
    return _in_world(pose, problem, cost, status, steps)


def _solvable(problem: AlignmentProblem) -> Bool[Array, ""]:
    """Every number finite, every size positive."""
    finite = [jnp.all(jnp.isfinite(leaf)) for leaf in jax.tree.leaves(problem)]
    sizes = jnp.all(problem.box.size > 0) & jnp.all(problem.model_size > 0)
    return jnp.all(jnp.stack(finite)) & sizes & (problem.start[0] > 0)


def _status(solvable, found, jacobian, converged):
    spread = jnp.linalg.svd(jacobian, compute_uv=False)
    regular = solvable & (spread[-1] > _RANK_TOLERANCE * spread[0])
    at_bound = jnp.abs(jnp.cos(found[0])) < _AT_BOUND_COSINE
    status = jnp.where(converged, AlignmentStatus.CONVERGED, AlignmentStatus.NOT_CONVERGED)
    # The sine is flat at a bound, which makes the Jacobian (not the Hessian) singular there.
    status = jnp.where(converged & at_bound, AlignmentStatus.AT_BOUND, status)
    return jnp.where(regular | (at_bound & solvable), status, AlignmentStatus.SINGULAR)


def _in_box(problem: AlignmentProblem, scale, yaw, translation) -> Pose:
    """A pose in the world, seen from the frame of x's box."""
    shift = rot_z(problem.box.yaw).T @ (translation - problem.box.center)
    return Pose(scale, yaw - problem.box.yaw, shift)


def _in_world(pose: Pose, problem: AlignmentProblem, cost, status, steps) -> AlignmentSolution:
    yaw = wrap_angle(problem.box.yaw + pose.yaw)
    translation = problem.box.center + rot_z(problem.box.yaw) @ pose.translation
    return AlignmentSolution(
        scale=pose.scale,
        yaw=yaw,
        translation=translation,
        T_world_cad=make_T(rot_z(yaw) @ problem.rotation, translation),
        cost=cost,
        status=status,
        num_steps=steps,
    )
