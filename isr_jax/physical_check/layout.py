"""Walls, floors and ceilings: how deep a candidate goes through them, and out of them again."""

from __future__ import annotations

import dataclasses

import numpy as np
from jaxtyping import Float

from ..config import PhysicalCheckSettings
from ..geometry.placed_solids import PlacedSolid
from ..types import Entities

_LEVEL = 0.5
_PASSES = 3
"""Leaving one wall may lead into another: a corner takes two."""


@dataclasses.dataclass(frozen=True, eq=False)
class LayoutPlane:
    """A plane of layout with its rectangle, normal into the room."""

    name: str
    normal: Float[np.ndarray, "3"]
    offset: float
    origin: Float[np.ndarray, "3"]
    sides: Float[np.ndarray, "2 3"]
    """Of the rectangle, from the origin."""

    @property
    def level(self) -> bool:
        return bool(abs(self.normal[2]) > _LEVEL)


def layout_planes(entities: Entities) -> list[LayoutPlane]:
    """The planes of all layout entities."""
    found = []
    for entity in entities:
        if not entity.is_layout:
            continue
        for row in np.flatnonzero(np.asarray(entity.planes.valid)):
            corners = np.asarray(entity.planes.corners[row], np.float64)
            normal = np.asarray(entity.planes.normal[row], np.float64)
            sides = np.stack([corners[1] - corners[0], corners[3] - corners[0]])
            offset = float(entity.planes.offset[row])
            found.append(LayoutPlane(entity.name, normal, offset, corners[0], sides))
    return found


def depth_through(solid: PlacedSolid, plane: LayoutPlane) -> tuple[float, float]:
    """How far parts that meet a plane's rectangle reach behind it, and before it, metres.

    A part counts with all of it if its projection meets the rectangle, less what it may reach too
    far.
    """
    behind, before = 0.0, 0.0
    if _lowest(solid, plane) >= 0:
        return behind, before
    for part in solid.parts:
        along = (part.vertices - plane.origin) @ plane.sides.T
        length_sq = np.sum(plane.sides**2, axis=1)
        if np.any(along.max(0) <= 0) or np.any(along.min(0) >= length_sq):
            continue
        signed = part.vertices @ plane.normal + plane.offset
        behind, before = max(behind, -signed.min()), max(before, signed.max())
    swelling_m = solid.swelling_m
    return max(0.0, float(behind) - swelling_m), max(0.0, float(before) - swelling_m)


def _lowest(solid: PlacedSolid, plane: LayoutPlane) -> float:
    """Signed distance of the nearest corner of the solid's box: most solids are off most walls."""
    corner = np.where(plane.normal > 0, solid.low, solid.high)
    return float(corner @ plane.normal + plane.offset)


def cleared_of_layout(
    solid: PlacedSolid,
    planes: list[LayoutPlane],
    *,
    supported: bool,
    settings: PhysicalCheckSettings,
) -> tuple[Float[np.ndarray, "3"], str | None]:
    """The step that takes a solid out of the layout, or why there is none.

    Penetration is the smaller of what lies behind a plane and before it, as in the released
    code: what stands in the next room does not count. Where most of a thing lies behind a
    plane, the plane is doubtful and the thing stays.
    """
    step, start = np.zeros(3), solid
    for _ in range(_PASSES):
        moved = False
        for plane in planes:
            behind, before = depth_through(solid, plane)
            if min(behind, before) > settings.layout_tolerance_m:
                return step, f"penetrates {plane.name} by {min(behind, before):.2f} m"
            # What stands on something keeps its height: planes along its way are walls.
            if 0 < behind <= before and not (supported and plane.level):
                step, moved = step + (behind + settings.clearance_m) * plane.normal, True
                step = step * [1, 1, 0] if supported else step
                solid = start.moved(step)
        if not moved:
            break
    return step, None
