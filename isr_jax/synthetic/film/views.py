"""What a film shows of each entity, frame by frame and in all."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
from jaxtyping import Bool, Float, Int

from ...borders.raycast import RayScene
from ...config import NoiseModel
from ...types import Camera
from ..camera.free_space import FreeSpace
from ..camera.visibility import Samples, in_image, room_samples, shares, visible_from
from ..surface import Surface

WELL_SEEN = 0.6
"""Share of its observable surface from which an entity counts as well seen."""
_EYES = 300
"""Places that what is observable is judged from."""
_RAYS = 500
"""About as many per entity and frame, spread over the rectangle around it."""
_COARSEST_PX = 8
_NEAR_M = 0.05
_DEPTH_SLACK = 0.02
"""Metres, and share of the depth: a sample is seen if its pixel shows its entity that near it."""


@dataclasses.dataclass(frozen=True)
class EntityView:
    """One entity in one frame."""

    visible_px: int
    unoccluded_px: int
    """That the image would show of it if it were alone in the room; estimated from every n-th
    pixel where the entity is large."""
    cut: bool
    """Whether it reaches beyond the border of the image."""


@dataclasses.dataclass(frozen=True, eq=False)
class FrameViews:
    """What one frame shows."""

    entities: dict[int, EntityView]
    """By id, of all that the image would show if nothing stood before it."""
    seen: Bool[np.ndarray, " samples"]


class Views:
    """Counts what frames show of a room."""

    def __init__(
        self,
        surfaces: dict[int, Surface],
        scene: RayScene,
        space: FreeSpace,
        camera: Camera,
        sensor: NoiseModel,
        seed: int,
    ) -> None:
        """Sample the surfaces, and find out what of them can be seen at all.

        Args:
            surfaces: By entity id.
            scene: All of them.
            space: Where eyes can be: what none of them (`_EYES` drawn) sees is not observable.
            camera: Of the film.
            sensor: Its range and flattest angle bound what is observable.
            seed: Of the draw.
        """
        self._camera, self._sensor = camera, sensor
        self._ids = list(surfaces)
        self._alone = [RayScene([s.mesh], [i]) for i, s in surfaces.items()]
        vertices = [s.mesh.vertices for s in surfaces.values()]
        self._first = np.concatenate([[0], np.cumsum([len(v) for v in vertices])[:-1]])
        self._vertices = np.concatenate(vertices)
        self.samples: Samples = room_samples(surfaces)
        places = np.random.default_rng([seed, 5]).permutation(len(space.eyes))[:_EYES]
        eyes = space.eyes[np.sort(places)]
        seen = visible_from(scene, self.samples, eyes, sensor)
        self.observable: Bool[np.ndarray, " samples"] = np.asarray(seen.any(0))

    def frame(
        self,
        T_world_camera: Float[np.ndarray, "4 4"],
        instance: Int[np.ndarray, "height width"],
        true_depth_m: Float[np.ndarray, "height width"],
    ) -> FrameViews:
        """What a frame shows of each entity, and which samples."""
        T = np.asarray(T_world_camera, np.float32)
        visible = np.bincount(instance.ravel(), minlength=max(self._ids) + 1)
        found = {}
        for i, low, high in self._rectangles(T):
            entity_id = self._ids[i]
            size = np.array([self._camera.width, self._camera.height])
            cut = bool(np.any(low < -0.5) or np.any(high > size - 0.5))
            low, high = np.maximum(low, 0), np.minimum(high, size - 1)
            if np.any(low > high):
                continue
            alone = self._pixels_alone(i, T, np.floor(low).astype(int), np.ceil(high).astype(int))
            whole = max(alone, int(visible[entity_id]))
            if whole > 0:
                found[entity_id] = EntityView(int(visible[entity_id]), whole, cut)
        return FrameViews(found, self._seen(T, instance, true_depth_m))

    def _rectangles(self, T: np.ndarray) -> list[tuple[int, np.ndarray, np.ndarray]]:
        """Row, and lower and upper corner in pixels, of each entity that is before the camera."""
        local = (self._vertices - T[:3, 3]) @ T[:3, :3]
        z = local[:, 2]
        ahead = z > _NEAR_M
        depth = np.where(ahead, z, 1.0)[:, None]
        focal = np.array([self._camera.fx, self._camera.fy], np.float32)
        pixel = local[:, :2] / depth * focal + [self._camera.cx, self._camera.cy]
        low = np.minimum.reduceat(np.where(ahead[:, None], pixel, np.inf), self._first)
        high = np.maximum.reduceat(np.where(ahead[:, None], pixel, -np.inf), self._first)
        # What reaches behind the camera may fill any of the image.
        some = np.logical_or.reduceat(ahead, self._first)
        through = some & ~np.logical_and.reduceat(ahead, self._first)
        low[through], high[through] = -np.inf, np.inf
        return [(int(i), low[i], high[i]) for i in np.flatnonzero(some)]

    def _pixels_alone(self, i: int, T: np.ndarray, low: np.ndarray, high: np.ndarray) -> int:
        """Pixels of the rectangle that would show the entity if it were alone, nearly."""
        area = float(np.prod(high - low + 1))
        stride = int(np.clip(np.sqrt(area / _RAYS), 1, _COARSEST_PX))
        u = np.arange(low[0] + stride // 2, high[0] + 1, stride, dtype=np.float32)
        v = np.arange(low[1] + stride // 2, high[1] + 1, stride, dtype=np.float32)
        x, y = (u - self._camera.cx) / self._camera.fx, (v - self._camera.cy) / self._camera.fy
        rays = x[None, :, None] * T[:3, 0] + y[:, None, None] * T[:3, 1] + T[:3, 2]
        rays = rays.reshape(-1, 3).astype(np.float32)
        hit = self._alone[i].blocked(np.broadcast_to(T[:3, 3], rays.shape), rays, 100.0)
        return int(hit.sum()) * stride * stride

    def _seen(self, T: np.ndarray, instance: np.ndarray, depth_m: np.ndarray) -> np.ndarray:
        """Samples whose pixel shows their entity at their depth, in range and not too flat."""
        points = self.samples.points
        seen = np.zeros(len(points), bool)
        rows = np.flatnonzero(self.observable & in_image(self._camera, T, points))
        local = (points[rows] - T[:3, 3]) @ T[:3, :3]
        z = local[:, 2]
        u = np.rint(self._camera.fx * local[:, 0] / z + self._camera.cx).astype(int)
        v = np.rint(self._camera.fy * local[:, 1] / z + self._camera.cy).astype(int)
        # On the border itself the two computations may round apart.
        u, v = np.clip(u, 0, self._camera.width - 1), np.clip(v, 0, self._camera.height - 1)
        distance = np.linalg.norm(local, axis=1)
        cosine = np.abs(np.einsum("si,si->s", points[rows] - T[:3, 3], self.samples.normals[rows]))
        limit = min(self._sensor.grazing_limit, np.pi / 2)
        shown = (instance[v, u] == self.samples.entity[rows]) & (
            np.abs(depth_m[v, u] - z) < _DEPTH_SLACK * (1 + z)
        )
        shown &= (z > self._sensor.range_min_m) & (z < self._sensor.range_max_m)
        seen[rows] = shown & (cosine > distance * np.cos(limit))
        return seen

    def record(self, frames: dict[str, FrameViews], names: dict[int, str]) -> dict[str, Any]:
        """Plain data of a whole film.

        ``frames``: by name and entity id (as text) what a frame shows. ``entities``: of each the
        share of its observable surface that some frame shows (None where nothing is observable),
        the share of its surface that is observable, the frames that show it, and how much of it is
        hidden in them. ``room``: means over the entities.

        Args:
            frames: By name.
            names: By entity id.
        """
        seen = np.any([views.seen for views in frames.values()], axis=0)
        entities = [self._entity_record(i, names[i], seen, frames) for i in self._ids]
        return {
            "frames": {
                name: {str(i): dataclasses.asdict(v) for i, v in views.entities.items()}
                for name, views in frames.items()
            },
            "entities": entities,
            "room": _room_record(entities),
        }

    def _entity_record(
        self, i: int, name: str, seen: np.ndarray, frames: dict[str, FrameViews]
    ) -> dict[str, Any]:
        own = self.samples.entity == i
        observable = int((self.observable & own).sum())
        shown = [views.entities[i] for views in frames.values() if i in views.entities]
        visible = sum(view.visible_px for view in shown)
        whole = sum(view.unoccluded_px for view in shown)
        return {
            "id": i,
            "name": name,
            "seen": float((seen & own).sum() / observable) if observable else None,
            "observable": float(shares(self.samples.entity, self.observable, i + 1)[i]),
            "frames": sum(view.visible_px > 0 for view in shown),
            "occlusion": float(1 - visible / whole) if whole else None,
        }


def _room_record(entities: list[dict[str, Any]]) -> dict[str, Any]:
    """Means over the entities for which they are defined."""
    seen = [entity["seen"] for entity in entities if entity["seen"] is not None]
    hidden = [entity["occlusion"] for entity in entities if entity["occlusion"] is not None]
    return {
        "entities": len(entities),
        "seen": float(np.mean(seen)) if seen else None,
        "well_seen": float(np.mean(np.array(seen) >= WELL_SEEN)) if seen else None,
        "well_seen_from": WELL_SEEN,
        "occlusion": float(np.mean(hidden)) if hidden else None,
    }
