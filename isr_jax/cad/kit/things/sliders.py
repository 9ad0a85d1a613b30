"""Sliding doors and windows: one pane fixed at the rear, one before it that slides.

Patio doors are 1.5 to 2.4 m wide and 2.0 to 2.2 m high on profiles of 50 to 70 mm; sliding windows
are 0.8 to 1.8 m wide.
"""

from __future__ import annotations

from .. import materials as m
from ..builder import ModelBuilder
from ..furniture.fronts import add_bar_handle
from ..solids import box
from .leaves import GAP_M, Leaf, add_leaf

PROFILE = Leaf(m.PVC_PROFILE, m.DOUBLE_GLAZING, stile=0.07, sill=0.07, thickness=0.42)
_FRONT_M = 0.006
"""The sliding pane stands so far behind the frame's face."""


def sliding_door(
    width: float,
    depth: float,
    height: float,
    *,
    leaf: Leaf = PROFILE,
    jamb: float = 0.05,
    sill: float = 0.03,
    class_name: str = "door",
) -> ModelBuilder:
    """A pane at the right that slides to the left, before a fixed one; both in one frame."""
    builder = ModelBuilder(class_name, symmetry=1)
    x, y = width / 2, depth / 2
    frame = leaf.material
    for side in ((-x, -x + jamb), (x - jamb, x)):
        builder.add(frame, box(side, (-y, y), (0.0, height)), carries=False)
    inner = (-x + jamb, x - jamb)
    for z in ((0.0, sill), (height - jamb, height)):
        builder.add(frame, box(inner, (-y, y), z), carries=False)
    thick = (depth - 2 * _FRONT_M - GAP_M) / 2
    front = (-y + _FRONT_M, -y + _FRONT_M + thick)
    rear = (front[1] + GAP_M, y - _FRONT_M)
    lap = leaf.stile / 2
    add_leaf(builder, "base", ((inner[0], lap), rear, (sill, height - jamb)), leaf, None)
    pane = ((-lap, inner[1] - GAP_M), front, (sill + GAP_M, height - jamb - GAP_M))
    add_leaf(builder, "pane", pane, leaf, None)
    z = min(1.05, 0.5 * height)
    at = (pane[0][1] - leaf.stile / 2, front[0], z)
    add_bar_handle(
        builder, at, min(0.3, 0.3 * height), upright=True, link="pane", thickness=0.014, reach=0.04
    )
    travel = round(pane[0][0] - inner[0] - GAP_M, 3)
    builder.slide("pane", (-1, 0, 0), travel, damping=20.0, friction=8.0)
    return builder
