"""Free space: which of many proposed places touch nothing that already stands."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable

import jax
import numpy as np
from jaxtyping import Float

from ..cad_types import CadLibrary, CadModel
from ..classes import class_named
from ..geometry import box_overlap_depth, stack_boxes
from ..types import Array, Box

MARGIN_M = 0.02
"""Least gap between the boxes of two things of which neither carries the other."""
TRIES = 32
"""Places drawn at once for one thing."""
ON_FLOOR, ON_NOTHING = -1, -2
"""Parents of proposals that no other thing carries."""


@dataclasses.dataclass(frozen=True, eq=False)
class Proposal:
    """A model, scaled, at a place in the room's frame."""

    model: CadModel
    scale: float
    yaw: float
    center: Float[np.ndarray, "3"]
    parent: int
    """Position of what carries it in `Occupancy.placed`, `ON_FLOOR` or `ON_NOTHING`."""
    plane: int = 0
    """Plane of the parent's model that carries it."""


def any_model(model: CadModel) -> bool:
    """Fits always."""
    return True


class Stock:
    """The models of a library by class, shuffled; each is drawn once before any twice.

    Models that hang where others of their class stand (a shelf on a wall) are left out.
    """

    def __init__(self, library: CadLibrary, rng: np.random.Generator) -> None:
        self._rng = rng
        self._models: dict[str, list[CadModel]] = {}
        for model in library.models:
            if model.mount != class_named(model.class_name).mount:
                continue
            self._models.setdefault(model.class_name, []).append(model)
        for class_name, models in self._models.items():
            self._models[class_name] = [models[i] for i in rng.permutation(len(models))]

    def __contains__(self, class_name: str) -> bool:
        return class_name in self._models

    @property
    def class_names(self) -> list[str]:
        return sorted(self._models)

    def draw(
        self, class_name: str, fits: Callable[[CadModel], bool] = any_model
    ) -> tuple[CadModel, float]:
        """A model that ``fits``, or any where none does, and a scale near 1."""
        models = self._models[class_name]
        model = next((m for m in models if fits(m)), models[0])
        models.remove(model)
        models.append(model)
        return model, float(self._rng.uniform(0.9, 1.1))


class Occupancy:
    """What stands in a room, and zones before doors and drawers that stay clear."""

    def __init__(self, size: np.ndarray) -> None:
        self.half = np.asarray(size[:2]) / 2
        """Half width and depth between the walls, metres."""
        self._height_m = float(size[2])
        self._boxes: list[Box] = []
        self._zones: list[Box] = []
        self.placed: list[Proposal] = []

    def add(self, proposal: Proposal, clear_front_m: float = 0.0) -> int:
        """Position in `placed` of what now stands there."""
        self.placed.append(proposal)
        self._boxes.append(solid_box(proposal))
        if clear_front_m > 0:
            self._zones.append(solid_box(proposal, clear_front_m))
        return len(self.placed) - 1

    def free(self, proposals: list[Proposal], front_m: float = 0.0) -> list[Proposal]:
        """Those that keep `MARGIN_M` from all that does not carry them; tested in one call.

        ``front_m``: free space wanted before the front; the zones of others count too if > 0.
        """
        if not proposals:
            return []
        carriers = self.carriers(proposals[0].parent)
        others = [box for i, box in enumerate(self._boxes) if i not in carriers]
        others += self._zones if front_m > 0 else []
        boxes = [solid_box(p, front_m) for p in proposals]
        apart = np.array([self._within(solid_box(p)) for p in proposals])
        if others:
            apart &= np.all(overlap_depths(boxes, others) <= -MARGIN_M, axis=1)
        return [proposals[i] for i in np.flatnonzero(apart)]

    def add_first(self, proposals: list[Proposal], clear_front_m: float = 0.0) -> int | None:
        """Place the first free proposal; its position, or None."""
        free = self.free(proposals, clear_front_m)
        return self.add(free[0], clear_front_m) if free else None

    def positions(self, *class_names: str) -> list[int]:
        """Where in `placed` things of these classes stand."""
        return [i for i, p in enumerate(self.placed) if p.model.class_name in class_names]

    def carriers(self, position: int) -> list[int]:
        """A position and all that carries it, directly or not."""
        chain: list[int] = []
        while position >= 0:
            chain.append(position)
            position = self.placed[position].parent
        return chain

    def _within(self, box: Box) -> bool:
        c, s = abs(np.cos(box.yaw)), abs(np.sin(box.yaw))
        x, y, z = np.asarray(box.size) / 2
        reach = np.abs(np.asarray(box.center[:2])) + np.array([c * x + s * y, s * x + c * y])
        return bool(np.all(reach <= self.half - MARGIN_M) and box.center[2] + z <= self._height_m)


def solid_box(proposal: Proposal, front_m: float = 0.0) -> Box:
    """The box of the whole mesh, handles included, grown towards the front (-y)."""
    vertices = proposal.model.mesh.vertices
    low, high = vertices.min(0) * proposal.scale, vertices.max(0) * proposal.scale
    low = low - np.array([0, front_m, 0])
    middle = (low + high) / 2
    moved = np.array([*(rotation_2d(proposal.yaw) @ middle[:2]), middle[2]])
    values = (proposal.center + moved, proposal.yaw, high - low)
    return Box(*(np.asarray(value, np.float32) for value in values))


def rotation_2d(yaw: float) -> Float[np.ndarray, "2 2"]:
    """Turn by ``yaw`` radians in the plane of the floor."""
    c, s = np.cos(yaw), np.sin(yaw)
    return np.array([[c, -s], [s, c]])


@jax.jit
def _pair_depths(a: Box, b: Box) -> Float[Array, "a b"]:
    return jax.vmap(lambda x: jax.vmap(lambda y: box_overlap_depth(x, y))(b))(a)


def overlap_depths(boxes: list[Box], others: list[Box]) -> Float[np.ndarray, "a b"]:
    """Depth to which every pair of boxes overlaps, metres; negative when apart."""
    depth = _pair_depths(_stacked(boxes), _stacked(others))
    return np.asarray(depth)[: len(boxes), : len(others)]


def _stacked(boxes: list[Box]) -> Box:
    """One batched `Box`, padded with copies of the first to a power-of-two bucket."""
    count = max(TRIES, 1 << (len(boxes) - 1).bit_length())
    return stack_boxes(boxes + [boxes[0]] * (count - len(boxes)))
