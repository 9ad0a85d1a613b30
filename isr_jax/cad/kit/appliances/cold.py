"""Fridges: insulated compartments behind doors and drawers.

European fridges are 0.55 to 0.6 m wide and deep and 0.85 to 2.0 m high, American ones 0.76 to
0.92 m wide (makers' catalogues); walls and doors are 40 to 60 mm of foam in sheet metal.
"""

from __future__ import annotations

import dataclasses
import math
from typing import Literal

import numpy as np

from .. import materials as m
from ..builder import ModelBuilder
from ..furniture.fronts import CLEARANCE_M, OPEN_RAD
from ..furniture.panels import Bounds, Space, add_bar_handle
from ..solids import Solid, between, box, prism

_SEAM_M = 0.002
_CHAMFER_M = 0.03
_MACHINE_M = 0.2
"""Height and depth of the room that the compressor takes at the back, at most."""
_TRAY_M = 0.09
CompartmentKind = Literal["left", "right", "double", "drawer"]


@dataclasses.dataclass(frozen=True)
class Compartment:
    """A part of a fridge behind one door, two doors, or a drawer."""

    kind: CompartmentKind
    """Where its hinge is, seen from the front."""
    share: float = 1.0


def fridge(
    width: float,
    depth: float,
    height: float,
    *,
    columns: tuple[tuple[Compartment, ...], ...] = ((Compartment("left"),),),
    shell: m.Material = m.WHITE_INSULATED,
    wall: float = 0.045,
    door: float = 0.055,
    foot: float = 0.03,
) -> ModelBuilder:
    """Insulated compartments, given from the top down for each column, with glass shelves.

    Doors carry trays inside and turn about their outer front edges.
    """
    builder = ModelBuilder("fridge", symmetry=1)
    x, y = width / 2, depth / 2
    face = -y + door + CLEARANCE_M
    builder.add(m.PLASTIC, box((-x + 0.02, x - 0.02), (face + 0.02, y - 0.02), (0.0, foot)))
    inner = _add_insulation(builder, shell, ((-x, x), (face, y), (foot, height)), wall)
    lowest = min(c[-1].share / sum(part.share for part in c) for c in columns)
    tall = min(_MACHINE_M, 0.6 * (lowest * (height - foot) - 1.5 * wall))
    rear = y - wall - round(min(_MACHINE_M, 0.35 * (y - wall - face)), 3)
    machine = (foot + wall, foot + wall + round(tall, 3))
    split = [round(v, 3) for v in np.linspace(-x, x, len(columns) + 1)]
    for i, column in enumerate(columns):
        left, right = split[i], split[i + 1]
        room = (
            inner[0] if i == 0 else left + wall / 2,
            inner[1] if i == len(columns) - 1 else right - wall / 2,
        )
        if i:
            divider = (left - wall / 2, left + wall / 2)
            builder.add(
                m.WHITE_INSULATED, box(divider, (face, y - wall), (foot + wall, height - wall))
            )
        builder.add(m.MACHINERY, box(room, (rear, y - wall), machine))
        front = (left + (_SEAM_M if i else 0), right - (_SEAM_M if i < len(columns) - 1 else 0))
        frame = _Frame(front, room, (-y, face, y - wall), (foot, height), rear, machine[1], wall)
        _add_compartments(builder, column, frame, shell)
    return builder


def _add_insulation(builder: ModelBuilder, shell: m.Material, space: Space, wall: float) -> Bounds:
    """Walls around ``space``, white inside, open to the front; the bounds between the sides."""
    (x0, x1), body, (z0, z1) = space
    skin = round(0.3 * wall, 4)
    inner = (x0 + wall, x1 - wall)
    for a, b in ((x0, x0 + skin), (x1 - skin, x1)):
        builder.add(shell, box((a, b), body, (z0, z1)))
    for a, b in ((x0 + skin, inner[0]), (inner[1], x1 - skin)):
        builder.add(m.WHITE_INSULATED, box((a, b), body, (z0, z1)))
    for a, b in ((z0, z0 + skin), (z1 - skin, z1)):
        builder.add(shell, box(inner, body, (a, b)))
    for a, b in ((z0 + skin, z0 + wall), (z1 - wall, z1 - skin)):
        builder.add(m.WHITE_INSULATED, box(inner, body, (a, b)))
    room = (z0 + wall, z1 - wall)
    builder.add(shell, box(inner, (body[1] - skin, body[1]), room))
    builder.add(m.WHITE_INSULATED, box(inner, (body[1] - wall, body[1] - skin), room))
    return inner


@dataclasses.dataclass(frozen=True)
class _Frame:
    """What one column of compartments lives in."""

    front: Bounds
    room: Bounds
    depth: tuple[float, float, float]
    """Front of the doors, of the body, and back of the room."""
    height: Bounds
    machine_front: float
    machine_top: float
    wall: float


def _add_compartments(builder, column: tuple[Compartment, ...], frame: _Frame, shell) -> None:
    z0, z1 = frame.height
    start, face, back = frame.depth
    rows = column[::-1]
    total = sum(row.share for row in rows)
    edges = [
        z0 + round((z1 - z0) * sum(r.share for r in rows[:k]) / total, 3) for k in range(len(rows))
    ]
    edges.append(z1)
    half = frame.wall / 2
    for k, row in enumerate(rows):
        low, high = edges[k], edges[k + 1]
        last = k == len(rows) - 1
        if k:
            builder.add(m.WHITE_INSULATED, box(frame.room, (face, back), (low - half, low + half)))
        inside = (low + (half if k else frame.wall), high - (frame.wall if last else half))
        space = (frame.room, (face, back), inside)
        tall = (low + (_SEAM_M if k else 0.0), high - (0.0 if last else _SEAM_M))
        panel = (frame.front, (start, face - CLEARANCE_M), tall)
        if row.kind == "drawer":
            _add_freezer_drawer(builder, panel, space, frame if k == 0 else None, shell)
            continue
        _add_glass_shelves(builder, space, frame.machine_top if k == 0 else 0.0)
        _add_doors(builder, panel, row.kind, space, shell)


def _add_glass_shelves(builder, space: Space, above: float) -> None:
    x, (y0, y1), (z0, z1) = space
    low = max(z0, above)
    count = max(0, round((z1 - low) / 0.3) - 1)
    levels = [low + round((z1 - low) * (k + 1) / (count + 1), 3) for k in range(count)]
    if above:
        levels.insert(0, above + 0.01)
    for z in levels:
        builder.add(
            m.GLASS, box(x, (y0 + min(_TRAY_M + 0.02, 0.4 * (y1 - y0)), y1), (z - 0.003, z + 0.003))
        )


def _door_slab(panel: Space, free_side: int) -> Solid:
    """A slab whose rear edge is cut at its free end, so that it clears a neighbour in turning."""
    (x0, x1), (y0, y1), z = panel
    c = _CHAMFER_M
    if free_side > 0:
        outline = [(x0, y0), (x1, y0), (x1, y1 - c), (x1 - c, y1), (x0, y1)]
    else:
        outline = [(x0, y0), (x1, y0), (x1, y1), (x0 + c, y1), (x0, y1 - c)]
    return prism(outline, "z", z)


def _add_doors(
    builder: ModelBuilder, panel: Space, kind: str, space: Space, shell: m.Material
) -> None:
    (x0, x1), y, z = panel
    middle = round((x0 + x1) / 2, 4)
    slabs = {
        "left": [(x0, x1, 1)],
        "right": [(x0, x1, -1)],
        "double": [(x0, middle - _SEAM_M, 1), (middle + _SEAM_M, x1, -1)],
    }[kind]
    for left, right, free in slabs:
        name = f"door_{sum(n.startswith('door') for n in builder.links) + 1}"
        builder.add(shell, _door_slab(((left, right), y, z), free), link=name)
        grip = right - 0.05 if free > 0 else left + 0.05
        length = min(0.45, 0.5 * (z[1] - z[0]))
        reach = min(max((z[0] + z[1]) / 2, z[0] + length / 2 + 0.04), 1.15)
        center = min(max(reach, z[0] + length / 2 + 0.04), z[1] - length / 2 - 0.04)
        add_bar_handle(
            builder,
            (grip, y[0], center),
            length,
            upright=True,
            link=name,
            thickness=0.016,
            reach=0.05,
        )
        _add_trays(builder, ((left, right), y, z), space, free, name)
        hinge = (left if free > 0 else right, y[0], (z[0] + z[1]) / 2)
        builder.hinge(name, hinge, (0, 0, -free), OPEN_RAD, damping=1.0, friction=0.6)


def _add_trays(builder, slab: Space, space: Space, free: int, link: str) -> None:
    """Trays for bottles inside a door, short enough to swing out past what is beside it."""
    (x0, x1), (y0, y1), _ = slab
    (room0, room1), (_, back), (z0, z1) = space
    if back - y1 < 2.5 * _TRAY_M or z1 - z0 < 0.25:
        return
    if free > 0:
        hinge, low, limit = x0, room0 + 0.02, min(room1, x1 - _CHAMFER_M) - x0
    else:
        hinge, low, limit = x1, room1 - 0.02, x1 - max(room0, x0 + _CHAMFER_M)
    swing = (limit - 0.004) ** 2 - (y1 - y0 + _TRAY_M) ** 2
    if swing <= (abs(low - hinge) + 0.1) ** 2:
        return
    x = between(low, hinge + free * math.floor(1000 * math.sqrt(swing)) / 1000)
    count, t, end = max(1, round((z1 - z0) / 0.4)), 0.005, y1 + _TRAY_M
    for k in range(count):
        floor = z0 + 0.09 + round((z1 - z0 - 0.18) * k / count, 3)
        wall = (floor, floor + 0.07)
        parts = [box(x, (y1, end), (floor - t, floor)), box(x, (end - t, end), wall)]
        parts += [box((x[0], x[0] + t), (y1, end - t), wall)]
        parts += [box((x[1] - t, x[1]), (y1, end - t), wall)]
        builder.add(m.LINER, *parts, link=link, carries=False)


def _add_freezer_drawer(builder, panel: Space, space: Space, frame, shell: m.Material) -> None:
    (px0, px1), (y0, y1), (pz0, pz1) = panel
    (ix0, ix1), (_, back), (z0, z1) = space
    name = f"drawer_{sum(n.startswith('drawer') for n in builder.links) + 1}"
    builder.add(shell, box((px0, px1), (y0, y1), (pz0, pz1)), link=name)
    end = (frame.machine_front if frame else back) - 0.02
    t, x0, x1, low = 0.006, ix0 + 0.01, ix1 - 0.01, z0 + 0.01
    high = low + round(0.75 * (z1 - low), 3)
    builder.add(m.LINER, box((x0, x0 + t), (y1, end), (low, high)), link=name)
    builder.add(m.LINER, box((x1 - t, x1), (y1, end), (low, high)), link=name)
    builder.add(m.LINER, box((x0 + t, x1 - t), (end - t, end), (low, high)), link=name)
    builder.add(m.LINER, box((x0 + t, x1 - t), (y1, end - t), (low, low + t)), link=name)
    at = ((px0 + px1) / 2, y0, pz1 - 0.07)
    add_bar_handle(
        builder,
        at,
        min(0.5, 0.6 * (px1 - px0)),
        upright=False,
        link=name,
        thickness=0.016,
        reach=0.05,
    )
    builder.slide(name, (0, -1, 0), round(0.75 * (end - y1), 2), damping=10.0, friction=4.0)
