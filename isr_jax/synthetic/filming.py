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
from .shading import shade
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
        self._room, self._camera, self._noise, self._seed = room, camera, noise, seed
        self._scene = RayScene([s.mesh for s in surfaces], [i for i, _ in (*layout, *items)])
        self._albedo = np.concatenate([s.face_rgb for s in surfaces])
        self._rays = camera_rays(camera).reshape(-1, 3).astype(np.float32)
        self._ray_length = np.sqrt(np.einsum("pi,pi->p", self._rays, self._rays))

    def shoot(self, index: int, T_world_camera: Float[np.ndarray, "4 4"]) -> Shot:
        """The frame seen from a pose; its noise depends on the seed and the index alone."""
        T = T_world_camera.astype(np.float32)
        shape = (self._camera.height, self._camera.width)
        directions = self._rays @ T[:3, :3].T
        hits = self._scene.cast(np.broadcast_to(T[:3, 3], directions.shape), directions)
        points = T[:3, 3] + directions * hits.distance[:, None]
        facing = np.einsum("pi,pi->p", hits.normal, directions)
        normals = hits.normal * -np.where(facing > 0, np.float32(1), np.float32(-1))[:, None]
        incidence = np.arccos(np.clip(np.abs(facing) / self._ray_length, 0, 1))
        rng = np.random.default_rng([self._seed, 2, index])
        depth = hits.distance.reshape(shape)
        color = shade(self._room, points, normals, self._albedo[hits.triangle], hits.instance)
        noisy = sensor_depth(depth, incidence.reshape(shape), self._camera, self._noise, rng)
        return Shot(
            color=color.reshape(*shape, 3),
            depth_m=noisy,
            true_depth_m=depth,
            instance=hits.instance.reshape(shape),
            seen=self._seen(depth, points, normals, hits.instance),
        )

    def _seen(self, depth, points, normals, instance) -> SeenSurface:
        noise, stride = self._noise, _SURFACE_STRIDE
        inside = (depth > max(noise.range_min_m, 0.0)) & (depth <= noise.range_max_m)
        rows = np.arange(depth.size).reshape(depth.shape)[::stride, ::stride]
        rows = rows[inside[::stride, ::stride]]
        return thinned(SeenSurface(points[rows], normals[rows], instance[rows]))


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
