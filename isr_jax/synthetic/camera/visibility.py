"""Which of the surface of a room can be seen, from where."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping

import numpy as np
from jaxtyping import Bool, Float, Int

from ...borders.raycast import RayScene
from ...config import NoiseModel
from ...geometry.surface_samples import surface_samples
from ...types import Camera
from ..surface import Surface

SAMPLES = 192
"""Points an entity, each for the same share of its surface, inside and out."""
_BLOCK = 64
"""Eyes whose rays are cast at once: bounds the memory."""
_SHORT_M = 0.004
"""Rays end so far before the sample, which lies on a surface itself."""


@dataclasses.dataclass(frozen=True, eq=False)
class Samples:
    """Points spread evenly over the surface of every entity, world frame."""

    points: Float[np.ndarray, "samples 3"]
    normals: Float[np.ndarray, "samples 3"]
    """Unit; a surface can be seen from either side."""
    entity: Int[np.ndarray, " samples"]
    """Entity id."""

    def subset(self, rows: np.ndarray) -> Samples:
        return Samples(self.points[rows], self.normals[rows], self.entity[rows])


def room_samples(surfaces: Mapping[int, Surface]) -> Samples:
    """`SAMPLES` of each surface, by entity id."""
    made = {i: surface_samples(s.mesh.vertices, s.mesh.faces, SAMPLES) for i, s in surfaces.items()}
    return Samples(
        np.concatenate([m.points for m in made.values()]),
        np.concatenate([m.normals for m in made.values()]),
        np.concatenate([np.full(len(m.points), i, np.int32) for i, m in made.items()]),
    )


def visible_from(
    scene: RayScene, samples: Samples, eyes: Float[np.ndarray, "eyes 3"], sensor: NoiseModel
) -> Bool[np.ndarray, "eyes samples"]:
    """Whether a camera at each eye that looks there gets a return of each sample.

    In range, seen less flat than the sensor's limit, and with nothing between.
    """
    eyes = np.asarray(eyes, np.float32)
    found = np.zeros((len(eyes), len(samples.points)), bool)
    for first in range(0, len(eyes), _BLOCK):
        block = eyes[first : first + _BLOCK]
        towards = samples.points - block[:, None]
        distance = np.sqrt(np.einsum("esi,esi->es", towards, towards))
        cosine = np.abs(np.einsum("esi,si->es", towards, samples.normals))
        fits = (distance > sensor.range_min_m) & (distance < sensor.range_max_m)
        fits &= cosine > distance * np.float32(np.cos(min(sensor.grazing_limit, np.pi / 2)))
        eye, sample = np.nonzero(fits)
        far = distance[eye, sample]
        blocked = scene.blocked(block[eye], towards[eye, sample], 1 - _SHORT_M / far)
        found[first + eye, sample] = ~blocked
    return found


def in_image(
    camera: Camera,
    T_world_camera: Float[np.ndarray, "*poses 4 4"],
    points: Float[np.ndarray, "points 3"],
) -> Bool[np.ndarray, "*poses points"]:
    """Whether points are before the camera and inside its image."""
    T = np.asarray(T_world_camera, np.float32)
    local = (
        points @ T[..., :3, :3]
        - np.einsum("...i,...ij->...j", T[..., :3, 3], T[..., :3, :3])[..., None, :]
    )
    x, y, z = np.moveaxis(local, -1, 0)
    ahead = z > 1e-3
    z = np.where(ahead, z, 1.0)
    u, v = camera.fx * x / z + camera.cx, camera.fy * y / z + camera.cy
    inside = (u > -0.5) & (u < camera.width - 0.5) & (v > -0.5) & (v < camera.height - 0.5)
    return ahead & inside


def shares(
    entity: Int[np.ndarray, " samples"], chosen: Bool[np.ndarray, " samples"], count: int
) -> Float[np.ndarray, " count"]:
    """Share of the samples of each entity id below ``count`` that is chosen; 0 without samples."""
    total = np.bincount(entity, minlength=count)
    return np.bincount(entity[chosen], minlength=count) / np.maximum(total, 1)
