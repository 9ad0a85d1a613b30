"""Things in furniture whose boards were not seen: a book on a shelf above the camera."""

from __future__ import annotations

import numpy as np
from jaxtyping import Int

from ..classes import class_named
from ..geometry import box_at, convex_overlap_area, footprint_corners
from ..types import UNSUPPORTED
from .flat import FlatEntities

_LEAST_SHARE = 0.5
"""Of a thing's footprint that lies in the furniture's."""


def put_inside(flat: FlatEntities, parent: Int[np.ndarray, " n"]) -> Int[np.ndarray, " n"]:
    """Parents, with the least furniture around each movable thing that nothing carries.

    Such a thing has a parent but no supporting plane: it stands on a board that was not seen.
    """
    parent = parent.copy()
    infos = [class_named(item.class_name) for item in flat.items]
    for row in np.flatnonzero(parent == UNSUPPORTED).tolist():
        if not infos[row].movable:
            continue
        around = [
            other
            for other in flat.slice(int(flat.scene[row]))
            if infos[other].kind == "thing"
            and not infos[other].movable
            and infos[other].mount == "floor"
            and _holds(flat, other, row)
        ]
        volume = [float(np.prod(flat.box.size[other])) for other in around]
        if around:
            parent[row] = around[int(np.argmin(volume))]
    return parent


def _holds(flat: FlatEntities, other: int, row: int) -> bool:
    """Whether a thing's bottom and half of its footprint lie in the box of another.

    The order of bottoms, ties by id, is that of supports: so no cycle can close.
    """
    top = float(flat.box.center[other, 2] + flat.box.size[other, 2] / 2)
    if not (flat.rank[other] < flat.rank[row] and flat.bottom[row] <= top):
        return False
    own = box_at(flat.box, row)
    shared = convex_overlap_area(footprint_corners(own), footprint_corners(box_at(flat.box, other)))
    return float(shared) >= _LEAST_SHARE * float(np.prod(np.asarray(own.size)[:2]))
