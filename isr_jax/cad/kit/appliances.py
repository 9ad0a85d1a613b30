"""Fridges, microwaves, monitors and televisions.

European fridges are 0.55 to 0.6 m wide and deep and 0.85 to 2.0 m high, American ones 0.76 to
0.92 m wide; walls and doors are 40 to 60 mm of foam in sheet metal. Microwaves of 17 to 32 l are
0.44 to 0.54 m wide, 0.26 to 0.31 m high. Screens are 16:9 (or 21:9), sized by their diagonal.
"""

from __future__ import annotations

import dataclasses
from typing import Literal

import numpy as np

from ...cad_types import CadModel
from . import materials as m
from .builder import ModelBuilder
from .fronts import CLEARANCE_M, OPEN_RAD, Bounds, Space, add_bar_handle
from .solids import Solid, box, frustum, prism

_SEAM_M = 0.002
_CHAMFER_M = 0.03
CompartmentKind = Literal["left", "right", "double", "drawer"]


@dataclasses.dataclass(frozen=True)
class Compartment:
    """A part of a fridge behind one door, two doors, or a drawer."""

    kind: CompartmentKind
    """Where its hinge is, seen from the front."""
    share: float = 1.0


def fridge(
    name: str,
    width: float,
    depth: float,
    height: float,
    columns: tuple[tuple[Compartment, ...], ...],
    *,
    shell: m.Material = m.WHITE_INSULATED,
    wall: float = 0.045,
    door: float = 0.055,
    foot: float = 0.03,
) -> CadModel:
    """Insulated compartments, given from the top down for each column, with glass shelves."""
    builder = ModelBuilder("fridge", name, symmetry=1)
    x, y = width / 2, depth / 2
    face = -y + door + CLEARANCE_M
    builder.add(m.PLASTIC, box((-x + 0.02, x - 0.02), (face + 0.02, y - 0.02), (0.0, foot)))
    inner = _add_insulation(builder, shell, ((-x, x), (face, y), (foot, height)), wall)
    machine = (foot + wall, foot + wall + 0.2)
    rear = y - wall - 0.2
    split = [round(v, 3) for v in np.linspace(-x, x, len(columns) + 1)]
    for i, column in enumerate(columns):
        left, right = split[i], split[i + 1]
        room = (inner[0] if i == 0 else left + wall / 2,
                inner[1] if i == len(columns) - 1 else right - wall / 2)  # fmt: skip
        if i:
            divider = (left - wall / 2, left + wall / 2)
            builder.add(shell, box(divider, (face, y - wall), (foot + wall, height - wall)))
        builder.add(m.MACHINERY, box(room, (rear, y - wall), machine))
        front = (left + (_SEAM_M if i else 0), right - (_SEAM_M if i < len(columns) - 1 else 0))
        frame = _Frame(front, room, (-y, face, y - wall), (foot, height), rear, machine[1], wall)
        _add_compartments(builder, column, frame, shell)
    return builder.build()


def _add_insulation(builder: ModelBuilder, shell: m.Material, space: Space, wall: float) -> Bounds:
    """Walls around ``space``, open to the front; the bounds of what is left between the sides."""
    (x0, x1), body, (z0, z1) = space
    builder.add(shell, box((x0, x0 + wall), body, (z0, z1)), box((x1 - wall, x1), body, (z0, z1)))
    inner = (x0 + wall, x1 - wall)
    builder.add(shell, box(inner, body, (z0, z0 + wall)), box(inner, body, (z1 - wall, z1)))
    builder.add(shell, box(inner, (body[1] - wall, body[1]), (z0 + wall, z1 - wall)))
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
            builder.add(shell, box(frame.room, (face, back), (low - half, low + half)))
        inside = (low + (half if k else frame.wall), high - (frame.wall if last else half))
        space = (frame.room, (face, back), inside)
        tall = (low + (_SEAM_M if k else 0.0), high - (0.0 if last else _SEAM_M))
        panel = (frame.front, (start, face - CLEARANCE_M), tall)
        if row.kind == "drawer":
            _add_freezer_drawer(builder, panel, space, frame if k == 0 else None, shell)
            continue
        _add_glass_shelves(builder, space, frame.machine_top if k == 0 else 0.0)
        _add_doors(builder, panel, row.kind, shell)


def _add_glass_shelves(builder, space: Space, above: float) -> None:
    x, (y0, y1), (z0, z1) = space
    low = max(z0, above)
    count = max(0, round((z1 - low) / 0.3) - 1)
    levels = [low + round((z1 - low) * (k + 1) / (count + 1), 3) for k in range(count)]
    if above:
        levels.insert(0, above + 0.01)
    for z in levels:
        builder.add(m.GLASS, box(x, (y0 + 0.05, y1), (z - 0.003, z + 0.003)))


def _door_slab(panel: Space, free_side: int) -> Solid:
    """A slab whose rear edge is cut at its free end, so that it clears a neighbour in turning."""
    (x0, x1), (y0, y1), z = panel
    c = _CHAMFER_M
    if free_side > 0:
        outline = [(x0, y0), (x1, y0), (x1, y1 - c), (x1 - c, y1), (x0, y1)]
    else:
        outline = [(x0, y0), (x1, y0), (x1, y1), (x0 + c, y1), (x0, y1 - c)]
    return prism(outline, "z", z)


def _add_doors(builder: ModelBuilder, panel: Space, kind: str, shell: m.Material) -> None:
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
        hinge = (left if free > 0 else right, y[0], (z[0] + z[1]) / 2)
        builder.hinge(name, hinge, (0, 0, -free), OPEN_RAD, damping=1.0, friction=0.6)


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


def microwave(
    name: str,
    width: float = 0.48,
    depth: float = 0.38,
    height: float = 0.28,
    *,
    shell: m.Material = m.SHEET_BODY,
    panel: float = 0.12,
    plate: float = 0.125,
) -> CadModel:
    """A cavity behind a door with its hinge at the left, machinery behind a control panel."""
    builder = ModelBuilder("microwave", name, symmetry=1)
    x, y, t, door, foot = width / 2, depth / 2, 0.016, 0.032, 0.012
    face = -y + door + CLEARANCE_M
    edge = x - panel
    body = (face, y)
    builder.add(
        shell, box((-x, -x + t), body, (foot, height)), box((x - t, x), body, (foot, height))
    )
    inner = (-x + t, x - t)
    builder.add(shell, box(inner, body, (foot, foot + t)), box(inner, body, (height - t, height)))
    room = (foot + t, height - t)
    builder.add(shell, box(inner, (y - t, y), room))
    builder.add(shell, box((edge - t, edge), (face, y - t), room))
    builder.add(m.MACHINERY, box((edge, x - t), (face, y - t), room))
    builder.add(m.SCREEN, box((edge + 0.0015, x), (-y, face), (foot, height)))
    center = ((-x + t + edge - t) / 2, (face + y - t) / 2)
    builder.add(m.GLASS, frustum((plate, plate), (room[0], room[0] + 0.006), center))
    for sx in (-1, 1):
        for sy in (face + 0.03, y - 0.03):
            cx = sx * (x - 0.04)
            leg = box((cx - 0.012, cx + 0.012), (sy - 0.012, sy + 0.012), (0.0, foot))
            builder.add(m.PLASTIC, leg)
    slab = ((-x, edge - 0.0015), (-y, -y + door), (foot, height))
    _add_window_door(builder, slab, shell)
    return builder.build()


def _add_window_door(builder: ModelBuilder, slab: Space, shell: m.Material) -> None:
    """A door of dark glass in a frame, hinge at the left."""
    (x0, x1), (y0, y1), (z0, z1) = slab
    rim, c = 0.03, 0.012
    link = "door_1"
    outer = [(x1 - rim, y0), (x1, y0), (x1, y1 - c), (x1 - c, y1), (x1 - rim, y1)]
    builder.add(shell, box((x0, x0 + rim), (y0, y1), (z0, z1)), link=link)
    builder.add(shell, prism(outer, "z", (z0, z1)), link=link)
    middle = (x0 + rim, x1 - rim)
    builder.add(shell, box(middle, (y0, y1), (z0, z0 + rim)), link=link)
    builder.add(shell, box(middle, (y0, y1), (z1 - rim, z1)), link=link)
    builder.add(m.SCREEN, box(middle, (y0, y1), (z0 + rim, z1 - rim)), link=link)
    at = (x1 - rim / 2, y0, (z0 + z1) / 2)
    add_bar_handle(builder, at, 0.6 * (z1 - z0), upright=True, link=link)
    builder.hinge(link, (x0, y0, (z0 + z1) / 2), (0, 0, -1), OPEN_RAD, damping=0.1, friction=0.2)


def monitor(
    name: str,
    width: float,
    height: float,
    *,
    lift: float = 0.12,
    thickness: float = 0.045,
    stand: Literal["plate", "feet"] = "plate",
    shell: m.Material = m.DISPLAY_SHELL,
) -> CadModel:
    """A screen of ``width`` x ``height``, its lower edge ``lift`` above what it stands on."""
    builder = ModelBuilder("monitor", name, symmetry=1)
    x, rim = width / 2, 0.004
    z = (lift, lift + height)
    middle = 0.6 * thickness
    screen = box((-x + 0.008, x - 0.008), (-rim, 0.0), (z[0] + 0.008, z[1] - 0.008))
    builder.add(m.SCREEN, screen)
    builder.add(shell, box((-x, x), (0.0, middle), z))
    back = box((-0.7 * x, 0.7 * x), (middle, thickness), (z[0] + 0.1 * height, z[0] + 0.8 * height))
    builder.add(shell, back)
    if stand == "plate":
        half, deep = min(0.14, 0.5 * x), 0.1
        builder.add(m.STEEL, box((-half, half), (-deep, deep + 0.02), (0.0, 0.004)), carries=False)
        neck = (thickness, thickness + 0.03)
        builder.add(shell, box((-0.03, 0.03), neck, (0.004, z[0] + 0.5 * height)))
        return builder.build()
    for side in (-1, 1):
        c = side * 0.72 * x
        span = (c - 0.015, c + 0.015)
        builder.add(shell, box(span, (-0.1, 0.13), (0.0, 0.012)), carries=False)
        builder.add(shell, box(span, (0.0, middle), (0.012, lift)))
    return builder.build()
