"""Free space: which of many proposed places touch nothing that already stands."""

from __future__ import annotations

import functools
from collections.abc import Collection

import jax
import numpy as np
from jaxtyping import Float

from ...geometry import box_overlap_depth
from ...library import CadModel
from ...runtime.batches import bucket
from ...types import Array, Attachment, Box
from .clearance import meshes_apart
from .proposal import Proposal

MARGIN_M = 0.02
"""Least gap between the boxes of two things of which neither carries the other."""
_TOUCH_M = 1e-4
TRIES = 32
"""Places drawn at once for one thing."""


class Occupancy:
    """What stands in a room, zones that stay clear, and chairs pushed under tables."""

    def __init__(self, size: np.ndarray, zones: Collection[Box] = ()) -> None:
        self.half = np.asarray(size[:2], np.float64) / 2
        """Half width and depth between the walls, metres."""
        self.height_m = float(size[2])
        self.placed: list[Proposal] = []
        self.notes: list[str] = []
        self.tucked: dict[int, int] = {}
        """What is pushed under what: their boxes overlap, their surfaces do not."""
        self._boxes: list[np.ndarray] = []
        self._doorways = [np.array([*b.center, b.yaw, *b.size], np.float64) for b in zones]
        self._fronts: list[np.ndarray] = []

    def add(self, proposal: Proposal, front_m: float = 0.0) -> int:
        """Position in `placed` of what now stands there; ``front_m`` before it stays clear."""
        self.placed.append(proposal)
        self._boxes.append(box_rows([proposal])[0])
        if front_m > 0:
            self._fronts.append(box_rows([proposal], front_m)[0])
        return len(self.placed) - 1

    def first_free(
        self, proposals: list[Proposal], front_m: float = 0.0, under: int | None = None
    ) -> Proposal | None:
        """The first that keeps `MARGIN_M` from all that does not carry it; all in one call.

        Args:
            proposals: Of one model, on one parent.
            front_m: Free space wanted before the front; that of others counts too if > 0.
            under: What they may be pushed under, with all that stands on it: of that, their
                surfaces stay clear instead of their boxes.
        """
        if not proposals:
            return None
        rows = box_rows(proposals)
        within = np.flatnonzero(self._within(rows, proposals[0].attachment))
        if not len(within):
            return None
        inside = [proposals[i] for i in within]
        boxes = box_rows(inside, front_m) if front_m > 0 else rows[within]
        carriers = self.carriers(proposals[0].parent)
        near = self._by_surface(carriers, under)
        far = [i for i in range(len(self._boxes)) if i not in carriers and i not in near]
        zones = self._doorways + (self._fronts if front_m > 0 else [])
        others = [self._boxes[i] for i in far + near] + zones
        if not others:
            return inside[0]
        close = _depths(boxes, np.array(others)) > -MARGIN_M
        by_box = np.ones(len(others), bool)
        by_box[len(far) : len(far) + len(near)] = False
        for row, proposal in zip(close, inside, strict=True):
            if row[by_box].any():
                continue
            touching = [i for i, hit in zip(near, row[~by_box], strict=True) if hit]
            if all(meshes_apart(proposal, self.placed[i]) for i in touching):
                return proposal
        return None

    def add_first(self, proposals: list[Proposal], front_m: float = 0.0) -> int | None:
        """Place the first free proposal; its position, or None."""
        free = self.first_free(proposals, front_m)
        return None if free is None else self.add(free, front_m)

    def add_under(self, proposals: list[Proposal], host: int) -> int | None:
        """As `add_first`, for what may reach under ``host``."""
        free = self.first_free(proposals, under=host)
        if free is None:
            return None
        position = self.add(free)
        self.tucked[position] = host
        return position

    def positions(self, *roles: str) -> list[int]:
        """Where in `placed` things of these roles stand."""
        return [i for i, p in enumerate(self.placed) if p.role in roles]

    def carriers(self, position: int) -> list[int]:
        """A position and all that carries it, directly or not."""
        chain: list[int] = []
        while position >= 0:
            chain.append(position)
            position = self.placed[position].parent
        return chain

    def _by_surface(self, carriers: list[int], under: int | None) -> list[int]:
        """Positions of which surfaces count, not boxes."""
        if under is not None:
            return [i for i in range(len(self.placed)) if under in self.carriers(i)]
        return [chair for chair, host in self.tucked.items() if host in carriers]

    def _within(self, rows: np.ndarray, attachment: Attachment) -> np.ndarray:
        """[boxes] between the walls: with a margin, unless fixed to one or leaning on it."""
        margin = MARGIN_M if attachment == "none" else -_TOUCH_M
        c, s = np.abs(np.cos(rows[:, 3])), np.abs(np.sin(rows[:, 3]))
        x, y, z = rows[:, 4:].T / 2
        reach = np.abs(rows[:, :2]) + np.stack([c * x + s * y, s * x + c * y], 1)
        below = rows[:, 2] + z <= self.height_m + _TOUCH_M
        return np.all(reach <= self.half - margin, axis=1) & below


def box_rows(proposals: list[Proposal], front_m: float = 0.0) -> Float[np.ndarray, "boxes 7"]:
    """Centre, yaw and size of the box of the whole mesh, handles included, room frame.

    Grown towards the front (-y) by ``front_m``. Of one model at one scale, leaning alike.
    """
    first = proposals[0]
    low, high = extent(first.model)
    if first.lean is not None:
        turned = first.model.mesh.vertices @ first.lean.T
        low, high = turned.min(0), turned.max(0)
    low, high = first.scale * low - np.array([0, front_m, 0]), first.scale * high
    x, y, z = (low + high) / 2
    yaw = np.array([p.yaw for p in proposals])
    c, s = np.cos(yaw), np.sin(yaw)
    moved = np.stack([c * x - s * y, s * x + c * y, np.full(len(yaw), z)], 1)
    center = np.array([p.center for p in proposals]) + moved
    size = np.broadcast_to(high - low, center.shape)
    return np.concatenate([center, yaw[:, None], size], 1)


@functools.lru_cache(maxsize=2048)
def extent(model: CadModel) -> tuple[np.ndarray, np.ndarray]:
    """Lowest and highest corner [3] of a model's mesh, handles included, unscaled."""
    vertices = model.mesh.vertices
    return vertices.min(0).astype(np.float64), vertices.max(0).astype(np.float64)


@jax.jit
def _pair_depths(a: Float[Array, "a 7"], b: Float[Array, "b 7"]) -> Float[Array, "a b"]:
    def depth(x: Array, y: Array) -> Array:
        return box_overlap_depth(Box(x[:3], x[3], x[4:]), Box(y[:3], y[3], y[4:]))

    return jax.vmap(lambda x: jax.vmap(lambda y: depth(x, y))(b))(a)


def overlap_depths(boxes: list[Box], others: list[Box]) -> Float[np.ndarray, "a b"]:
    """Depth to which every pair of boxes overlaps, metres; negative when apart."""
    rows = (np.array([[*b.center, b.yaw, *b.size] for b in many]) for many in (boxes, others))
    return _depths(*rows)


def _depths(
    rows: Float[np.ndarray, "a 7"], others: Float[np.ndarray, "b 7"]
) -> Float[np.ndarray, "a b"]:
    return np.asarray(_pair_depths(_padded(rows), _padded(others)))[: len(rows), : len(others)]


def _padded(rows: Float[np.ndarray, "boxes 7"]) -> Float[np.ndarray, "padded 7"]:
    """With copies of the first up to a power of two, so that few shapes are compiled."""
    count = bucket(len(rows), 2 * TRIES)
    more = np.broadcast_to(rows[:1], (count - len(rows), 7))
    return np.concatenate([rows, more]).astype(np.float32)
