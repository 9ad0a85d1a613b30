"""What the map knows of a point: nothing, free space, or surface."""

from __future__ import annotations

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Float, Int, Int8

from ..runtime.batches import bucket
from ..types import Array
from .blocks import BlockIndex
from .pool import BLOCK_SIDE, VoxelPool
from .voxel_kernel import MapScale

UNKNOWN = 0
"""Never in view, or behind a surface."""
EMPTY = 1
"""A ray went through: the voxel lies farther than the band in front of the surface, or its whole
block was seen through."""
SURFACE = 2
"""Within `_BAND_VOXELS` of the surface, along the ray."""
_FARTHEST_M = 1e6
"""No map reaches so far."""
_BAND_VOXELS = 2.0
"""A voxel that the surface cuts has its centre up to 0.87 voxels off, more along a slanted ray."""


def observed(
    pool: VoxelPool, blocks: BlockIndex, scale: MapScale, points: Float[np.ndarray, "n 3"]
) -> Int8[np.ndarray, " n"]:
    """`UNKNOWN`, `EMPTY` or `SURFACE` at each point of the world, metres.

    A voxel with a weight speaks for itself; any other, and a place without a block, by whether
    some frame's rays went through the whole block. Of a point that is not finite nothing is known.
    """
    points = np.asarray(points, np.float64)
    known = np.all(np.abs(points) < _FARTHEST_M, axis=1)
    voxel = np.floor(np.where(known[:, None], points, 0.0) / scale.voxel_m).astype(np.int64)
    block = voxel >> 3
    x, y, z = (voxel & 7).T
    rows = blocks.rows_at(block)
    count = len(rows)
    size = bucket(count, 64)
    row_and_voxel = np.zeros((2, size), np.int32)
    row_and_voxel[0, :count] = np.where(rows < 0, pool.capacity, rows)
    row_and_voxel[1, :count] = (x * BLOCK_SIDE + y) * BLOCK_SIDE + z
    band_m = min(_BAND_VOXELS * scale.voxel_m, scale.truncation_m)
    said = np.asarray(_said(pool.sdf_m, pool.weight, *row_and_voxel, band_m))[:count]
    passed = np.where(blocks.passed(block), np.int8(EMPTY), np.int8(UNKNOWN))
    return np.where(known, np.where(said < 0, passed, said), np.int8(UNKNOWN))


@jax.jit
def _said(
    sdf_m: Float[Array, "capacity 512"],
    weight: Float[Array, "capacity 512"],
    rows: Int[Array, " n"],
    voxels: Int[Array, " n"],
    band_m: Float[Array, ""],
) -> Int8[Array, " n"]:
    """What each voxel says; -1 where it was never updated."""
    sdf = jnp.asarray(sdf_m).at[rows, voxels].get(mode="fill", fill_value=0.0)
    seen = jnp.asarray(weight).at[rows, voxels].get(mode="fill", fill_value=0.0) > 0
    said = jnp.where(sdf >= band_m, EMPTY, jnp.where(sdf > -band_m, SURFACE, UNKNOWN))
    return jnp.where(seen, said, -1).astype(jnp.int8)
