"""The alignment error AE: how far an entity's surface lies from a moved CAD model."""

from __future__ import annotations

from collections.abc import Sequence

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Bool, Float, Int

from ..geometry import points_to_triangles_distance_sq
from ..types import Array
from .problem import AlignmentSolution


class SurfacePairs(eqx.Module):
    """Points of entities beside surfaces of CAD models, and which pair is of which; padded."""

    points: Float[Array, "entities points 3"]
    """World frame, metres."""
    point_valid: Bool[Array, "entities points"]
    triangles: Float[Array, "models faces 3 3"]
    """Canonical frame, metres."""
    triangle_valid: Bool[Array, "models faces"]
    entity: Int[Array, " pairs"]
    """Row of ``points``."""
    model: Int[Array, " pairs"]
    """Row of ``triangles``."""
    valid: Bool[Array, " pairs"]
    """False for padding."""


def alignment_error(solution: AlignmentSolution, surfaces: SurfacePairs) -> Float[Array, " pairs"]:
    """RMS distance from an entity's vertices to the nearest points of its aligned model, metres.

    AE = sqrt(mean_i min_{q in T y} |v_i - q|^2)  (Sec. V-C, the text after Eq. 11)

    Exact, one-directional: a model may have parts that the camera never saw. One pair at a time,
    so that memory stays at one [points, faces] block. Differentiable almost everywhere, in poses,
    points and triangles; 0, and without derivatives, for padding.

    Args:
        solution: Where the model of each pair stands, and its scale.
        surfaces: What is compared (`surfaces_of`), on the same axis.
    """
    return _alignment_error(solution.T_world_cad, solution.scale, surfaces)


@jax.jit
def _alignment_error(T_world_cad, scale, surfaces):
    def one(pair):
        T, alpha, i, j, live = pair
        return surface_rms(
            T,
            alpha,
            surfaces.points[i],
            surfaces.point_valid[i] & live,
            surfaces.triangles[j],
            surfaces.triangle_valid[j],
        )

    pairs = (T_world_cad, scale, surfaces.entity, surfaces.model, surfaces.valid)
    return jax.lax.map(one, pairs)


def surface_rms(
    T_world_cad: Float[Array, "4 4"],
    scale: Float[Array, ""],
    points: Float[Array, "points 3"],
    point_valid: Bool[Array, " points"],
    triangles: Float[Array, "faces 3 3"],
    triangle_valid: Bool[Array, " faces"],
) -> Float[Array, ""]:
    """AE of one pair, metres. The points go to the model: its triangles then stay as they are."""
    seen = (points - T_world_cad[:3, 3]) @ T_world_cad[:3, :3] / scale
    square = points_to_triangles_distance_sq(seen, triangles, triangle_valid)
    square = scale**2 * jnp.where(point_valid, square, 0.0)
    mean = jnp.sum(square) / jnp.maximum(jnp.sum(point_valid), 1)
    # The root has no derivative at 0, which only an exact copy reaches.
    return jnp.where(mean > 0, jnp.sqrt(jnp.where(mean > 0, mean, 1.0)), 0.0)


_TILE_POINTS = 512
_TILE_FACES = 256
_TILES_PER_CALL = 16
"""Two million point-triangle pairs per call, some milliseconds: far above its overhead."""
_BATCH_POINTS = 64
_FAR_M = 1e4
"""Where padding triangles lie."""


def alignment_errors(
    T_world_cad: Float[np.ndarray, "pairs 4 4"],
    scale: Float[np.ndarray, " pairs"],
    points: Sequence[np.ndarray],
    triangles: Sequence[np.ndarray],
) -> Float[np.ndarray, " pairs"]:
    """`alignment_error` of ragged pairs on the host: points [n, 3] against triangles [f, 3, 3].

    All pairs are cut into tiles of so many points against so many faces, and calls take so many
    tiles: one shape for every scene and library, so it compiles once. Tiles of the same points
    are joined by their minimum.
    """
    tiles = [
        (pair, p, f)
        for pair in range(len(points))
        for p in range(0, len(points[pair]), _TILE_POINTS)
        for f in range(0, len(triangles[pair]), _TILE_FACES)
    ]
    square = [np.full(len(p), np.inf, np.float32) for p in points]
    for start in range(0, len(tiles), _TILES_PER_CALL):
        batch = tiles[start : start + _TILES_PER_CALL]
        at = np.zeros((_TILES_PER_CALL, _TILE_POINTS, 3), np.float32)
        on = np.full((_TILES_PER_CALL, _TILE_FACES, 3, 3), _FAR_M, np.float32)
        for k, (pair, p, f) in enumerate(batch):
            seen = points[pair][p : p + _TILE_POINTS]
            T = T_world_cad[pair]
            at[k, : len(seen)] = (seen - T[:3, 3]) @ T[:3, :3] / scale[pair]
            faces = triangles[pair][f : f + _TILE_FACES]
            on[k, : len(faces)] = faces
        nearest = np.asarray(_tile_distances_sq(at, on))
        for (pair, p, _), found in zip(batch, nearest, strict=False):
            here = square[pair][p : p + _TILE_POINTS]
            np.minimum(here, found[: len(here)], out=here)
    return np.array(
        [s * np.sqrt(np.mean(d)) if len(d) else 0.0 for s, d in zip(scale, square, strict=True)],
        np.float32,
    )


def _tile_distance_sq(tile):
    return points_to_triangles_distance_sq(*tile, batch_size=_BATCH_POINTS)


@jax.jit
def _tile_distances_sq(points, triangles):
    return jax.lax.map(_tile_distance_sq, (points, triangles))
