"""A camera in a room: true images, noisy images, and the surface that was seen."""

from __future__ import annotations

import dataclasses

import numpy as np
from jaxtyping import Float, Int, UInt8

from ...borders.raycast import RayHits, RayScene, camera_rays
from ...classes import class_named
from ...config import NoiseModel
from ...types import Camera
from ..image.noise import sensor_depth
from ..image.shading import Developed, develop, studio
from ..image.shadows import STRIDE, lit_share
from ..room import Room
from ..surface import Surface, first_parts, room_surfaces

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
    class_id: Int[np.ndarray, "height width"]
    """Row of `classes.CLASSES`; 0 = nothing."""
    part: Int[np.ndarray, "height width"]
    """Id of `surface.room_parts`; 0 = nothing."""
    seen: SeenSurface


@dataclasses.dataclass(frozen=True, eq=False)
class Look:
    """What the rays of one frame meet."""

    eye: Float[np.ndarray, "3"]
    """World frame, metres."""
    directions: Float[np.ndarray, "rays 3"]
    """World frame, of length 1 along the optical axis."""
    hits: RayHits
    barycentric: Float[np.ndarray, "rays 2"]
    lit: Float[np.ndarray, " rays"]
    """Share of the lamp."""


@dataclasses.dataclass(frozen=True, eq=False)
class SeenSurface:
    """True surface points, one per cell of a 2 cm grid and entity, world frame."""

    points: Float[np.ndarray, "points 3"]
    normals: Float[np.ndarray, "points 3"]
    """Unit, towards the camera that saw them first."""
    instance: Int[np.ndarray, " points"]
    """Entity id."""


class Film:
    """A room made ready to be filmed by one camera."""

    def __init__(self, room: Room, camera: Camera, noise: NoiseModel, seed: int) -> None:
        self.surfaces: dict[int, Surface] = room_surfaces(room)
        """By entity id, the layout first: all that rays can meet."""
        surfaces = list(self.surfaces.values())
        self.scene: RayScene = RayScene([s.mesh for s in surfaces], list(self.surfaces))
        self._camera, self._noise, self._seed = camera, noise, seed
        first = first_parts(room)
        part = [first[i] + surface.face_part for i, surface in self.surfaces.items()]
        self._part_or_none = np.append(np.concatenate(part), 0).astype(np.int32)
        class_name = class_names(room)
        self._class_id = np.zeros(max(class_name) + 1, np.int32)
        self._class_id[list(class_name)] = [class_named(n).id for n in class_name.values()]
        names = [class_name[i] for i in self.surfaces]
        self._studio = studio(room, names, surfaces, self.scene.normals)
        self._rays = camera_rays(camera).astype(np.float32)

    def shoot(self, index: int, T_world_camera: Float[np.ndarray, "4 4"]) -> Shot:
        """The frame seen from a pose; its noise depends on the seed and the index alone."""
        look = self.look(T_world_camera)
        return self.shot(index, look, self.expose(look))

    def look(self, T_world_camera: Float[np.ndarray, "4 4"]) -> Look:
        """Cast the rays of a frame, and from every fourth hit one to the lamp."""
        T = T_world_camera.astype(np.float32)
        # The rays of a row share y and those of a column x: two sums instead of a product.
        across = self._rays[:1, :, :1] * T[:3, 0]
        directions = across + (self._rays[:, :1, 1:] @ T[:3, 1:3].T)
        flat = directions.reshape(-1, 3)
        hits, barycentric = self.scene.cast_into(np.broadcast_to(T[:3, 3], flat.shape), flat)
        shape = self._rays.shape[:2]
        some = directions[::STRIDE, ::STRIDE]
        normal = hits.normal.reshape(*shape, 3)[::STRIDE, ::STRIDE]
        facing = np.einsum("rci,rci->rc", normal, some)[..., None]
        point = T[:3, 3] + hits.distance.reshape(shape)[::STRIDE, ::STRIDE, None] * some
        normal = np.where(facing > 0, -normal, normal)
        lit = lit_share(self.scene, np.asarray(self._studio.lights[0]), point, normal, shape)
        return Look(T[:3, 3], flat, hits, barycentric, lit.ravel())

    def expose(self, look: Look) -> Developed:
        """Colour and angles of what the rays met; may still be computed when it returns."""
        hits = look.hits
        return develop(
            self._studio,
            look.eye,
            look.directions,
            hits.distance,
            hits.triangle,
            look.barycentric,
            look.lit,
        )

    def shot(self, index: int, look: Look, developed: Developed) -> Shot:
        """The images of a frame, with the sensor's noise."""
        shape = self._rays.shape[:2]
        instance = look.hits.instance.reshape(shape)
        part = self._part_or_none[look.hits.triangle].reshape(shape)
        depth = look.hits.distance.reshape(shape)
        return Shot(
            color=np.asarray(developed.rgb).reshape(*shape, 3),
            depth_m=self.sense(index, depth, developed),
            true_depth_m=depth,
            instance=instance,
            class_id=self._class_id[instance],
            part=part,
            seen=self._seen(look, developed),
        )

    def sense(
        self, index: int, depth_m: Float[np.ndarray, "height width"], developed: Developed
    ) -> Float[np.ndarray, "height width"]:
        """What the depth sensor returns of a frame."""
        incidence = np.asarray(developed.incidence).reshape(depth_m.shape)
        albedo = np.asarray(developed.albedo).reshape(depth_m.shape)
        rng = np.random.default_rng([self._seed, 2, index])
        return sensor_depth(depth_m, incidence, self._camera, self._noise, rng, albedo=albedo)

    def _seen(self, look: Look, developed: Developed) -> SeenSurface:
        stride, shape = _SURFACE_STRIDE, self._rays.shape[:2]
        depth = look.hits.distance.reshape(shape)[::stride, ::stride]
        rows = np.arange(shape[0] * shape[1]).reshape(shape)[::stride, ::stride]
        rows = rows[(depth > self._noise.range_min_m) & (depth <= self._noise.range_max_m)]
        points = look.eye + look.hits.distance[rows, None] * look.directions[rows]
        normals = np.asarray(developed.normal)[rows]
        return thinned(SeenSurface(points, normals, look.hits.instance[rows]))


def class_names(room: Room) -> dict[int, str]:
    """By entity id: the layout, then the items."""
    layout = {patch.id: patch.class_name for patch in room.layout}
    return layout | {item.id: item.model.class_name for item in room.items}


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
