"""Pairs of things whose boxes overlap or nearly do: one kernel call over all scenes."""

from __future__ import annotations

import dataclasses

import jax
import numpy as np
from jaxtyping import Float, Int

from ..geometry import box_overlap_depth
from ..runtime.batches import in_blocks, take_rows
from ..types import Box
from .flat import FlatEntities

_BLOCK = 256
"""Pairs per call."""

_depths = jax.jit(jax.vmap(box_overlap_depth))


@dataclasses.dataclass(frozen=True, eq=False)
class ClosePairs:
    """Pairs of things of one scene whose boxes overlap or nearly do."""

    pairs: Int[np.ndarray, "pairs 2"]
    """Positions i < j in the flat entities."""
    depth_m: Float[np.ndarray, " pairs"]
    """Depth to which the boxes overlap; negative: a gap."""

    def __getitem__(self, which: np.ndarray) -> ClosePairs:
        return ClosePairs(self.pairs[which], self.depth_m[which])

    def of(self, row: int, distance_m: float) -> Int[np.ndarray, " others"]:
        """What is within a distance of one thing."""
        pairs = self.pairs[(self.depth_m >= -distance_m) & np.any(self.pairs == row, axis=-1)]
        return pairs.sum(-1) - row


def close_pairs(flat: FlatEntities, box: Box, distance_m: float) -> ClosePairs:
    """Pairs of things no farther apart than ``distance_m``."""
    pairs = _culled_pairs(flat, box, distance_m)
    if not len(pairs):
        return ClosePairs(pairs, np.zeros(0, np.float32))

    def arguments(rows):
        return take_rows(box, pairs[rows, 0]), take_rows(box, pairs[rows, 1])

    found = ClosePairs(pairs, in_blocks(_depths, arguments, len(pairs), _BLOCK))
    return found[found.depth_m > -distance_m]


def _culled_pairs(flat: FlatEntities, box: Box, distance_m: float) -> Int[np.ndarray, "pairs 2"]:
    """Pairs whose bounding cylinders come that near."""
    radius = np.linalg.norm(box.size[:, :2], axis=-1) / 2
    half = box.size[:, 2] / 2
    found = [np.zeros((0, 2), np.int32)]
    for scene in range(len(flat.start) - 1):
        span = np.arange(*flat.start[scene : scene + 2])
        span = span[~flat.is_layout[span]]
        i, j = (span[side] for side in np.triu_indices(len(span), 1))
        distance = np.linalg.norm(box.center[i, :2] - box.center[j, :2], axis=-1)
        rise = np.abs(box.center[i, 2] - box.center[j, 2])
        near = distance <= radius[i] + radius[j] + distance_m
        near &= rise <= half[i] + half[j] + distance_m
        found.append(np.stack([i[near], j[near]], -1).astype(np.int32))
    return np.concatenate(found)
