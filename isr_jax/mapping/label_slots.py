"""Label counts of voxels: a few slots a voxel, counted up a frame at a time, renamed on a merge."""

from __future__ import annotations

import functools

import jax
import jax.numpy as jnp
from jax import lax
from jaxtyping import Int, UInt32

from ..types import Array
from .fuse import CHUNK_BLOCKS
from .pool import LABEL_BITS, LABEL_MASK, MAX_COUNT, ROW_MULTIPLE


def count_label(slots, label):
    """Count one label more in a voxel's slots, kept in descending order of counts.

    A label that has a slot gains 1 (up to `MAX_COUNT`). Another takes the last slot if that is
    empty; if it is not, its count falls by 1, and at 0 the newcomer takes it. So the leading
    label never loses a count, and a label of noise cannot hold a slot for ever.
    """
    counts = [s >> LABEL_BITS for s in slots]
    matches = [((s & LABEL_MASK) == label) & (c > 0) for s, c in zip(slots, counts, strict=True)]
    known = functools.reduce(jnp.logical_or, matches)
    one = jnp.uint32(1 << LABEL_BITS)
    out = [
        jnp.where(m & (c < MAX_COUNT), s + one, s)
        for s, m, c in zip(slots, matches, counts, strict=True)
    ]
    last = slots[-1]
    worn = jnp.where(counts[-1] > 1, last - one, label | one)
    out[-1] = jnp.where(known, out[-1], worn)
    for i in range(len(out) - 1, 0, -1):
        swap = (out[i] >> LABEL_BITS) > (out[i - 1] >> LABEL_BITS)
        out[i - 1], out[i] = (
            jnp.where(swap, out[i], out[i - 1]),
            jnp.where(swap, out[i - 1], out[i]),
        )
    return tuple(jnp.where(label > 0, o, s) for o, s in zip(out, slots, strict=True))


@functools.partial(jax.jit, donate_argnames=("labels",))
def count_labels(
    labels: tuple[UInt32[Array, "capacity 512"], ...],
    hits: UInt32[Array, "blocks 512"],
    label_of_segment: UInt32[Array, " segments"],
    slots: Int[Array, " blocks"],
    count: Int[Array, ""],
) -> tuple[UInt32[Array, "capacity 512"], ...]:
    """Count the map label of the segment that each voxel saw (0 = no label)."""

    def step(i, labels):
        start = i * CHUNK_BLOCKS
        rows = lax.dynamic_slice(slots, (start,), (CHUNK_BLOCKS,))
        seen = lax.dynamic_slice(hits, (start, 0), (CHUNK_BLOCKS, hits.shape[1]))
        segment = lax.optimization_barrier((seen >> LABEL_BITS).astype(jnp.int32))
        label = lax.optimization_barrier(label_of_segment[segment])
        old = tuple(s.at[rows].get(mode="clip") for s in labels)
        new = lax.optimization_barrier(count_label(old, label))
        return tuple(
            s.at[rows].set(n, mode="drop", unique_indices=True)
            for s, n in zip(labels, new, strict=True)
        )

    trips = (count + CHUNK_BLOCKS - 1) // CHUNK_BLOCKS
    return lax.fori_loop(0, trips, step, labels)


@functools.partial(jax.jit, donate_argnames=("labels",))
def relabel(
    labels: tuple[UInt32[Array, "capacity 512"], ...],
    table: UInt32[Array, " labels"],
    used: Int[Array, ""],
) -> tuple[UInt32[Array, "capacity 512"], ...]:
    """Give every label its new number, in the first ``used`` rows of the pool.

    Slots of a voxel that become one label add up.
    """

    def step(i, labels):
        rows = i * ROW_MULTIPLE + jnp.arange(ROW_MULTIPLE)
        renamed = _renamed([s[rows] for s in labels], table)
        return tuple(
            s.at[rows].set(n, mode="drop", unique_indices=True)
            for s, n in zip(labels, renamed, strict=True)
        )

    return lax.fori_loop(0, (used + ROW_MULTIPLE - 1) // ROW_MULTIPLE, step, labels)


def _renamed(slots, table):
    """A voxel's slots with new labels, equal ones added up, counts descending."""
    new = [(s & ~jnp.uint32(LABEL_MASK)) | table[s & LABEL_MASK] for s in slots]
    for i in range(len(new)):
        for j in range(i + 1, len(new)):
            same = (new[i] & LABEL_MASK) == (new[j] & LABEL_MASK)
            same &= new[j] > LABEL_MASK
            total = jnp.minimum((new[i] >> LABEL_BITS) + (new[j] >> LABEL_BITS), MAX_COUNT)
            new[i] = jnp.where(same, (total << LABEL_BITS) | (new[i] & LABEL_MASK), new[i])
            new[j] = jnp.where(same, 0, new[j])
    return _sorted_by_count(new)


def _sorted_by_count(slots):
    """Bubble sort of a few slots, counts descending; equal counts keep their order."""
    for end in range(len(slots) - 1, 0, -1):
        for i in range(end):
            swap = (slots[i + 1] >> LABEL_BITS) > (slots[i] >> LABEL_BITS)
            slots[i], slots[i + 1] = (
                jnp.where(swap, slots[i + 1], slots[i]),
                jnp.where(swap, slots[i], slots[i + 1]),
            )
    return tuple(slots)
