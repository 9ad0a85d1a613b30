"""Planes on which things are put: where they are really there, and what stands in the way."""

from __future__ import annotations

import dataclasses
import functools

import numpy as np
from jaxtyping import Bool, Float

from ...borders.raycast import RayScene
from ...library import CadModel
from ..cutting import cut_edges

SAMPLE_M = 0.03
"""Longest edge between sampled points of a surface."""
CELL_M = 0.01
_OPEN_SHELVES = ("bookshelf",)
"""Classes whose inner planes are seen from outside, and carry."""
_LEVEL_M = 1e-4
"""How much a plane that carries may lie off its own height."""
_ABOVE_M = 0.003
_TALLEST_M = 0.9
_REACH_M = 0.08


@dataclasses.dataclass(frozen=True, eq=False)
class Top:
    """One carrying plane of a model, canonical frame, unscaled."""

    low: Float[np.ndarray, "2"]
    high: Float[np.ndarray, "2"]
    """Corners of its rectangle; rectangles follow the model's axes."""
    height_m: float
    solid: Bool[np.ndarray, "nx ny"]
    """Cells of `CELL_M` from ``low`` on, at whose middle the surface lies at that height."""
    obstacles: Float[np.ndarray, "points 3"]
    """Points of the model above the plane, at most `SAMPLE_M` apart."""

    @property
    def area_m2(self) -> float:
        """Of the surface that is there."""
        return float(self.solid.mean() * np.prod(self.high - self.low))

    def carries(self, points: Float[np.ndarray, "points 2"]) -> bool:
        """Whether all points lie on the surface itself."""
        cell = np.floor((points - self.low) / CELL_M).astype(int)
        inside = np.all((points >= self.low) & (points < self.high), axis=1)
        return bool(inside.all() and self.solid[cell[:, 0], cell[:, 1]].all())


@functools.lru_cache(maxsize=2048)
def carrying_planes(model: CadModel) -> np.ndarray:
    """Planes of a model that things are put on: its top, or the shelves of an open one."""
    corners = np.asarray(model.planes.corners)
    height = corners[:, :, 2].mean(1)
    area = np.asarray(model.planes.area_m2)
    level = np.abs(corners[:, :, 2] - height[:, None]).max(1) < _LEVEL_M
    supporting = np.asarray(model.plane_supporting) & level & _along_axes(corners)
    if model.class_name in _OPEN_SHELVES:
        return np.flatnonzero(supporting & (area > 0.02))
    upper = np.flatnonzero(supporting & (height > (0.2 - 0.5) * model.size[2]))
    return upper[np.lexsort((height[upper], np.round(area[upper], 3)))[-1:]]


def _along_axes(corners: np.ndarray) -> np.ndarray:
    """Rectangles whose sides follow x and y."""
    side = corners[:, 1, :2] - corners[:, 0, :2]
    return np.abs(side).min(1) < 1e-3 + 1e-3 * np.abs(side).max(1)


@functools.lru_cache(maxsize=512)
def top_of(model: CadModel, plane: int) -> Top:
    """The grid of a plane, by rays from just above it straight down."""
    corners = np.asarray(model.planes.corners[plane], np.float64)
    low, high, height = corners[:, :2].min(0), corners[:, :2].max(0), corners[:, 2].mean()
    shape = np.maximum(1, np.ceil((high - low) / CELL_M - 1e-6)).astype(int)
    x, y = (low[k] + (np.arange(shape[k]) + 0.5) * CELL_M for k in (0, 1))
    middle = np.stack([g.ravel() for g in np.meshgrid(x, y, indexing="ij")], 1)
    middle = np.minimum(middle, high - 1e-4)
    origins = np.concatenate([middle, np.full((len(middle), 1), height + _ABOVE_M)], 1)
    hits = ray_scene(model).cast(origins, np.tile([0.0, 0.0, -1.0], (len(middle), 1)))
    solid = (hits.instance > 0) & (np.abs(hits.distance - _ABOVE_M) < _LEVEL_M)
    return Top(
        low, high, float(height), solid.reshape(tuple(shape)), _above(model, low, high, height)
    )


def _above(model: CadModel, low: np.ndarray, high: np.ndarray, height: float) -> np.ndarray:
    points = model_samples(model)
    beside = np.all((points[:, :2] > low - _REACH_M) & (points[:, :2] < high + _REACH_M), axis=1)
    level = (points[:, 2] > height + 0.004) & (points[:, 2] < height + _TALLEST_M)
    return points[beside & level]


@functools.lru_cache(maxsize=512)
def ray_scene(model: CadModel) -> RayScene:
    """All visuals of a model, joints closed, for rays in its canonical frame."""
    return RayScene([model.mesh], [1])


@functools.lru_cache(maxsize=512)
def model_samples(model: CadModel) -> np.ndarray:
    """[points, 3] on the surface, canonical frame: corners of triangles of edges < `SAMPLE_M`."""
    return cut_edges(model.mesh.vertices, model.mesh.faces, SAMPLE_M).vertices
