"""The cells of some blocks that hold a vertex of the surface, read from their voxels (host)."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator

import numpy as np
from jaxtyping import Float, Int, UInt8

from ..config import MappingSettings
from ..runtime.batches import bucket
from .blocks import BlockIndex
from .cell_kernels import BATCH, CORNERS, HALO_OF_VOXEL, cell_labels, cell_vertices, find_cells
from .pool import BLOCK_SIDE, BLOCK_VOXELS, VoxelPool

_BLOCK = (BLOCK_SIDE,) * 3
_LEAST_READ, _LEAST_CELLS = 2 * BATCH, 32 * BATCH
"""Smallest buckets: few batches need the next, so that a kernel has few shapes."""


@dataclasses.dataclass(frozen=True, eq=False)
class Cells:
    """Cells that hold a vertex, ascending by block row and voxel."""

    row: Int[np.ndarray, " cells"]
    """Pool row of the block of the lowest corner."""
    voxel: Int[np.ndarray, " cells"]
    """Lowest corner, in its block."""
    case: UInt8[np.ndarray, " cells"]
    """Which corners are inside, one bit per corner in the order of `CORNERS`."""
    vertex: Float[np.ndarray, "cells 3"]
    """World frame, metres."""
    normal: Float[np.ndarray, "cells 3"]
    """Unit, outward."""
    color: UInt8[np.ndarray, "cells 3"]
    label: Int[np.ndarray, " cells"]
    """The map label that its corners have counted most."""

    @staticmethod
    def none() -> Cells:
        """No cells."""
        index, byte = np.zeros(0, np.int32), np.zeros(0, np.uint8)
        triple = np.zeros((0, 3), np.float32)
        return Cells(index, index, byte, triple, triple, triple.astype(np.uint8), index)

    def take(self, which: np.ndarray) -> Cells:
        """Some of the cells: a mask, or positions."""
        return Cells(*(getattr(self, f.name)[which] for f in dataclasses.fields(self)))


def joined(parts: list[Cells]) -> Cells:
    """The cells of all parts, as they come."""
    columns = [[getattr(p, f.name) for p in parts] for f in dataclasses.fields(Cells)]
    return Cells(*(np.concatenate(c) for c in columns))


@dataclasses.dataclass(frozen=True, eq=False)
class _Batch:
    """Up to `BATCH` blocks, and the blocks that their cells read."""

    rows: Int[np.ndarray, " blocks"]
    read: Int[np.ndarray, " read"]
    """Pool rows; -1 is padding, and stands for blocks that are not there."""
    local: Int[np.ndarray, "8 batch"]
    """Place in ``read`` of each block and of its upper neighbours."""


def _batches(blocks: BlockIndex, rows: Int[np.ndarray, " blocks"]) -> Iterator[_Batch]:
    for start in range(0, len(rows), BATCH):
        part = rows[start : start + BATCH]
        upper = blocks.rows_at(blocks.coords[part] + CORNERS[:, None])
        found, local = np.unique(upper, return_inverse=True)
        read = np.full(bucket(len(found) + 1, _LEAST_READ), -1, np.int32)
        read[: len(found)] = found
        padded = np.full((8, BATCH), len(read) - 1, np.int32)
        padded[:, : len(part)] = local.reshape(upper.shape)
        yield _Batch(part, read, padded)


def read_cells(
    pool: VoxelPool,
    blocks: BlockIndex,
    rows: Int[np.ndarray, " blocks"],
    settings: MappingSettings,
) -> Cells:
    """Cells of some blocks that hold a vertex.

    Args:
        pool: Of the map.
        blocks: Of the map.
        rows: Of those blocks, ascending.
        settings: Of the map.
    """
    voxel_m = settings.voxel_size_m
    limits = (
        np.float32(settings.mesh_min_weight),
        np.float32(settings.mesh_max_jump_voxels * voxel_m),
    )
    parts, started = [Cells.none()], None
    for batch in _batches(blocks, rows):
        found = find_cells(pool, batch.read, batch.local, *limits)
        if started is not None:  # the host reads one batch while the next is on its way
            parts.append(_cells_of(pool, blocks, voxel_m, *started))
        started = batch, *found
    if started is not None:
        parts.append(_cells_of(pool, blocks, voxel_m, *started))
    return joined(parts)


def _cells_of(
    pool: VoxelPool, blocks: BlockIndex, voxel_m: float, batch: _Batch, case, sdf_m, halo_voxel
) -> Cells:
    case = np.ascontiguousarray(np.asarray(case)[:, : len(batch.rows)].T).reshape(-1)
    flat = np.flatnonzero(case != 0)
    block, voxel = np.divmod(flat.astype(np.int32), np.int32(BLOCK_VOXELS))
    found = cell_vertices(pool, batch.read, sdf_m, halo_voxel, _anchors(block, voxel))
    place, *rest = (np.asarray(f)[: len(flat)] for f in found)
    row = batch.rows[block].astype(np.int32)
    corner = blocks.coords[row] * BLOCK_SIDE + np.stack(np.unravel_index(voxel, _BLOCK), -1)
    vertex = ((corner + 0.5 + place) * voxel_m).astype(np.float32)
    return Cells(row, voxel, case[flat], vertex, *rest)


def read_labels(pool: VoxelPool, blocks: BlockIndex, cells: Cells) -> Int[np.ndarray, " cells"]:
    """Labels of cells as the voxels have them now."""
    labels = [np.zeros(0, np.int32)]
    for batch in _batches(blocks, np.unique(cells.row)):
        part = slice(*np.searchsorted(cells.row, [batch.rows[0], batch.rows[-1] + 1]))
        block = np.searchsorted(batch.rows, cells.row[part])
        anchor = _anchors(block, cells.voxel[part])
        found = cell_labels(pool, batch.read, batch.local, anchor)
        labels.append(np.asarray(found)[: len(block)])
    return np.concatenate(labels)


def _anchors(block, voxel) -> Int[np.ndarray, " padded"]:
    """Lowest corners of cells in the halos of a batch, padded to a bucket."""
    anchor = np.zeros(bucket(len(block), _LEAST_CELLS), np.int32)
    anchor[: len(block)] = HALO_OF_VOXEL[voxel] * BATCH + block
    return anchor
