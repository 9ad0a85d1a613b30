"""What hangs: on walls, above a kitchen run, beside windows, from the ceiling."""

from __future__ import annotations

import numpy as np

from ...library import CadModel
from .floor_rules import WALL_YAWS, at_wall, scaled_extent, wall_of
from .placement import MARGIN_M, TRIES, Occupancy
from .proposal import ON_NOTHING, Proposal, rotation_2d
from .recipe import FromCeiling, OnWall, Run
from .stock import Stock

WALL_GAP_M = 0.003
"""Between a wall and what is fixed to it: nothing is driven into the wall by rounding."""
_ABOVE_RUN_M = (1.42, 1.52)
"""Lower edges of wall cabinets: half a metre above a worktop."""
_TALL_M = 1.2
_LEAST_BELOW_M = 1.15
"""Free height under what hangs from a ceiling, over tables too."""
_HEADROOM_M = 1.95
"""The same where people walk."""


def hang_on_walls(space: Occupancy, stock: Stock, rng: np.random.Generator, step: OnWall) -> None:
    """So many things on any walls, or beside others."""
    hosts = space.positions(*step.near) if step.near else []
    if step.near and not hosts:
        return
    for _ in range(int(rng.integers(step.count[0], step.count[1] + 1))):
        found = stock.first(step.roles)
        if found is None:
            return
        low = float(rng.uniform(*step.low_m))
        proposals = []
        for _ in range(TRIES):
            if hosts:
                beside = space.placed[hosts[int(rng.integers(len(hosts)))]]
                wall, along = wall_of(beside.yaw), _beside(beside, found[1], found[2], rng)
            else:
                wall = int(rng.integers(4))
                along = float(rng.uniform(-1, 1) * (space.half[wall % 2] - 0.1))
            proposals.append(_hung(space, *found, wall, along, low))
        if space.add_first(proposals) is None:
            space.notes.append(f"no wall has space for {found[1].id}")


def hang_above_run(space: Occupancy, stock: Stock, rng: np.random.Generator, step: Run) -> None:
    """Wall cabinets side by side above what is not tall of a run."""
    units = space.positions(*{role for roles in step.units for role in roles})
    low_units = [space.placed[i] for i in units if _top(space.placed[i]) < _TALL_M]
    if not low_units or not step.above:
        return
    wall = wall_of(low_units[0].yaw)
    ends = [_ends(unit, wall) for unit in low_units]
    along, end = min(low for low, _ in ends), max(high for _, high in ends)
    low = float(rng.uniform(*_ABOVE_RUN_M))
    misses = 0
    while along < end and misses < TRIES:
        found = stock.first(step.above)
        if found is None:
            return
        left, right = scaled_extent(found[1], found[2], 0)
        if along + right - left > end:
            break
        middle = along - left if wall in (0, 3) else along + right
        placed = space.add_first([_hung(space, *found, wall, middle, low)])
        misses += placed is None
        gap = float(rng.uniform(MARGIN_M + 0.003, 0.05))
        along += 0.1 if placed is None else right - left + gap


def hang_from_ceiling(
    space: Occupancy, stock: Stock, rng: np.random.Generator, step: FromCeiling
) -> None:
    """A lamp whose upper end touches the ceiling."""
    found = stock.first(step.roles)
    if found is None:
        return
    role, model, scale = found
    height = scale * float(model.size[2])
    hosts = space.positions(*step.over)
    under = _LEAST_BELOW_M if hosts else _HEADROOM_M
    if space.height_m - height < under:
        space.notes.append(f"the ceiling is too low for {model.id}")
        return
    proposals = []
    for _ in range(TRIES):
        middle = space.placed[int(rng.choice(hosts))].center[:2] if hosts else np.zeros(2)
        at = middle + rng.uniform(-0.15, 0.15, 2)
        center = np.array([*at, space.height_m - height / 2])
        yaw = float(rng.uniform(-np.pi, np.pi))
        proposals.append(
            Proposal(model, scale, yaw, center, ON_NOTHING, attachment="hanging", role=role)
        )
    space.add_first(proposals)


def _hung(
    space: Occupancy, role: str, model: CadModel, scale: float, wall: int, along: float, low: float
) -> Proposal:
    """On a wall, its lower edge at a height; lower where the room is not high enough."""
    at = at_wall(space, role, model, scale, wall, along, WALL_GAP_M)
    height = scale * float(model.size[2])
    low = max(MARGIN_M + 0.005, min(low, space.height_m - height - 0.05))
    center = np.array([*at.center[:2], low + height / 2])
    return Proposal(model, scale, WALL_YAWS[wall], center, ON_NOTHING, attachment="wall", role=role)


def _beside(window: Proposal, model: CadModel, scale: float, rng: np.random.Generator) -> float:
    """Along the window's wall, to either side of it."""
    reach = window.scale * float(window.model.size[0]) / 2 + scale * float(model.size[0]) / 2
    out = (reach + MARGIN_M + float(rng.uniform(0.01, 0.1))) * (1 if rng.random() < 0.5 else -1)
    place = window.center[:2] + rotation_2d(window.yaw) @ np.array([out, 0.0])
    return float(place[wall_of(window.yaw) % 2])


def _top(placed: Proposal) -> float:
    return float(placed.center[2] + placed.scale * placed.model.size[2] / 2)


def _ends(unit: Proposal, wall: int) -> tuple[float, float]:
    half = unit.scale * float(unit.model.size[0]) / 2
    return float(unit.center[wall % 2]) - half, float(unit.center[wall % 2]) + half
