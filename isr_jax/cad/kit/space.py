"""The space that convex solids leave: which of them stand over a plane, and what blocks a ray."""

from __future__ import annotations

import dataclasses
import functools

import numpy as np

from .solids import Solid

PROBE_M = 0.0001
"""What is said of a surface is asked so far above it."""


@dataclasses.dataclass(frozen=True, eq=False)
class Piece:
    """A solid and the link that it belongs to."""

    solid: Solid
    link: str
    carries: bool = True
    """False: nobody puts things on it, flat as it may be (the foot plate of a table)."""


@dataclasses.dataclass(frozen=True, eq=False)
class Space:
    """All solids: half-spaces [solids, faces, 4], padded with ones that hold everywhere."""

    planes: np.ndarray
    faces: np.ndarray
    """[solids] how many of the half-spaces are no padding."""
    vertices: tuple[np.ndarray, ...]

    @staticmethod
    def of(pieces: list[Piece]) -> Space:
        rows = [piece.solid.planes for piece in pieces]
        planes = np.zeros((len(rows), max(map(len, rows)), 4))
        planes[..., 3] = -1.0
        for i, row in enumerate(rows):
            planes[i, : len(row)] = row
        counts = np.array([len(row) for row in rows])
        return Space(planes, counts, tuple(piece.solid.vertices for piece in pieces))

    @functools.cached_property
    def _stacked(self) -> tuple[np.ndarray, np.ndarray]:
        """All vertices, and where those of each solid start."""
        counts = [len(v) for v in self.vertices]
        return np.concatenate(self.vertices), np.cumsum([0, *counts[:-1]])

    def above(self, normal: np.ndarray, offset: float, reach: float = np.inf) -> Space:
        """The solids that stand above a plane, from less than ``reach`` over it."""
        points, starts = self._stacked
        height = points @ normal + offset
        near = np.maximum.reduceat(height, starts) > PROBE_M
        near &= np.minimum.reduceat(height, starts) < reach
        rows = np.flatnonzero(near)
        most = int(self.faces[rows].max(initial=0))
        vertices = tuple(self.vertices[i] for i in rows)
        return Space(self.planes[rows, :most], self.faces[rows], vertices)

    def blocked(self, points: np.ndarray, direction: np.ndarray, length: float) -> np.ndarray:
        """Whether the segments from ``points`` [n, 3] along ``direction`` meet any solid."""
        return self.blocked_from(self.heights(points), direction, length)

    def heights(self, points: np.ndarray) -> np.ndarray:
        """[n, solids, faces] of ``points`` [n, 3] above each face."""
        return np.einsum("sfc,nc->nsf", self.planes[..., :3], points) + self.planes[..., 3]

    def blocked_from(self, heights: np.ndarray, direction: np.ndarray, length: float) -> np.ndarray:
        """`blocked` for points that are so high above the faces (slabs of a convex solid)."""
        if not self.vertices:
            return np.zeros(len(heights), bool)
        slope = self.planes[..., :3] @ direction
        level = np.abs(slope) <= 1e-9
        crossing = heights * (-1.0 / np.where(level, 1.0, slope))
        enter = np.where(slope < -1e-9, crossing, 0.0).max(-1)
        leave = np.where(slope > 1e-9, crossing, length).min(-1)
        meets = np.maximum(enter, 0.0) < np.minimum(leave, length) - 1e-7
        if level.any():
            meets &= ~(level & (heights > 0)).any(-1)
        return meets.any(-1)
