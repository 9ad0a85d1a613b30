"""What ranges, built-in ovens and small ovens share: a hot cavity behind a door that opens down.

Cavities are 0.40 to 0.50 m wide and 0.35 to 0.42 m deep behind 40 to 60 mm of wool and glass
(EN 60350-1 and makers' catalogues). The door turns about the lower edge of its front face: its
weight keeps it closed there, and carries it when it lies open.
"""

from __future__ import annotations

import dataclasses
import math

from .. import materials as m
from ..builder import ModelBuilder
from ..furniture.fronts import CLEARANCE_M, OPEN_RAD
from ..furniture.panels import Bounds, Space, add_bar_handle
from ..solids import box, prism

_CHAMFER_M = 0.02
_WIRE_M = 0.006
_WIRE_STEP_M = 0.055


@dataclasses.dataclass(frozen=True)
class OvenLook:
    """Materials of an oven."""

    shell: m.Material = m.WHITE_OVEN
    frame: m.Material = m.BLACK_OVEN
    """Of the door."""
    handle: m.Material = m.STEEL_TUBE
    reach: float = 0.05
    """How far the bar of the door stands out, metres."""


def seam_above(door_height: float, door: float, hinge_below: float = 0.0) -> float:
    """Gap that a door which opens down needs above it: its rear edge rises at first, metres."""
    arm = door_height + hinge_below
    c = min(_CHAMFER_M, door / 2)
    rise = math.hypot(door - c, arm) - arm
    rise = max(rise, math.hypot(door, arm - c) - arm)
    return round(CLEARANCE_M + rise + 0.0005, 4)


def add_down_door(
    builder: ModelBuilder,
    slab: Space,
    look: OvenLook,
    *,
    window: bool = True,
    board: m.Material | None = None,
    lining: m.Material | None = None,
) -> str:
    """A door with its hinge below and a bar near its upper edge; the name of its link.

    ``board`` is what its upper part is made of where that holds the controls, ``lining`` what its
    inner side is made of where there is no window.
    """
    (x0, x1), y, (z0, z1) = slab
    name = f"door_{sum(n.startswith('door') for n in builder.links) + 1}"
    c, rim = min(_CHAMFER_M, (y[1] - y[0]) / 2), round(min(0.075, 0.24 * (z1 - z0)), 4)
    top = [(y[0], z1 - rim), (y[1], z1 - rim), (y[1], z1 - c), (y[1] - c, z1), (y[0], z1)]
    builder.add(board or look.frame, prism(top, "x", (x0, x1)), link=name)
    below = ((x0, x1), y, (z0, z1 - rim))
    if window:
        _add_window(builder, below, 0.6 * rim, look.frame, name)
    else:
        middle = (y[0] + y[1]) / 2
        builder.add(look.frame, box((x0, x1), (y[0], middle), below[2]), link=name)
        builder.add(lining or look.frame, box((x0, x1), (middle, y[1]), below[2]), link=name)
    y0 = y[0]
    at = ((x0 + x1) / 2, y0, z1 - rim / 2)
    add_bar_handle(
        builder,
        at,
        round(0.8 * (x1 - x0), 3),
        upright=False,
        link=name,
        material=look.handle,
        thickness=min(0.018, 0.5 * rim),
        reach=look.reach,
    )
    builder.hinge(name, ((x0 + x1) / 2, y0, z0), (1, 0, 0), OPEN_RAD, damping=1.5, friction=1.0)
    return name


def _add_window(builder: ModelBuilder, space: Space, low: float, frame: m.Material, link) -> None:
    """Dark glass in a frame whose lower bar is ``low`` high; above it lies the door's top."""
    (x0, x1), y, (z0, z1) = space
    side = round(min(0.06, 0.15 * (x1 - x0)), 4)
    inner, sill = (x0 + side, x1 - side), z0 + round(low, 4)
    for rail in ((x0, x0 + side), (x1 - side, x1)):
        builder.add(frame, box(rail, y, (z0, z1)), link=link)
    builder.add(frame, box(inner, y, (z0, sill)), link=link)
    builder.add(m.OVEN_GLASS, box(inner, y, (sill, z1)), link=link)


def add_cavity(builder: ModelBuilder, block: Space, wall: float, shell: m.Material) -> Space:
    """Insulation around a hollow that is open to the front; the hollow."""
    (x0, x1), (y0, y1), (z0, z1) = block
    skin = 0.2 * wall
    for a, b in ((x0, x0 + skin), (x1 - skin, x1)):
        builder.add(shell, box((a, b), (y0, y1), (z0, z1)))
    inner = (x0 + wall, x1 - wall)
    for a, b in ((x0 + skin, inner[0]), (inner[1], x1 - skin)):
        builder.add(m.OVEN_LINING, box((a, b), (y0, y1), (z0, z1)))
    for low, high in ((z0 + skin, z0 + wall), (z1 - wall, z1 - skin)):
        builder.add(m.OVEN_LINING, box(inner, (y0, y1), (low, high)))
    for low, high in ((z0, z0 + skin), (z1 - skin, z1)):
        builder.add(shell, box(inner, (y0, y1), (low, high)))
    room = (z0 + wall, z1 - wall)
    builder.add(m.OVEN_LINING, box(inner, (y1 - wall, y1), room))
    return inner, (y0, y1 - wall), room


def add_racks(builder: ModelBuilder, room: Space, *, tray: bool = True) -> None:
    """A rack of wires above, and below it a tray; where it is low, one rack."""
    x, (y0, y1), (z0, z1) = room
    tall = z1 - z0
    y = (y0 + 0.01, y1)
    levels = (0.28, 0.62) if tray and tall > 0.2 else (0.4,)
    if len(levels) == 2:
        _add_tray(builder, (x, y), z0 + round(levels[0] * tall, 3))
    z = z0 + round(levels[-1] * tall, 3)
    rails = (z - _WIRE_M / 2, z + _WIRE_M / 2)
    for bar in ((y[0], y[0] + _WIRE_M), (y[1] - _WIRE_M, y[1])):
        builder.add(m.STEEL, box(x, bar, rails))
    count = max(2, round((x[1] - x[0]) / _WIRE_STEP_M))
    for k in range(count):
        at = round(x[0] + (x[1] - x[0]) * (k + 0.5) / count, 4)
        wire = (at - _WIRE_M / 2, at + _WIRE_M / 2)
        builder.add(m.STEEL, box(wire, (y[0] + _WIRE_M, y[1] - _WIRE_M), rails))


def _add_tray(builder: ModelBuilder, plan: tuple[Bounds, Bounds], z: float) -> None:
    (x0, x1), (y0, y1) = plan
    t, rim = 0.003, (z, z + 0.018)
    builder.add(m.ENAMEL, box((x0, x1), (y0, y1), (z - t, z)))
    for bar in ((y0, y0 + t), (y1 - t, y1)):
        builder.add(m.ENAMEL, box((x0, x1), bar, rim), carries=False)
    for bar in ((x0, x0 + t), (x1 - t, x1)):
        builder.add(m.ENAMEL, box(bar, (y0 + t, y1 - t), rim), carries=False)
