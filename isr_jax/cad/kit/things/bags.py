"""Bags: shopping bags, handbags, backpacks, travel bags and suitcases.

Paper carriers are 180 to 450 mm wide; backpacks of 15 to 30 l are 270 to 330 mm wide and 400 to
500 mm high; cabin suitcases are 550 x 400 x 200 mm at most and weigh 2 to 3 kg empty, large ones
are up to 800 mm high and weigh 4 kg. Soft bags stand as if filled: their densities are those of
cloth with air and things in it.
"""

from __future__ import annotations

from .. import materials as m
from ..builder import ModelBuilder
from ..shapes.strips import strip, upright_prism
from ..solids import ROUND_SIDES, between, box, circle, prism, tapered_box

_CLEAR_M = 0.003
_LEVEL = (1.0, 0.0)


def shopping_bag(
    width: float,
    depth: float,
    height: float,
    *,
    loop: float = 0.1,
    wall: float = 0.002,
    material: m.Material = m.KRAFT_PAPER,
    cord: m.Material = m.CORD,
) -> ModelBuilder:
    """An open carrier of paper or cloth; its two loops, ``loop`` high, are in the box."""
    builder = ModelBuilder("bag", symmetry=4 if width == depth and not loop else 2)
    x, y, top, t = width / 2, depth / 2, height - loop, wall
    builder.add(material, box((-x, x), (-y, y), (0.0, t)))
    for side in (-1, 1):
        builder.add(material, box(between(side * x, side * (x - t)), (-y, y), (t, top)))
        builder.add(material, box((-x + t, x - t), between(side * y, side * (y - t)), (t, top)))
        if loop:
            half, r = min(0.35 * x, 0.09), 0.005
            path = [(-half, top), (-0.8 * half, height - 0.2 * loop), (-0.4 * half, height - r / 2)]
            path += [(-across, z) for across, z in reversed(path)]
            builder.add(cord, *strip(path, r, "y", between(side * (y - t), side * y), _LEVEL))
    return builder


def handbag(
    width: float,
    depth: float,
    height: float,
    *,
    loop: float = 0.4,
    lean: float = 0.8,
    material: m.Material = m.LEATHER_GOODS,
    trim: m.Material = m.BLACK_TRIM,
) -> ModelBuilder:
    """A filled bag, its top ``lean`` times as long as its foot, under two arched handles.

    The handles take ``loop`` of the height, and are in the box.
    """
    builder = ModelBuilder("bag", symmetry=2)
    x, y, foot = width / 2, depth / 2, 0.008
    top = round(height * (1 - loop), 4)
    slim = 0.45
    for sx in (-1, 1):
        for sy in (-1, 1):
            cx, cy = sx * (x - 0.03), sy * (y - 0.02)
            builder.add(trim, box((cx - 0.008, cx + 0.008), (cy - 0.008, cy + 0.008), (0.0, foot)))
    flare = foot + 0.25 * (top - foot)
    builder.add(material, box((-x, x), (-y, y), (foot, flare)))
    ridge = (-lean * x, lean * x, -slim * y, slim * y)
    builder.add(material, tapered_box((-x, x, -y, y), ridge, (flare, top)))
    for side in (-1, 1):
        half, r = 0.5 * lean * x, 0.01
        rise = height - top
        path = [
            (-half, top),
            (-0.9 * half, top + 0.55 * rise),
            (-0.5 * half, height - 0.14 * rise),
            (-0.2 * half, height - r / 2),
        ]
        path += [(-across, z) for across, z in reversed(path)]
        inner = side * 0.25 * y
        builder.add(trim, *strip(path, r, "y", between(inner, inner + side * 0.008), _LEVEL))
    return builder


def backpack(
    width: float,
    depth: float,
    height: float,
    *,
    pocket: float = 0.3,
    strap: float = 0.05,
    material: m.Material = m.BLUE_CLOTH,
    pocket_material: m.Material = m.BLACK_CLOTH,
) -> ModelBuilder:
    """A filled backpack: ``pocket`` is the share of its depth in front, straps are at the rear."""
    builder = ModelBuilder("bag", symmetry=1)
    x, y = width / 2, depth / 2
    loop, strap_deep = 0.03, 0.035
    top, front, back = height - loop, -y + pocket * depth, y - strap_deep
    bend = 0.3 * (back - front)
    profile = [
        (back, 0.0),
        (back, top - 0.02),
        (back - 0.02, top),
        (front + bend, top),
        (front, top - 1.2 * bend),
        (front, 0.0),
    ]
    builder.add(material, upright_prism(profile, "x", (-x, x)), carries=False)
    lower = 0.52 * top
    pouch = [
        (front, 0.0),
        (front, lower + 0.03),
        (-y + 0.02, lower),
        (-y, lower - 0.04),
        (-y, 0.03),
        (-y + 0.02, 0.0),
    ]
    builder.add(pocket_material, upright_prism(pouch, "x", (-0.85 * x, 0.85 * x)), carries=False)
    r = 0.01
    for side in (-1, 1):
        inner = side * 0.3 * x
        path = [(back, 0.88 * top), (y - r / 2, 0.78 * top), (y - r / 2, 0.35 * top)]
        path.append((back, 0.12 * top))
        span = between(inner, inner + side * strap)
        builder.add(pocket_material, *strip(path, r, "x", span, cut=(0.0, 1.0)))
    grip = [(-0.04, top), (-0.03, height - 0.004), (0.03, height - 0.004), (0.04, top)]
    middle = (back - 0.04, back - 0.02)
    builder.add(pocket_material, *strip(grip, 0.008, "y", middle, _LEVEL))
    return builder


def duffel(
    width: float,
    depth: float,
    height: float,
    *,
    loop: float = 0.1,
    material: m.Material = m.BLACK_CLOTH,
    strap: m.Material = m.BLUE_CLOTH,
) -> ModelBuilder:
    """A filled travel bag that lies along x, flat below, under two handles ``loop`` high."""
    builder = ModelBuilder("bag", symmetry=2)
    x, y, top = width / 2, depth / 2, height - loop
    c = 0.28  # share that the slants take
    outline = [
        (-y * (1 - c), 0.0),
        (y * (1 - c), 0.0),
        (y, c * top),
        (y, top * (1 - 1.2 * c)),
        (y * (1 - 1.2 * c), top),
        (-y * (1 - 1.2 * c), top),
        (-y, top * (1 - 1.2 * c)),
        (-y, c * top),
    ]
    half = 0.28 * width
    band = 0.035
    for a, b, cloth in (
        (-x, -half - band, material),
        (-half - band, -half, strap),
        (-half, half, material),
        (half, half + band, strap),
        (half + band, x, material),
    ):
        builder.add(cloth, upright_prism(outline, "x", (a, b)), carries=False)
    grip = half + band / 2
    for side in (-1, 1):
        path = [(-grip, top), (-0.7 * grip, height - 0.25 * loop), (-0.3 * grip, height - 0.006)]
        path += [(-across, z) for across, z in reversed(path)]
        inner = side * 0.3 * y
        builder.add(strap, *strip(path, 0.012, "y", between(inner, inner + side * 0.02), _LEVEL))
    return builder


def suitcase(
    width: float,
    depth: float,
    height: float,
    *,
    wheel: float = 0.028,
    rise: float = 0.45,
    material: m.Material = m.BLUE_SHELL,
    ribs: int = 5,
    sides: int = ROUND_SIDES,
) -> ModelBuilder:
    """An upright case on four wheels; its handle slides up at the rear.

    The wheels' radius is ``wheel``, or less on a shallow case; the handle travels ``rise`` times
    the height.
    """
    builder = ModelBuilder("bag", symmetry=1)
    x, y, well, rib, c = width / 2, depth / 2, 0.024, 0.006, 0.04
    front, rear = -y + rib, y - well
    radius = min(wheel, 0.16 * (rear - front))
    low = 2 * radius + 0.012
    outline = [
        (-x + c, front),
        (x - c, front),
        (x, front + c),
        (x, rear),
        (-x, rear),
        (-x, front + c),
    ]
    builder.add(material, prism(outline, "z", (low, height)))
    pitch = (2 * x - 2 * c) / (2 * ribs + 1)
    for k in range(ribs):
        start = -x + c + (2 * k + 1) * pitch
        builder.add(material, box((start, start + pitch), (-y, front), (low + c, height - c)))
    spots = (x - 0.045, front + 0.28 * (rear - front), rear - 0.2 * (rear - front))
    _add_case_wheels(builder, spots, radius, low, sides)
    rail, grip = 0.32 * x, 0.035
    for side in (-1, 1):
        outer = between(side * (rail + 0.02), side * x)
        builder.add(material, box(outer, (rear, y), (low, height)))
    _add_case_handle(builder, rail, (rear, y), (low + 0.02, height - 0.004), grip)
    travel = round(rise * height, 3)
    builder.slide("handle", (0, 0, 1), travel, damping=2.0, friction=3.0)
    carry = [(-0.1, height), (-0.085, height + 0.03), (0.085, height + 0.03), (0.1, height)]
    middle = (front + rear) / 2
    builder.add(
        m.BLACK_TRIM,
        *strip(carry, 0.01, "y", (middle - 0.012, middle + 0.012), _LEVEL),
        handle=True,
    )
    return builder


def _add_case_wheels(builder: ModelBuilder, at, radius: float, low: float, sides: int) -> None:
    across, front, rear = at
    for side in (-1, 1):
        for cy in (front, rear):
            cx = side * across
            tread = circle(radius, sides, (cy, radius))
            builder.add(m.RUBBER, prism(tread, "x", (cx - 0.01, cx + 0.01)))
            deep = (cy - 0.7 * radius, cy + 0.7 * radius)
            fork = box((cx - 0.014, cx + 0.014), deep, (2 * radius, low))
            builder.add(m.PLASTIC, fork)


def _add_case_handle(builder: ModelBuilder, rail: float, y, z, grip: float) -> None:
    """Two tubes in the well behind the case, joined by a grip."""
    deep = (y[0] + _CLEAR_M, y[1] - 0.008)
    for side in (-1, 1):
        span = between(side * rail, side * (rail - 0.012))
        builder.add(m.STEEL_TUBE, box(span, deep, (z[0], z[1] - grip)), link="handle")
    builder.add(
        m.BLACK_TRIM, box((-rail, rail), deep, (z[1] - grip, z[1])), link="handle", handle=True
    )
