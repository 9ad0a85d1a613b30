"""A camera in a room: true images, noisy images, and the surface that was seen."""

from __future__ import annotations

import dataclasses

import numpy as np
from jaxtyping import Float, Int, UInt8

from ..config import NoiseModel
from ..raycast import RayScene, camera_rays
from ..types import Camera
from .noise import sensor_depth
from .room import Room
from .shading import Developed, develop, studio
from .surface import layout_surface, whole_surface

SURFACE_GRID_M = 0.02
_SURFACE_STRIDE = 2
"""Pixels between samples of the seen surface: denser than its grid up to 4.5 m."""


@dataclasses.dataclass(frozen=True, eq=False)
class Shot:
    """One frame as filmed."""

    color: UInt8[np.ndarray, "height width 3"]
    depth_m: Float[np.ndarray, "height width"]
    """With the sensor's noise; 0 = no return."""
    true_depth_m: Float[np.ndarray, "height width"]
    instance: Int[np.ndarray, "height width"]
    """Entity id; 0 = nothing."""
    seen: SeenSurface


@dataclasses.dataclass(frozen=True, eq=False)
class SeenSurface:
    """True surface points, one a cell of a 2 cm grid and entity, world frame."""

    points: Float[np.ndarray, "points 3"]
    normals: Float[np.ndarray, "points 3"]
    """Unit, towards the camera that saw them first."""
    instance: Int[np.ndarray, " points"]
    """Entity id."""


class Film:
    """A room made ready to be filmed by one camera."""

    def __init__(self, room: Room, camera: Camera, noise: NoiseModel, seed: int) -> None:
        layout = [(p.id, layout_surface(p, np.inf)) for p in room.layout]
        items = [(item.id, whole_surface(item)) for item in room.items]
        surfaces = [surface for _, surface in (*layout, *items)]
        self._camera, self._noise, self._seed = camera, noise, seed
        self._studio = studio(room)
        self._scene = RayScene([s.mesh for s in surfaces], [i for i, _ in (*layout, *items)])
        self._albedo = np.concatenate([s.face_rgb for s in surfaces])
        self._rays = camera_rays(camera).astype(np.float32)

    def shoot(self, index: int, T_world_camera: Float[np.ndarray, "4 4"]) -> Shot:
        """The frame seen from a pose; its noise depends on the seed and the index alone."""
        T = T_world_camera.astype(np.float32)
        shape = self._rays.shape[:2]
        # The rays of a row share y and those of a column x: two sums instead of a product.
        across = self._rays[:1, :, :1] * T[:3, 0]
        directions = (across + (self._rays[:, :1, 1:] @ T[:3, 1:3].T)).reshape(-1, 3)
        hits = self._scene.cast(np.broadcast_to(T[:3, 3], directions.shape), directions)
        albedo = self._albedo[hits.triangle]
        developed = develop(
            self._studio, T[:3, 3], directions, hits.distance, hits.normal, albedo, hits.instance
        )
        depth = hits.distance.reshape(shape)
        incidence = np.asarray(developed.incidence).reshape(shape)
        rng = np.random.default_rng([self._seed, 2, index])
        return Shot(
            color=np.asarray(developed.rgb).reshape(*shape, 3),
            depth_m=sensor_depth(depth, incidence, self._camera, self._noise, rng),
            true_depth_m=depth,
            instance=hits.instance.reshape(shape),
            seen=self._seen(depth, developed, hits.instance),
        )

    def _seen(self, depth: np.ndarray, developed: Developed, instance: np.ndarray) -> SeenSurface:
        stride = _SURFACE_STRIDE
        inside = (depth > self._noise.range_min_m) & (depth <= self._noise.range_max_m)
        rows = np.arange(depth.size).reshape(depth.shape)[::stride, ::stride]
        rows = rows[inside[::stride, ::stride]]
        points, normals = np.asarray(developed.point)[rows], np.asarray(developed.normal)[rows]
        return thinned(SeenSurface(points, normals, instance[rows]))


def thinned(seen: SeenSurface) -> SeenSurface:
    """The first point of every cell and entity."""
    cell = np.floor(seen.points / SURFACE_GRID_M).astype(np.int64) + (1 << 14)
    key = ((cell[:, 0] << 15 | cell[:, 1]) << 15 | cell[:, 2]) << 15 | seen.instance
    _, first = np.unique(key, return_index=True)
    first.sort()
    return SeenSurface(seen.points[first], seen.normals[first], seen.instance[first])


def joined(parts: list[SeenSurface]) -> SeenSurface:
    """What several shots saw."""
    fields = ("points", "normals", "instance")
    columns = [np.concatenate([getattr(part, field) for part in parts]) for field in fields]
    return thinned(SeenSurface(*columns))
