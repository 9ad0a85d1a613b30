"""Tables.

Dining tables are 0.72 to 0.76 m high and give each guest 0.6 m by 0.4 m (DIN 68885 and makers'
catalogues); coffee tables are 0.35 to 0.50 m high, side tables 0.45 to 0.6 m, consoles 0.75 to
0.9 m, bar tables 1.0 to 1.1 m. Tops are 18 to 40 mm thick.
"""

from __future__ import annotations

import dataclasses

import numpy as np

from .. import materials as m
from ..builder import ModelBuilder
from ..solids import ROUND_SIDES, between, box, frustum, tapered_box
from .fronts import Column, Look, add_carcass

_TOP_SIDES = 32
"""Of round tops at most: a hull has no more than 64 vertices."""


def rectangular_table(
    width: float,
    depth: float,
    height: float,
    *,
    top: float = 0.028,
    leg: float = 0.06,
    overhang: float = 0.02,
    apron: float = 0.09,
    frame: m.Material = m.OAK,
    top_material: m.Material | None = None,
    shelf: float | None = None,
) -> ModelBuilder:
    """Four square legs joined by aprons; ``shelf`` is the height of a board between the legs."""
    builder = ModelBuilder("table", symmetry=4 if width == depth else 2)
    x, y, under = width / 2, depth / 2, height - top
    builder.add(top_material or frame, box((-x, x), (-y, y), (under, height)))
    lx, ly = x - overhang, y - overhang
    for sx in (-1, 1):
        for sy in (-1, 1):
            bx, by = between(sx * lx, sx * (lx - leg)), between(sy * ly, sy * (ly - leg))
            builder.add(frame, box(bx, by, (0.0, under)))
    if apron:
        add_aprons(builder, frame, lx, ly, leg, (under - apron, under))
    if shelf is not None:
        inner = ((-lx + leg, lx - leg), (-ly + leg, ly - leg))
        builder.add(frame, box(*inner, (shelf - 0.018, shelf)))
    return builder


def add_aprons(
    builder: ModelBuilder, frame: m.Material, lx: float, ly: float, leg: float, z
) -> None:
    """Boards between the legs under a top."""
    board, inset = 0.02, leg / 2
    for side in (-1, 1):
        cy, cx = side * (ly - inset), side * (lx - inset)
        along = (-lx + leg, lx - leg)
        across = (-ly + leg, ly - leg)
        builder.add(frame, box(along, (cy - board / 2, cy + board / 2), z))
        builder.add(frame, box((cx - board / 2, cx + board / 2), across, z))


def drawer_table(
    width: float,
    depth: float,
    height: float,
    *,
    columns: tuple[Column, ...],
    body: float = 0.13,
    top: float = 0.025,
    leg: float = 0.05,
    look: Look | None = None,
    frame: m.Material = m.OAK,
    shelf: float | None = None,
    class_name: str = "table",
) -> ModelBuilder:
    """A top on four legs with drawers between the front ones; ``body`` is how high they are."""
    look = look or Look(m.OAK_BOARD, m.OAK_BOARD, m.BLACK_TUBE)
    builder = ModelBuilder(class_name, symmetry=1)
    x, y, under = width / 2, depth / 2, height - top
    builder.add(frame, box((-x, x), (-y, y), (under, height)))
    lx, ly = x - 0.01, y - 0.01
    for sx in (-1, 1):
        for sy in (-1, 1):
            bx, by = between(sx * lx, sx * (lx - leg)), between(sy * ly, sy * (ly - leg))
            builder.add(frame, box(bx, by, (0.0, under)))
    inner = (-lx + leg, lx - leg)
    look = dataclasses.replace(look, covered=True, beside=True)
    add_carcass(builder, (inner, (-ly, ly), (under - body, under)), columns, look)
    if shelf is not None:
        builder.add(frame, box(inner, (-ly, ly), (shelf - 0.018, shelf)))
    return builder


def round_table(
    width: float,
    depth: float,
    height: float,
    *,
    top: float = 0.026,
    column: float = 0.045,
    foot: float = 0.5,
    material: m.Material = m.BIRCH,
    frame: m.Material = m.BLACK_TUBE,
    sides: int = ROUND_SIDES,
) -> ModelBuilder:
    """A round or oval top on one column; the foot plate is ``foot`` times as wide as the top."""
    builder = ModelBuilder("table", symmetry=0 if width == depth else 2)
    x, y, under = width / 2, depth / 2, height - top
    many = min(2 * sides, _TOP_SIDES)
    builder.add(material, frustum(((x, y), (x, y)), (under, height), sides=many))
    builder.add(frame, frustum((column, column), (0.03, under), sides=sides))
    plate = [(f * foot * x, f * foot * y) for f in (1.0, 0.97)]
    builder.add(m.STEEL, frustum((plate[0], plate[1]), (0.0, 0.012), sides=many), carries=False)
    builder.add(frame, frustum((column * 2, column), (0.012, 0.03), sides=sides))
    return builder


def drum_table(
    width: float,
    depth: float,
    height: float,
    *,
    top: float = 0.022,
    legs: int = 4,
    splay: float = 0.14,
    material: m.Material = m.OAK,
    frame: m.Material | None = None,
    shelf: bool = False,
    sides: int = ROUND_SIDES,
) -> ModelBuilder:
    """A round or oval top on tapered legs, below it if wished a smaller one."""
    symmetry = {3: 1, 4: 4 if width == depth else 2}[legs]
    builder = ModelBuilder("table", symmetry=symmetry)
    x, y, under = width / 2, depth / 2, height - top
    builder.add(
        material, frustum(((x, y), (x, y)), (under, height), sides=min(2 * sides, _TOP_SIDES))
    )
    turn = np.pi / 2 + (np.pi / 4 if legs == 4 else 0.0)
    for k in range(legs):
        c, s = np.cos(turn + 2 * np.pi * k / legs), np.sin(turn + 2 * np.pi * k / legs)
        rows = []
        for share, r in ((0.9, 0.014), (0.9 - splay, 0.021)):
            cx, cy = round((share * x - 0.03) * c, 4), round((share * y - 0.03) * s, 4)
            rows.append((cx - r, cx + r, cy - r, cy + r))
        builder.add(frame or material, tapered_box(rows[0], rows[1], (0.0, under)))
    if shelf:
        # Its edge touches no leg: it stands on a cross between them, seen only from below.
        level, small = round(0.4 * height, 3), (0.55 * x, 0.55 * y)
        builder.add(
            material,
            frustum((small, small), (level, level + 0.016), sides=min(2 * sides, _TOP_SIDES)),
        )
        post = frustum((0.012, 0.012), (level + 0.016, under), sides=sides)
        builder.add(frame or material, post)
    return builder


def trestle_table(
    width: float,
    depth: float,
    height: float,
    *,
    top: float = 0.032,
    material: m.Material = m.PINE,
) -> ModelBuilder:
    """A top on two end panels with feet, tied by a beam."""
    builder = ModelBuilder("table", symmetry=2)
    x, y, under = width / 2, depth / 2, height - top
    builder.add(material, box((-x, x), (-y, y), (under, height)))
    panel, half, foot = 0.04, 0.3 * depth, 0.05
    inset = 0.22 * min(width, 1.2)
    for side in (-1, 1):
        center = side * (x - inset)
        across = (center - panel / 2, center + panel / 2)
        builder.add(material, box(across, (-half, half), (foot, under)))
        feet = (center - panel, center + panel)
        along = (-0.42 * depth, 0.42 * depth)
        builder.add(material, box(feet, along, (0.0, foot)), carries=False)
    inner = x - inset - panel / 2
    beam = (0.32 * height, 0.32 * height + 0.1)
    builder.add(material, box((-inner, inner), (-0.018, 0.018), beam))
    return builder


def tapered_leg_table(
    width: float,
    depth: float,
    height: float,
    *,
    top: float = 0.022,
    material: m.Material = m.WALNUT,
    frame: m.Material | None = None,
) -> ModelBuilder:
    """A thin top on legs that splay outwards and taper, as made since the 1950s."""
    builder = ModelBuilder("table", symmetry=4 if width == depth else 2)
    x, y, under = width / 2, depth / 2, height - top
    builder.add(material, box((-x, x), (-y, y), (under, height)))
    for sx in (-1, 1):
        for sy in (-1, 1):
            foot, head = (sx * (x - 0.04), sy * (y - 0.04)), (sx * (x - 0.12), sy * (y - 0.12))
            rows = [
                (cx - r, cx + r, cy - r, cy + r) for (cx, cy), r in ((foot, 0.016), (head, 0.028))
            ]
            builder.add(frame or material, tapered_box(rows[0], rows[1], (0.0, under)))
    return builder


def frame_table(
    width: float,
    depth: float,
    height: float,
    *,
    top: float = 0.035,
    bar: float = 0.05,
    inset: float = 0.12,
    material: m.Material = m.OAK,
    frame: m.Material = m.BLACK_TUBE,
    shelf: float | None = None,
) -> ModelBuilder:
    """A top on two rectangular frames of steel, open in the middle; or a ``shelf`` on them."""
    builder = ModelBuilder("table", symmetry=2)
    x, y, under = width / 2, depth / 2, height - top
    builder.add(material, box((-x, x), (-y, y), (under, height)))
    ends, half = y - 0.05, bar / 2
    for side in (-1, 1):
        c = side * (x - inset)
        span = (c - half, c + half)
        for sy in (-1, 1):
            by = between(sy * ends, sy * (ends - 0.03))
            builder.add(frame, box(span, by, (0.0, under)))
        inner = (-ends + 0.03, ends - 0.03)
        builder.add(frame, box(span, inner, (0.0, 0.03)), carries=False)
        builder.add(frame, box(span, inner, (under - 0.03, under)))
    if shelf is not None:
        between_frames = (-x + inset + half, x - inset - half)
        builder.add(material, box(between_frames, (-ends, ends), (shelf - 0.022, shelf)))
    return builder


def pedestal_table(
    width: float,
    depth: float,
    height: float,
    *,
    top: float = 0.03,
    material: m.Material = m.WALNUT,
    frame: m.Material | None = None,
) -> ModelBuilder:
    """A rectangular top on a square column over a cross of two feet."""
    builder = ModelBuilder("table", symmetry=4 if width == depth else 2)
    x, y, under, r, t = width / 2, depth / 2, height - top, 0.045, 0.05
    under_top = under - 0.03
    stem = frame or material
    builder.add(material, box((-x, x), (-y, y), (under, height)))
    for reach, z in ((0.72, (0.0, t)), (0.5, (under_top, under))):
        builder.add(stem, box((-r, r), (-reach * y, reach * y), z), carries=False)
        for side in (-1, 1):
            builder.add(stem, box(between(side * r, side * reach * x), (-r, r), z), carries=False)
    builder.add(stem, box((-r, r), (-r, r), (t, under_top)))
    return builder
