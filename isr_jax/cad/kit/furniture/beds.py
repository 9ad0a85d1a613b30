"""Beds.

Mattresses are 1.9 to 2.0 m long (1.2 to 1.6 m for children), 0.8 to 1.8 m wide (EN 1334) and 0.1
to 0.25 m thick; one lies 0.4 to 0.6 m above the floor; headboards end at 0.8 to 1.2 m.
"""

from __future__ import annotations

import itertools

import numpy as np

from .. import materials as m
from ..builder import ModelBuilder
from ..solids import Solid, between, box, prism, split
from .fronts import Look
from .sofas import cushion

_RAIL_M = 0.03
_END_M = 0.04
_PILLOW_M = 0.1


def bed(
    width: float,
    depth: float,
    height: float,
    *,
    lying: float = 0.5,
    mattress: float = 0.2,
    footboard: float = 0.0,
    frame: m.Material = m.OAK,
    pillows: int = 1,
    side_back: float = 0.0,
    slatted: bool = False,
    blanket: m.Material | None = None,
    drawers: int = 0,
) -> ModelBuilder:
    """A mattress in a frame on legs; the headboard, ``height`` high, at +y, feet to -y.

    ``lying`` is the height of the mattress' top; a daybed has a ``side_back`` along +x; drawers
    below the mattress draw out to both sides.
    """
    builder = ModelBuilder("bed", symmetry=1)
    x, y, rail = width / 2 - _RAIL_M, depth / 2 - _END_M, _RAIL_M
    low = lying - mattress
    rails = (max(0.1, low - 0.14), low + 0.06)
    if drawers:
        rails = (low - 0.05, low + 0.06)
    for side in (-1, 1):
        span = between(side * x, side * (x + rail))
        builder.add(frame, box(span, (-y, y), rails), carries=False)
    builder.add(m.SLATS, box((-x, x), (-y, y), (low - 0.02, low)))
    builder.add(m.MATTRESS, *cushion((-x, x), (-y, y), (low, lying), 0.02))
    foot = 0.03 if drawers else rails[0]
    ends = ((1, height), (-1, max(footboard, rails[1])))
    for end, top in ends:
        span = between(end * y, end * (y + _END_M))
        across = (-x - rail, x + rail)
        if slatted and top > rails[1] + 0.15:
            _add_slatted_board(builder, frame, across, span, (foot, top))
        else:
            builder.add(frame, box(across, span, (foot, top)), carries=False)
        for side in (-1, 1):
            leg = between(side * (x + rail), side * (x + rail - 0.06))
            builder.add(frame, box(leg, span, (0.0, foot)))
    if side_back:
        builder.add(frame, box((x, x + rail), (-y, y), (rails[1], side_back)), carries=False)
    if drawers:
        builder.add(m.PLINTH, box((-0.012, 0.012), (-y, y), (0.0, low - 0.02)), carries=False)
        _add_drawers(builder, frame, (x + rail, y), (0.03, rails[0]), drawers)
    add_bedding(builder, pillows, x, (-y, y), lying, blanket)
    return builder


def _add_slatted_board(builder, frame, across, depth, z) -> None:
    """Two posts, rails above and below, and upright bars between them."""
    (x0, x1), (z0, z1), t = across, z, 0.06
    for post in ((x0, x0 + t), (x1 - t, x1)):
        builder.add(frame, box(post, depth, z), carries=False)
    inner = (x0 + t, x1 - t)
    low = (z0, z0 + min(0.24, 0.5 * (z1 - z0)))
    builder.add(frame, box(inner, depth, low), carries=False)
    builder.add(frame, box(inner, depth, (z1 - 0.06, z1)), carries=False)
    add_bars(builder, frame, inner, depth, (low[1], z1 - 0.06), 0.1)


def add_bars(builder, frame, across, depth, z, pitch: float, bar: float = 0.022) -> None:
    """Upright bars at about ``pitch`` between two rails, set back in their thickness."""
    (a, b), (y0, y1) = across, depth
    count = max(1, round((b - a) / pitch) - 1)
    inset = min(0.008, 0.25 * (y1 - y0))
    for k in range(count):
        c = a + round((b - a) * (k + 1) / (count + 1), 4)
        builder.add(frame, box((c - bar / 2, c + bar / 2), (y0 + inset, y1 - inset), z))


def _add_drawers(builder, frame, half, z, count: int) -> None:
    """Drawers on castors under the bed, in a row at either side."""
    (x, y), (low, high) = half, z
    edges = split(-y, y, count)
    look = Look(m.SLATS, frame)
    for side in (-1, 1):
        for a, b in itertools.pairwise(edges):
            _add_side_drawer(builder, look, side, x, (a + 0.004, b - 0.004), (low, high - 0.004))


def _add_side_drawer(builder, look: Look, side: int, x: float, along, z) -> None:
    name = f"drawer_{sum(n.startswith('drawer') for n in builder.links) + 1}"
    (y0, y1), (z0, z1), t = along, z, 0.012
    end = 0.03
    outer = between(side * x, side * (x - 0.018))
    builder.add(look.front, box(outer, along, z), link=name)
    inner = x - 0.018
    top = z0 + round(0.7 * (z1 - z0), 3)
    depth = between(side * inner, side * end)
    wall = (z0 + 0.01, top)
    for a, b in ((y0 + 0.01, y0 + 0.01 + t), (y1 - 0.01 - t, y1 - 0.01)):
        builder.add(look.board, box(depth, (a, b), wall), link=name)
    between_walls = (y0 + 0.01 + t, y1 - 0.01 - t)
    back = between(side * end, side * (end + t))
    builder.add(look.board, box(back, between_walls, wall), link=name)
    floor = between(side * (end + t), side * inner)
    builder.add(look.board, box(floor, between_walls, (z0 + 0.01, z0 + 0.022)), link=name)
    middle, grip = (y0 + y1) / 2, z1 - 0.04
    for a, b, c, d in (
        (-0.07, 0.07, 0.023, 0.035),
        (-0.07, -0.058, 0, 0.023),
        (0.058, 0.07, 0, 0.023),
    ):
        bar = between(side * (x + c), side * (x + d))
        solid = box(bar, (middle + a, middle + b), (grip - 0.006, grip + 0.006))
        builder.add(look.handle, solid, link=name, handle=True)
    builder.slide(name, (side, 0, 0), round(0.75 * (inner - end), 2))


def add_bedding(
    builder: ModelBuilder,
    pillows: int,
    x: float,
    along: tuple[float, float],
    lying: float,
    blanket: m.Material | None,
) -> None:
    """Pillows in a row at the head, and a blanket over the rest, between -x and x."""
    y0, y = along
    step = 2 * x / max(pillows, 1)
    for k in range(pillows):
        center, wide = -x + (k + 0.5) * step, min(0.32, 0.42 * step)
        across = (round(center - wide, 3), round(center + wide, 3))
        pillow = pillow_solid(across, (y - 0.45, y - 0.05), (lying, lying + _PILLOW_M))
        builder.add(m.PILLOW, pillow, carries=False)
    if blanket:
        spread = ((-x + 0.02, x - 0.02), (y0 + 0.02, y - 0.62), (lying, lying + 0.03))
        builder.add(blanket, *cushion(*spread, 0.015))


def pillow_solid(x, y, z) -> Solid:
    """A pillow, thin at its front edge."""
    (y0, y1), (z0, z1) = y, z
    outline = [
        (y0 + 0.02, z0),
        (y1, z0),
        (y1, z1 - 0.02),
        (y1 - 0.06, z1),
        (y1 - 0.16, z1),
        (y0, z0 + 0.03),
    ]
    return prism(np.round(outline, 6), "x", x)


def divan(
    width: float,
    depth: float,
    height: float,
    *,
    lying: float = 0.58,
    headboard: bool = True,
    fabric: m.Material = m.GREY_FABRIC,
    pillows: int = 2,
    blanket: m.Material | None = None,
    padded: int = 0,
) -> ModelBuilder:
    """A mattress on an upholstered box; ``height`` is that of the headboard, or of the pillows.

    ``padded``: panels of cushions on the headboard, side by side.
    """
    builder = ModelBuilder("bed", symmetry=1)
    x, foot = width / 2, 0.05
    thick = 0.09 if headboard else 0.0
    y0, y1 = -depth / 2, depth / 2 - thick
    lying = lying if headboard else height - (_PILLOW_M if pillows else 0.0)
    spring = lying - min(0.24, 0.45 * lying)
    builder.add(fabric, box((-x, x), (y0, y1), (foot, spring)))
    builder.add(m.MATTRESS, *cushion((-x, x), (y0, y1), (spring, lying), 0.02))
    if headboard:
        back = (y1 + 0.04, y1 + thick) if padded else (y1, y1 + thick)
        builder.add(fabric, box((-x, x), back, (foot, height)), carries=False)
        edges = split(-x, x, padded) if padded else []
        for a, b in itertools.pairwise(edges):
            span = (a + 0.002, b - 0.002)
            builder.add(fabric, box(span, (y1, y1 + 0.04), (foot, height)), carries=False)
    for side in (-1, 1):
        for cy in (y0 + 0.08, y1 - 0.08):
            cx = side * (x - 0.08)
            leg = box((cx - 0.03, cx + 0.03), (cy - 0.03, cy + 0.03), (0.0, foot))
            builder.add(m.BLACK_WOOD, leg)
    add_bedding(builder, pillows, x, (y0, y1), lying, blanket)
    return builder
