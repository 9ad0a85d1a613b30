"""Border: embreex. Rays against triangle meshes: depth, instance and normal of the first hit.

Embree works in float32; rays whose directions have z = 1 in the camera frame give the depth along
the optical axis as their parameter, so no square root stands between a hit and its depth.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence

import numpy as np
from embreex.mesh_construction import TriangleMesh
from embreex.rtcore_scene import EmbreeScene
from jaxtyping import Bool, Float, Int

from ..types import Array, Camera, Mesh

MISS = -1
"""Triangle of a ray that hits nothing."""


@dataclasses.dataclass(frozen=True, eq=False)
class RayHits:
    """First hits of a set of rays; a ray that hits nothing has distance 0 and instance 0."""

    distance: Float[np.ndarray, " rays"]
    """In lengths of the ray's direction."""
    triangle: Int[np.ndarray, " rays"]
    """Face, counted over all meshes of the scene; `MISS` where there is none."""
    instance: Int[np.ndarray, " rays"]
    normal: Float[np.ndarray, "rays 3"]
    """Unit, by the winding of the triangle; 0 where there is none."""


@dataclasses.dataclass(frozen=True, eq=False)
class View:
    """What a camera sees: images of the first hits."""

    depth_m: Float[np.ndarray, "height width"]
    """Along the optical axis; 0 = nothing hit."""
    instance: Int[np.ndarray, "height width"]
    triangle: Int[np.ndarray, "height width"]
    normal: Float[np.ndarray, "height width 3"]
    """World frame."""


class RayScene:
    """Triangle meshes that rays can be cast against, each with an instance id (> 0)."""

    def __init__(self, meshes: Sequence[Mesh], instances: Sequence[int]) -> None:
        counts = [len(mesh.vertices) for mesh in meshes]
        starts = np.concatenate([[0], np.cumsum(counts)[:-1]]).astype(np.int64)
        self.vertices: np.ndarray = np.concatenate([m.vertices for m in meshes]).astype(np.float32)
        self.faces: np.ndarray = np.concatenate(
            [m.faces + start for m, start in zip(meshes, starts, strict=True)]
        ).astype(np.int32)
        """All faces, mesh after mesh; `RayHits.triangle` counts in these."""
        per_mesh = [len(mesh.faces) for mesh in meshes]
        instance = np.repeat(np.asarray(instances, np.int32), per_mesh)
        self._instance_or_none = np.append(instance, np.int32(0))
        normal = _unit_normals(self.vertices[self.faces])
        self._normal_or_none = np.append(normal, np.zeros((1, 3), np.float32), axis=0)
        self.normals: np.ndarray = self._normal_or_none[:-1]
        """Unit, of each of ``faces`` by its winding."""
        # Embree keeps pointers into the arrays, so they live as long as the scene does.
        self._scene = EmbreeScene()
        self._mesh = TriangleMesh(self._scene, self.vertices, self.faces)

    def cast(self, origins: Float[Array, "rays 3"], directions: Float[Array, "rays 3"]) -> RayHits:
        """First hit of each ray. Directions need not be unit."""
        return self.cast_into(origins, directions)[0]

    def cast_into(
        self, origins: Float[Array, "rays 3"], directions: Float[Array, "rays 3"]
    ) -> tuple[RayHits, Float[np.ndarray, "rays 2"]]:
        """First hit of each ray, and where in its triangle.

        Returns:
            Hits, and the weights of the triangle's second and third corner; 0 at a miss.
        """
        out = self._scene.run(
            np.ascontiguousarray(origins, np.float32),
            np.ascontiguousarray(directions, np.float32),
            query="INTERSECT",
            output=1,
        )
        # A miss is -1, and so reads the row that stands behind the last face.
        hit = out["primID"] >= 0
        triangle = np.where(hit, out["primID"], MISS)
        hits = RayHits(
            distance=np.where(hit, out["tfar"], np.float32(0)),
            triangle=triangle,
            instance=self._instance_or_none[triangle],
            normal=self._normal_or_none[triangle],
        )
        return hits, np.stack([out["u"], out["v"]], 1) * hit[:, None]

    def blocked(
        self,
        origins: Float[Array, "rays 3"],
        directions: Float[Array, "rays 3"],
        reach: float | Float[Array, " rays"],
    ) -> Bool[np.ndarray, " rays"]:
        """Whether something lies on each ray nearer than ``reach``, in lengths of its direction."""
        met = self._scene.run(
            np.ascontiguousarray(origins, np.float32),
            np.ascontiguousarray(directions, np.float32),
            dists=np.broadcast_to(np.float32(reach), len(directions)).astype(np.float32),
            query="OCCLUDED",
        )
        return met != MISS

    def view(self, camera: Camera, T_world_camera: Float[Array, "4 4"]) -> View:
        """Depth, instance, triangle and normal images of a pinhole camera."""
        T = np.asarray(T_world_camera, np.float64)
        rays = camera_rays(camera)
        shape = rays.shape[:2]
        directions = rays.reshape(-1, 3) @ T[:3, :3].T
        origins = np.broadcast_to(T[:3, 3], directions.shape)
        hits = self.cast(origins, directions)
        return View(
            depth_m=hits.distance.reshape(shape),
            instance=hits.instance.reshape(shape),
            triangle=hits.triangle.reshape(shape),
            normal=hits.normal.reshape(*shape, 3),
        )


def camera_rays(camera: Camera) -> Float[np.ndarray, "height width 3"]:
    """Direction of each pixel's centre in the camera frame, with z = 1."""
    u, v = np.meshgrid(np.arange(camera.width), np.arange(camera.height))
    x, y = (u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy
    return np.stack([x, y, np.ones_like(x)], -1)


def _unit_normals(triangles: np.ndarray) -> np.ndarray:
    edges = triangles[:, 1:] - triangles[:, :1]
    normal = np.cross(edges[:, 0], edges[:, 1])
    length = np.linalg.norm(normal, axis=1, keepdims=True)
    return (normal / np.maximum(length, 1e-20)).astype(np.float32)
