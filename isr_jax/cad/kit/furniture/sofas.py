"""Sofas and upholstered armchairs.

Seats are 0.38 to 0.46 m high, 0.50 to 0.60 m deep and 0.55 to 0.75 m wide for each person, arms
end 0.55 to 0.68 m, backs 0.70 to 0.95 m above the floor (EN 12520, makers' catalogues).
"""

from __future__ import annotations

import itertools

import numpy as np

from .. import materials as m
from ..builder import ModelBuilder
from ..solids import (
    ROUND_SIDES,
    Solid,
    between,
    box,
    circle,
    frustum,
    prism,
    split,
    tapered_box,
    tube,
)
from .seats import leaning

_BEVEL_M = 0.025


def cushion(x, y, z, bevel: float = _BEVEL_M) -> list[Solid]:
    """A box with a rounded upper edge: two convex pieces on one another."""
    mid = round(z[1] - bevel, 6)
    top = (x[0] + bevel, x[1] - bevel, y[0] + bevel, y[1] - bevel)
    return [box(x, y, (z[0], mid)), tapered_box((*x, *y), top, (mid, z[1]))]


def sofa(
    width: float,
    depth: float,
    height: float,
    *,
    seats: int = 2,
    arm: float = 0.16,
    seat: float = 0.43,
    arm_height: float = 0.60,
    back: float = 0.22,
    fabric: m.Material = m.GREY_FABRIC,
    feet: m.Material = m.BLACK_WOOD,
    foot: float = 0.09,
    chaise: float = 0.0,
    loose: bool = False,
    class_name: str = "sofa",
) -> ModelBuilder:
    """A base on feet, arms, a back, and seat cushions.

    ``chaise`` lengthens the seat at the right by so much, ``depth`` includes it; with ``loose``
    cushions stand on the seat before the back.
    """
    builder = ModelBuilder(class_name, symmetry=1)
    x, y, thick = width / 2, depth / 2, 0.15
    front, rear, deck = -y + chaise, y - back, seat - thick
    inner = (-x + arm, x - arm)
    builder.add(fabric, box(inner, (front, rear), (foot, deck)))
    builder.add(fabric, *cushion(inner, (rear, y), (foot, height)), carries=False)
    for side in (-1, 1) if arm else ():
        span = between(side * x, side * (x - arm))
        builder.add(fabric, *cushion(span, (front, y), (foot, arm_height), min(0.025, arm / 4)))
    edges = split(inner[0], inner[1], seats)
    for i, (a, b) in enumerate(itertools.pairwise(edges)):
        span = (a + (0.0015 if i else 0), b - (0.0015 if i < seats - 1 else 0))
        builder.add(fabric, *cushion(span, (front + 0.01, rear), (deck, seat), 0.012))
        if loose:
            stand = (rear - 0.13, rear)
            builder.add(fabric, _back_cushion(span, stand, (seat, height)), carries=False)
    if chaise:
        span = (edges[-2] + 0.0015, x)
        builder.add(fabric, *cushion(span, (-y, front), (foot, seat), 0.012))
    corners = [(-x, front), (x, -y), (-x, y), (x, y)]
    if chaise:
        corners.append((edges[-2] + 0.12, -y))
    _add_feet(builder, corners, foot, feet)
    return builder


def _back_cushion(x, y, z) -> Solid:
    """A cushion that leans against a back: thick below, thin above."""
    (y0, y1), (z0, z1) = y, z
    outline = [
        (y0, z0),
        (y1, z0),
        (y1, z1 - 0.03),
        (y1 - 0.05, z1),
        (y0 + 0.06, z1),
        (y0 + 0.02, z1 - 0.06),
    ]
    return prism(np.round(outline, 6), "x", x)


def _add_feet(builder, corners: list[tuple[float, float]], height: float, material) -> None:
    """Feet 60 mm inside the given corners, towards the middle, tapering downwards."""
    for x, y in corners:
        cx = x + 0.06 if x < 0 else x - 0.06
        cy = y + 0.06 if y < 0 else y - 0.06
        rows = [(cx - r, cx + r, cy - r, cy + r) for r in (0.018, 0.025)]
        builder.add(material, tapered_box(rows[0], rows[1], (0.0, height)))


def corner_sofa(
    width: float,
    depth: float,
    height: float,
    *,
    seats: int = 3,
    deep: float = 0.9,
    arm: float = 0.16,
    seat: float = 0.43,
    arm_height: float = 0.6,
    back: float = 0.2,
    fabric: m.Material = m.GREY_FABRIC,
    foot: float = 0.06,
) -> ModelBuilder:
    """Two wings: one along the rear with an arm at the left, one along the right side."""
    builder = ModelBuilder("sofa", symmetry=1)
    x, y, deck = width / 2, depth / 2, seat - 0.15
    front, rear, side = y - deep, y - back, x - back
    inner = -x + arm
    builder.add(fabric, box((inner, side), (front, rear), (foot, deck)))
    builder.add(fabric, box((x - deep, side), (-y, front), (foot, deck)))
    builder.add(fabric, *cushion((inner, x), (rear, y), (foot, height)), carries=False)
    builder.add(fabric, *cushion((side, x), (-y, rear), (foot, height)), carries=False)
    builder.add(fabric, *cushion((-x, inner), (front, y), (foot, arm_height)))
    edges = split(inner, x - deep, seats - 1)
    for a, b in itertools.pairwise(edges):
        builder.add(fabric, *cushion((a + 0.0015, b), (front, rear), (deck, seat), 0.012))
    builder.add(fabric, *cushion((x - deep + 0.0015, side), (front, rear), (deck, seat), 0.012))
    wing = split(-y, front, 2)
    for a, b in itertools.pairwise(wing):
        builder.add(fabric, *cushion((x - deep, side), (a, b - 0.0015), (deck, seat), 0.012))
    corners = [(-x, front + 0.12), (-x, y), (x, y), (x, -y), (x - deep + 0.12, -y)]
    _add_feet(builder, corners, foot, m.BLACK_WOOD)
    return builder


def armchair(
    width: float,
    depth: float,
    height: float,
    *,
    seat: float = 0.43,
    arm: float = 0.1,
    arm_height: float = 0.6,
    lean: float = 0.2,
    wings: bool = False,
    fabric: m.Material = m.GREY_FABRIC,
    feet: m.Material = m.OAK,
    foot: float = 0.16,
) -> ModelBuilder:
    """A padded seat between arms, on high feet; the back leans, with ``wings`` beside the head."""
    builder = ModelBuilder("chair", symmetry=1)
    x, y, thick, back = width / 2, depth / 2, 0.14, 0.14
    deck = seat - thick
    end = round(y - lean * (height - deck), 6)
    rear = end - back
    inner = (-x + arm, x - arm)
    builder.add(fabric, box(inner, (-y, end), (foot, deck)))
    builder.add(fabric, *cushion(inner, (-y + 0.01, rear), (deck, seat), 0.012))
    builder.add(fabric, leaning(inner, (rear, end), (deck, height), lean, deck))
    for side in (-1, 1):
        span = between(side * x, side * (x - arm))
        builder.add(fabric, box(span, (-y, end), (foot, deck)))
        builder.add(fabric, *cushion(span, (-y, end), (deck, arm_height), 0.02))
        if wings:
            slope = [round(end + lean * (h - deck), 6) for h in (arm_height, height)]
            outline = [
                (end - 0.2, arm_height),
                (end, arm_height),
                (slope[1], height),
                (slope[1] - 0.16, height),
            ]
            builder.add(fabric, prism(np.round(outline, 6), "x", span))
    corners = [(-x, -y), (x, -y), (-x, end), (x, end)]
    for cx, cy in corners:
        px = cx + 0.05 if cx < 0 else cx - 0.05
        py = cy + 0.05 if cy < 0 else cy - 0.05
        rows = [(px - r, px + r, py - r, py + r) for r in (0.012, 0.022)]
        builder.add(feet, tapered_box(rows[0], rows[1], (0.0, foot)))
    return builder


def tub_chair(
    width: float,
    depth: float,
    height: float,
    *,
    seat: float = 0.44,
    wall: float = 0.09,
    fabric: m.Material = m.GREEN_FABRIC,
    feet: m.Material = m.BRASS_TUBE,
    foot: float = 0.14,
    sides: int = ROUND_SIDES,
) -> ModelBuilder:
    """A round seat with a wall around its rear half that is back and arms in one."""
    builder = ModelBuilder("chair", symmetry=1)
    x, y, low = width / 2, depth / 2, seat - 0.13
    builder.add(fabric, frustum(((x, y), (x, y)), (foot, low), sides=sides), carries=False)
    builder.add(fabric, frustum(((x, y), (x, y)), (low, seat), sides=sides))
    outer, inner = (np.stack([circle(r, sides)] * 2) for r in ((x, y), (x - wall, y - wall)))
    staves = tube(outer, inner, (seat, height), is_round=True)
    reach = 2 * round(5 / 16 * sides)
    start = (sides // 2 - reach) // 2
    for k in range(reach):
        shown = {5} if k == 0 else {3} if k == reach - 1 else set()
        builder.add(fabric, staves[(start + k) % sides].shown(shown), carries=False)
    for sx in (-1, 1):
        for sy in (-1, 1):
            cx, cy = round(0.62 * sx * x, 4), round(0.62 * sy * y, 4)
            rows = [(cx - r, cx + r, cy - r, cy + r) for r in (0.01, 0.016)]
            builder.add(feet, tapered_box(rows[0], rows[1], (0.0, foot)))
    return builder


def frame_armchair(
    width: float,
    depth: float,
    height: float,
    *,
    seat: float = 0.42,
    arm_height: float = 0.58,
    lean: float = 0.28,
    seats: int = 1,
    frame: m.Material = m.OAK,
    fabric: m.Material = m.BEIGE_FABRIC,
    class_name: str = "chair",
) -> ModelBuilder:
    """Loose cushions in an open wooden frame with flat armrests."""
    builder = ModelBuilder(class_name, symmetry=1)
    x, y, post, thick = width / 2, depth / 2, 0.04, 0.13
    deck = seat - thick
    end = round(y - 0.02 - lean * (height - 0.03 - deck), 6)
    for side in (-1, 1):
        span = between(side * x, side * (x - post))
        builder.add(frame, box(span, (-y, -y + post), (0.0, arm_height)))
        builder.add(frame, box(span, (end - post, end), (0.0, arm_height)))
        builder.add(frame, box(span, (-y + post, end - post), (deck - 0.07, deck)))
        rest = between(side * x, side * (x - 0.07))
        top = (arm_height, arm_height + 0.025)
        builder.add(frame, box(rest, (-y, end), top), carries=False)
    inner = (-x + post, x - post)
    for rail in ((-y, -y + 0.025), (end - 0.025, end)):
        builder.add(frame, box(inner, rail, (deck - 0.07, deck - 0.02)))
    builder.add(m.SLATS, box(inner, (-y, end), (deck - 0.02, deck)))
    pads = (-x + 0.072, x - 0.072)
    edges = split(*pads, seats)
    back = end - 0.13
    for i, (a, b) in enumerate(itertools.pairwise(edges)):
        span = (a + (0.0015 if i else 0), b - (0.0015 if i < seats - 1 else 0))
        builder.add(fabric, *cushion(span, (-y + 0.01, back), (deck, seat), 0.012))
        builder.add(fabric, leaning(span, (back, end), (deck, height), lean, deck))
    for side in (-1, 1):
        board = between(side * (x - 0.072), side * (x - 0.092))
        builder.add(frame, leaning(board, (end, end + 0.02), (deck, height - 0.03), lean, deck))
    rail = leaning(
        (-x + 0.092, x - 0.092), (end, end + 0.02), (height - 0.1, height - 0.03), lean, deck
    )
    builder.add(frame, rail)
    return builder
