"""Which block lies in which row of the pool: a direct-addressed index grid on the host.

An int32 a block of the scene's bounds is smaller and faster than any hash at room scale (a
6 x 5 x 2.6 m room at 2 cm is 22,000 blocks). The grid grows with the scene.
"""

from __future__ import annotations

import numpy as np
from jaxtyping import Bool, Int

from ..errors import MapError
from .pool import ROW_MULTIPLE

_MARGIN = 8
"""Blocks added on a side that grows, so that it grows seldom."""
_MAX_GRID = 1 << 27
"""Blocks in the bounds of the scene: beyond this the poses are not those of a room."""


class BlockIndex:
    """Block coordinates to rows of the pool, and back."""

    def __init__(self, capacity: int, max_blocks: int) -> None:
        self.max_blocks = -(-max_blocks // ROW_MULTIPLE) * ROW_MULTIPLE
        capacity = -(-capacity // ROW_MULTIPLE) * ROW_MULTIPLE
        self.origin = np.zeros(3, np.int32)
        self.grid = np.full((0, 0, 0), -1, np.int32)
        self.coords = np.zeros((min(capacity, self.max_blocks), 3), np.int32)
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
        """Grow the grid to hold ``low`` to ``high``."""
        if self.grid.size:
            end = self.origin + self.extent
            new_low = np.where(low < self.origin, low - _MARGIN, self.origin)
            new_high = np.where(high >= end, high + 1 + _MARGIN, end)
        else:
            new_low, new_high = low - _MARGIN, high + 1 + _MARGIN
        shape = (new_high - new_low).astype(np.int64)
        if np.prod(shape) > _MAX_GRID:
            raise MapError(
                f"the map spans {shape.tolist()} blocks of 8^3 voxels",
                "check the poses and the depth unit, or raise MappingSettings.voxel_size_m",
            )
        grid = np.full(shape, -1, np.int32)
        self.origin, self.grid = new_low.astype(np.int32), grid
        self.index_rows(0, self.used)

    def allocate(self, flat: Int[np.ndarray, " active"]) -> Int[np.ndarray, " active"]:
        """Rows of the blocks at flat grid positions; new ones get the next free rows."""
        cells = self.grid.reshape(-1)
        rows = cells[flat]
        new = flat[rows < 0]
        self._reserve(self.used + len(new))
        place = np.stack(np.unravel_index(new, self.grid.shape), -1)
        self.coords[self.used : self.used + len(new)] = place + self.origin
        self.index_rows(self.used, self.used + len(new))
        self.used += len(new)
        return cells[flat]

    def index_rows(self, start: int, end: int) -> None:
        """Enter the rows from ``start`` to ``end`` in the grid."""
        x, y, z = (self.coords[start:end] - self.origin).T
        self.grid[x, y, z] = np.arange(start, end, dtype=np.int32)

    def _reserve(self, needed: int) -> None:
        capacity = self.capacity
        while capacity < needed and capacity < self.max_blocks:
            capacity = min(2 * capacity, self.max_blocks)
        if capacity < needed:
            raise MapError(
                f"the map needs {needed} blocks; MappingSettings.max_blocks = {self.max_blocks}",
                "raise MappingSettings.max_blocks, or voxel_size_m, or lower input.depth_max_m",
            )
        tail = np.zeros((capacity - self.capacity, 3), np.int32)
        self.coords = np.concatenate([self.coords, tail])

    def rows_at(self, block: Int[np.ndarray, "*batch 3"]) -> Int[np.ndarray, "*batch"]:
        """Rows of the blocks with these coordinates; -1 where there is none."""
        local = block - self.origin
        inside = np.all((local >= 0) & (local < self.extent), -1)
        safe = np.where(inside[..., None], local, 0)
        rows = self.grid[safe[..., 0], safe[..., 1], safe[..., 2]]
        return np.where(inside, rows, np.int32(-1))

    def marked(self, marks: Bool[np.ndarray, " size"]) -> Int[np.ndarray, " active"]:
        """Flat grid positions of set marks, ascending."""
        return np.flatnonzero(marks[: self.grid.size])
