"""The voxel pool: blocks of 8^3 voxels in arrays of fixed capacity, one array a field.

One array a field, not one array of records: a stacked pool was measured four times slower. The
pool grows by doubling, on the host, and never drops a block in silence.
"""

from __future__ import annotations

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Float, Int, UInt32

from ..types import Array

BLOCK_SIDE = 8
BLOCK_VOXELS = BLOCK_SIDE**3

ROW_MULTIPLE = 64
"""Capacities are multiples of this, so that a pool can be walked in equal parts."""

LABEL_BITS = 20
"""A voxel's label slot holds ``count << LABEL_BITS | label``."""
LABEL_MASK = (1 << LABEL_BITS) - 1
MAX_COUNT = (1 << (32 - LABEL_BITS)) - 1
"""Counts saturate here."""

SEGMENT_BITS = 12
"""A frame's word holds ``depth << SEGMENT_BITS | segment``."""
MAX_SEGMENTS = (1 << SEGMENT_BITS) - 1
DEPTH_STEP_M = 1e-4
"""Depth is packed in tenths of a millimetre: 20 bits reach 104 m."""

VOXEL_OFFSETS = np.stack(
    np.meshgrid(*[np.arange(BLOCK_SIDE, dtype=np.int32)] * 3, indexing="ij"), -1
).reshape(-1, 3)
"""[512, 3]: place of each voxel in its block; z runs fastest."""


class VoxelPool(eqx.Module):
    """Signed distances, weights, colours and label counts of all blocks, a row a block."""

    sdf_m: Float[Array, "capacity 512"]
    """Truncated signed distance along the ray, positive towards the camera, metres."""
    weight: Float[Array, "capacity 512"]
    """0 = never seen."""
    color: UInt32[Array, "capacity 512"]
    """Red, green and blue in 10 bits each (8-bit value times 4), a running mean."""
    labels: tuple[UInt32[Array, "capacity 512"], ...]
    """Label slots, counts descending; 0 = empty."""

    @property
    def capacity(self) -> int:
        return self.sdf_m.shape[0]


def empty_pool(capacity: int, label_slots: int) -> VoxelPool:
    """A pool without a seen voxel."""

    def zeros(dtype):
        return jnp.zeros((capacity, BLOCK_VOXELS), dtype)

    slots = tuple(zeros(jnp.uint32) for _ in range(label_slots))
    return VoxelPool(zeros(jnp.float32), zeros(jnp.float32), zeros(jnp.uint32), slots)


def grown_pool(pool: VoxelPool, capacity: int) -> VoxelPool:
    """The same blocks in a larger pool."""

    def grow(field):
        tail = jnp.zeros((capacity - field.shape[0], BLOCK_VOXELS), field.dtype)
        return jnp.concatenate([field, tail])

    return VoxelPool(
        grow(pool.sdf_m), grow(pool.weight), grow(pool.color), tuple(grow(s) for s in pool.labels)
    )


def unpack_color(color: UInt32[Array, "*batch"]) -> Float[Array, "*batch 3"]:
    """Red, green and blue, 0 to 255."""
    channels = [(color >> shift) & 1023 for shift in (20, 10, 0)]
    return jnp.stack(channels, -1).astype(jnp.float32) / 4


def leading_labels(slot: UInt32[Array, "*batch"]) -> Int[Array, "*batch"]:
    """The label of a slot; of the first slot that is the voxel's leading one."""
    return (slot & LABEL_MASK).astype(np.int32)
