"""The voxels that a frame labels, and what they vote: each for its segment and its leading label.

They are a seventh of the voxels in a frame's blocks, so they are listed, and what follows works on
the list. Their positions are found on the host: XLA's own search takes ten times as long.
"""

from __future__ import annotations

import dataclasses

import jax
import jax.numpy as jnp
import numpy as np
from jax import lax
from jaxtyping import Int, UInt16, UInt32

from ..runtime.wide_vectors import jit_wide_vectors
from ..types import Array
from .pool import BLOCK_VOXELS, LABEL_MASK
from .voxel_kernel import LABELLED, SEGMENT_SHIFT, VOTES

CHUNK_VOXELS = 1 << 14
"""Voxels per step of a loop: their temporaries stay in a core's cache."""
_VOXEL_MASK = BLOCK_VOXELS - 1
_BLOCK_SHIFT = BLOCK_VOXELS.bit_length() - 1


@jax.tree_util.register_dataclass
@dataclasses.dataclass(frozen=True, eq=False)
class LabelledVoxels:
    """Voxels that a frame labels; padding has a row out of range."""

    row: Int[Array, " voxels"]
    """Of the pool."""
    voxel: Int[Array, " voxels"]
    """In its block."""
    segment: Int[Array, " voxels"]
    leading: UInt32[Array, " voxels"]
    """First label slot, before the frame is counted."""


def labelled_voxels(
    observations: UInt16[np.ndarray, "blocks 512"],
) -> Int[np.ndarray, " labelled"]:
    """Indices, ``512 * block + voxel``, of the voxels that are to be labelled."""
    return np.flatnonzero(observations.reshape(-1) >= LABELLED)


@jit_wide_vectors
def cast_votes(
    leading: UInt32[Array, "capacity 512"],
    observations: UInt16[Array, "frames blocks 512"],
    frame: Int[Array, ""],
    rows: Int[Array, " blocks"],
    indices: Int[Array, " voxels"],
    labels: UInt32[Array, " chunks"],
    chunks: Int[Array, ""],
) -> tuple[LabelledVoxels, UInt32[Array, " voxels"]]:
    """What labelled voxels saw and bear, and the ballot of each.

    Args:
        leading: First label slots of the pool.
        observations: Of all frames of the step (`voxel_kernel.integrate_into_blocks`).
        frame: Which of them votes.
        rows: Rows of the blocks of ``observations``.
        indices: From `labelled_voxels`; ``chunks`` chunks of `CHUNK_VOXELS` are true.
        labels: Number of labels of each chunk's map.

    Returns:
        The voxels, and ``segment * labels + label`` of each that votes, else 0.
    """
    capacity, flat = len(leading), observations.reshape(-1)
    first = frame * (observations.shape[1] * BLOCK_VOXELS)

    def step(i, found):
        index = part(indices, i)
        block, voxel, at = index >> _BLOCK_SHIFT, index & _VOXEL_MASK, index + first
        block, voxel, at = lax.optimization_barrier((block, voxel, at))
        row = jnp.take(rows, block, mode="fill", fill_value=capacity)
        observed = jnp.take(flat, at, mode="clip").astype(jnp.uint32)
        row, observed = lax.optimization_barrier((row, observed))
        slot = lax.optimization_barrier(jnp.asarray(leading).at[row, voxel].get(mode="clip"))
        segment = observed >> SEGMENT_SHIFT
        ballot = segment * labels[i] + (slot & LABEL_MASK)
        ballot = jnp.where((observed & VOTES) > 0, ballot, 0)
        new = LabelledVoxels(row, voxel, segment.astype(jnp.int32), slot), ballot
        return jax.tree.map(lambda whole, some: _with_part(whole, i, some), found, new)

    number, slot = jnp.zeros(len(indices), jnp.int32), jnp.zeros(len(indices), jnp.uint32)
    found = LabelledVoxels(number, number, number, slot), slot
    return lax.fori_loop(0, chunks, step, found)


def part(entries, i):
    """Those of ``[voxels, ...]`` entries that chunk ``i`` holds: `CHUNK_VOXELS`."""
    return lax.dynamic_slice(entries, (i * CHUNK_VOXELS,), (CHUNK_VOXELS,))


def _with_part(entries, i, some):
    return lax.dynamic_update_slice(entries, some, (i * CHUNK_VOXELS,))
