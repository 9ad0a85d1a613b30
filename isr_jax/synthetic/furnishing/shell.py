"""The shell of a room: floor, walls with openings, ceiling, and what fills the openings."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable

import numpy as np
from jaxtyping import Float

from ...library import CadModel
from ...types import Box
from ..openings import JOINT_M, patch_sides
from ..room import LayoutPatch
from .proposal import ON_NOTHING, Proposal
from .stock import Stock

DOOR_CLEAR_M = 0.9
"""Kept clear before a door: its leaf swings, and people come in."""
WINDOW_CLEAR_M = 0.5
"""Kept clear of furniture that is higher than the sill."""
SILL_M = 0.9
_LOWEST_SILL_M = 0.05
"""Of windows that are nearly as high as the room."""
_LINTEL_M = 0.15
"""Least wall above an opening."""
_PIER_M = 0.3
"""Least wall beside an opening."""
_LARGEST_SCALE = 1.1
_MAX_WIDTH_M, _MAX_DEPTH_M = 2.5, 0.4
"""Garage doors and built-in wardrobes are wider or deeper."""
_DOORWAY_M = (0.9, 2.05)
_TRIES = 24
_OPENINGS_A_WALL = 2
"""So that a wall is at most seven rectangles, fewer than the planes that entities keep."""
_FLOOR_ID = 1


@dataclasses.dataclass(frozen=True, eq=False)
class Shell:
    """In the room's frame: axes along the walls, origin at the middle of the floor."""

    size: Float[np.ndarray, "3"]
    """Between the walls, metres."""
    layout: tuple[LayoutPatch, ...]
    """Floor, four walls and, if any, the ceiling; ids from 1."""
    items: tuple[Proposal, ...]
    """Doors and windows in the openings: on no parent, front (-y) into the room and flush with
    the wall, attached to the wall."""
    zones: tuple[Box, ...]
    """To be kept clear: before doors and doorways from the floor up, and before windows from the
    sill up."""
    notes: tuple[str, ...]


def make_shell(
    size: Float[np.ndarray, "3"], stock: Stock, rng: np.random.Generator, *, ceiling: bool
) -> Shell:
    """Walls with one or two ways in, and none to two windows, as the stock and the walls allow.

    A way in is a door of the stock or, in one of four, an open doorway; the only way in is one
    where the stock has no door. Windows without a model are left out. Behind an opening that
    nothing fills there is nothing, so that it returns no depth.

    Args:
        size: Width, depth and height between the walls, metres.
        stock: Draws models of the classes ``door`` and ``window``.
        rng: Decides all that is left open.
        ceiling: Whether there is one.
    """
    plan = _Plan(np.asarray(size, np.float64), rng, _plain_layout(size, ceiling))
    doors = 1 + int(rng.random() < 0.3)
    windows = int(rng.choice(3, p=[0.1, 0.5, 0.4]))
    for i in range(doors):
        bare = rng.random() < 0.25
        if bare or "door" not in stock:
            if i == 0 or bare:
                plan.cut(None, *_DOORWAY_M, 0.0)
        else:
            plan.fill("door", stock)
    for _ in range(windows if "window" in stock else 0):
        plan.fill("window", stock)
    for name in ("door", "window"):
        if name not in stock:
            plan.notes.append(f"no model of class {name} for an opening")
    return plan.shell()


class _Plan:
    """Openings as they are decided on."""

    def __init__(
        self, size: np.ndarray, rng: np.random.Generator, layout: tuple[LayoutPatch, ...]
    ) -> None:
        self._size, self._rng, self._layout = size, rng, layout
        self._openings: dict[int, list[tuple[float, ...]]] = {i: [] for i in range(1, 5)}
        self._items: list[Proposal] = []
        self._zones: list[Box] = []
        self.notes: list[str] = []

    def fill(self, class_name: str, stock: Stock) -> None:
        """An opening for a model of this class."""
        widest = min(_MAX_WIDTH_M, max(self._size[:2]) - 2 * _PIER_M)
        fits = _fits(widest, self._size[2] - _LINTEL_M - _LOWEST_SILL_M)
        model, scale = stock.draw(class_name, fits)
        if not fits(model):
            self.notes.append(f"no {class_name} of the library fits into a wall")
            return
        width, _, height = scale * np.asarray(model.size, np.float64)
        sill = min(SILL_M, self._size[2] - _LINTEL_M - height) if class_name == "window" else 0.0
        if not self.cut((model, scale), float(width), float(height), float(sill)):
            self.notes.append(f"no wall has space for {model.id}")

    def cut(
        self, filling: tuple[CadModel, float] | None, width_m: float, height_m: float, sill_m: float
    ) -> bool:
        """Cut an opening into a wall that has space for it; False if none has."""
        for wall in self._rng.integers(1, 5, _TRIES):
            length = patch_sides(self._layout[wall])[0]
            spare = length - width_m - 2 * (JOINT_M + _PIER_M)
            at = float(self._rng.random()) * spare + _PIER_M + JOINT_M
            low, high = at - JOINT_M, at + width_m + JOINT_M
            others = self._openings[wall]
            meets = any(low < o[2] + _PIER_M and o[0] - _PIER_M < high for o in others)
            if spare < 0 or meets or len(others) == _OPENINGS_A_WALL:
                continue
            bottom = sill_m - JOINT_M if sill_m > 0 else 0.0
            self._openings[wall].append((low, bottom, high, sill_m + height_m + JOINT_M))
            middle = (at + width_m / 2, sill_m + height_m / 2)
            if filling is not None:
                self._items.append(_filled(self._layout[wall], middle, *filling))
            depth = WINDOW_CLEAR_M if sill_m > 0 else DOOR_CLEAR_M
            size = np.array([width_m, depth, height_m])
            self._zones.append(_zone(self._layout[wall], middle, size))
            return True
        return False

    def shell(self) -> Shell:
        layout = tuple(
            dataclasses.replace(patch, openings=np.array(self._openings[i], np.float32))
            if self._openings.get(i)
            else patch
            for i, patch in enumerate(self._layout)
        )
        size = self._size.astype(np.float32)
        return Shell(size, layout, tuple(self._items), tuple(self._zones), tuple(self.notes))


def _fits(width_m: float, height_m: float) -> Callable[[CadModel], bool]:
    def fits(model: CadModel) -> bool:
        width, depth, height = _LARGEST_SCALE * np.asarray(model.size, np.float64)
        return bool(width <= width_m and height <= height_m and depth <= _MAX_DEPTH_M)

    return fits


def _frame(wall: LayoutPatch, at: tuple[float, float]) -> tuple[np.ndarray, float]:
    """The point (u, v) of a wall, and the yaw of a model whose front looks into the room."""
    base = np.asarray(wall.corners[1], np.float64) - wall.corners[0]
    along = base / np.linalg.norm(base)
    yaw = float(np.arctan2(wall.normal[0], -wall.normal[1]))
    return wall.corners[0] + at[0] * along + np.array([0, 0, at[1]]), yaw


def _filled(
    wall: LayoutPatch, middle: tuple[float, float], model: CadModel, scale: float
) -> Proposal:
    point, yaw = _frame(wall, middle)
    center = point - wall.normal * scale * float(model.size[1]) / 2
    return Proposal(model, scale, yaw, center, ON_NOTHING)


def _zone(wall: LayoutPatch, middle: tuple[float, float], size: np.ndarray) -> Box:
    point, yaw = _frame(wall, middle)
    values = (point + wall.normal * size[1] / 2, yaw, size)
    return Box(*(np.asarray(value, np.float32) for value in values))


def _plain_layout(size: Float[np.ndarray, "3"], ceiling: bool) -> tuple[LayoutPatch, ...]:
    """Floor, walls and ceiling without openings, room frame."""
    x, y, z = float(size[0]) / 2, float(size[1]) / 2, float(size[2])
    ground = [(-x, -y, 0.0), (x, -y, 0.0), (x, y, 0.0), (-x, y, 0.0)]
    patches = [("floor", ground)]
    for i in range(4):
        # Seen from inside the room, the wall's base runs from the later corner to the earlier.
        (bx, by, _), (ax, ay, _) = ground[i], ground[(i + 1) % 4]
        patches.append(("wall", [(ax, ay, 0.0), (bx, by, 0.0), (bx, by, z), (ax, ay, z)]))
    if ceiling:
        patches.append(("ceiling", [(px, py, z) for px, py, _ in reversed(ground)]))
    return tuple(
        LayoutPatch(_FLOOR_ID + i, name, np.array(corners, np.float32))
        for i, (name, corners) in enumerate(patches)
    )
