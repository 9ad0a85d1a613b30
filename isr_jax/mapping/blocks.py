"""Which block lies in which row of the pool, and which blocks were seen empty: grids on the host.

One int32 per block of the scene's bounds is smaller and faster than any hash at room scale (a
6 x 5 x 2.6 m room at 2 cm is 22,000 blocks). A byte beside it counts the frames whose rays went
through the whole block. The grids grow with the scene.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from jaxtyping import Bool, Int, UInt8

from ..errors import MapError
from .pool import ROW_MULTIPLE

_MARGIN = 8
"""Blocks added at least on a side that grows, so that it grows seldom."""
_MAX_GRID = 1 << 27
"""Blocks in the bounds of the scene: beyond this the poses are not those of a room."""


class BlockIndex:
    """Block coordinates to rows of the pool, and back."""

    def __init__(self, capacity: int, max_blocks: int) -> None:
        self.max_blocks = -(-max_blocks // ROW_MULTIPLE) * ROW_MULTIPLE
        capacity = -(-capacity // ROW_MULTIPLE) * ROW_MULTIPLE
        self.origin = np.zeros(3, np.int32)
        self.grid: Int[np.ndarray, "x y z"] = np.full((0, 0, 0), -1, np.int32)
        self.passes: UInt8[np.ndarray, "x y z"] = np.zeros((0, 0, 0), np.uint8)
        """Frames that saw through the whole block, up to 255; the shape of ``grid``."""
        self.coords = np.zeros((min(capacity, self.max_blocks), 3), np.int32)
        self.stamp = np.zeros(len(self.coords), np.int64)
        """Number of the step that last changed a row's distances, colours or counts of labels."""
        self.generation = np.zeros(len(self.coords), np.int32)
        """Numbering of map labels in which a row's labels are written."""
        self.used = 0

    @property
    def capacity(self) -> int:
        """Rows that the pool must have."""
        return len(self.coords)

    @property
    def extent(self) -> np.ndarray:
        """Blocks of the grid along x, y, z."""
        return np.array(self.grid.shape, np.int32)

    def covers(self, low: Int[np.ndarray, "3"], high: Int[np.ndarray, "3"]) -> bool:
        """Whether the grid holds every block from ``low`` to ``high``."""
        return bool(np.all(low >= self.origin) and np.all(high < self.origin + self.extent))

    def cover(self, low: Int[np.ndarray, "3"], high: Int[np.ndarray, "3"]) -> None:
        """Grow the grid to hold ``low`` to ``high``; by a share of it, so that it grows seldom.

        Raises:
            MapError: it would span more blocks than a room's; the grid is as it was.
        """
        if self.covers(low, high):
            return
        if self.grid.size:
            margin = np.maximum(_MARGIN, self.extent // 4)
            end = self.origin + self.extent
            new_low = np.where(low < self.origin, low - margin, self.origin)
            new_high = np.where(high >= end, high + 1 + margin, end)
        else:
            new_low, new_high = low - _MARGIN, high + 1 + _MARGIN
        shape = (new_high - new_low).astype(np.int64)
        if np.prod(shape) > _MAX_GRID:
            raise MapError(
                f"the map spans {shape.tolist()} blocks of 8^3 voxels",
                "check the poses and the depth unit, or raise MappingSettings.voxel_size_m",
            )
        grid, passes = np.full(shape, -1, np.int32), np.zeros(shape, np.uint8)
        start = self.origin - new_low
        old = tuple(slice(s, s + n) for s, n in zip(start, self.grid.shape, strict=True))
        if self.grid.size:
            grid[old], passes[old] = self.grid, self.passes
        self.origin, self.grid, self.passes = new_low.astype(np.int32), grid, passes

    def part(self, low: Int[np.ndarray, "3"], extent: Int[np.ndarray, "3"]):
        """Where a covered box of blocks lies in the grids."""
        start = low - self.origin
        return tuple(slice(s, s + n) for s, n in zip(start.tolist(), extent.tolist(), strict=True))

    def allocate(self, coords: Int[np.ndarray, "active 3"], reserve: Callable[[int], None]) -> None:
        """Give covered blocks rows where they have none: the next free ones.

        Args:
            reserve: Called with the capacity that the pool must have.

        Raises:
            MapError: they are more than ``max_blocks``, or ``reserve`` raised it; nothing has
                changed.
        """
        x, y, z = (coords - self.origin).T
        new = coords[self.grid[x, y, z] < 0]
        start, end = self.used, self.used + len(new)
        capacity = self._capacity_for(end)
        reserve(capacity)
        self.resize(capacity)
        self.coords[start:end] = new
        self.index_rows(start, end)
        self.used = end

    def index_rows(self, start: int, end: int) -> None:
        """Enter the rows from ``start`` to ``end`` in the grid."""
        x, y, z = (self.coords[start:end] - self.origin).T
        self.grid[x, y, z] = np.arange(start, end, dtype=np.int32)

    def _capacity_for(self, needed: int) -> int:
        capacity = self.capacity
        while capacity < needed and capacity < self.max_blocks:
            capacity = min(2 * capacity, self.max_blocks)
        if capacity < needed:
            raise MapError(
                f"the map needs {needed} blocks; MappingSettings.max_blocks = {self.max_blocks}",
                "raise MappingSettings.max_blocks, or voxel_size_m, or lower input.depth_max_m",
            )
        return capacity

    def resize(self, capacity: int) -> None:
        """Room for ``capacity`` rows; used ones stay."""
        tail = capacity - self.capacity
        if tail > 0:
            self.coords = np.pad(self.coords, ((0, tail), (0, 0)))
            self.stamp = np.pad(self.stamp, (0, tail))
            self.generation = np.pad(self.generation, (0, tail))

    def rows_at(self, block: Int[np.ndarray, "*batch 3"]) -> Int[np.ndarray, "*batch"]:
        """Rows of the blocks with these coordinates; -1 where there is none."""
        return self._at(self.grid, block, np.int32(-1))

    def passed(self, block: Int[np.ndarray, "*batch 3"]) -> Bool[np.ndarray, "*batch"]:
        """Whether rays of some frame went through the whole block."""
        return self._at(self.passes, block, np.uint8(0)) > 0

    def _at(self, grid, block, otherwise):
        if not grid.size:
            return np.full(np.shape(block)[:-1], otherwise)
        local = block - self.origin
        inside = np.all((local >= 0) & (local < self.extent), -1)
        safe = np.where(inside[..., None], local, 0)
        return np.where(inside, grid[safe[..., 0], safe[..., 1], safe[..., 2]], otherwise)
