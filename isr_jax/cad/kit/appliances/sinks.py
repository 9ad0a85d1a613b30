"""Sinks and washbasins.

Kitchen sinks are 0.45 to 1.2 m wide and 0.43 to 0.52 m deep, their bowls 0.14 to 0.22 m deep
(EN 13310); washbasins are 0.4 to 0.65 m wide, their rims 0.80 to 0.88 m above the floor (EN 31 and
makers' catalogues). The box holds the tap, without its levers.
"""

from __future__ import annotations

import dataclasses

import numpy as np

from .. import materials as m
from ..builder import ModelBuilder
from ..furniture.fronts import Column, Look, add_carcass, columns_of
from ..furniture.panels import Bounds
from ..shapes.shells import Level, d_outline, layered_wall, loft, squircle
from ..solids import ROUND_SIDES, box, circle, frustum
from .faucets import add_mixer, add_pillar_tap, add_tall_tap

_LEDGE_M = 0.09
_DRAIN_M = 0.03


def _add_drain(builder, center: tuple[float, float], z: float, sides: int) -> None:
    disc = frustum((_DRAIN_M, _DRAIN_M), (z, z + 0.002), center, sides)
    builder.add(m.CHROME, disc, carries=False)


def kitchen_sink(
    width: float,
    depth: float,
    height: float,
    *,
    bowls: int = 1,
    drainer: float = 0.0,
    tap: float = 0.3,
    sheet: m.Material = m.THIN_STEEL,
    thick: float = 0.004,
    metal: m.Material = m.CHROME,
    sides: int = ROUND_SIDES,
) -> ModelBuilder:
    """Bowls hung in a deck with a tall tap behind them, as it is let into a worktop.

    ``drainer`` is the part of the width that a ribbed plate takes at the right, ``tap`` how far the
    tap stands above the deck.
    """
    builder = ModelBuilder("sink", symmetry=1)
    x, y, t, deck = width / 2, depth / 2, thick, height - tap
    rim = 0.03 + thick
    edge = x - rim - round(drainer * width, 4)
    front, back = -y + rim, y - _LEDGE_M
    span = (edge - (-x + rim) - (bowls - 1) * rim) / bowls
    starts = [round(-x + rim + k * (span + rim), 4) for k in range(bowls)]
    plate = (deck - t, deck)
    builder.add(sheet, box((-x, x), (-y, front), plate), box((-x, x), (back, y), plate))
    ends = [-x] + [s + round(span, 4) for s in starts]
    for a, b in zip(ends, [*starts, x]):
        builder.add(sheet, box((a, b), (front, back), plate))
    for start in starts:
        bowl = ((start, start + round(span, 4)), (front, back))
        _add_sheet_bowl(builder, bowl, (0.0, deck - t), t, sheet)
        middle = (sum(bowl[0]) / 2, sum(bowl[1]) / 2)
        _add_drain(builder, middle, t, sides)
    if drainer:
        _add_ribs(builder, (edge + 0.03, x - 0.03), (front + 0.02, back), deck, sheet)
    center = (starts[0] + ends[-1]) / 2
    reach = min(0.22, round(0.6 * (depth - _LEDGE_M / 2), 3))
    add_tall_tap(builder, (center, y - _LEDGE_M / 2, deck), tap, reach=reach, metal=metal)
    return builder


def _add_sheet_bowl(builder, plan: tuple[Bounds, Bounds], z: Bounds, t: float, sheet) -> None:
    """Floor and walls of sheet around a hollow of the given plan."""
    (x0, x1), (y0, y1) = plan
    low = z[0] + t
    builder.add(sheet, box((x0 - t, x1 + t), (y0 - t, y1 + t), (z[0], low)))
    for a, b in ((x0 - t, x0), (x1, x1 + t)):
        builder.add(sheet, box((a, b), (y0 - t, y1 + t), (low, z[1])))
    for a, b in ((y0 - t, y0), (y1, y1 + t)):
        builder.add(sheet, box((x0, x1), (a, b), (low, z[1])))


def _add_ribs(builder, x: Bounds, y: Bounds, z: float, sheet: m.Material) -> None:
    count = max(2, round((x[1] - x[0]) / 0.05))
    step = (x[1] - x[0]) / count
    for k in range(count):
        a = round(x[0] + (k + 0.35) * step, 4)
        rib = box((a, a + round(0.3 * step, 4)), y, (z, z + 0.003))
        builder.add(sheet, rib, carries=False)


def utility_sink(
    width: float,
    depth: float,
    height: float,
    *,
    tap: float = 0.16,
    bowl: float = 0.3,
    material: m.Material = m.WHITE_PLASTIC,
    legs: m.Material = m.STEEL_TUBE,
    sides: int = ROUND_SIDES,
) -> ModelBuilder:
    """A deep tub on four legs for a laundry; its walls slope."""
    builder = ModelBuilder("sink", symmetry=1, mount="floor")
    x, y, rim, leg = width / 2, depth / 2, height - tap, 0.03
    floor = rim - round(min(bowl, 0.45 * rim), 4)
    ledge = 0.08
    front = (y - ledge + y) / 2
    center = (0.0, -ledge / 2)
    outline = squircle(x, front, np.inf, sides)
    levels = [Level(floor, 0.86, 0.82, center), Level(rim - 0.03, 0.96, 0.92, center)]
    levels += [Level(rim, 1.0, 0.92, center)]
    builder.add(material, *layered_wall(outline, outline, levels, is_round=False))
    bottom = [np.asarray(center) + s * outline for s in (0.84, 0.86)]
    builder.add(material, loft(bottom[0], bottom[1], (floor - 0.012, floor)))
    builder.add(material, box((-x, x), (y - ledge, y), (rim - 0.03, rim)))
    _add_drain(builder, center, floor, sides)
    for sx in (-1, 1):
        for cy in (-y + 0.14 * depth, y - ledge - 0.14 * depth):
            cx = sx * (0.84 * x - leg)
            spot = ((cx - leg / 2, cx + leg / 2), (cy - leg / 2, cy + leg / 2))
            builder.add(legs, box(*spot, (0.0, floor - 0.012)))
    add_mixer(builder, (0.0, y - ledge / 2, rim), tap, reach=min(0.17, 0.5 * depth))
    return builder


def _add_basin(
    builder: ModelBuilder,
    plan: tuple[float, float, float],
    z: Bounds,
    ledge: float,
    material: m.Material,
    sides: int,
) -> None:
    """A D-shaped bowl before a ledge for the tap; ``plan`` is half width, front and back."""
    half, front, back = plan
    wall = back - ledge
    depth = wall - front
    rear = round(0.42 * depth, 4)
    outline = d_outline(half, depth - rear, rear, half, sides)
    low, rim = z
    floor = rim - round(0.72 * (rim - low), 4)

    def level(height: float, outer: float, inner: float) -> Level:
        return Level(height, outer, inner, (0.0, wall - outer * rear))

    ends = [level(low, 0.5, 0.0), level(floor, 0.74, 0.0)]
    solid = [np.asarray(v.center) + v.outer * outline for v in ends]
    builder.add(material, loft(solid[0], solid[1], (low, floor)))
    levels = [level(floor, 0.74, 0.6), level(rim - 0.3 * (rim - low), 0.96, 0.85)]
    levels.append(level(rim, 1.0, 0.9))
    builder.add(material, *layered_wall(outline, outline, levels))
    builder.add(material, box((-half, half), (wall, back), (rim - 0.06, rim)))
    _add_drain(builder, (0.0, wall - 0.74 * rear), floor, sides)


def washbasin(
    width: float,
    depth: float,
    height: float,
    *,
    pedestal: bool = True,
    tap: float = 0.14,
    taps: int = 1,
    bowl: float = 0.18,
    material: m.Material = m.SANITARY,
    metal: m.Material = m.CHROME,
    sides: int = ROUND_SIDES,
) -> ModelBuilder:
    """A bowl on a pedestal, or on a wall with a trap below it; one mixer or two pillar taps."""
    builder = ModelBuilder("sink", symmetry=1, mount="floor" if pedestal else "wall")
    x, y, rim, ledge = width / 2, depth / 2, height - tap, min(0.1, 0.25 * depth)
    low = rim - min(bowl, 0.6 * rim)
    _add_basin(builder, (x, -y, y), (low, rim), ledge, material, sides)
    wall = y - ledge
    middle = wall - 0.21 * (wall + y)
    if pedestal:
        foot = squircle(0.21 * width, 0.22 * depth, 3.0, sides)
        neck = round(0.75 * low, 4)
        at = np.array([0.0, middle + 0.04])
        builder.add(material, loft(at + foot, at + 0.72 * foot, (0.0, neck)))
        builder.add(material, loft(at + 0.72 * foot, at + 0.84 * foot, (neck, low)))
    else:
        bend = round(min(0.08, 0.4 * low), 4)
        bottle = frustum((0.028, 0.028), (0.0, bend), (0.0, middle), sides)
        pipe = frustum((0.016, 0.016), (bend, low), (0.0, middle), sides)
        builder.add(m.CHROME, bottle, pipe, carries=False)
    _add_taps(builder, taps, (x, y - ledge / 2, rim), tap, metal, sides)
    return builder


def _add_taps(builder, taps: int, at, tap: float, metal: m.Material, sides: int) -> None:
    x, y, rim = at
    if taps == 1:
        add_mixer(builder, (0.0, y, rim), tap, metal=metal)
        return
    for side in (-1, 1):
        add_pillar_tap(builder, (side * 0.45 * x, y, rim), tap, metal=metal, sides=sides)


def vanity(
    width: float,
    depth: float,
    height: float,
    *,
    columns: tuple[Column, ...] = columns_of("L", "R"),
    look: Look = Look(),  # noqa: B008 - frozen
    tap: float = 0.14,
    bowl: float = 0.13,
    material: m.Material = m.SANITARY,
    metal: m.Material = m.CHROME,
    plinth: float = 0.09,
    sides: int = ROUND_SIDES,
) -> ModelBuilder:
    """A washbasin that lies on a cabinet of its size."""
    builder = ModelBuilder("sink", symmetry=1, mount="floor")
    x, y, rim = width / 2, depth / 2, height - tap
    low = rim - bowl
    if plinth:
        builder.add(m.PLINTH, box((-x + 0.01, x - 0.01), (-y + 0.07, y - 0.02), (0.0, plinth)))
    below = dataclasses.replace(look, covered=True)
    add_carcass(builder, ((-x, x), (-y + 0.004, y), (plinth, low)), columns, below)
    outer = squircle(x, y, np.inf, sides)
    hollow = (1 - 0.095 / y) * squircle(x, y, 5.0, sides)
    floor = low + 0.022
    builder.add(material, box((-x, x), (-y, y), (low, floor)))
    levels = [Level(floor, 1.0, 0.82), Level(rim - 0.03, 1.0, 0.97), Level(rim, 1.0, 1.0)]
    builder.add(material, *layered_wall(outer, hollow, levels, is_round=False), carries=False)
    _add_drain(builder, (0.0, 0.0), floor, sides)
    add_mixer(builder, (0.0, y - 0.045, rim), tap, metal=metal, reach=min(0.14, 0.35 * depth))
    return builder


def vessel(
    width: float,
    depth: float,
    height: float,
    *,
    power: float = 2.0,
    wall: float = 0.015,
    material: m.Material = m.SANITARY,
    sides: int = ROUND_SIDES,
) -> ModelBuilder:
    """A bowl without a tap that stands on a worktop; ``power`` 2 is oval, 5 nearly square."""
    round_one = power == 2.0 and width == depth
    symmetry = 0 if round_one else 4 if width == depth else 2
    builder = ModelBuilder("sink", symmetry=symmetry)
    x, y = width / 2, depth / 2
    outline = circle((x, y), sides) if power == 2.0 else squircle(x, y, power, sides)
    t = wall / min(x, y)
    floor = max(0.02, 0.14 * height)
    bottom, mid = (0.55, 0.86) if power == 2.0 else (0.8, 0.93)
    foot = bottom + (mid - bottom) * floor / (0.55 * height)
    levels = [Level(floor, foot, foot - t), Level(0.55 * height, mid, mid - t)]
    levels.append(Level(height, 1.0, 1.0 - t))
    builder.add(material, loft(bottom * outline, foot * outline, (0.0, floor)))
    builder.add(material, *layered_wall(outline, outline, levels))
    _add_drain(builder, (0.0, 0.0), floor, sides)
    return builder
