"""Label counts of voxels: a few slots per voxel, counted up by frames, renumbered on a merge."""

from __future__ import annotations

import functools

import jax
import jax.numpy as jnp
from jax import lax
from jaxtyping import Bool, Int, UInt32

from ..runtime.wide_vectors import jit_wide_vectors
from ..types import Array
from .ballots import CHUNK_VOXELS, LabelledVoxels, part
from .pool import LABEL_BITS, LABEL_MASK, MAX_COUNT, ROW_MULTIPLE, LabelSlots


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


def count_leading(slot, label):
    """`count_label` where the first slot holds the label, or nothing yet; and whether it does.

    Other slots stay as they are.
    """
    one = jnp.uint32(1 << LABEL_BITS)
    count = slot >> LABEL_BITS
    known = (slot & LABEL_MASK) == label
    new = jnp.where(known & (count > 0), slot + jnp.where(count < MAX_COUNT, one, 0), label | one)
    done = known | (count == 0) | (label == 0)
    return jnp.where(done & (label > 0), new, slot), done


@functools.partial(jit_wide_vectors, donate_argnames=("leading",))
def count_leading_labels(
    leading: UInt32[Array, "capacity 512"],
    labelled: LabelledVoxels,
    first_segment: Int[Array, " chunks"],
    label_of_segment: UInt32[Array, " segments"],
    chunks: Int[Array, ""],
) -> tuple[UInt32[Array, "capacity 512"], Bool[Array, " voxels"]]:
    """`count_labels` of the voxels that need their first slot alone.

    Most do, after some frames; that is a third of the memory traffic. The others are left as they
    are: the second result says which.

    Args:
        first_segment: Where the segments of each chunk's map begin in ``label_of_segment``.
        chunks: True chunks of `CHUNK_VOXELS`.
    """

    def step(i, carry):
        leading, left = carry
        some = jax.tree.map(lambda entries: part(entries, i), labelled)
        label = _label_of(some.segment, first_segment[i], label_of_segment)
        new, done = lax.optimization_barrier(count_leading(some.leading, label))
        at = leading.at[some.row, some.voxel]
        leading = at.set(new, mode="drop", unique_indices=True)
        return leading, lax.dynamic_update_slice(left, ~done, (i * CHUNK_VOXELS,))

    left = jnp.zeros(len(labelled.row), bool)
    return lax.fori_loop(0, chunks, step, (leading, left))


@functools.partial(jit_wide_vectors, donate_argnames=("labels",))
def count_labels(
    labels: LabelSlots,
    labelled: LabelledVoxels,
    indices: Int[Array, " some"],
    first_segment: Int[Array, " chunks"],
    label_of_segment: UInt32[Array, " segments"],
    chunks: Int[Array, ""],
) -> LabelSlots:
    """Count the map label of the segment that each of some voxels saw (0 = no label).

    Args:
        indices: Of the voxels in ``labelled``; ``chunks`` chunks of `CHUNK_VOXELS` are true,
            padding lies out of range.
        first_segment: Where the segments of each chunk's map begin in ``label_of_segment``.
    """
    capacity = len(labels[0])

    def step(i, labels):
        some = part(indices, i)
        row = jnp.take(labelled.row, some, mode="fill", fill_value=capacity)
        voxel, segment = (
            jnp.take(e, some, mode="clip") for e in (labelled.voxel, labelled.segment)
        )
        row, voxel, segment = lax.optimization_barrier((row, voxel, segment))
        label = _label_of(segment, first_segment[i], label_of_segment)
        old = tuple(s.at[row, voxel].get(mode="clip") for s in labels)
        new = lax.optimization_barrier(count_label(lax.optimization_barrier(old), label))
        return tuple(
            s.at[row, voxel].set(n, mode="drop", unique_indices=True)
            for s, n in zip(labels, new, strict=True)
        )

    return lax.fori_loop(0, chunks, step, labels)


def _label_of(segment, first_segment, label_of_segment):
    """The map label of each segment of a map."""
    entry = lax.optimization_barrier(segment + first_segment)
    return lax.optimization_barrier(jnp.take(label_of_segment, entry, mode="clip"))


@functools.partial(jax.jit, static_argnames=("size",))
def leading_somewhere(
    leading: UInt32[Array, "capacity 512"], rows: Int[Array, "2"], size: int
) -> Bool[Array, " labels"]:
    """Which labels below ``size`` are in the first slot of a voxel.

    Args:
        rows: First row, and number of rows.
    """
    first, count = rows

    def step(i, found):
        some = i * ROW_MULTIPLE + jnp.arange(ROW_MULTIPLE)
        slots = jnp.take(leading, first + some, axis=0, mode="clip")
        there = (some < count)[:, None] & (slots > LABEL_MASK)
        label = jnp.where(there, slots & LABEL_MASK, size).astype(jnp.int32)
        return found.at[label.reshape(-1)].set(True, mode="drop")

    trips = (count + ROW_MULTIPLE - 1) // ROW_MULTIPLE
    return lax.fori_loop(0, trips, step, jnp.zeros(size, bool))


@functools.partial(jit_wide_vectors, donate_argnames=("labels",))
def renumber_slots(
    labels: LabelSlots,
    tables: UInt32[Array, "tables labels"],
    rows: Int[Array, " blocks"],
    table_of: Int[Array, " blocks"],
    count: Int[Array, ""],
) -> LabelSlots:
    """Give every label its new number in the first ``count`` of some rows of the pool.

    Slots of a voxel that become one label add up; slots are in order of counts, then of labels, so
    that two renumberings one after the other are the one that both make.

    Args:
        table_of: Table of each row.
    """
    width = tables.shape[1]
    new_label = tables.reshape(-1)

    def step(i, labels):
        start = i * ROW_MULTIPLE
        some = lax.dynamic_slice(rows, (start,), (ROW_MULTIPLE,))
        table = lax.dynamic_slice(table_of, (start,), (ROW_MULTIPLE,)) * width
        old = [jnp.take(s, some, axis=0, mode="clip") for s in labels]
        entries = [(s & LABEL_MASK).astype(jnp.int32) + table[:, None] for s in old]
        entries = lax.optimization_barrier(entries)
        new = _renumbered(old, [new_label[entry] for entry in entries])
        return tuple(
            s.at[some].set(n, mode="drop", unique_indices=True)
            for s, n in zip(labels, new, strict=True)
        )

    trips = (count + ROW_MULTIPLE - 1) // ROW_MULTIPLE
    return lax.fori_loop(0, trips, step, labels)


def _renumbered(slots, new_labels):
    """A voxel's slots with new labels, equal ones added up, by counts, then by labels.

    A label that became 0 leaves its slot empty.
    """
    new = [
        jnp.where(label > 0, (s & ~jnp.uint32(LABEL_MASK)) | label, 0)
        for s, label in zip(slots, new_labels, strict=True)
    ]
    for i in range(len(new)):
        for j in range(i + 1, len(new)):
            same = (new[i] & LABEL_MASK) == (new[j] & LABEL_MASK)
            same &= new[j] > LABEL_MASK
            total = jnp.minimum((new[i] >> LABEL_BITS) + (new[j] >> LABEL_BITS), MAX_COUNT)
            new[i] = jnp.where(same, (total << LABEL_BITS) | (new[i] & LABEL_MASK), new[i])
            new[j] = jnp.where(same, 0, new[j])
    return _sorted(new)


def _sorted(slots):
    """Bubble sort of a few slots: counts descending, of equal counts the lower label first."""
    for end in range(len(slots) - 1, 0, -1):
        for i in range(end):
            # with its label's bits turned round, a slot is its own place in the order
            swap = (slots[i + 1] ^ LABEL_MASK) > (slots[i] ^ LABEL_MASK)
            slots[i], slots[i + 1] = (
                jnp.where(swap, slots[i + 1], slots[i]),
                jnp.where(swap, slots[i], slots[i + 1]),
            )
    return tuple(slots)
