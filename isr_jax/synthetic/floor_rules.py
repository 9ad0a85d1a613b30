"""Where furniture stands: along walls, on walls, in the middle. Room frame, origin mid-floor.

A model's front is -y: a yaw of 0 turns its back to the wall at +y.
"""

from __future__ import annotations

import numpy as np

from ..cad_types import CadModel
from .placement import (
    MARGIN_M,
    ON_FLOOR,
    ON_NOTHING,
    TRIES,
    Occupancy,
    Proposal,
    Stock,
    rotation_2d,
)

_WALL_YAWS = (0.0, -np.pi / 2, np.pi, np.pi / 2)
"""Yaw of what has its back to the wall at +y, +x, -y, -x."""
_KITCHEN = ("fridge", "cabinet", "counter", "cabinet", "dishwasher", "oven", "cabinet")
_CLEAR_FRONT_M = {"desk": 0.9, "sofa": 0.5, "bookshelf": 0.5, "bed": 0.4, "wardrobe": 0.5}
_HANGING_HEIGHT_M = 1.45
"""Of the lower edge of what hangs on a wall."""


def kitchen_run(space: Occupancy, stock: Stock, rng: np.random.Generator) -> None:
    """Fridge, cabinets and counters side by side along one wall."""
    wall = int(rng.integers(4))
    end = float(space.half[wall % 2])
    along = -end + float(rng.uniform(0.03, 0.10))
    for class_name in (name for name in _KITCHEN if name in stock):
        model, scale = stock.draw(class_name, _fits_kitchen)
        left, right = _extent(model, scale, 0)
        # Seen from the room, walls 0 and 3 run along the model's +x, the others against it.
        middle = along - left if wall in (0, 3) else along + right
        placed = space.add_first([_at_wall(space, model, scale, wall, middle, 0.03)], 0.4)
        if placed is not None:
            along += right - left + float(rng.uniform(0.025, 0.05))


def stand_at_wall(
    space: Occupancy, stock: Stock, rng: np.random.Generator, class_name: str
) -> int | None:
    """One thing with its back to any wall with space for it; its position, or None."""
    model, scale = stock.draw(class_name)
    proposals = []
    for _ in range(TRIES):
        wall = int(rng.integers(4))
        reach = float(space.half[wall % 2]) - max(map(abs, _extent(model, scale, 0))) - 0.05
        along = float(rng.uniform(-1, 1)) * max(reach, 0.0)
        gap = float(rng.uniform(0.025, 0.06))
        proposals.append(_at_wall(space, model, scale, wall, along, gap))
    return space.add_first(proposals, _CLEAR_FRONT_M.get(class_name, 0.1))


def hang_on_wall(
    space: Occupancy, stock: Stock, rng: np.random.Generator, class_name: str
) -> int | None:
    """One thing on a wall, above cabinets where there are any."""
    model, scale = stock.draw(class_name)
    below = space.positions("cabinet", "counter")
    proposals = []
    for _ in range(TRIES):
        wall, along = int(rng.integers(4)), float(rng.uniform(-1, 1))
        if below:
            base = space.placed[below[int(rng.integers(len(below)))]]
            wall = _WALL_YAWS.index(base.yaw)
            along = float(base.center[wall % 2] + rng.uniform(-0.3, 0.3))
        at = _at_wall(space, model, scale, wall, along, MARGIN_M + 0.001)
        center = np.array([*at.center[:2], _HANGING_HEIGHT_M + scale * model.size[2] / 2])
        proposals.append(Proposal(model, scale, at.yaw, center, ON_NOTHING))
    return space.add_first(proposals)


def table_with_chairs(
    space: Occupancy, stock: Stock, rng: np.random.Generator, chairs: int
) -> int | None:
    """A turned table in the middle with chairs that face it; None with fewer than two."""
    model, scale = stock.draw("table", _seats_people)
    proposals = []
    for _ in range(TRIES):
        x, y = rng.uniform(-0.5, 0.5, 2) * np.maximum(space.half - 1.5, 0)
        yaw = rng.uniform(-0.35, 0.35) + np.pi / 2 * rng.integers(4)
        proposals.append(_standing(model, scale, float(yaw), float(x), float(y)))
    table = space.add_first(proposals)
    if table is None:
        return None
    sides = rng.permutation(4)[:chairs]
    seated = [chair_at(space, stock, rng, table, int(side)) for side in sides]
    return table if sum(seat is not None for seat in seated) >= 2 else None


def chair_at(
    space: Occupancy, stock: Stock, rng: np.random.Generator, host: int, side: int
) -> int | None:
    """A chair that faces a side (0 front, then counter-clockwise) of a thing."""
    model, scale = stock.draw("chair")
    under = space.placed[host]
    outline = under.scale * under.model.mesh.vertices[:, :2]
    normal = np.array([(0.0, -1.0), (1.0, 0.0), (0.0, 1.0), (-1.0, 0.0)][side])
    tangent = np.array([-normal[1], normal[0]])
    edge, half = (outline @ normal).max(), (outline @ tangent).max()
    depth = -_extent(model, scale, 1)[0]
    facing = under.yaw + np.arctan2(normal[1], normal[0]) - np.pi / 2
    proposals = []
    for _ in range(TRIES):
        out = edge + depth + MARGIN_M + rng.uniform(0.03, 0.12)
        slide = rng.uniform(-0.3, 0.3) * half
        at = under.center[:2] + rotation_2d(under.yaw) @ (out * normal + slide * tangent)
        yaw = facing + rng.uniform(-0.15, 0.15)
        proposals.append(_standing(model, scale, float(yaw), *at.tolist()))
    return space.add_first(proposals)


def _fits_kitchen(model: CadModel) -> bool:
    """Worktop height, and depth of a run; fridges may be tall."""
    low, high = (0.75, 2.1) if model.class_name == "fridge" else (0.7, 1.05)
    return bool(low < model.size[2] < high and model.size[0] < 2.0 and model.size[1] < 0.8)


def _seats_people(model: CadModel) -> bool:
    return bool(0.65 < model.size[2] < 0.85 and model.size[:2].max() > 0.7)


def _extent(model: CadModel, scale: float, axis: int) -> tuple[float, float]:
    """From where to where the whole mesh reaches along one of the model's axes."""
    values = model.mesh.vertices[:, axis]
    return float(values.min()) * scale, float(values.max()) * scale


def _standing(model: CadModel, scale: float, yaw: float, x: float, y: float) -> Proposal:
    center = np.array([x, y, scale * model.size[2] / 2])
    return Proposal(model, scale, float(yaw), center, ON_FLOOR)


def _at_wall(
    space: Occupancy, model: CadModel, scale: float, wall: int, along: float, gap_m: float
) -> Proposal:
    """Back to wall 0..3 (+y, +x, -y, -x), ``gap_m`` before it."""
    back = _extent(model, scale, 1)[1]
    out = (float(space.half[1 - wall % 2]) - gap_m - back) * (1.0 if wall < 2 else -1.0)
    x, y = (along, out) if wall % 2 == 0 else (out, along)
    return _standing(model, scale, _WALL_YAWS[wall], x, y)
