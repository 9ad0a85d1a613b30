"""Washing machines: a drum behind a porthole, or below a lid.

Front loaders are 0.595 to 0.6 m wide, 0.4 to 0.65 m deep and 0.85 m high (to fit below worktops,
EN 1116), portholes 0.28 to 0.34 m wide; top loaders are 0.4 m wide in Europe, 0.68 m in America.
Half of the mass is a counterweight, the rest drum, motor and sheet (makers' catalogues).
"""

from __future__ import annotations

import dataclasses

import numpy as np

from .. import materials as m
from ..builder import ModelBuilder
from ..furniture.fronts import CLEARANCE_M
from ..furniture.panels import Bounds, Space, add_bar_handle
from ..shapes.shells import lying, lying_disc, lying_ring, plate_with_hole, turned
from ..solids import ROUND_SIDES, box, circle, frustum, tube
from .controls import add_knob, add_panel_with_display

_SKIN_M = 0.012
_FRONT_M = 0.02
_DOOR_M = 0.035
_KICK_M = 0.09
_SEAM_M = 0.0025
_FOOT_M = 0.015
_COUNTERWEIGHT_M3 = 0.016
"""Of concrete, at most: 37 kg."""
_CONSOLE_M = 0.085


@dataclasses.dataclass(frozen=True)
class _Drum:
    """Where the drum of a front loader is, and its porthole."""

    z: float
    radius: float
    hole: float
    y: Bounds


def washing_machine(
    width: float,
    depth: float,
    height: float,
    *,
    shell: m.Material = m.WHITE_SHEET,
    ring: m.Material = m.SILVER_BODY,
    top: float = 0.03,
    panel: float = 0.11,
    sides: int = ROUND_SIDES,
) -> ModelBuilder:
    """A front loader: porthole with its hinge at the left, drum, drawer for detergent, knob."""
    builder = ModelBuilder("washing_machine", symmetry=1)
    x, y = width / 2, depth / 2
    front = -y + _DOOR_M + CLEARANCE_M
    behind, board = front + _FRONT_M, height - top - panel
    z = round((_KICK_M + board) / 2, 4)
    half = min(x, (board - _KICK_M) / 2)
    door = round(min(0.185, 0.62 * half), 4)
    drum = _Drum(z, half - 0.03, round(0.82 * door, 4), (behind + 0.05, y - 0.09))
    _add_body(builder, (x, (behind, y), height - top), shell)
    builder.add(shell, box((-x, x), (front, y), (height - top, height)))
    pieces = plate_with_hole(
        ((-x, x), (_KICK_M, board)), (-behind, -front), (0.0, z), drum.hole, sides
    )
    builder.add(shell, *(lying(p) for p in pieces))
    builder.add(shell, box((-x, x), (front, behind), (_FOOT_M, _KICK_M)))
    _add_controls(builder, ((-x, x), (front, behind), (board, height - top)), shell, y, sides)
    boot = (circle(1.08 * drum.hole, sides), circle(drum.hole, sides))
    builder.add(m.RUBBER, *lying_ring(*boot, (behind, drum.y[0] - 0.004), (0.0, z)))
    _add_lying_drum(builder, drum, sides)
    _add_porthole(builder, (-y, behind), z, door, ring, sides)
    return builder


def _add_body(builder: ModelBuilder, space, shell: m.Material) -> None:
    """Sides, back and bottom, with a counterweight below and a motor behind the drum."""
    x, (front, back), z1 = space
    z0 = _FOOT_M
    for wall in ((-x, -x + _SKIN_M), (x - _SKIN_M, x)):
        builder.add(shell, box(wall, (front, back), (z0, z1)))
    inner = (-x + _SKIN_M, x - _SKIN_M)
    builder.add(shell, box(inner, (back - _SKIN_M, back), (z0, z1)))
    deep = (front + 0.02, back - _SKIN_M)
    area = (inner[1] - inner[0]) * (deep[1] - deep[0])
    high = round(min(_KICK_M - 0.02 - z0, _COUNTERWEIGHT_M3 / area), 4)
    builder.add(m.COUNTERWEIGHT, box(inner, deep, (z0, z0 + high)), carries=False)
    motor = (back - _SKIN_M - 0.06, back - _SKIN_M)
    middle = (0.25 * z1, 0.65 * z1)
    builder.add(m.MACHINERY, box((-0.6 * x, 0.6 * x), motor, middle), carries=False)
    for sx in (-1, 1):
        for cy in (front + 0.06, back - 0.06):
            cx = sx * (x - 0.06)
            leg = box((cx - 0.025, cx + 0.025), (cy - 0.025, cy + 0.025), (0.0, z0))
            builder.add(m.RUBBER, leg)


def _add_controls(builder: ModelBuilder, space: Space, shell, y: float, sides: int) -> None:
    """From the left: drawer, knob, display."""
    (x0, x1), (front, behind), (z0, z1) = space
    wide = x1 - x0
    edge = x0 + round(0.3 * wide, 4)
    display = (x0 + round(0.62 * wide, 4), x1 - round(0.06 * wide, 4))
    add_panel_with_display(builder, ((edge, x1), (front, behind), (z0, z1)), shell, display)
    z = (z0 + z1) / 2
    radius = min(0.03, 0.36 * (z1 - z0), 0.12 * wide)
    add_knob(
        builder,
        (x0 + 0.46 * wide, front, z),
        round(radius, 4),
        depth=0.02,
        material=m.SILVER_BODY,
        sides=sides,
    )
    name, t = "drawer_1", 0.004
    rear = behind - _SEAM_M
    panel = ((x0, edge - _SEAM_M), (front, rear), (z0 + _SEAM_M, z1 - _SEAM_M))
    builder.add(shell, box(*panel), link=name)
    left, right = x0 + _SKIN_M + 0.004, edge - 0.012
    floor, rim = z0 + 0.012, z1 - 0.015
    end = round(min(behind + 0.28, y - 0.12), 4)
    walls = [box(w, (rear, end), (floor, rim)) for w in ((left, left + t), (right - t, right))]
    walls.append(box((left + t, right - t), (end - t, end), (floor, rim)))
    walls.append(box((left + t, right - t), (rear, end - t), (floor, floor + t)))
    builder.add(m.WHITE_PLASTIC, *walls, link=name)
    lip = ((left, right), (front - 0.014, front), (z0 + 0.02, z0 + 0.03))
    builder.add(m.SILVER_BODY, box(*lip), link=name, handle=True)
    travel = round(0.7 * (end - behind), 2)
    builder.slide(name, (0, -1, 0), travel, damping=8.0, friction=2.0)


def _add_lying_drum(builder: ModelBuilder, drum: _Drum, sides: int) -> None:
    """Hollow, open to the front, with four ribs that lift the washing."""
    name, t, center = "drum", 0.004, (0.0, drum.z)
    outer, inner = circle(drum.radius, sides), circle(drum.radius - t, sides)
    y0, y1 = drum.y
    lip = circle(1.04 * drum.hole, sides)
    builder.add(
        m.THIN_STEEL, *lying_ring(outer, lip, (y0, y0 + t), center), link=name, carries=False
    )
    walls = lying_ring(outer, inner, (y0 + t, y1 - t), center)
    builder.add(m.STEEL_LINER, *walls, link=name, carries=False)
    back = lying_disc((drum.radius, drum.radius), (y1 - t, y1), center, sides)
    builder.add(m.THIN_STEEL, back, link=name, carries=False)
    flat = (drum.radius - t) * np.cos(np.pi / sides)
    tall, half = min(0.05, 0.25 * flat), min(0.014, 0.7 * flat * np.tan(np.pi / sides))
    rib = box((flat - tall, flat), (y0 + 0.02, y1 - 0.02), (drum.z - half, drum.z + half))
    for k in range(0, sides, sides // 4):
        angle = 2 * np.pi * (k + 0.5) / sides
        piece = turned(rib, "y", -angle, (0.0, 0.0, drum.z))
        builder.add(m.WHITE_PLASTIC, piece, link=name, carries=False)
    rim = (0.0, y0, drum.z - 1.1 * drum.hole)
    builder.swivel(name, (0.0, y0, drum.z), (0, 1, 0), damping=0.1, friction=0.5, at=rim)


def _add_porthole(builder: ModelBuilder, y: Bounds, z: float, radius: float, ring, sides) -> None:
    """A ring with a bowl of glass that bulges into the drum, narrow enough to swing out."""
    name, center = "door_1", (0.0, z)
    pane, back = round(0.72 * radius, 4), y[0] + _DOOR_M
    frame = (circle(radius, sides), circle(pane, sides))
    builder.add(ring, *lying_ring(*frame, (y[0], back), center), link=name)
    builder.add(
        m.PORTHOLE, lying_disc((pane, pane), (y[0] + 0.006, back), center, sides), link=name
    )
    deep = min(y[1] + 0.035, y[0] + 0.7 * radius)
    if deep > y[1]:
        bulge = lying_disc((0.9 * pane, 0.72 * pane), (back, round(deep, 4)), center, sides)
        builder.add(m.PORTHOLE, bulge, link=name)
    at = (round(0.88 * radius, 4), y[0], z)
    add_bar_handle(
        builder,
        at,
        round(0.5 * radius, 3),
        upright=True,
        link=name,
        material=ring,
        thickness=0.01,
        reach=0.03,
    )
    builder.hinge(name, (-radius, y[0], z), (0, 0, -1), 1.9, damping=0.3, friction=0.4)


def top_loader(
    width: float,
    depth: float,
    height: float,
    *,
    console: float = 0.0,
    knobs: int = 1,
    shell: m.Material = m.WHITE_SHEET,
    lid: m.Material = m.WHITE_SHEET,
    sides: int = ROUND_SIDES,
) -> ModelBuilder:
    """A drum about an upright axis below a lid; controls behind it, ``console`` high or level."""
    builder = ModelBuilder("washing_machine", symmetry=1)
    x, y, strip = width / 2, depth / 2, 0.13
    deck = height - console
    _add_body(builder, (x, (-y + _SKIN_M, y), deck - 0.045), shell)
    builder.add(shell, box((-x, x), (-y, -y + _SKIN_M), (_FOOT_M, deck - 0.045)))
    edge = y - strip
    center = (0.0, (-y + edge) / 2)
    hole = round(0.78 * min(x, (edge + y) / 2), 4)
    plate = (deck - 0.045, deck - 0.02 - _SEAM_M)
    builder.add(
        shell, *plate_with_hole(((-x, x), (-y, edge)), plate, center, hole, sides), carries=False
    )
    builder.add(shell, box((-x, x), (edge, y), (deck - 0.045, deck)))
    rear = y - _CONSOLE_M
    if console:
        builder.add(shell, box((-x, x), (rear, y), (deck, height)))
        _add_console_knobs(builder, x, rear, (deck, height), knobs, sides)
    _add_upright_drum(builder, center, (0.13, plate[0] - 0.01), hole, sides)
    slab = ((-x, x), (-y, edge - 0.003), (deck - 0.02, deck))
    builder.add(lid, box(*slab), link="lid")
    grip = box((-0.06, 0.06), (-y - 0.014, -y), (deck - 0.014, deck - 0.004))
    builder.add(lid, grip, link="lid", handle=True)
    builder.hinge("lid", (0.0, slab[1][1], deck), (-1, 0, 0), 1.57, damping=0.5, friction=0.5)
    return builder


def _add_upright_drum(builder, center, z: Bounds, hole: float, sides: int) -> None:
    """Hollow, open above, with a cone in the middle that moves the washing."""
    name, t, r = "drum", 0.004, round(1.06 * hole, 4)
    rims = [np.stack([circle(v, sides, center)] * 2) for v in (r, r - t)]
    builder.add(m.STEEL_LINER, *tube(rims[0], rims[1], (z[0] + t, z[1]), is_round=True), link=name)
    builder.add(
        m.STEEL_LINER, frustum((r, r), (z[0], z[0] + t), center, sides), link=name, carries=False
    )
    cone = frustum((0.4 * r, 0.14 * r), (z[0] + t, z[0] + 0.6 * (z[1] - z[0])), center, sides)
    builder.add(m.WHITE_PLASTIC, cone, link=name, carries=False)
    rim = (center[0], center[1] - r, z[1])
    builder.swivel(name, (*center, z[0]), damping=0.1, friction=0.5, at=rim)


def _add_console_knobs(builder, x: float, y: float, z: Bounds, knobs: int, sides: int) -> None:
    """Knobs on the front of a console, before which the open lid stands."""
    step = 2 * x / (knobs + 1)
    radius = round(min(0.028, 0.3 * (z[1] - z[0]), 0.3 * step), 4)
    for k in range(knobs):
        at = (round(-x + (k + 1) * step, 4), y, (z[0] + z[1]) / 2 + 0.01)
        add_knob(builder, at, radius, material=m.SILVER_BODY, sides=sides)
