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

from ..runtime.wide_vectors import wide_jit
from ..types import Array
from .fuse import LABELLED, SEGMENT_SHIFT, VOTES
from .pool import BLOCK_VOXELS, LABEL_MASK

CHUNK_VOXELS = 1 << 14
"""Voxels a step: their temporaries stay in a core's cache."""
_VOXEL_MASK = BLOCK_VOXELS - 1
_BLOCK_SHIFT = BLOCK_VOXELS.bit_length() - 1


@jax.tree_util.register_dataclass
@dataclasses.dataclass(frozen=True, eq=False)
class SeenVoxels:
    """Voxels that a frame labels; padding has a row out of range."""

    row: Int[Array, " voxels"]
    """Of the pool."""
    voxel: Int[Array, " voxels"]
    """In its block."""
    segment: Int[Array, " voxels"]
    leading: UInt32[Array, " voxels"]
    """First label slot, before the frame is counted."""


def labelled(hits: UInt16[np.ndarray, "blocks 512"]) -> Int[np.ndarray, " labelled"]:
    """Places, ``512 * block + voxel``, of the voxels that are to be labelled."""
    return np.flatnonzero(hits.reshape(-1) >= LABELLED)


@wide_jit
def cast_votes(
    leading: UInt32[Array, "capacity 512"],
    hits: UInt16[Array, "frames blocks 512"],
    frame: Int[Array, ""],
    rows: Int[Array, " blocks"],
    places: Int[Array, " voxels"],
    labels: UInt32[Array, " chunks"],
    chunks: Int[Array, ""],
) -> tuple[SeenVoxels, UInt32[Array, " voxels"]]:
    """What labelled voxels saw and bear, and the ballot of each.

    Args:
        leading: First label slots of the pool.
        rows: Rows of the blocks of ``hits``.
        places: Of `labelled`; ``chunks`` chunks of `CHUNK_VOXELS` are true.
        labels: Number of labels of each chunk's map.

    Returns:
        The voxels, and ``segment * labels + label`` of each that votes, else 0.
    """
    capacity, flat = len(leading), hits.reshape(-1)
    first = frame * (hits.shape[1] * BLOCK_VOXELS)

    def step(i, found):
        place = part(places, i)
        block, voxel, at = place >> _BLOCK_SHIFT, place & _VOXEL_MASK, place + first
        block, voxel, at = lax.optimization_barrier((block, voxel, at))
        row = jnp.take(rows, block, mode="fill", fill_value=capacity)
        seen = jnp.take(flat, at, mode="clip").astype(jnp.uint32)
        row, seen = lax.optimization_barrier((row, seen))
        slot = lax.optimization_barrier(jnp.asarray(leading).at[row, voxel].get(mode="clip"))
        segment = seen >> SEGMENT_SHIFT
        ballot = segment * labels[i] + (slot & LABEL_MASK)
        ballot = jnp.where((seen & VOTES) > 0, ballot, 0)
        new = SeenVoxels(row, voxel, segment.astype(jnp.int32), slot), ballot
        return jax.tree.map(lambda whole, some: _with_part(whole, i, some), found, new)

    number, word = jnp.zeros(len(places), jnp.int32), jnp.zeros(len(places), jnp.uint32)
    found = SeenVoxels(number, number, number, word), word
    return lax.fori_loop(0, chunks, step, found)


def part(entries, i):
    """Those of ``[voxels, ...]`` entries that chunk ``i`` holds: `CHUNK_VOXELS`."""
    return lax.dynamic_slice(entries, (i * CHUNK_VOXELS,), (CHUNK_VOXELS,))


def _with_part(entries, i, some):
    return lax.dynamic_update_slice(entries, some, (i * CHUNK_VOXELS,))
