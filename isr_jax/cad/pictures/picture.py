"""A model as an image, by ray casting: glass lets through, textures show, corners darken."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from jaxtyping import Float, UInt8

from ...borders.raycast import RayHits, RayScene, camera_rays
from ...library import CadModel
from ...robot_model import link_transforms
from ...types import Camera, Mesh
from .paint import Paint

PAPER = np.array([250.0, 250.0, 248.0])
"""What there is around a model, RGB."""
_SAMPLES = 2
"""Rays along each side of a pixel."""
_FROM = np.array([-0.52, -0.74, 0.52])
"""Where the viewer is: in front (-y), to the left, above."""
_DISTANCE = 3.5
"""Of the viewer, in diagonals of the model."""
_LIGHT = np.array([-0.35, -0.35, 0.87])
_LAYERS = 8
"""Surfaces that a ray may pass through glass."""
_FILL = 0.92
"""Share of the image that a model takes."""
_STEP = 1e-4
"""How far a ray starts from the surface it leaves, in diagonals of the model."""
_REACH = 0.5
"""What is farther away keeps no light of the sky off, in diagonals of the model."""
_SKY_RAYS = 8
"""Of every sample; each of a pixel's samples has its own."""
_FADED = 0.02
"""Light that is left behind glass when a ray is given up."""
_SOLID_ALPHA = 0.6
"""Clearer things cast no shadow."""


def picture(
    model: CadModel,
    width: int,
    height: int,
    positions: Mapping[str, float] | None = None,
    *,
    room_for: Mapping[str, float] | None = None,
) -> UInt8[np.ndarray, "{height} {width} 3"]:
    """The model from its front left above, on white, with its shadow where it stands.

    Args:
        model: Shown as large as fits.
        width: Pixels.
        height: Pixels.
        positions: Of its joints, radians or metres; closed by default.
        room_for: Positions that must fit into the picture too, so that two pictures compare.
    """
    scene = ModelScene(model, positions or {})
    shown = [scene.vertices]
    if room_for is not None:
        shown.append(np.concatenate([m.vertices for m in placed_meshes(model, room_for)]))
    camera, T = _viewpoint(np.concatenate(shown), width * _SAMPLES, height * _SAMPLES)
    rays = camera_rays(camera) @ T[:3, :3].T
    row, column = np.indices(rays.shape[:2])
    turn = (row % _SAMPLES) * _SAMPLES + column % _SAMPLES
    light = scene.shoot(T[:3, 3], rays.reshape(-1, 3), turn.ravel())
    image = light.reshape(height, _SAMPLES, width, _SAMPLES, 3).mean((1, 3))
    return np.rint(np.clip(image, 0, 255)).astype(np.uint8)


def placed_meshes(model: CadModel, positions: Mapping[str, float]) -> list[Mesh]:
    """Meshes of all visuals in the canonical frame, links at the given joint positions."""
    poses, found = link_transforms(model.robot, positions), []
    for link in model.robot.links:
        T = poses[link.name]
        for visual in link.visuals:
            moved = visual.mesh.vertices @ T[:3, :3].T + T[:3, 3]
            found.append(Mesh(moved.astype(np.float32), visual.mesh.faces))
    return found


class ModelScene:
    """A model with its paint, a light, a sky, and the ground where it stands."""

    def __init__(self, model: CadModel, positions: Mapping[str, float]) -> None:
        meshes = placed_meshes(model, positions)
        visuals = [visual for link in model.robot.links for visual in link.visuals]
        self._paint = Paint(visuals)
        self._rays = RayScene(meshes, [i + 1 for i in range(len(meshes))])
        solid = [m for m, v in zip(meshes, visuals, strict=True) if v.rgba[3] >= _SOLID_ALPHA]
        self._solid = RayScene(solid, [1] * len(solid)) if solid else None
        self._starts = np.cumsum([0, *(len(m.faces) for m in meshes)])
        self.vertices = self._rays.vertices
        low, high = self.vertices.min(0), self.vertices.max(0)
        diagonal = float(np.linalg.norm(high - low))
        self._step, self._reach = _STEP * diagonal, _REACH * diagonal
        self._ground = float(low[2]) if model.mount in ("floor", "surface") else None
        self._light = _LIGHT / np.linalg.norm(_LIGHT)

    def shoot(self, eye: np.ndarray, rays: np.ndarray, turn: np.ndarray) -> np.ndarray:
        """Light [rays, 3] that comes along each ray.

        Args:
            eye: Where all rays start [3].
            rays: Directions [rays, 3].
            turn: Which set of sky rays each uses [rays].
        """
        rays = rays / np.linalg.norm(rays, axis=1, keepdims=True)
        origins = np.tile(eye, (len(rays), 1))
        light, left = np.zeros((len(rays), 3)), np.ones(len(rays))
        active = np.arange(len(rays))
        for _ in range(_LAYERS):
            hits = self._rays.cast(origins[active], rays[active])
            hit = hits.instance > 0
            out = active[~hit]
            light[out] += left[out, None] * self._around(origins[out], rays[out], turn[out])
            left[out] = 0
            inside, chosen = active[hit], _rows(hits, hit)
            points = origins[inside] + chosen.distance[:, None] * rays[inside]
            color, alpha = self._surface(chosen, points, rays[inside], turn[inside])
            light[inside] += (left[inside] * alpha)[:, None] * color
            left[inside] *= 1 - alpha
            origins[inside] = points + self._step * rays[inside]
            active = inside[left[inside] > _FADED]
            if not len(active):
                break
        return light + left[:, None] * PAPER

    def _surface(
        self, hits: RayHits, points: np.ndarray, rays: np.ndarray, turn: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Shaded colour [hits, 3] and opacity [hits], whichever side is seen."""
        toward = np.where(np.sum(hits.normal * rays, -1, keepdims=True) > 0, -1.0, 1.0)
        normal = hits.normal * toward
        visual = hits.instance - 1
        corners = self._rays.vertices[self._rays.faces[hits.triangle]]
        face = hits.triangle - self._starts[visual]
        color, alpha = self._paint.at(visual, face, corners, points)
        facing = np.clip(normal @ self._light, 0, 1)
        lit = facing * self._open(points, normal, np.tile(self._light, (len(points), 1)))
        sky = self._sky(points, normal, turn)
        return color * (0.26 + 0.44 * sky + 0.42 * lit)[:, None], alpha

    def _around(self, origins: np.ndarray, rays: np.ndarray, turn: np.ndarray) -> np.ndarray:
        """Paper, darker where the model keeps light from the ground."""
        color = np.tile(PAPER, (len(rays), 1))
        if self._ground is None:
            return color
        down = rays[:, 2] < -1e-6
        reach = (self._ground - origins[down, 2]) / rays[down, 2]
        points = origins[down] + reach[:, None] * rays[down]
        normal = np.tile([0.0, 0.0, 1.0], (len(points), 1))
        light = np.tile(self._light, (len(points), 1))
        lit, sky = self._open(points, normal, light), self._sky(points, normal, turn[down])
        color[down] *= (0.45 + 0.35 * sky + 0.2 * lit)[:, None]
        return color

    def _sky(self, points: np.ndarray, normal: np.ndarray, turn: np.ndarray) -> np.ndarray:
        """Part of the light from everywhere that arrives; from below comes the ground's."""
        total = np.zeros(len(points))
        for k in range(_SKY_RAYS):
            # A unit normal plus an even point of the sphere is spread like Lambert's cosine.
            toward = normal + _SPHERE[turn * _SKY_RAYS + k]
            open_ = self._open(points, normal, toward, self._reach)
            total += open_ * np.where(toward[:, 2] < 0, 0.6, 1.0)
        return total / _SKY_RAYS

    def _open(
        self, points: np.ndarray, normal: np.ndarray, toward: np.ndarray, reach_m: float = np.inf
    ) -> np.ndarray:
        """1 where nothing solid is within reach, 0 where it is at the point itself."""
        if self._solid is None or not len(points):
            return np.ones(len(points))
        hits = self._solid.cast(points + self._step * normal, toward)
        distance = hits.distance * np.linalg.norm(toward, axis=1)
        return np.where(hits.instance == 0, 1.0, np.minimum(1.0, distance / reach_m))


def _rows(hits: RayHits, chosen: np.ndarray) -> RayHits:
    return RayHits(
        hits.distance[chosen], hits.triangle[chosen], hits.instance[chosen], hits.normal[chosen]
    )


def _viewpoint(
    points: Float[np.ndarray, "points 3"], width: int, height: int
) -> tuple[Camera, Float[np.ndarray, "4 4"]]:
    """A camera in whose image the points fill the given share, in the middle."""
    low, high = points.min(0), points.max(0)
    backward = _FROM / np.linalg.norm(_FROM)
    right = np.cross(-backward, [0.0, 0.0, 1.0])
    right /= np.linalg.norm(right)
    T = np.eye(4)
    T[:3, :3] = np.stack([right, np.cross(-backward, right), -backward], 1)
    T[:3, 3] = (low + high) / 2 + backward * _DISTANCE * float(np.linalg.norm(high - low))
    seen = (points - T[:3, 3]) @ T[:3, :3]
    flat = seen[:, :2] / seen[:, 2:]
    first, last = flat.min(0), flat.max(0)
    focal = _FILL * float(np.min(np.array([width, height]) / np.maximum(last - first, 1e-9)))
    middle = np.array([width, height]) / 2 - focal * (first + last) / 2
    return Camera(focal, focal, float(middle[0]), float(middle[1]), width, height), T


def _even_sphere(count: int) -> Float[np.ndarray, "{count} 3"]:
    """Points spread evenly over the unit sphere (golden spiral), neighbours far apart in order."""
    i = (np.arange(count) * 7) % count + 0.5
    z, angle = 1 - 2 * i / count, np.pi * (1 + 5**0.5) * i
    ring = np.sqrt(1 - z * z)
    return 0.999 * np.stack([ring * np.cos(angle), ring * np.sin(angle), z], 1)


_SPHERE = _even_sphere(_SKY_RAYS * _SAMPLES**2)
