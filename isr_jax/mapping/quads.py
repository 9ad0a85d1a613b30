"""Faces of the surface: which four cells each crossed voxel edge joins (host).

A vertex is named by its cell: ``row * 512 + rank``, where ``rank`` counts the cells of that block
that hold a vertex. Names of other blocks stay valid when one block is meshed again, and turn into
positions in the mesh by one look-up in a table of the blocks' first vertices.
"""

from __future__ import annotations

import dataclasses

import numpy as np
from jaxtyping import Float, Int, UInt8

from .blocks import BlockIndex
from .cell_kernels import CORNERS
from .pool import BLOCK_SIDE, BLOCK_VOXELS

_RANK_BITS = 9
_AXIS_BIT = (4, 2, 1)
"""Corner at the end of the edge that leaves the lowest corner along x, y, z."""


def _lower_tables():
    """Block (a row of `CORNERS`, downwards) and voxel of the cell one step down from each voxel."""
    place = np.stack(np.unravel_index(np.arange(BLOCK_VOXELS), (BLOCK_SIDE,) * 3), -1)
    down = place - CORNERS[:, None]
    voxel = (down & (BLOCK_SIDE - 1)) @ [BLOCK_SIDE**2, BLOCK_SIDE, 1]
    return ((down < 0) @ [4, 2, 1]).astype(np.int32), voxel.astype(np.int32)


_LOWER_SLOT, _LOWER_VOXEL = _lower_tables()


def first_cells(row: Int[np.ndarray, " cells"], used: int) -> Int[np.ndarray, " used"]:
    """Position of each block's first cell; ``row`` ascends."""
    count = np.bincount(row, minlength=used)
    return (np.cumsum(count) - count).astype(np.int32)


def positions(
    names: Int[np.ndarray, "*batch"], first: Int[np.ndarray, " used"]
) -> Int[np.ndarray, "*batch"]:
    """Cells that vertices are named by; ``first`` is that of `first_cells`."""
    return first[names >> _RANK_BITS] + (names & (BLOCK_VOXELS - 1))


def join_cells(
    blocks: BlockIndex,
    wanted: Int[np.ndarray, " wanted"],
    row: Int[np.ndarray, " cells"],
    voxel: Int[np.ndarray, " cells"],
    case: UInt8[np.ndarray, " cells"],
) -> tuple[Int[np.ndarray, " quads"], Int[np.ndarray, "quads 4"]]:
    """Quadrilaterals of the edges that start in ``wanted`` blocks, normals outward.

    Args:
        blocks: Of the map.
        wanted: Rows, ascending.
        row: Block row of the cells that hold a vertex, ascending; those of the wanted blocks and
            their lower neighbours, at least.
        voxel: Their voxels, ascending in a block.
        case: Their cases.

    Returns:
        The block row of each quadrilateral, ascending, and the names of its vertices. Edges
        around which a cell is missing have none, so that unobserved borders stay open.
    """
    lower = blocks.rows_at(blocks.coords[wanted][:, None] - CORNERS)
    is_known = np.zeros(blocks.used + 1, bool)  # row -1 is the last
    is_known[lower] = is_known[-1] = True
    place_of = np.where(is_known, np.cumsum(is_known, dtype=np.int32) - 1, -1)
    rank = np.arange(len(row), dtype=np.int32) - first_cells(row, blocks.used)[row]
    name = (row << _RANK_BITS) + rank
    name_at = np.full((place_of[-1] + 1, BLOCK_VOXELS), -1, np.int32)
    held = np.flatnonzero(place_of[row] >= 0)
    name_at[place_of[row[held]], voxel[held]] = name[held]
    block_of = np.full(blocks.used, -1, np.int32)
    block_of[wanted] = np.arange(len(wanted))
    ours = np.flatnonzero(block_of[row] >= 0)
    around = _Around(block_of[row[ours]], voxel[ours], place_of[lower], name_at)
    found = [_quads(axis, case[ours], name[ours], around) for axis in range(3)]
    owner = np.concatenate([row[ours[cell]] for cell, _ in found])
    order = np.argsort(owner, kind="stable")
    return owner[order], np.concatenate([quads for _, quads in found])[order]


@dataclasses.dataclass(frozen=True, eq=False)
class _Around:
    """Cells, and what lies below them."""

    block: Int[np.ndarray, " cells"]
    voxel: Int[np.ndarray, " cells"]
    lower: Int[np.ndarray, "blocks 8"]
    """Row of ``name_at`` of each block and its lower neighbours."""
    name_at: Int[np.ndarray, "known 512"]
    """Name of the vertex in each cell; -1 = none."""

    def names(self, cell: Int[np.ndarray, " some"], step: int) -> Int[np.ndarray, " some"]:
        """Names of the vertices one step down from cells, along the axes whose bits are set."""
        voxel = self.voxel[cell]
        slot = self.block[cell] * 8 + _LOWER_SLOT[step][voxel]
        at = self.lower.reshape(-1)[slot] * BLOCK_VOXELS + _LOWER_VOXEL[step][voxel]
        return self.name_at.reshape(-1)[at]


def _quads(axis: int, case, name, around: _Around):
    """Quadrilaterals of the edges along one axis, and the cells at whose lowest corner they start.

    Seen against the axis the four cells lie counter-clockwise; that way faces outward when the
    edge starts inside.
    """
    inside = case & 1
    cell = np.flatnonzero(inside != case >> _AXIS_BIT[axis] & 1)
    b, c = _AXIS_BIT[(axis + 1) % 3], _AXIS_BIT[(axis + 2) % 3]
    corners = name[cell], *(around.names(cell, step) for step in (b, b | c, c))
    starts = inside[cell] != 0
    quads = np.stack([np.where(starts, i, j) for i, j in zip(corners, corners[::-1])], 1)
    whole = np.all(quads >= 0, 1)
    return cell[whole], quads[whole]


def turned(
    quads: Int[np.ndarray, "quads 4"],
    position: Int[np.ndarray, "quads 4"],
    vertices: Float[np.ndarray, "vertices 3"],
) -> Int[np.ndarray, "quads 4"]:
    """Quadrilaterals so turned that their shorter diagonal joins the first and third vertex.

    Args:
        quads: Names of vertices.
        position: Rows of ``vertices`` of the same.
        vertices: Metres.
    """
    a, b, c, d = (np.take(vertices, p, axis=0) for p in position.T)
    first, second = a - c, b - d
    longer = np.einsum("ij,ij->i", first, first) > np.einsum("ij,ij->i", second, second)
    return np.where(longer[:, None], np.roll(quads, -1, 1), quads)
