"""What a made room is: layout rectangles and placed models, all in the world frame."""

from __future__ import annotations

import dataclasses
import functools
from typing import Literal, get_args

import numpy as np
from jaxtyping import Float

from ..classes import class_named
from ..geometry import canonical_box, smallest_rotation
from ..library import CadModel
from ..types import Attachment, Box, Mesh

RoomKind = Literal["kitchen", "office", "living", "bedroom", "meeting"]
ROOM_KINDS: tuple[RoomKind, ...] = get_args(RoomKind)
_UPRIGHT_COSINE = 1.0 - 1e-6
WALL_SLAB_M = 0.02
"""Thickness of the boxes of layout entities; their surface is the side towards the room."""


@dataclasses.dataclass(frozen=True, eq=False)
class LayoutPatch:
    """A rectangle of floor, wall or ceiling."""

    id: int
    class_name: str
    corners: Float[np.ndarray, "4 3"]
    """Counter-clockwise seen from inside the room, world frame, metres."""
    openings: Float[np.ndarray, "openings 4"] = dataclasses.field(
        default_factory=lambda: np.zeros((0, 4), np.float32)
    )
    """Holes for doors and windows that do not meet: (u0, v0, u1, v1) in metres from
    ``corners[0]`` along the sides to ``corners[1]`` (u) and ``corners[3]`` (v)."""

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
    T_world_cad: Float[np.ndarray, "4 4"]
    """float32, without the scale: the model's axes in the world, and the centre of its box.
    Upright but for things that lean."""
    parent: str | None
    """Name of the entity that carries it; None where nothing does."""
    parent_plane: int | None
    """Plane of the parent: of a model's own planes, or 0 for layout."""
    attachment: Attachment
    """What leans has no parent."""
    tint: Float[np.ndarray, "3"]
    """Factor on the model's colours: instances of one model differ a little."""

    @property
    def name(self) -> str:
        return f"{self.model.class_name}_{self.id}"

    @property
    def kind(self) -> str:
        """Of its class: ``thing``, or ``stuff`` (windows, pictures), which is no entity."""
        return class_named(self.model.class_name).kind

    @property
    def center(self) -> np.ndarray:
        """[3] of the model's box, world frame, metres."""
        return self.T_world_cad[:3, 3]

    @property
    def yaw(self) -> float:
        """Heading of the model's +x, radians; not brought into [-pi/4, pi/4)."""
        return float(np.arctan2(self.T_world_cad[1, 0], self.T_world_cad[0, 0]))

    @functools.cached_property
    def box(self) -> Box:
        """The model's box (handles left out), world frame; around the turned one if it leans."""
        half = self.scale * np.asarray(self.model.size) / 2
        c, s = np.cos(self.yaw), np.sin(self.yaw)
        level = np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]]) @ self.T_world_cad[:3, :3]
        size = self.scale * np.asarray(self.model.size)
        if level[2, 2] < _UPRIGHT_COSINE:
            size = 2 * np.abs(level) @ half
        return canonical_box(self.center, self.yaw, size)

    def to_world(self, points: np.ndarray) -> np.ndarray:
        """Points of the model's canonical frame, in the world."""
        T = self.T_world_cad
        return (self.scale * points @ T[:3, :3].T + T[:3, 3]).astype(np.float32)


@dataclasses.dataclass(frozen=True, eq=False)
class Room:
    """A furnished room. World: z up, floor at z = 0, walls off the axes."""

    name: str
    kind: RoomKind
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
    notes: tuple[str, ...] = ()
    """What the library had no models for, what found no place, what was taken away again."""

    @property
    def things(self) -> tuple[PlacedModel, ...]:
        """The items that are entities: a map keeps the others as stuff."""
        return tuple(item for item in self.items if item.kind == "thing")

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
