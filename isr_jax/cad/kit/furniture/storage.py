"""Cabinets, wall cabinets, counters, nightstands and drawer units: bodies with fronts.

Kitchen base units are 0.72 m on a plinth of 0.08 to 0.15 m, 0.56 m deep plus fronts, in widths
of 0.3 to 1.2 m; wall units are 0.35 to 0.4 m deep and 0.35 to 0.9 m high; worktops stand 0.86 to
0.94 m high and 0.6 to 0.65 m deep (EN 1116). Nightstands are 0.35 to 0.55 m wide and 0.45 to
0.65 m high, chests of drawers 0.4 to 0.5 m deep and 0.7 to 1.3 m high (makers' catalogues).
"""

from __future__ import annotations

import dataclasses
from typing import Literal

from .. import materials as m
from ..builder import ModelBuilder
from ..solids import Solid, box, circle, prism, tapered_box
from .fronts import Column, Look, add_carcass

_TOP_M = 0.022
_CASTOR_M = 0.05
Stand = Literal["square", "tapered", "castors", "sled"]


def cabinet(
    width: float,
    depth: float,
    height: float,
    *,
    columns: tuple[Column, ...],
    look: Look | None = None,
    plinth: float = 0.08,
    top: m.Material | None = None,
    feet: float = 0.0,
    stand: Stand = "square",
    foot_material: m.Material = m.BLACK_TUBE,
    class_name: str = "cabinet",
) -> ModelBuilder:
    """A hollow body with doors and drawers on a plinth or feet, with a separate top if given."""
    look = dataclasses.replace(look or Look(), covered=top is not None)
    builder = ModelBuilder(class_name, symmetry=1)
    x, y = width / 2, depth / 2
    low = max(plinth, feet)
    high = height - (_TOP_M if top else 0.0)
    if top:
        builder.add(top, box((-x, x), (-y, y), (high, height)))
    if plinth:
        builder.add(m.PLINTH, box((-x + 0.01, x - 0.01), (-y + 0.06, y - 0.02), (0.0, plinth)))
    elif feet:
        add_feet(builder, (x, y), feet, stand, foot_material)
    add_carcass(builder, ((-x, x), (-y, y), (low, high)), columns, look)
    return builder


def add_feet(
    builder: ModelBuilder,
    half: tuple[float, float],
    height: float,
    stand: Stand,
    material: m.Material,
) -> None:
    """Four feet near the corners of a body of half-widths ``half``, or two runners."""
    x, y = half
    if stand == "sled":
        _add_runners(builder, half, height, material)
        return
    cy = (-y + 0.06, y - 0.06)
    for cx in (-x + 0.06, x - 0.06):
        for c in cy:
            builder.add(m.CASTOR if stand == "castors" else material, *_foot(cx, c, height, stand))


def _foot(cx: float, cy: float, height: float, stand: Stand) -> list[Solid]:
    if stand == "castors":
        disc = circle(_CASTOR_M / 2, 16, (cy, _CASTOR_M / 2))
        wheel = prism(disc, "x", (cx - 0.012, cx + 0.012))
        wheel = dataclasses.replace(wheel, curved=frozenset(range(len(disc))))
        fork = box((cx - 0.016, cx + 0.016), (cy - 0.016, cy + 0.016), (_CASTOR_M, height))
        return [wheel, fork]
    radii = (0.011, 0.02) if stand == "tapered" else (0.02, 0.02)
    rows = [(cx - r, cx + r, cy - r, cy + r) for r in radii]
    return [tapered_box(rows[0], rows[1], (0.0, height))]


def _add_runners(builder, half, height: float, material) -> None:
    """Frames of flat bar at both ends, from front to rear."""
    (x, y), bar = half, 0.025
    for cx in (-x + 0.08, x - 0.08):
        across = (cx - bar / 2, cx + bar / 2)
        builder.add(material, box(across, (-y + 0.05, y - 0.03), (0.0, bar)))
        for a, b in ((-y + 0.05, -y + 0.05 + bar), (y - 0.03 - bar, y - 0.03)):
            builder.add(material, box(across, (a, b), (bar, height)))


def wall_cabinet(
    width: float,
    depth: float,
    height: float,
    *,
    columns: tuple[Column, ...],
    look: Look | None = None,
    shelf_spacing: float = 0.26,
) -> ModelBuilder:
    """A hollow body that hangs on a wall by its back."""
    builder = ModelBuilder("wall_cabinet", symmetry=1)
    x, y = width / 2, depth / 2
    look = dataclasses.replace(look or Look(), shelf_spacing=shelf_spacing)
    # Fronts see that it hangs and put handles low.
    add_carcass(builder, ((-x, x), (-y, y), (1.4, 1.4 + height)), columns, look)
    return builder


def counter(
    width: float,
    depth: float,
    height: float,
    *,
    columns: tuple[Column, ...],
    look: Look | None = None,
    worktop: m.Material = m.LAMINATE,
    plinth: float = 0.1,
    thickness: float = 0.038,
    upstand: float = 0.0,
    overhang: float = 0.0,
) -> ModelBuilder:
    """Base units in a row under one worktop that overhangs the fronts by 20 mm.

    ``height`` includes the ``upstand`` at the rear; with an ``overhang`` at the rear, on a panel
    at either end, people sit there.
    """
    look = dataclasses.replace(look or Look(), covered=True)
    builder = ModelBuilder("counter", symmetry=1)
    x, y = width / 2, depth / 2
    top = height - upstand
    under = top - thickness
    rear = y - overhang
    builder.add(worktop, box((-x, x), (-y, y), (under, top)))
    builder.add(m.PLINTH, box((-x, x), (-y + 0.07, rear - 0.05), (0.0, plinth)))
    add_carcass(builder, ((-x, x), (-y + 0.02, rear), (plinth, under)), columns, look)
    if upstand:
        builder.add(worktop, box((-x, x), (y - 0.02, y), (top, height)), carries=False)
    if overhang:
        for end in ((-x, -x + 0.03), (x - 0.03, x)):
            builder.add(look.board, box(end, (rear, y - 0.02), (0.0, under)))
    return builder


def leg_nightstand(
    width: float,
    depth: float,
    height: float,
    *,
    columns: tuple[Column, ...],
    look: Look | None = None,
    leg: float = 0.035,
    body: float = 0.2,
    shelf: bool = True,
    class_name: str = "nightstand",
) -> ModelBuilder:
    """A low body with drawers between four legs under a top, a board between the legs below."""
    look = dataclasses.replace(look or Look(), covered=True, beside=True)
    builder = ModelBuilder(class_name, symmetry=1)
    x, y = width / 2, depth / 2
    under = height - _TOP_M
    builder.add(look.board, box((-x, x), (-y, y), (under, height)))
    for sx in (-1, 1):
        for sy in (-1, 1):
            cx, cy = sx * (x - 0.01 - leg / 2), sy * (y - 0.01 - leg / 2)
            post = box((cx - leg / 2, cx + leg / 2), (cy - leg / 2, cy + leg / 2), (0.0, under))
            builder.add(look.board, post)
    inner = (-x + 0.01 + leg, x - 0.01 - leg)
    add_carcass(builder, (inner, (-y + 0.012, y - 0.01), (under - body, under)), columns, look)
    if shelf:
        level = round(0.22 * height, 3)
        builder.add(look.board, box(inner, (-y + 0.01, y - 0.01), (level, level + 0.018)))
    return builder
