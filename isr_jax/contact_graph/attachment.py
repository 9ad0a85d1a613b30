"""How things stay up that nothing carries: on a wall, from the ceiling, leaning, or not at all."""

from __future__ import annotations

import numpy as np

from ..config import ContactGraphSettings
from ..types import UNSUPPORTED
from .flat import FlatEntities
from .support import Support
from .triples import Triples

_WALL_TILT = 0.3
"""A layout plane with a smaller |n . up| is a wall."""


def attachments(
    flat: FlatEntities,
    triples: Triples,
    support: Support,
    parent: np.ndarray,
    close: tuple[np.ndarray, np.ndarray],
    settings: ContactGraphSettings,
) -> list[str]:
    """``none``, ``wall``, ``hanging`` or ``leaning`` for each entity; ``none`` where carried.

    - ``leaning``: it stands on something with less than the contact that would carry it (its
      bottom within the attach distance of a plane, A above 0), and a wall or the side of another
      thing is within that distance. Not for classes that hang on walls.
    - ``wall``: a wall is within the attach distance of its box, beside the wall's extent. Classes
      that hang on walls may be farther: often only their fronts were seen.
    - ``hanging``: the ceiling is within that distance of its top.
    """
    distance = settings.attach_distance_m
    hangs_by_class = np.isin(flat.mount, ("wall", "opening"))
    result = ["none"] * len(parent)
    for row in np.flatnonzero(parent == UNSUPPORTED).tolist():
        reach = settings.attach_distance_mounted_m if hangs_by_class[row] else distance
        wall = _touches_wall(flat, row, reach)
        foot = _footholds(triples, support, row, distance)
        beside = wall or _beside(row, foot, close, distance)
        if len(foot) and beside and not hangs_by_class[row]:
            result[row] = "leaning"
        elif wall:
            result[row] = "wall"
        elif _touches_ceiling(flat, row, distance):
            result[row] = "hanging"
    return result


def _layout_planes(flat: FlatEntities, row: int):
    """(n, d, corners) of the layout of the scene that holds ``row``."""
    for other in flat.slice(int(flat.scene[row])):
        if flat.is_layout[other]:
            for k in np.flatnonzero(flat.planes.valid[other]):
                planes = flat.planes
                yield planes.normal[other, k], planes.offset[other, k], planes.corners[other, k]


def _corners(flat: FlatEntities, row: int) -> np.ndarray:
    """Eight corners of the entity's box, world frame."""
    box = flat.box
    c, s = np.cos(box.yaw[row]), np.sin(box.yaw[row])
    signs = np.stack(np.meshgrid(*[(-0.5, 0.5)] * 3, indexing="ij"), -1).reshape(-1, 3)
    turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    return (signs * box.size[row]) @ turn.T + box.center[row]


def _touches_wall(flat: FlatEntities, row: int, distance: float) -> bool:
    """A wall's plane passes within ``distance`` of the box, along the wall's own length.

    Heights are not compared: the upper part of a wall is often not seen.
    """
    corners = _corners(flat, row)
    for normal, offset, extent in _layout_planes(flat, row):
        if abs(normal[2]) >= _WALL_TILT:
            continue
        away = corners @ normal + offset
        along = np.array([-normal[1], normal[0], 0.0])
        place, reach = corners @ along, extent @ along
        beside = place.min() <= reach.max() + distance and reach.min() <= place.max() + distance
        if beside and away.min() <= distance and away.max() >= -distance:
            return True
    return False


def _touches_ceiling(flat: FlatEntities, row: int, distance: float) -> bool:
    """A down-facing layout plane lies within ``distance`` of the top of the box, or below it."""
    corners = _corners(flat, row)
    for normal, offset, _ in _layout_planes(flat, row):
        if normal[2] <= -0.9 and (corners @ normal + offset).min() <= distance:
            return True
    return False


def _footholds(triples: Triples, support: Support, row: int, distance: float) -> np.ndarray:
    """What has a plane at the height of the bottom, below some part of it."""
    near = (triples.child == row) & (support.contact > 0) & (np.abs(support.gap_m) <= distance)
    return np.unique(triples.parent[near])


def _beside(
    row: int, foot: np.ndarray, close: tuple[np.ndarray, np.ndarray], distance: float
) -> bool:
    """Whether another thing than those below is within ``distance`` of the box."""
    pairs, depth = close
    ours = (depth >= -distance) & np.any(pairs == row, axis=-1)
    others = pairs[ours].sum(-1) - row
    return bool(np.any(~np.isin(others, foot)))
