"""Planes by RANSAC with inliers removed, as one kernel per point set.

A draw takes one point, gathers the points near the plane through it along its normal, and fits a
plane to them; the fit with the most inliers wins and is fitted again. One point a draw finds a
plane that holds a tenth of the points within 200 draws; three points a draw (0.1^3) would not.
"""

from __future__ import annotations

import functools

import jax
import jax.numpy as jnp
from jax import lax
from jaxtyping import Bool, Float, Int

from ..types import Array

PLANE_SLOTS = 16
"""Room for planes in a result; more are never asked for."""
_GATHER = 2.0
"""Points within so many thresholds of the drawn plane take part in its first fit."""
_REFITS = 2


def fit_plane(
    points: Float[Array, "points 3"], share: Float[Array, " points"]
) -> tuple[Float[Array, "3"], Float[Array, ""]]:
    """Weighted least-squares plane: unit normal (either sign) and offset d."""
    total = jnp.maximum(jnp.sum(share), 1e-6)
    center = share @ points / total
    apart = points - center
    scatter = (apart * share[:, None]).T @ apart / total
    _, vectors = jnp.linalg.eigh(scatter)
    normal = vectors[:, 0]
    return normal, -jnp.dot(normal, center)


def plane_inliers(
    points: Float[Array, "points 3"],
    normals: Float[Array, "points 3"],
    live: Bool[Array, " points"],
    normal: Float[Array, "3"],
    offset: Float[Array, ""],
    threshold_m: Float[Array, ""],
    min_cosine: Float[Array, ""],
) -> Bool[Array, " points"]:
    """Points near a plane whose own normals agree with it."""
    near = jnp.abs(points @ normal + offset) < threshold_m
    return live & near & (normals @ normal > min_cosine)


def _outward(points, normals, share, normal, offset):
    """The plane with its normal agreeing with the mean normal of its points."""
    sign = jnp.where(jnp.dot(share @ normals, normal) < 0, -1.0, 1.0)
    return sign * normal, sign * offset


def _refit(points, normals, live, plane, threshold_m, min_cosine):
    normal, offset = plane
    inside = plane_inliers(points, normals, live, normal, offset, threshold_m, min_cosine)
    share = inside.astype(points.dtype)
    fitted = _outward(points, normals, share, *fit_plane(points, share))
    enough = jnp.sum(inside) >= 3
    return jax.tree.map(lambda new, old: jnp.where(enough, new, old), fitted, plane)


def best_plane(
    points: Float[Array, "points 3"],
    normals: Float[Array, "points 3"],
    live: Bool[Array, " points"],
    draws: Float[Array, " draws"],
    threshold_m: Float[Array, ""],
    min_cosine: Float[Array, ""],
) -> tuple[Float[Array, "3"], Float[Array, ""], Bool[Array, " points"]]:
    """The plane with the most inliers among the draws (uniform in [0, 1)), and its inliers."""
    rank = jnp.cumsum(live.astype(jnp.int32))
    wanted = jnp.floor(draws * rank[-1]).astype(jnp.int32) + 1
    picks = jnp.clip(jnp.searchsorted(rank, wanted), 0, len(points) - 1)

    def attempt(pick):
        start = normals[pick], -jnp.dot(normals[pick], points[pick])
        normal, offset = _refit(points, normals, live, start, _GATHER * threshold_m, min_cosine)
        inside = plane_inliers(points, normals, live, normal, offset, threshold_m, min_cosine)
        return (normal, offset), jnp.sum(inside)

    planes, counts = lax.map(attempt, picks, batch_size=25)
    best = jnp.argmax(counts)
    plane = jax.tree.map(lambda field: field[best], planes)
    for _ in range(_REFITS):
        plane = _refit(points, normals, live, plane, threshold_m, min_cosine)
    normal, offset = plane
    inside = plane_inliers(points, normals, live, normal, offset, threshold_m, min_cosine)
    return normal, offset, inside


@functools.partial(jax.jit, static_argnames="iterations")
def peel_planes(
    points: Float[Array, "points 3"],
    normals: Float[Array, "points 3"],
    valid: Bool[Array, " points"],
    key: jax.Array,
    threshold_m: Float[Array, ""],
    min_cosine: Float[Array, ""],
    min_ratio: Float[Array, ""],
    max_planes: Int[Array, ""],
    *,
    iterations: int,
) -> tuple[Float[Array, "planes 3"], Float[Array, " planes"], Int[Array, " planes"]]:
    """Planes one after the other, the inliers of each removed before the next.

    Stops when a plane holds, or the remainder is, less than ``min_ratio`` of the points.

    Returns:
        Of `PLANE_SLOTS` planes: unit normals agreeing with the points' own, offsets, and inlier
        counts (0 = no plane).
    """
    least = min_ratio * jnp.sum(valid)

    def one(carry):
        k, live, going, (normal, offset, count) = carry
        draws = jax.random.uniform(jax.random.fold_in(key, k), (iterations,))
        n, d, inside = best_plane(points, normals, live, draws, threshold_m, min_cosine)
        found = jnp.sum(inside)
        going = (found >= least) & (found >= 3)
        count = count.at[k].set(jnp.where(going, found, 0))
        planes = normal.at[k].set(n), offset.at[k].set(d), count
        live = live & ~(inside & going)
        return k + 1, live, going & (jnp.sum(live) >= least), planes

    up = jnp.tile(jnp.array([0.0, 0.0, 1.0], points.dtype), (PLANE_SLOTS, 1))
    empty = up, jnp.zeros(PLANE_SLOTS, points.dtype), jnp.zeros(PLANE_SLOTS, jnp.int32)
    start = jnp.int32(0), valid, jnp.sum(valid) >= 3, empty
    *_, planes = lax.while_loop(lambda c: (c[0] < max_planes) & c[2], one, start)
    return planes
