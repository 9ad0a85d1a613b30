"""What a frame's voxels vote: the leading label of each voxel on the surface of a segment.

Most layers of 8 x 8 voxels vote as one (one segment, one label), and are read back as one ballot.
Only mixed layers are read voxel by voxel, so the host sees a small part of the voxels.
"""

from __future__ import annotations

import functools

import jax.numpy as jnp
import numpy as np
from jax import lax
from jaxtyping import Int, UInt8, UInt16, UInt32

from ..types import Array
from .fuse import CHUNK_BLOCKS, SEGMENT_MASK, VOTES
from .pool import BLOCK_SIDE, BLOCK_VOXELS, LABEL_BITS, LABEL_MASK, LAYER_VOXELS
from .wide_jit import wide_jit

NO_VOTE = np.uint32(0xFFFFFFFF)


@functools.partial(wide_jit, donate_argnames=("ballots",))
def cast_votes(
    leading: UInt32[Array, "capacity 512"],
    hits: UInt16[Array, "frames blocks 512"],
    frame: Int[Array, ""],
    rows: Int[Array, " voting"],
    places: Int[Array, " voting"],
    chunks: Int[Array, ""],
    ballots: UInt32[Array, "voting 512"],
) -> tuple[
    UInt32[Array, "voting 512"],
    UInt32[Array, "voting 8"],
    UInt32[Array, "voting 8"],
    UInt8[Array, "voting 8"],
]:
    """``segment << LABEL_BITS | label`` of each voxel that votes, else `NO_VOTE`.

    Args:
        leading: First label slots of the pool.
        rows: Rows of the blocks that vote; ``chunks`` chunks of `CHUNK_BLOCKS` are true.
        places: Places of the blocks in ``hits``.
        ballots: Storage for the first result.

    Returns:
        The ballots, and of each layer its least, its greatest and the number cast.
    """
    blocks = hits.shape[1]
    flat = hits.reshape(-1, BLOCK_VOXELS)

    def step(i, carry):
        start = i * CHUNK_BLOCKS
        chunk = lax.dynamic_slice(rows, (start,), (CHUNK_BLOCKS,))
        place = lax.dynamic_slice(places, (start,), (CHUNK_BLOCKS,)) + frame * blocks
        seen = jnp.take(flat, place, axis=0, mode="clip").astype(jnp.uint32)
        label = jnp.take(leading, chunk, axis=0, mode="clip") & LABEL_MASK
        seen, label = lax.optimization_barrier((seen, label))
        votes = (seen & VOTES) > 0
        cast = ((seen & SEGMENT_MASK) << LABEL_BITS) | label
        low = jnp.where(votes, cast, NO_VOTE)
        layers = (CHUNK_BLOCKS, LAYER_VOXELS, BLOCK_SIDE)  # across: twice as fast as along memory
        high, ones = jnp.where(votes, cast, 0), votes.astype(jnp.uint8)
        low, high, ones = lax.optimization_barrier((low, high, ones))
        found = (
            low,
            low.reshape(layers).min(1),
            high.reshape(layers).max(1),
            ones.reshape(layers).sum(1, dtype=jnp.uint8),
        )
        return tuple(
            lax.dynamic_update_slice(a, f, (start, 0)) for a, f in zip(carry, found, strict=True)
        )

    layers = (len(rows), BLOCK_SIDE)
    least, most = jnp.zeros(layers, jnp.uint32), jnp.zeros(layers, jnp.uint32)
    carry = (ballots, least, most, jnp.zeros(layers, jnp.uint8))
    return lax.fori_loop(0, chunks, step, carry)


def counted(
    ballots: UInt32[np.ndarray, "voting 512"],
    least: UInt32[np.ndarray, "voting 8"],
    most: UInt32[np.ndarray, "voting 8"],
    number: UInt8[np.ndarray, "voting 8"],
) -> tuple[UInt32[np.ndarray, " ballots"], Int[np.ndarray, " ballots"]]:
    """Ballots and how often each was cast, of `cast_votes`' result; one may come up repeatedly."""
    uniform = (number > 0) & (least == most)
    mixed = (number > 0) & ~uniform
    single = ballots.reshape(-1, LAYER_VOXELS, BLOCK_SIDE).swapaxes(1, 2)[mixed].reshape(-1)
    single = single[single != NO_VOTE]
    cast = np.concatenate([least[uniform], single])
    often = np.concatenate([number[uniform].astype(np.int64), np.ones(len(single), np.int64)])
    return cast, often
