"""The alignment error AE: how far an entity's surface lies from a moved CAD model."""

from __future__ import annotations

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Bool, Float, Int

from ..geometry import points_to_mesh_distance_sq
from ..types import Array


class PointSets(eqx.Module):
    """Points of entities, world frame, padded."""

    points: Float[Array, "*batch points 3"]
    valid: Bool[Array, "*batch points"]


class Surfaces(eqx.Module):
    """Triangle meshes of CAD models, canonical frame, padded. Padded vertices and faces are 0."""

    vertices: Float[Array, "*batch vertices 3"]
    faces: Int[Array, "*batch faces 3"]
    face_valid: Bool[Array, "*batch faces"]


def alignment_error(
    T_world_cad: Float[Array, "pairs 4 4"],
    scale: Float[Array, " pairs"],
    points: PointSets,
    surfaces: Surfaces,
    entity: Int[Array, " pairs"],
    model: Int[Array, " pairs"],
) -> Float[Array, " pairs"]:
    """RMS distance from an entity's vertices to the nearest points of its aligned model, metres.

    AE = sqrt(mean_i min_{q in T y} |v_i - q|^2)  (Sec. V-C, the text after Eq. 9)

    Exact, one-directional: a model may have parts that the camera never saw. One pair at a time,
    so that memory stays at one [points, faces] block. Differentiable almost everywhere.

    Args:
        T_world_cad: Poses without scale.
        scale: alpha of each pair.
        points: Point set of each entity.
        surfaces: Surface of each model.
        entity: Row of ``points`` of each pair.
        model: Row of ``surfaces`` of each pair.
    """
    return _alignment_error(T_world_cad, scale, points, surfaces, entity, model)


@jax.jit
def _alignment_error(T_world_cad, scale, points, surfaces, entity, model):
    def one(pair):
        T, alpha, i, j = pair
        at = jax.tree.map(lambda leaf: leaf[i], points)
        surface = jax.tree.map(lambda leaf: leaf[j], surfaces)
        return surface_rms(T, alpha, at, surface)

    return jax.lax.map(one, (T_world_cad, scale, entity, model))


def surface_rms(
    T_world_cad: Float[Array, "4 4"],
    scale: Float[Array, ""],
    points: PointSets,
    surface: Surfaces,
) -> Float[Array, ""]:
    """AE of one pair, metres. The points go to the model: its triangles then stay as they are."""
    seen = (points.points - T_world_cad[:3, 3]) @ T_world_cad[:3, :3] / scale
    square = scale**2 * points_to_mesh_distance_sq(
        seen, surface.vertices, surface.faces, surface.face_valid
    )
    square = jnp.where(points.valid, square, 0.0)
    mean = jnp.sum(square) / jnp.maximum(jnp.sum(points.valid), 1)
    # The root has no derivative at 0, which only an exact copy reaches.
    return jnp.where(mean > 0, jnp.sqrt(jnp.where(mean > 0, mean, 1.0)), 0.0)
