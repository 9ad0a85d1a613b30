"""What a made room is: layout rectangles and placed models, all in the world frame."""

from __future__ import annotations

import dataclasses
import functools

import numpy as np
from jaxtyping import Float

from ..cad_types import CadModel
from ..geometry import canonical_box, smallest_rotation
from ..types import Box, Mesh

WALL_SLAB_M = 0.02
"""Thickness of the boxes of layout entities; their surface is the side towards the room."""


@dataclasses.dataclass(frozen=True, eq=False)
class LayoutPatch:
    """A rectangle of floor, wall or ceiling."""

    id: int
    class_name: str
    corners: Float[np.ndarray, "4 3"]
    """Counter-clockwise seen from inside the room, world frame, metres."""

    @property
    def name(self) -> str:
        return f"{self.class_name}_{self.id}"

    @functools.cached_property
    def normal(self) -> np.ndarray:
        """[3] unit, into the room."""
        cross = np.cross(self.corners[1] - self.corners[0], self.corners[3] - self.corners[0])
        return (cross / np.linalg.norm(cross)).astype(np.float32)

    @functools.cached_property
    def box(self) -> Box:
        """A thin slab behind the rectangle."""
        along = self.corners[1] - self.corners[0]
        sides = [np.linalg.norm(along), np.linalg.norm(self.corners[3] - self.corners[0])]
        center = self.corners.mean(0) - self.normal * WALL_SLAB_M / 2
        yaw = float(np.arctan2(along[1], along[0]))
        upright = abs(self.normal[2]) < 0.5
        size = (sides[0], WALL_SLAB_M, sides[1]) if upright else (*sides, WALL_SLAB_M)
        return canonical_box(center, yaw, np.array(size))


@dataclasses.dataclass(frozen=True, eq=False)
class PlacedModel:
    """A model of the library, standing in the room: p_world = T_world_cad (scale p_cad)."""

    id: int
    model: CadModel
    scale: float
    yaw: float
    """Of the model about +z, world frame, radians; not brought into [-pi/4, pi/4)."""
    center: Float[np.ndarray, "3"]
    """Centre of the model's box, world frame, metres."""
    parent: str | None
    """Name of the entity that carries it; None where nothing does."""
    parent_plane: int | None
    """Plane of the parent: of a model's own planes, or 0 for layout."""
    attachment: str
    tint: Float[np.ndarray, "3"]
    """Factor on the model's colours: instances of one model differ a little."""

    @property
    def name(self) -> str:
        return f"{self.model.class_name}_{self.id}"

    @functools.cached_property
    def T_world_cad(self) -> np.ndarray:
        """[4, 4], without the scale."""
        T = np.eye(4, dtype=np.float32)
        c, s = np.cos(self.yaw), np.sin(self.yaw)
        T[:2, :2] = [[c, -s], [s, c]]
        T[:3, 3] = self.center
        return T

    @functools.cached_property
    def box(self) -> Box:
        """The model's box (handles left out), world frame."""
        return canonical_box(self.center, self.yaw, self.scale * self.model.size)

    def to_world(self, points: np.ndarray) -> np.ndarray:
        """Points of the model's canonical frame, in the world."""
        T = self.T_world_cad
        return (self.scale * points @ T[:3, :3].T + T[:3, 3]).astype(np.float32)


@dataclasses.dataclass(frozen=True, eq=False)
class Room:
    """A furnished room. World: z up, floor at z = 0, walls off the axes."""

    name: str
    seed: int
    layout: tuple[LayoutPatch, ...]
    """The floor first."""
    items: tuple[PlacedModel, ...]
    T_world_room: Float[np.ndarray, "4 4"]
    """From the frame whose axes are the room's walls and whose origin is the floor's centre."""
    size: Float[np.ndarray, "3"]
    """Width, depth and height between the walls, metres."""
    T_world_dataset: Float[np.ndarray, "4 4"]
    """float64. The frame in which a sequence of this room is written is not z-up."""
    gravity_dataset: Float[np.ndarray, "3"]
    """Unit, down, dataset frame, float64."""

    def item(self, name: str) -> PlacedModel:
        return next(item for item in self.items if item.name == name)

    def support_depth(self, name: str) -> int:
        """How many supports lie between an item and the room: 1 stands on the floor."""
        names = {item.name: item for item in self.items}
        depth = 0
        while name in names and names[name].parent is not None:
            name, depth = names[name].parent or "", depth + 1
        return depth


def upright_from_gravity(gravity: np.ndarray, floor_height_m: float) -> np.ndarray:
    """[4, 4] float64: the smallest rotation that brings ``gravity`` to -z, then a lift."""
    T = np.eye(4)
    T[:3, :3] = smallest_rotation(gravity, np.array([0.0, 0.0, -1.0]))
    T[2, 3] = floor_height_m
    return T


def merge_meshes(meshes: list[Mesh]) -> Mesh:
    """One mesh of several, without colours and normals."""
    starts = np.cumsum([0, *(len(m.vertices) for m in meshes[:-1])])
    return Mesh(
        np.concatenate([m.vertices for m in meshes]).astype(np.float32),
        np.concatenate([m.faces + s for m, s in zip(meshes, starts, strict=True)]).astype(np.int32),
    )
