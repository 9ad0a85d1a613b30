"""Pairs of things whose boxes overlap or nearly do: one kernel call over all scenes."""

from __future__ import annotations

import jax
import numpy as np
from jaxtyping import Float, Int

from ..geometry import box_overlap_depth
from ..types import Box
from .flat import FlatEntities, in_blocks, take

_BLOCK = 256
"""Pairs a call."""

_depths = jax.jit(jax.vmap(box_overlap_depth))


def close_pairs(
    flat: FlatEntities, box: Box, distance_m: float
) -> tuple[Int[np.ndarray, "pairs 2"], Float[np.ndarray, " pairs"]]:
    """Pairs i < j of things of one scene, and the depth to which their boxes overlap.

    Pairs farther apart than ``distance_m`` are left out; a negative depth is a gap.
    """
    pairs = _culled_pairs(flat, box, distance_m)
    if not len(pairs):
        return pairs, np.zeros(0, np.float32)

    def arguments(rows):
        return take(box, pairs[rows, 0]), take(box, pairs[rows, 1])

    depth = in_blocks(_depths, arguments, len(pairs), _BLOCK)
    near = depth > -distance_m
    return pairs[near], depth[near]


def _culled_pairs(flat: FlatEntities, box: Box, distance_m: float) -> Int[np.ndarray, "pairs 2"]:
    """Pairs whose bounding cylinders come that near."""
    radius = np.linalg.norm(box.size[:, :2], axis=-1) / 2
    half = box.size[:, 2] / 2
    found = [np.zeros((0, 2), np.int32)]
    for scene in range(len(flat.start) - 1):
        span = np.arange(*flat.start[scene : scene + 2])
        span = span[~flat.is_layout[span]]
        i, j = (span[side] for side in np.triu_indices(len(span), 1))
        apart = np.linalg.norm(box.center[i, :2] - box.center[j, :2], axis=-1)
        aloft = np.abs(box.center[i, 2] - box.center[j, 2])
        near = apart <= radius[i] + radius[j] + distance_m
        near &= aloft <= half[i] + half[j] + distance_m
        found.append(np.stack([i[near], j[near]], -1).astype(np.int32))
    return np.concatenate(found)
