"""Where furniture stands: along walls, beside and before other furniture, in the middle.

Room frame, origin mid-floor. A model's front is -y: a yaw of 0 turns its back to the wall at +y.
"""

from __future__ import annotations

import numpy as np

from ...library import CadModel
from .placement import MARGIN_M, TRIES, Occupancy, extent
from .proposal import ON_FLOOR, Proposal
from .recipe import AtWall, OnFloor, Roles, Run
from .stock import Stock

WALL_YAWS = (0.0, -np.pi / 2, np.pi, np.pi / 2)
"""Yaw of what has its back to the wall at +y, +x, -y, -x."""
_STEP_M = 0.08
_RUN_SCALE = (0.97, 1.03)
"""Of all units of a run: their tops are at one height."""
_LEAST_RUN = 2


def place_run(space: Occupancy, stock: Stock, rng: np.random.Generator, step: Run) -> bool:
    """Units side by side along the wall that takes the most of them, tall ones at its end."""
    drawn = [found for roles in step.units if (found := stock.first(roles)) is not None]
    scale = float(rng.uniform(*_RUN_SCALE))
    start = float(rng.uniform(0.03, 0.10))
    gaps = rng.uniform(MARGIN_M + 0.003, 0.04, len(drawn))
    walls = rng.permutation(4)
    runs = [_run_along(space, drawn, scale, int(wall), start, gaps) for wall in walls]
    best = max(runs, key=len)
    for proposal in best:
        space.add(proposal, 0.45)
    return len(best) >= min(_LEAST_RUN, len(drawn))


def _run_along(
    space: Occupancy,
    drawn: list[tuple[str, CadModel, float]],
    scale: float,
    wall: int,
    start: float,
    gaps: np.ndarray,
) -> list[Proposal]:
    """What finds a place, in order, from one end of a wall to the other."""
    found, end = [], float(space.half[wall % 2])
    along = -end + start
    for (role, model, _), gap in zip(drawn, gaps, strict=True):
        left, right = scaled_extent(model, scale, 0)
        reach = along
        while reach + right - left < end:
            # Seen from the room, walls 0 and 3 run along the model's +x, the others against it.
            middle = reach - left if wall in (0, 3) else reach + right
            proposal = at_wall(space, role, model, scale, wall, middle, 0.03)
            if space.first_free([proposal], 0.45) is not None:
                found.append(proposal)
                along = reach + right - left + float(gap)
                break
            reach += _STEP_M
    return found


def place_at_walls(space: Occupancy, stock: Stock, rng: np.random.Generator, step: AtWall) -> None:
    """Single things along the walls."""
    for _ in range(int(rng.integers(step.count[0], step.count[1] + 1))):
        stand_at_wall(space, stock, rng, step.roles, step.front_m)


def stand_at_wall(
    space: Occupancy,
    stock: Stock,
    rng: np.random.Generator,
    roles: Roles,
    front_m: float,
    *,
    wall: int | None = None,
    along_m: float | None = None,
    near_m: float = 0.4,
    beside_m: float = 0.0,
) -> int | None:
    """One thing with its back to a wall, or None.

    Args:
        front_m: Space that stays clear before it.
        wall: 0..3; None: any.
        along_m: Where about on that wall, give or take ``near_m``; None: anywhere.
        beside_m: Least distance from the corners, where the wall is long enough.
    """
    found = stock.first(roles)
    if found is None:
        return None
    role, model, scale = found
    proposals = []
    for _ in range(2 * TRIES):
        at = int(rng.integers(4)) if wall is None else wall
        reach = float(space.half[at % 2]) - max(map(abs, scaled_extent(model, scale, 0))) - 0.03
        reach = max(reach - beside_m, min(reach, 0.1), 0.0)
        along = float(rng.uniform(-1, 1)) * reach
        if along_m is not None:
            along = float(np.clip(along_m + rng.uniform(-near_m, near_m), -reach, reach))
        gap = float(rng.uniform(0.025, 0.05))
        proposals.append(at_wall(space, role, model, scale, at, along, gap))
    position = space.add_first(proposals, front_m)
    if position is None:
        space.notes.append(f"no wall has space for {model.id}")
    return position


def stand_beside(
    space: Occupancy,
    rng: np.random.Generator,
    role: str,
    model: CadModel,
    scale: float,
    host: int,
    side: float,
) -> int | None:
    """One thing at the wall of its host, close to its right (``side`` 1) or left (-1)."""
    under = space.placed[host]
    wall = wall_of(under.yaw)
    proposals = []
    for _ in range(TRIES):
        reach = scaled_extent(under.model, under.scale, 0)[int(side > 0)]
        own = scaled_extent(model, scale, 0)[int(side < 0)]
        out = abs(reach) + abs(own) + MARGIN_M + float(rng.uniform(0.01, 0.06))
        right = np.array([np.cos(under.yaw), np.sin(under.yaw)])
        along = float((under.center[:2] + side * out * right)[wall % 2])
        gap = float(rng.uniform(0.025, 0.05))
        proposals.append(at_wall(space, role, model, scale, wall, along, gap))
    return space.add_first(proposals)


def place_on_floor(space: Occupancy, stock: Stock, rng: np.random.Generator, step: OnFloor) -> None:
    """Rugs, wherever nothing stands."""
    for _ in range(int(rng.integers(step.count[0], step.count[1] + 1))):
        found = stock.first(step.roles)
        if found is None:
            return
        role, model, scale = found
        proposals = []
        for _ in range(2 * TRIES):
            x, y = rng.uniform(-1, 1, 2) * (space.half - 0.2)
            yaw = rng.uniform(-0.1, 0.1) + np.pi / 2 * rng.integers(4)
            proposals.append(standing(role, model, scale, float(yaw), float(x), float(y)))
        if space.add_first(proposals) is None:
            space.notes.append(f"no free floor for {model.id}")


def wall_of(yaw: float) -> int:
    """Which wall 0..3 (+y, +x, -y, -x) is at the back of what has this yaw."""
    return int(np.argmax([np.cos(yaw - wall) for wall in WALL_YAWS]))


def scaled_extent(model: CadModel, scale: float, axis: int) -> tuple[float, float]:
    """From where to where the whole mesh reaches along one of the model's axes, metres."""
    low, high = extent(model)
    return float(low[axis]) * scale, float(high[axis]) * scale


def standing(role: str, model: CadModel, scale: float, yaw: float, x: float, y: float) -> Proposal:
    """Upright on the floor."""
    center = np.array([x, y, scale * float(model.size[2]) / 2])
    return Proposal(model, scale, float(yaw), center, ON_FLOOR, role=role)


def at_wall(
    space: Occupancy,
    role: str,
    model: CadModel,
    scale: float,
    wall: int,
    along: float,
    gap_m: float,
) -> Proposal:
    """On the floor, back to wall 0..3 (+y, +x, -y, -x), ``gap_m`` before it."""
    back = scaled_extent(model, scale, 1)[1]
    out = (float(space.half[1 - wall % 2]) - gap_m - back) * (1.0 if wall < 2 else -1.0)
    x, y = (along, out) if wall % 2 == 0 else (out, along)
    return standing(role, model, scale, WALL_YAWS[wall], x, y)
