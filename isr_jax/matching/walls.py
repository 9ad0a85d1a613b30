"""The wall that an entity stands or hangs at (host)."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float

from ..geometry import box_corners
from ..types import Entities, Entity

_UPRIGHT = 0.3
"""A layout plane with a smaller |n . up| is a wall."""


def wall_normal(scene: Entities, entity: Entity, distance_m: float) -> Float[np.ndarray, "3"]:
    """Normal of the nearest wall within ``distance_m`` of an entity's box; 0 where none is.

    Only walls beside whose length the box lies count. Heights are not compared: the upper part
    of a wall is often not seen.
    """
    corners = np.asarray(box_corners(entity.box))
    nearest, best = distance_m, np.zeros(3, np.float32)
    for wall in scene:
        if not wall.is_layout or abs(wall.planes.normal[0, 2]) >= _UPRIGHT:
            continue
        normal = np.asarray(wall.planes.normal[0])
        gap = float(np.abs((corners @ normal + wall.planes.offset[0]).min()))
        # With openings, a wall has several rectangles in one plane.
        extent = np.asarray(wall.planes.corners)[np.asarray(wall.planes.valid)].reshape(-1, 3)
        if gap <= nearest and _beside(corners, normal, extent):
            nearest, best = gap, normal
    return best.astype(np.float32)


def _beside(corners: np.ndarray, normal: np.ndarray, extent: np.ndarray) -> bool:
    along = np.array([-normal[1], normal[0], 0.0])
    place, reach = corners @ along, extent @ along
    return bool(place.min() <= reach.max() and reach.min() <= place.max())
