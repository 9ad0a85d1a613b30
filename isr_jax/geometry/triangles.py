"""Exact distance from points to triangles."""

from __future__ import annotations

import functools

import jax
import jax.numpy as jnp
from jaxtyping import Bool, Float, Int

from ..types import Array


def point_triangle_distance_sq(
    point: Float[Array, "3"], triangle: Float[Array, "3 3"]
) -> Float[Array, ""]:
    """Squared distance from a point to a triangle (its interior, edges and corners), m^2.

    Projects on the plane and on the three edges and takes the nearest; a degenerate triangle
    is served by its edges alone. Differentiable almost everywhere, never NaN.
    """
    a, b, c = triangle
    ab, ac, ap = b - a, c - a, point - a
    normal = jnp.cross(ab, ac)
    area_sq = jnp.sum(normal * normal)
    safe_area_sq = jnp.where(area_sq > 1e-20, area_sq, 1.0)
    v = jnp.dot(jnp.cross(ap, ac), normal) / safe_area_sq
    w = jnp.dot(jnp.cross(ab, ap), normal) / safe_area_sq
    inside = (v >= 0) & (w >= 0) & (v + w <= 1) & (area_sq > 1e-20)
    plane_sq = jnp.dot(ap, normal) ** 2 / safe_area_sq

    def edge_sq(start, end):
        along = end - start
        length_sq = jnp.sum(along * along)
        t = jnp.dot(point - start, along) / jnp.where(length_sq > 1e-20, length_sq, 1.0)
        gap = point - (start + jnp.clip(t, 0.0, 1.0) * along)
        return jnp.sum(gap * gap)

    edges_sq = jnp.minimum(jnp.minimum(edge_sq(a, b), edge_sq(b, c)), edge_sq(c, a))
    return jnp.where(inside, plane_sq, edges_sq)


@functools.partial(jax.jit, static_argnames="batch_size")
def points_to_mesh_distance(
    points: Float[Array, "points 3"],
    vertices: Float[Array, "vertices 3"],
    faces: Int[Array, "faces 3"],
    face_valid: Bool[Array, " faces"],
    *,
    batch_size: int = 128,
) -> Float[Array, " points"]:
    """Distance from each point to the nearest valid triangle, metres; brute force, exact.

    ``batch_size`` points at a time keep the [points, faces] block in cache.
    """
    triangles = vertices[faces]

    def nearest(point):
        squared = jax.vmap(point_triangle_distance_sq, (None, 0))(point, triangles)
        return jnp.sqrt(jnp.min(jnp.where(face_valid, squared, jnp.inf)))

    return jax.lax.map(nearest, points, batch_size=batch_size)
