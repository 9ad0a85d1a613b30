"""The voxel pool: blocks of 8^3 voxels in arrays of fixed capacity, one array per field.

One array per field, not one array of records: a stacked pool was measured four times slower. The
pool grows by doubling, on the host, and never drops a block in silence.
"""

from __future__ import annotations

import dataclasses
import functools

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Float, Int, UInt32

from ..errors import MapError
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

VOXEL_OFFSETS = np.stack(
    np.meshgrid(*[np.arange(BLOCK_SIDE, dtype=np.int32)] * 3, indexing="ij"), -1
).reshape(-1, 3)
"""[512, 3]: place of each voxel in its block; z runs fastest."""


class OutOfMemory(MapError):
    """A pool that could not grow; ``kept`` is the pool as it was."""

    def __init__(self, kept: VoxelPool, rows: int) -> None:
        super().__init__(
            f"no memory for {rows} blocks of {BLOCK_VOXELS} voxels",
            "lower MappingSettings.max_blocks to stop earlier, or raise voxel_size_m",
        )
        self.kept = kept


LabelSlots = tuple[UInt32[Array, "capacity 512"], ...]
"""Label slots of all voxels, the leading ones first."""


@jax.tree_util.register_dataclass
@dataclasses.dataclass(frozen=True, eq=False)
class VoxelPool:
    """Signed distances, weights, colours and label counts of all blocks, one row per block."""

    sdf_m: Float[Array, "capacity 512"]
    """Truncated signed distance along the ray, positive towards the camera, metres."""
    weight: Float[Array, "capacity 512"]
    """0 = never seen."""
    color: UInt32[Array, "capacity 512"]
    """Red, green and blue in 10 bits each (8-bit value times 4), a running mean."""
    labels: LabelSlots
    """Counts descending; 0 = empty."""

    @property
    def capacity(self) -> int:
        return self.sdf_m.shape[0]


def empty_pool(capacity: int, label_slots: int) -> VoxelPool:
    """A pool without a seen voxel."""

    def zeros(dtype):
        return jnp.zeros((capacity, BLOCK_VOXELS), dtype)

    slots = tuple(zeros(jnp.uint32) for _ in range(label_slots))
    return VoxelPool(zeros(jnp.float32), zeros(jnp.float32), zeros(jnp.uint32), slots)


def with_labels(pool: VoxelPool, labels: LabelSlots) -> VoxelPool:
    """The pool with other label slots."""
    return VoxelPool(pool.sdf_m, pool.weight, pool.color, labels)


def grown_pool(pool: VoxelPool, capacity: int, parts: int = 1) -> VoxelPool:
    """The same blocks in a pool with room for ``capacity``; it takes the storage of ``pool``.

    One field after the other, each freed before the next is copied, so the peak is the new pool
    and one old field.

    Args:
        parts: Equal parts of the pool that each get ``capacity`` rows (maps of a stacked pool).

    Raises:
        OutOfMemory: ``kept`` holds the pool as it was.
    """
    before = pool.capacity // parts
    fields, tree = jax.tree.flatten(pool)
    for i, field in enumerate(fields):
        try:
            fields[i] = jax.block_until_ready(_resized(field, parts, capacity))
        except (MemoryError, jax.errors.JaxRuntimeError) as error:
            fields[:i] = [_resized(grown, parts, before) for grown in fields[:i]]
            kept = jax.tree.unflatten(tree, fields)
            raise OutOfMemory(kept, parts * capacity) from error
        field.delete()
    return jax.tree.unflatten(tree, fields)


@functools.partial(jax.jit, static_argnames=("parts", "capacity"))
def _resized(field, parts, capacity):
    """Parts of a field with ``capacity`` rows each: empty ones added, or the last ones cut off."""
    rows = field.reshape(parts, -1, BLOCK_VOXELS)[:, :capacity]
    tail = ((0, 0), (0, capacity - rows.shape[1]), (0, 0))
    return jnp.pad(rows, tail).reshape(-1, BLOCK_VOXELS)


def sdf_m(pool: VoxelPool, rows: Int[Array, "*batch"]) -> Float[Array, "*batch 512"]:
    """Truncated signed distances of blocks, metres; 0 where a row is out of range."""
    return _rows_of(pool.sdf_m, rows)


def weight(pool: VoxelPool, rows: Int[Array, "*batch"]) -> Float[Array, "*batch 512"]:
    """Weights of blocks, 0 = never seen; 0 where a row is out of range."""
    return _rows_of(pool.weight, rows)


def color(pool: VoxelPool, rows: Int[Array, "*batch"]) -> UInt32[Array, "*batch 512"]:
    """Colours of blocks, 10 bits per channel (see `unpack_color`); 0 = none."""
    return _rows_of(pool.color, rows)


def leading_label(
    pool: VoxelPool, rows: Int[Array, "*batch"]
) -> tuple[Int[Array, "*batch 512"], Int[Array, "*batch 512"]]:
    """The label that each voxel of blocks has counted most, and its count; 0 where none."""
    slot = _rows_of(pool.labels[0], rows)
    return leading_labels(slot), (slot >> LABEL_BITS).astype(np.int32)


def _rows_of(field, rows):
    """Rows of a field; zeros where a row is out of range, negative ones too."""
    rows = jnp.where(jnp.asarray(rows) < 0, field.shape[0], rows)
    return jnp.take(field, rows, axis=0, mode="fill", fill_value=0)


def unpack_color(color: UInt32[Array, "*batch"]) -> Float[Array, "*batch 3"]:
    """Red, green and blue, 0 to 255."""
    channels = [(color >> shift) & 1023 for shift in (20, 10, 0)]
    return jnp.stack(channels, -1).astype(jnp.float32) / 4


def leading_labels(slot: UInt32[Array, "*batch"]) -> Int[Array, "*batch"]:
    """The label of a slot; of the first slot that is the voxel's leading one."""
    return (slot & LABEL_MASK).astype(np.int32)
