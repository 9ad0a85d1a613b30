"""What stands together: seats around tables, a chair at a desk, stands at a bed, a lounge."""

from __future__ import annotations

import numpy as np

from ...library import CadModel
from .floor_rules import scaled_extent, stand_at_wall, stand_beside, standing, wall_of
from .placement import MARGIN_M, TRIES, Occupancy
from .proposal import Proposal, rotation_2d
from .recipe import Lounge, Seating, Sleeping, Workplace
from .stock import Stock

_SIDES = np.array([(0.0, -1.0), (1.0, 0.0), (0.0, 1.0), (-1.0, 0.0)])
"""Outward normals of a model's sides: front, then counter-clockwise."""
_SEAT_M = 0.66
"""Of a table's side for one seat."""
_DEEPEST_TUCK_M = 0.30
_TUCKS = 5
_LEAST_SEATS = 2
_STAND_M = 0.6
"""Kept for a stand on either side of a bed."""


def place_seating(space: Occupancy, stock: Stock, rng: np.random.Generator, step: Seating) -> bool:
    """A table in the free middle with seats that face it; False with fewer than two."""
    found = stock.first(step.table)
    if found is None:
        return False
    role, model, scale = found
    quarter = _quarter_along(space, model) if step.long_sides_only else int(rng.integers(4))
    proposals = []
    for _ in range(2 * TRIES):
        x, y = rng.uniform(-0.6, 0.6, 2) * np.maximum(space.half - 1.2, 0)
        yaw = rng.uniform(-step.turn_rad, step.turn_rad) + np.pi / 2 * quarter
        proposals.append(standing(role, model, scale, float(yaw), float(x), float(y)))
    table = space.add_first(proposals)
    if table is None:
        space.notes.append(f"no free floor for {model.id}")
        return False
    seats = _seat_all(space, stock, rng, step, table)
    return seats >= min(_LEAST_SEATS, step.count[0])


def _seat_all(
    space: Occupancy, stock: Stock, rng: np.random.Generator, step: Seating, table: int
) -> int:
    """How many of the wanted seats found a place at the table; all of one model."""
    found = stock.first(step.seats)
    if found is None:
        return 0
    wanted = int(rng.integers(step.count[0], step.count[1] + 1))
    slots = _slots(space.placed[table], step.long_sides_only, rng)
    seated = 0
    for side, slide in slots:
        if seated < wanted:
            seated += seat_at(space, rng, *found, table, side, slide) is not None
    return seated


def _quarter_along(space: Occupancy, model: CadModel) -> int:
    """Turns the long side of a table along the long side of the room."""
    return int((space.half[0] < space.half[1]) != (model.size[0] < model.size[1]))


def _slots(
    table: Proposal, long_sides_only: bool, rng: np.random.Generator
) -> list[tuple[int, float]]:
    """(side, place along it in metres) for each seat; sides take turns."""
    size = table.scale * np.asarray(table.model.size[:2], np.float64)
    counts = [max(1, int((size[side % 2] - 0.05) / _SEAT_M)) for side in range(4)]
    long = 0 if size[0] >= size[1] else 1
    sides = [s for s in rng.permutation(4) if not long_sides_only or s % 2 == long]
    rows = []
    for side in sides:
        n, length = counts[side], size[side % 2]
        rows.append([(int(side), ((k + 0.5) / n - 0.5) * length) for k in range(n)])
    longest = max(map(len, rows))
    return [row[k] for k in range(longest) for row in rows if k < len(row)]


def seat_at(
    space: Occupancy,
    rng: np.random.Generator,
    role: str,
    model: CadModel,
    scale: float,
    host: int,
    side: int,
    slide_m: float,
) -> int | None:
    """A seat that faces a side of a table, as far under it as is drawn and as its parts allow."""
    under = space.placed[host]
    outline = under.scale * under.model.mesh.vertices[:, :2].astype(np.float64)
    normal = _SIDES[side]
    tangent = np.array([-normal[1], normal[0]])
    edge = float((outline @ normal).max())
    facing = under.yaw + np.arctan2(normal[1], normal[0]) - np.pi / 2
    depth = -scaled_extent(model, scale, 1)[0]
    proposals = []
    deepest = float(rng.uniform(0.05, _DEEPEST_TUCK_M))
    for tuck in [*np.linspace(deepest, 0.0, _TUCKS), -0.06, -0.1, -0.15]:
        for _ in range(3):
            yaw = facing + rng.uniform(-0.1, 0.1)
            out = (edge + depth - tuck) * normal + (slide_m + rng.uniform(-0.04, 0.04)) * tangent
            at = under.center[:2] + rotation_2d(under.yaw) @ out
            proposals.append(standing(role, model, scale, float(yaw), *at.tolist()))
    return space.add_under(proposals, host)


def place_workplaces(
    space: Occupancy, stock: Stock, rng: np.random.Generator, step: Workplace
) -> bool:
    """Desks at walls with a chair before each."""
    done = 0
    for _ in range(int(rng.integers(step.count[0], step.count[1] + 1))):
        desk = stand_at_wall(space, stock, rng, step.desk, 0.9)
        chair = stock.first(step.chair)
        if desk is None or chair is None:
            break
        done += seat_at(space, rng, *chair, desk, 0, float(rng.uniform(-0.1, 0.1))) is not None
    return done >= 1


def place_sleeping(
    space: Occupancy, stock: Stock, rng: np.random.Generator, step: Sleeping
) -> bool:
    """A bed with its head at a wall, and two stands of one model beside it."""
    bed = stand_at_wall(space, stock, rng, step.bed, 0.4, beside_m=_STAND_M)
    if bed is None:
        return False
    found = stock.first(step.stands)
    if found is not None:
        for side in (1.0, -1.0):
            stand_beside(space, rng, *found, bed, side)
    return True


def place_lounge(space: Occupancy, stock: Stock, rng: np.random.Generator, step: Lounge) -> bool:
    """A sofa at a wall, a low table before it, a seat at its end, a bench across the room."""
    sofa = stand_at_wall(space, stock, rng, step.sofa, 0.9)
    if sofa is None:
        return False
    back = space.placed[sofa]
    wall = wall_of(back.yaw)
    stand_at_wall(
        space, stock, rng, step.bench, 0.4, wall=(wall + 2) % 4, along_m=back.center[wall % 2]
    )
    found = stock.first(step.table)
    if found is None:
        return True
    role, model, scale = found
    front = -scaled_extent(back.model, back.scale, 1)[0]
    behind = scaled_extent(model, scale, 1)[1]
    proposals = []
    for _ in range(TRIES):
        out = front + behind + float(rng.uniform(0.3, 0.5))
        at = _before(back, float(rng.uniform(-0.15, 0.15)), out)
        proposals.append(standing(role, model, scale, back.yaw + rng.uniform(-0.06, 0.06), *at))
    table = space.add_first(proposals)
    seat = stock.first(step.seat)
    if table is not None and seat is not None:
        _face(space, rng, *seat, table)
    return True


def _face(
    space: Occupancy, rng: np.random.Generator, role: str, model: CadModel, scale: float, host: int
) -> int | None:
    """A seat at either end of a low table, turned to it."""
    under = space.placed[host]
    proposals = []
    for side in rng.permutation([1.0, -1.0]):
        for _ in range(TRIES // 2):
            end = abs(scaled_extent(under.model, under.scale, 0)[int(side > 0)])
            out = end - scaled_extent(model, scale, 1)[0] + MARGIN_M + rng.uniform(0.1, 0.35)
            local = np.array([side * out, rng.uniform(-0.2, 0.1)])
            at = under.center[:2] + rotation_2d(under.yaw) @ local
            yaw = under.yaw + side * np.pi / 2 + rng.uniform(-0.25, 0.25)
            proposals.append(standing(role, model, scale, float(yaw), *at.tolist()))
    return space.add_first(proposals)


def _before(under: Proposal, right_m: float, out_m: float) -> tuple[float, float]:
    """The point ``out_m`` before the front of a thing."""
    x, y = under.center[:2] + rotation_2d(under.yaw) @ np.array([right_m, -out_m])
    return float(x), float(y)
