"""Boxes: cartons with flaps, storage boxes with a lid, trays and crates.

Cartons are of corrugated board of 4 mm (FEFCO 0201: the flaps are as long as half the shorter
side, so that the long ones meet in the middle); storage boxes and Euro containers are 0.2 x 0.3 m
to 0.4 x 0.6 m (600 x 400 mm and its fractions, as EN 13199 has them), with walls of 2.5 mm;
crates are of 9 mm pine.
"""

from __future__ import annotations

import math
from typing import Literal

import numpy as np

from .. import materials as m
from ..builder import ModelBuilder
from ..shapes.strips import strip
from ..solids import Solid, between, box, tube

_GAP_M = 0.003
_FLAP_RAD = 3.6
"""A flap laid back: it hangs outside, a little off the wall."""
_HANG_RAD = 0.6
"""Flaps of an open carton hang so much below the level."""
_SHUT_RAD = 1.9
"""They close until they are a little short of upright, where all four still pass each other."""


def _walls(
    half: tuple[float, float], z: tuple[float, float], wall: float, floor: float
) -> list[Solid]:
    """Floor and four upright walls of a box open at the top."""
    x, y = half
    inner = (z[0] + floor, z[1])
    solids = [box((-x, x), (-y, y), (z[0], inner[0]))]
    for side in (-1, 1):
        solids.append(box(between(side * x, side * (x - wall)), (-y, y), inner))
        solids.append(box((-x + wall, x - wall), between(side * y, side * (y - wall)), inner))
    return solids


def carton(
    width: float,
    depth: float,
    height: float,
    *,
    board: float = 0.004,
    material: m.Material = m.CARDBOARD,
    inside: m.Material = m.CARDBOARD_INSIDE,
) -> ModelBuilder:
    """A carton closed by two long flaps, which open outwards, over two short ones folded in."""
    builder = ModelBuilder("box", symmetry=2)
    x, y, t = width / 2, depth / 2, board
    under = height - t - _GAP_M
    builder.add(material, *_walls((x, y), (0.0, under), t, t))
    short = min(x, y) - 2 * t
    for side in (-1, 1):
        across = between(side * (x - t), side * (x - t - short))
        builder.add(inside, box(across, (-y + t, y - t), (under - t, under)))
        name = f"flap_{1 if side < 0 else 2}"
        along = between(side * y, side * _GAP_M / 2)
        builder.add(material, box((-x, x), along, (height - t, height)), link=name)
        edge, grip = (0.0, side * y, height), (0.0, side * _GAP_M / 2, height)
        builder.hinge(name, edge, (-side, 0, 0), _FLAP_RAD, damping=0.005, friction=0.003, at=grip)
    return builder


def open_carton(
    width: float,
    depth: float,
    height: float,
    *,
    board: float = 0.004,
    material: m.Material = m.CARDBOARD,
) -> ModelBuilder:
    """A carton open at the top, its four flaps hanging out; they turn up until nearly upright.

    The box is around the flaps too.
    """
    builder = ModelBuilder("box", symmetry=4 if width == depth else 2)
    t, c, s = board, math.cos(_HANG_RAD), math.sin(_HANG_RAD)
    flap = 0.5 * (min(width, depth) - 2 * t * s) / (1 + c)
    out = flap * c + t * s
    x, y, edge = round(width / 2 - out, 6), round(depth / 2 - out, 6), height - t * c
    builder.add(material, *_walls((x, y), (0.0, edge - _GAP_M), t, t))
    # The middle of a flap from its hinge outwards: (outwards, up).
    middle = [(-0.5 * t * s, 0.5 * t * c), (-0.5 * t * s - flap * c, 0.5 * t * c - flap * s)]
    spare = t + _GAP_M
    ends: tuple[tuple[Literal["x", "y"], float, float], ...] = (("x", y, x), ("y", x, y - spare))
    for k, (along, half, span) in enumerate(ends):
        for side in (-1, 1):
            name = f"flap_{2 * k + (1 if side < 0 else 2)}"
            path = [(side * (half - back), edge + up) for back, up in middle]
            builder.add(material, *strip(path, t, along, (-span, span)), link=name)
            at_y, at_x = (0.0, side * half, edge), (side * half, 0.0, edge)
            origin, axis = (at_y, (side, 0, 0)) if along == "x" else (at_x, (0, -side, 0))
            builder.hinge(name, origin, axis, _SHUT_RAD, damping=0.005, friction=0.003)
    return builder


def storage_box(
    width: float,
    depth: float,
    height: float,
    *,
    lid: float = 0.03,
    wall: float = 0.0025,
    material: m.Material = m.WHITE_PLASTIC,
    lid_material: m.Material = m.GREY_LID,
    latch: bool = True,
    opening_rad: float = 1.85,
) -> ModelBuilder:
    """A box under a lid hinged at its rear edge; a latch stands out at the front, as a handle.

    Beyond the upright the lid's weight holds it open; that of a light box would tip it over.
    """
    builder = ModelBuilder("box", symmetry=1 if latch else 2)
    x, y, top = width / 2, depth / 2, height - lid
    lip = 0.006
    builder.add(material, *_walls((x - lip, y - lip), (0.0, top - _GAP_M), wall, 2 * wall))
    rim = 0.45 * lid
    builder.add(lid_material, box((-x, x), (-y, y), (top, top + rim)), link="lid")
    crown = box((-x + 0.02, x - 0.02), (-y + 0.02, y - 0.02), (top + rim, height))
    builder.add(lid_material, crown, link="lid")
    if latch:
        half = min(0.04, 0.3 * x)
        hook = box((-half, half), (-y - 0.012, -y), (top - 0.02, top + rim))
        builder.add(lid_material, hook, link="lid", handle=True)
    grip = None if latch else (0.0, -y, top)
    builder.hinge(
        "lid", (0.0, y, top), (-1, 0, 0), opening_rad, damping=0.02, friction=0.01, at=grip
    )
    return builder


def tray(
    width: float,
    depth: float,
    height: float,
    *,
    wall: float = 0.0025,
    rim: float = 0.012,
    taper: float = 0.94,
    material: m.Material = m.GREY_PLASTIC,
) -> ModelBuilder:
    """An open stacking container: four walls that lean out to a rim ``rim`` wide."""
    builder = ModelBuilder("box", symmetry=4 if width == depth else 2)
    corners = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)], np.float64)
    half, band = np.array([width / 2, depth / 2]), 0.025
    upper, lower = half - rim, (half - rim) * taper
    floor = 2 * wall
    (x, y) = lower
    builder.add(material, box((-x, x), (-y, y), (0.0, floor)))
    outer = np.round([corners * lower, corners * upper], 6)
    builder.add(material, *tube(outer, outer - wall * corners, (floor, height - band)))
    edge = np.round([corners * half, corners * half], 6)
    # A little wider than the wall below: no edge belongs to both.
    inner = np.round([corners * (upper - wall + 0.0005)] * 2, 6)
    builder.add(material, *tube(edge, inner, (height - band, height)))
    return builder


def crate(
    width: float,
    depth: float,
    height: float,
    *,
    slats: int = 3,
    board: float = 0.009,
    gap: float = 0.012,
    material: m.Material = m.PINE,
) -> ModelBuilder:
    """A wooden crate: ``slats`` boards above one another on each side, nailed to corner posts."""
    builder = ModelBuilder("box", symmetry=4 if width == depth else 2)
    x, y, t, post = width / 2, depth / 2, board, 0.022
    builder.add(material, box((-x + t, x - t), (-y + t, y - t), (0.0, t)))
    for sx in (-1, 1):
        for sy in (-1, 1):
            px, py = (
                between(sx * (x - t), sx * (x - t - post)),
                between(sy * (y - t), sy * (y - t - post)),
            )
            builder.add(material, box(px, py, (t, height)))
    tall = (height - (slats - 1) * gap) / slats
    for k in range(slats):
        low = round(k * (tall + gap), 5)
        z = (low, height if k == slats - 1 else round(low + tall, 5))
        for side in (-1, 1):
            builder.add(material, box((-x, x), between(side * y, side * (y - t)), z))
            builder.add(material, box(between(side * x, side * (x - t)), (-y + t, y - t), z))
    return builder
