"""What stands on what: things on the planes of other things, wholly on them and clear above."""

from __future__ import annotations

import functools
from collections.abc import Callable

import numpy as np

from ..cad_types import CadModel
from .cutting import cut_edges
from .placement import (
    MARGIN_M,
    TRIES,
    Occupancy,
    Proposal,
    Stock,
    any_model,
    rotation_2d,
    solid_box,
)

_OPEN_SHELVES = ("bookshelf",)
"""Classes whose inner planes are seen from outside, and carry."""
_FACING_FRONT = ("monitor", "microwave", "laptop", "keyboard")
"""Classes that face where their carrier faces."""
_REACH_M = 1.35
"""Nobody puts a cup higher, and no camera at eye height would see it."""
_SIDE_CLEARANCE_M = 0.01
_SAMPLE_M = 0.03


def put_on(
    space: Occupancy,
    stock: Stock,
    rng: np.random.Generator,
    hosts: list[int],
    class_name: str,
    fits: Callable[[CadModel], bool] = any_model,
) -> int | None:
    """One thing on any of the hosts that has a place for it; its position, or None."""
    if class_name not in stock:
        return None
    model, scale = stock.draw(class_name, fits)
    for host in rng.permutation(np.asarray(hosts, int)):
        under = space.placed[host]
        for plane in rng.permutation(carrying_planes(under.model)):
            if plane_height_m(under, int(plane)) > _REACH_M:
                continue
            spots = _spots(under, int(host), int(plane), model, scale, rng)
            for spot in space.free(spots):
                if _clear_of_carriers(space, spot):
                    return space.add(spot)
    return None


def carrying_planes(model: CadModel) -> np.ndarray:
    """Planes of a model that things are put on: its top, or the shelves of an open one."""
    height = model.planes.corners[:, :, 2].mean(1)
    area = np.asarray(model.planes.area_m2)
    supporting = np.asarray(model.plane_supporting)
    if model.class_name in _OPEN_SHELVES:
        return np.flatnonzero(supporting & (area > 0.02))
    upper = np.flatnonzero(supporting & (height > 0.2 * model.size[2]))
    return upper[np.lexsort((height[upper], np.round(area[upper], 3)))[-1:]]


def plane_height_m(under: Proposal, plane: int) -> float:
    """Height of a plane of what stands there, above the floor."""
    return float(under.center[2] + under.scale * under.model.planes.corners[plane, 0, 2])


def _spots(
    under: Proposal,
    host: int,
    plane: int,
    model: CadModel,
    scale: float,
    rng: np.random.Generator,
) -> list[Proposal]:
    """Places at which the whole footprint lies on the plane's rectangle."""
    corners = under.scale * under.model.planes.corners[plane]
    low, high = corners[:, :2].min(0), corners[:, :2].max(0)
    at_front = model.class_name in _FACING_FRONT
    turn = 0.12 if at_front else np.pi
    turn = 0.05 if under.model.class_name in _OPEN_SHELVES else turn
    spots = []
    for _ in range(TRIES):
        yaw = float(rng.uniform(-turn, turn))
        c, s = abs(np.cos(yaw)), abs(np.sin(yaw))
        x, y = model.size[:2] * scale / 2
        reach = np.array([c * x + s * y, s * x + c * y]) + 0.005
        at = rng.uniform(low, high)
        if at_front:
            at[1] = high[1] - reach[1] - rng.uniform(0.0, 0.08)
        if np.all(at - reach >= low) and np.all(at + reach <= high):
            height = plane_height_m(under, plane) + scale * model.size[2] / 2
            center = np.array([*(under.center[:2] + rotation_2d(under.yaw) @ at), height])
            spots.append(Proposal(model, scale, under.yaw + yaw, center, host, plane))
    return spots


def _clear_of_carriers(space: Occupancy, spot: Proposal) -> bool:
    """No shelf, side or edge of what carries the thing inside its box grown by a margin."""
    box = solid_box(spot)
    half = np.asarray(box.size) / 2
    for position in space.carriers(spot.parent):
        local = _samples(space.placed[position]) - np.asarray(box.center)
        beside = np.abs(local[:, :2] @ rotation_2d(spot.yaw)) < half[:2] + _SIDE_CLEARANCE_M
        level = (local[:, 2] > -half[2] + 0.004) & (local[:, 2] < half[2] + MARGIN_M)
        if np.any(np.all(beside, axis=1) & level):
            return False
    return True


def _samples(placed: Proposal) -> np.ndarray:
    """Points on the surface of what stands there, room frame."""
    points = placed.scale * _model_samples(placed.model)
    turned = points[:, :2] @ rotation_2d(placed.yaw).T
    return np.concatenate([turned, points[:, 2:]], 1) + placed.center


@functools.lru_cache(maxsize=512)
def _model_samples(model: CadModel) -> np.ndarray:
    return cut_edges(model.mesh.vertices, model.mesh.faces, _SAMPLE_M).vertices
