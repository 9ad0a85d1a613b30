"""What stands on what: things on the planes of other things, wholly on them and clear above."""

from __future__ import annotations

import numpy as np

from ...library import CadModel
from .placement import MARGIN_M, TRIES, Occupancy, box_rows
from .proposal import Proposal, rotation_2d
from .recipe import OnTop, Roles, Stack
from .stock import Stock
from .tops import CELL_M, carrying_planes, top_of

_FACING_FRONT = {
    "monitor",
    "television",
    "microwave",
    "small oven",
    "hot plate",
    "laptop",
    "keyboard",
    "mouse",
    "clock",
    "basin",
}
"""Roles that face where their carrier faces."""
_SHELVES = {"bookshelf", "wall shelf"}
_REACH_M = 1.4
"""Nobody puts a cup higher, and no camera at eye height would see it."""
_SIDE_CLEARANCE_M = 0.01
_EDGE_M = 0.005
_ENOUGH = 8
"""Places on one plane that are tested against what stands there."""
_LAST_RESORT = ("microwave", "small oven")
"""Flat on top, and so stacked upon anywhere, but only where the library has nothing better."""
_DRAWS = 3
"""Models that are tried before a place is left empty."""
_SPREAD = 0.15
"""How far, in halves of the rectangle, a thing stands from where it is wanted."""


def place_on_tops(space: Occupancy, stock: Stock, rng: np.random.Generator, step: OnTop) -> None:
    """So many things on all of the hosts, or on each."""
    hosts = space.positions(*step.hosts)
    for group in [[host] for host in hosts] if step.each else [hosts]:
        for _ in range(int(rng.integers(step.count[0], step.count[1] + 1))):
            put_on(space, stock, rng, group, step.roles, step.at)


def place_stacks(space: Occupancy, stock: Stock, rng: np.random.Generator, step: Stack) -> None:
    """One thing on the other, each level on the one before."""
    for _ in range(int(rng.integers(step.count[0], step.count[1] + 1))):
        hosts = space.positions(*step.hosts)
        for roles in step.levels:
            better = tuple(r for r in roles if r in stock and r not in _LAST_RESORT)
            position = put_on(space, stock, rng, hosts, better or roles)
            if position is None:
                break
            hosts = [position]


def put_on(
    space: Occupancy,
    stock: Stock,
    rng: np.random.Generator,
    hosts: list[int],
    roles: Roles,
    at: tuple[float | None, float | None] = (None, None),
) -> int | None:
    """One thing of any of the roles on any of the hosts with a place for it, or None."""
    order = [roles[i] for i in rng.permutation(len(roles))]
    held = [role for role in order if role in stock]
    for role in (held * _DRAWS)[:_DRAWS] if hosts else []:
        found = stock.pick(role)
        position = found and _put(space, rng, hosts, (role, *found), at)
        if position is not None:
            return position
    return None


def _put(
    space: Occupancy,
    rng: np.random.Generator,
    hosts: list[int],
    thing: tuple[str, CadModel, float],
    at: tuple[float | None, float | None],
) -> int | None:
    """On any plane of any host within reach, in random order."""
    for host in rng.permutation(np.asarray(hosts, int)):
        under = space.placed[host]
        for plane in rng.permutation(carrying_planes(under.model)):
            if plane_height_m(under, int(plane)) > _REACH_M:
                continue
            position = space.add_first(_spots(space, int(host), int(plane), thing, at, rng))
            if position is not None:
                return position
    return None


def plane_height_m(under: Proposal, plane: int) -> float:
    """Height of a plane of what stands there, above the floor."""
    return float(under.center[2] + under.scale * top_of(under.model, plane).height_m)


def _spots(
    space: Occupancy,
    host: int,
    plane: int,
    thing: tuple[str, CadModel, float],
    at: tuple[float | None, float | None],
    rng: np.random.Generator,
) -> list[Proposal]:
    """Places at which the whole footprint lies on the plane itself, clear of what is above."""
    role, model, scale = thing
    under, spots = space.placed[host], []
    top = top_of(under.model, plane)
    half = scale * np.asarray(model.size[:2], np.float64) / 2
    turn = 0.05 if under.role in _SHELVES else 0.12 if role in _FACING_FRONT else np.pi
    height = plane_height_m(under, plane) + scale * float(model.size[2]) / 2
    for _ in range(TRIES):
        yaw = float(rng.uniform(-turn, turn))
        middle = _wanted(top.low, top.high, at, rng)
        points = _footprint(half + _EDGE_M) @ rotation_2d(yaw).T
        if not top.carries(middle + points / under.scale):
            continue
        place = under.center[:2] + rotation_2d(under.yaw) @ (under.scale * middle)
        center = np.array([*place, height])
        spot = Proposal(model, scale, under.yaw + yaw, center, host, plane, role=role)
        if clear_of_carriers(space, spot):
            spots.append(spot)
        if len(spots) == _ENOUGH:
            break
    return spots


def _wanted(
    low: np.ndarray,
    high: np.ndarray,
    at: tuple[float | None, float | None],
    rng: np.random.Generator,
) -> np.ndarray:
    """A point of the rectangle about where the thing is wanted."""
    share = rng.uniform(-1, 1, 2)
    for axis, wanted in enumerate(at):
        if wanted is not None:
            share[axis] = np.clip(wanted + _SPREAD * share[axis], -1, 1)
    return (low + high) / 2 + share * (high - low) / 2


def _footprint(half: np.ndarray) -> np.ndarray:
    """[points, 2] over a rectangle, no wider apart than two cells."""
    x, y = (np.linspace(-h, h, max(2, int(np.ceil(h / CELL_M)) + 1)) for h in half)
    return np.stack([g.ravel() for g in np.meshgrid(x, y)], 1)


def clear_of_carriers(space: Occupancy, spot: Proposal, side_m: float = _SIDE_CLEARANCE_M) -> bool:
    """No shelf, side or edge of what carries the thing inside its box grown by a margin."""
    row = box_rows([spot])[0]
    middle, half = row[:3], row[4:] / 2
    position, plane = spot.parent, spot.plane
    while position >= 0:
        under = space.placed[position]
        local = under.to_room(top_of(under.model, plane).obstacles) - middle
        beside = np.abs(local[:, :2] @ rotation_2d(spot.yaw)) < half[:2] + side_m
        level = (local[:, 2] > -half[2] + 0.004) & (local[:, 2] < half[2] + MARGIN_M)
        if np.any(np.all(beside, axis=1) & level):
            return False
        position, plane = under.parent, under.plane
    return True
