"""How things stay up that nothing carries: on a wall, from the ceiling, leaning, or not at all."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from jaxtyping import Float, Int

from ..config import ContactGraphSettings
from ..geometry import WALL_COSINE, beside_wall
from ..types import UNSUPPORTED, Array, Attachment
from .flat import FlatEntities
from .proximal import ClosePairs
from .support import Support
from .triples import Triples


def attachments(
    flat: FlatEntities,
    triples: Triples,
    support: Support,
    parent: Int[np.ndarray, " entities"],
    close: ClosePairs,
    settings: ContactGraphSettings,
    up_cosine: float,
) -> list[Attachment]:
    """How each entity is held; ``none`` where it is carried.

    - ``leaning``: it stands on something with less than the contact that would carry it (its
      bottom within the attach distance of a plane, A above 0), and a wall or the side of another
      thing is within that distance. Not for classes that hang on walls.
    - ``wall``: a wall is within the attach distance of its box, beside the wall's extent. Classes
      that hang on walls may be farther: often only their fronts were seen.
    - ``hanging``: the ceiling is within that distance of its top. A ceiling faces down as a
      supporting plane faces up: n . up is at most -``up_cosine``.
    """
    distance = settings.attach_distance_m
    hangs_by_class = np.isin(flat.mount, ("wall", "opening"))
    result: list[Attachment] = ["none"] * len(parent)
    for row in np.flatnonzero(parent == UNSUPPORTED).tolist():
        reach = settings.attach_distance_mounted_m if hangs_by_class[row] else distance
        wall = _touches_wall(flat, row, reach)
        foot = _footholds(triples, support, row, distance)
        beside = wall or bool(np.any(~np.isin(close.of(row, distance), foot)))
        if len(foot) and beside and not hangs_by_class[row]:
            result[row] = "leaning"
        elif wall:
            result[row] = "wall"
        elif _touches_ceiling(flat, row, distance, up_cosine):
            result[row] = "hanging"
    return result


def _layout_planes(
    flat: FlatEntities, row: int
) -> Iterator[tuple[Float[Array, "3"], Float[Array, ""], Float[Array, "4 3"]]]:
    """(n, d, corners) of the layout of the scene that holds ``row``."""
    planes = flat.planes
    for other in flat.slice(int(flat.scene[row])):
        if flat.is_layout[other]:
            for k in np.flatnonzero(planes.valid[other]):
                yield planes.normal[other, k], planes.offset[other, k], planes.corners[other, k]


def _corners(flat: FlatEntities, row: int) -> Float[np.ndarray, "8 3"]:
    """Eight corners of the entity's box, world frame."""
    box = flat.box
    c, s = np.cos(box.yaw[row]), np.sin(box.yaw[row])
    signs = np.stack(np.meshgrid(*[(-0.5, 0.5)] * 3, indexing="ij"), -1).reshape(-1, 3)
    turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    return (signs * box.size[row]) @ turn.T + box.center[row]


def _touches_wall(flat: FlatEntities, row: int, distance_m: float) -> bool:
    """A wall's plane passes within ``distance_m`` of the box, along the wall's own length."""
    corners = _corners(flat, row)
    for normal, offset, extent in _layout_planes(flat, row):
        if abs(normal[2]) >= WALL_COSINE:
            continue
        away = corners @ normal + offset
        near = away.min() <= distance_m and away.max() >= -distance_m
        if near and beside_wall(corners, normal, extent, distance_m):
            return True
    return False


def _touches_ceiling(flat: FlatEntities, row: int, distance_m: float, up_cosine: float) -> bool:
    """A ceiling lies within ``distance_m`` of the top of the box, or below it."""
    corners = _corners(flat, row)
    for normal, offset, _ in _layout_planes(flat, row):
        if normal[2] <= -up_cosine and (corners @ normal + offset).min() <= distance_m:
            return True
    return False


def _footholds(triples: Triples, support: Support, row: int, distance_m: float) -> np.ndarray:
    """What has a plane at the height of the bottom, below some part of it."""
    near = (triples.child == row) & (support.contact > 0) & (np.abs(support.gap_m) <= distance_m)
    return np.unique(triples.parent[near])
