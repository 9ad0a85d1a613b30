"""Beds with posts: bunk and loft beds, four-posters, cots.

Upper bunks lie 1.2 to 1.5 m above the floor, their guards end at least 0.16 m above the mattress
(EN 747); bars of cots stand 45 to 65 mm apart, their sides are 0.6 m above the mattress' base
(EN 716). Ladders rise 0.2 to 0.3 m a rung.
"""

from __future__ import annotations

from .. import materials as m
from ..builder import ModelBuilder
from ..solids import between, box
from .beds import add_bedding, pillow_solid
from .sofas import cushion


def bunk_bed(
    width: float,
    depth: float,
    height: float,
    *,
    upper: float = 1.25,
    lower: float | None = 0.32,
    mattress: float = 0.12,
    frame: m.Material = m.PINE,
    blanket: m.Material | None = m.BLUE_BLANKET,
) -> ModelBuilder:
    """Two beds above one another between four posts with a ladder; a loft bed without the lower.

    ``upper`` and ``lower`` are the heights of the slats.
    """
    builder = ModelBuilder("bed", symmetry=1)
    x, y, post = width / 2, depth / 2, 0.06
    front = -x + 0.05
    for sx in (front, x):
        for sy in (-1, 1):
            bx = (sx, sx + post) if sx < 0 else (sx - post, sx)
            by = between(sy * y, sy * (y - post))
            builder.add(frame, box(bx, by, (0.0, height)), carries=False)
    inner = (front + post, x - post)
    for level in (upper, lower) if lower is not None else (upper,):
        _add_bunk(builder, frame, (front, x), (-y + post, y - post), level, mattress, blanket)
        for sy in (-1, 1):
            by = between(sy * y, sy * (y - 0.03))
            builder.add(frame, box(inner, by, (level - 0.08, level + 0.05)), carries=False)
    guard = height - 0.09
    for sy in (-1, 1):
        by = between(sy * y, sy * (y - 0.03))
        builder.add(frame, box(inner, by, (guard, height - 0.02)), carries=False)
    along = (-y + post, y - post)
    builder.add(frame, box((x - 0.025, x), along, (guard, height - 0.02)), carries=False)
    gate = -y + post + min(0.5, 0.3 * depth)
    builder.add(
        frame, box((front, front + 0.025), (gate, y - post), (guard, height - 0.02)), carries=False
    )
    builder.add(
        frame,
        box((front, front + 0.025), (gate, gate + 0.05), (upper + 0.05, guard)),
        carries=False,
    )
    _add_ladder(builder, frame, (-x, front), (-y + post, gate), upper + 0.05)
    return builder


def _add_bunk(builder, frame, across, along, level: float, mattress: float, blanket) -> None:
    """Rails at both sides, slats between them, a mattress with a pillow and a blanket."""
    (x0, x1), rail = across, 0.025
    for bx in ((x0, x0 + rail), (x1 - rail, x1)):
        builder.add(frame, box(bx, along, (level - 0.08, level + 0.05)), carries=False)
    inner = (x0 + rail, x1 - rail)
    builder.add(m.SLATS, box(inner, along, (level - 0.02, level)))
    top = level + mattress
    builder.add(m.MATTRESS, *cushion(inner, along, (level, top), 0.015))
    middle = (x0 + x1) / 2
    y1 = along[1]
    half = min(0.28, 0.38 * (inner[1] - inner[0]))
    pillow = pillow_solid((middle - half, middle + half), (y1 - 0.4, y1 - 0.05), (top, top + 0.08))
    builder.add(m.PILLOW, pillow, carries=False)
    if blanket:
        spread = ((inner[0] + 0.02, inner[1] - 0.02), (along[0] + 0.02, y1 - 0.5))
        builder.add(blanket, *cushion(*spread, (top, top + 0.03), 0.015))


def _add_ladder(builder, frame, across, along, top: float) -> None:
    """Two uprights before the bed, and rungs about every 0.25 m."""
    (x0, x1), (y0, y1), t = across, along, 0.03
    for side in ((y0, y0 + t), (y1 - t, y1)):
        builder.add(frame, box((x0, x1), side, (0.0, top)), carries=False)
    count = round(top / 0.25)
    for k in range(1, count):
        z = round(top * k / count, 3)
        rung = box((x0 + 0.005, x1 - 0.005), (y0 + t, y1 - t), (z - 0.015, z + 0.015))
        builder.add(frame, rung, carries=False)


def four_poster(
    width: float,
    depth: float,
    height: float,
    *,
    lying: float = 0.55,
    frame: m.Material = m.WALNUT,
    blanket: m.Material | None = m.GREY_BLANKET,
) -> ModelBuilder:
    """A bed between four posts that carry a frame above it."""
    builder = ModelBuilder("bed", symmetry=1)
    x, y, post = width / 2, depth / 2, 0.06
    low = lying - 0.2
    for sx in (-1, 1):
        for sy in (-1, 1):
            bx, by = between(sx * x, sx * (x - post)), between(sy * y, sy * (y - post))
            builder.add(frame, box(bx, by, (0.0, height)), carries=False)
    inner, along = (-x + post, x - post), (-y + post, y - post)
    for z in ((low - 0.1, low + 0.06), (height - 0.05, height)):
        for side in (-1, 1):
            bx = between(side * x, side * (x - 0.03))
            by = between(side * y, side * (y - 0.03))
            builder.add(frame, box(bx, along, z), box(inner, by, z), carries=False)
    board = (y - 0.03, y)
    builder.add(frame, box(inner, board, (low + 0.06, 0.55 * height)), carries=False)
    lx = x - 0.03
    builder.add(m.SLATS, box((-lx, lx), along, (low - 0.02, low)))
    builder.add(m.MATTRESS, *cushion((-lx, lx), along, (low, lying), 0.02))
    add_bedding(builder, 2, lx, along, lying, blanket)
    return builder


def cot(
    width: float,
    depth: float,
    height: float,
    *,
    level: float = 0.35,
    frame: m.Material = m.WHITE_BOARD,
) -> ModelBuilder:
    """A child's bed with bars at both sides and boards at both ends."""
    builder = ModelBuilder("bed", symmetry=2)
    x, y, t = width / 2, depth / 2, 0.022
    for end in (-1, 1):
        span = between(end * y, end * (y - t))
        builder.add(frame, box((-x, x), span, (0.0, height)), carries=False)
    along = (-y + t, y - t)
    for side in (-1, 1):
        span = between(side * x, side * (x - t))
        builder.add(frame, box(span, along, (level - 0.06, level)), carries=False)
        builder.add(frame, box(span, along, (height - 0.04, height)), carries=False)
        _add_side_bars(builder, frame, span, along, (level, height - 0.04))
    inner = (-x + t, x - t)
    builder.add(m.SLATS, box(inner, along, (level - 0.02, level)))
    builder.add(m.MATTRESS, *cushion(inner, along, (level, level + 0.1), 0.015))
    return builder


def _add_side_bars(builder, frame, across, along, z) -> None:
    """Upright bars between the rails of a cot, about 75 mm from middle to middle."""
    (a, b), (x0, x1) = along, across
    count = round((b - a) / 0.075) - 1
    for k in range(count):
        c = a + round((b - a) * (k + 1) / (count + 1), 4)
        builder.add(frame, box((x0 + 0.004, x1 - 0.004), (c - 0.007, c + 0.007), z))
