"""Chairs without upholstered arms: wooden, shell, folding, cantilever and cafe chairs.

Seats are 0.40 to 0.48 m high and 0.38 to 0.45 m deep, backs end 0.76 to 1.1 m above the floor,
armrests 0.2 to 0.25 m above the seat (EN 1335 for work, EN 12520 for homes, makers' catalogues).
"""

from __future__ import annotations

import numpy as np

from .. import materials as m
from ..builder import ModelBuilder
from ..solids import ROUND_SIDES, Solid, between, box, circle, frustum, prism, tapered_box, tube
from .panels import Space


def leaning(
    x: tuple[float, float], y: tuple[float, float], z: tuple[float, float], lean: float, base: float
) -> Solid:
    """A board between two heights that leans backwards by ``lean`` a metre above ``base``."""
    (y0, y1), (z0, z1) = y, z
    a, b = lean * (z0 - base), lean * (z1 - base)
    outline = [(y0 + a, z0), (y1 + a, z0), (y1 + b, z1), (y0 + b, z1)]
    return prism(np.round(outline, 6), "x", x)


def wooden_chair(
    width: float,
    depth: float,
    height: float,
    *,
    seat: float = 0.45,
    slats: int = 3,
    upright_slats: bool = False,
    lean: float = 0.16,
    leg: float = 0.034,
    frame: m.Material = m.BEECH,
    cushion: m.Material | None = None,
    arms: bool = False,
    stretchers: bool = False,
) -> ModelBuilder:
    """Four legs, a seat board, and two posts that lean back with slats between them."""
    builder = ModelBuilder("chair", symmetry=1)
    x, y, board = width / 2, depth / 2, 0.02
    pad = 0.03 if cushion else 0.0
    under = seat - pad - board
    deck = under + board
    end = round(y - lean * (height - deck), 6)
    builder.add(frame, box((-x, x), (-y, end), (under, deck)))
    _add_legs(builder, frame, (x, (-y, end)), leg, under, stretchers)
    rear = (end - 0.03, end)
    if cushion:
        inside = (-x + leg + 0.002, x - leg - 0.002)
        builder.add(cushion, box(inside, (-y + 0.005, rear[0] - 0.01), (deck, seat)))
    for side in (-1, 1):
        post = between(side * x, side * (x - leg))
        builder.add(frame, leaning(post, rear, (deck, height), lean, deck))
        if arms:
            _add_arm(builder, frame, post, (-y, rear[0]), (deck, seat + 0.21), lean)
    inner, middle = (-x + leg, x - leg), (rear[0] + 0.008, rear[1] - 0.008)
    add_slats = _add_upright_slats if upright_slats else _add_level_slats
    add_slats(builder, frame, slats, (inner, middle, (deck, height)), lean)
    return builder


def _add_arm(builder, frame, x, y, z, lean: float) -> None:
    """An armrest from a post on the seat to the back, cut to the back's slope."""
    (front, rear), (deck, top), t = y, z, 0.025
    builder.add(frame, box(x, (front, front + 0.03), (deck, top)))
    slope = [rear + lean * (h - deck) for h in (top, top + t)]
    outline = [(front, top), (slope[0], top), (slope[1], top + t), (front, top + t)]
    builder.add(frame, prism(np.round(outline, 6), "x", x), carries=False)


def _add_legs(builder, frame, half, leg: float, under: float, stretchers: bool) -> None:
    """Square legs at the corners, rails between them below the seat, and stretchers lower down."""
    x, (front, rear) = half
    for sx in (-1, 1):
        bx = between(sx * x, sx * (x - leg))
        builder.add(frame, box(bx, (front, front + leg), (0.0, under)))
        builder.add(frame, box(bx, (rear - leg, rear), (0.0, under)))
    rails = [(under - 0.05, under)]
    if stretchers:
        rails.append((0.3 * under, 0.3 * under + 0.022))
    for rail in rails:
        for side in (-1, 1):
            c = side * (x - leg / 2)
            builder.add(frame, box((c - 0.01, c + 0.01), (front + leg, rear - leg), rail))
        for c in (front + leg / 2, rear - leg / 2):
            builder.add(frame, box((-x + leg, x - leg), (c - 0.01, c + 0.01), rail))


def _add_upright_slats(builder, frame, slats: int, back: Space, lean: float) -> None:
    inner, y, (deck, height) = back
    builder.add(frame, leaning(inner, y, (height - 0.06, height), lean, deck))
    edges = np.linspace(inner[0], inner[1], 2 * slats + 2)
    for a, b in zip(edges[1::2], edges[2::2]):
        span = (round(a, 4), round(b, 4))
        builder.add(frame, leaning(span, y, (deck, height - 0.06), lean, deck))


def _add_level_slats(builder, frame, slats: int, back: Space, lean: float) -> None:
    inner, y, (deck, height) = back
    pitch = (height - deck - 0.12) / slats
    for k in range(slats):
        top = round(height - k * pitch, 4)
        builder.add(frame, leaning(inner, y, (top - 0.65 * pitch, top), lean, deck))


def shell_chair(
    width: float,
    depth: float,
    height: float,
    *,
    seat: float = 0.45,
    lean: float = 0.2,
    shell: m.Material = m.WHITE_PLASTIC,
    frame: m.Material = m.STEEL_TUBE,
    arms: bool = False,
    skids: bool = False,
) -> ModelBuilder:
    """A plastic or upholstered seat and back on four straight tubes, or on a bent one.

    With ``skids`` the tube runs from the front of the seat down and back along the floor.
    """
    builder = ModelBuilder("chair", symmetry=1)
    x, y, tube_m, board = width / 2, depth / 2, 0.022, 0.025
    deck = seat - board
    end = round(y - lean * (height - seat), 6)
    builder.add(shell, box((-x, x), (-y, end), (deck, seat)))
    if skids:
        _add_skids(builder, frame, x - 0.03, (-y + 0.02, y), deck, tube_m)
    else:
        _add_tubes(builder, frame, x - 0.03, (-y + 0.03, end - 0.03), deck, tube_m)
    rear = (end - 0.022, end)
    back = (-x + 0.01, x - 0.01)
    low = seat + 0.4 * (height - seat) if not arms else seat
    for side in (-1, 1) if low > seat else ():
        c = side * (x - 0.06)
        builder.add(frame, leaning((c - 0.011, c + 0.011), rear, (seat, low), lean, seat))
    builder.add(shell, leaning(back, rear, (low, height), lean, seat))
    for side in (-1, 1) if arms else ():
        c, arm = side * (x - 0.025), seat + 0.2
        span = (c - 0.025, c + 0.025)
        rest = box(span, (-y + 0.06, rear[0] - 0.002), (arm, arm + 0.03))
        builder.add(shell, rest, carries=False)
        builder.add(frame, box((c - 0.011, c + 0.011), (-y + 0.08, -y + 0.102), (seat, arm)))
        builder.add(frame, box((c - 0.011, c + 0.011), (end - 0.1, end - 0.078), (seat, arm)))
    return builder


def _add_tubes(builder, frame, x: float, ends, deck: float, tube_m: float) -> None:
    half = tube_m / 2
    for sx in (-1, 1):
        for cy in ends:
            cx = sx * x
            leg = box((cx - half, cx + half), (cy - half, cy + half), (0.0, deck))
            builder.add(frame, leg)


def _add_skids(builder, frame, x: float, ends, deck: float, tube_m: float) -> None:
    front, rear = ends
    for side in (-1, 1):
        span = (side * x - tube_m / 2, side * x + tube_m / 2)
        builder.add(frame, box(span, (front, rear), (0.0, tube_m)))
        builder.add(frame, box(span, (front, front + tube_m), (tube_m, deck)))
    inner = (-x + tube_m / 2, x - tube_m / 2)
    builder.add(frame, box(inner, (rear - tube_m, rear), (0.0, tube_m)))


def folding_chair(
    width: float,
    depth: float,
    height: float,
    *,
    seat: float = 0.45,
    frame: m.Material = m.STEEL_TUBE,
    boards: m.Material = m.BEECH,
) -> ModelBuilder:
    """Two pairs of crossing legs; the outer one goes up to carry the back."""
    builder = ModelBuilder("chair", symmetry=1)
    x, y, t, leg = width / 2, depth / 2, 0.018, 0.026
    deck = seat - t
    hip = round(y - 0.3 * (height - seat) - leg, 6)

    def leg_pair(at: float, low: float, high: float, top: float) -> None:
        outline = np.round([(low, 0.0), (low + leg, 0.0), (high + leg, top), (high, top)], 6)
        for side in (-1, 1):
            builder.add(frame, prism(outline, "x", between(side * at, side * (at - t))))

    leg_pair(x, -y, hip, deck)
    leg_pair(x - t - 0.004, y - leg, -y + 0.06, deck)
    builder.add(boards, box((-x, x), (-y + 0.02, hip + leg), (deck, seat)))
    for side in (-1, 1):
        post = between(side * x, side * (x - t))
        builder.add(frame, leaning(post, (hip, hip + leg), (seat, height), 0.3, seat))
    inner = (-x + t, x - t)
    rise = height - seat
    for top in (height, height - 0.4 * rise):
        z = (top - min(0.09, 0.26 * rise), top)
        slat = leaning(inner, (hip + 0.004, hip + leg - 0.004), z, 0.3, seat)
        builder.add(boards, slat)
    return builder


def cafe_chair(
    width: float,
    depth: float,
    height: float,
    *,
    seat: float = 0.46,
    spindles: int = 5,
    frame: m.Material = m.BLACK_WOOD,
    sides: int = ROUND_SIDES,
) -> ModelBuilder:
    """A round seat on splayed legs, and a bent rail on spindles around its rear."""
    builder = ModelBuilder("chair", symmetry=1)
    x, y, board = width / 2, depth / 2, 0.028
    deck = seat - board
    builder.add(frame, frustum(((0.9 * x, 0.9 * y), (x, y)), (deck, seat), sides=sides))
    for sx in (-1, 1):
        for sy in (-1, 1):
            rows = [(sx * f * x, sy * f * y, r) for f, r in ((0.69, 0.013), (0.52, 0.018))]
            ends = [(cx - r, cx + r, cy - r, cy + r) for cx, cy, r in rows]
            builder.add(frame, tapered_box(ends[0], ends[1], (0.0, deck)))
    rail = (height - 0.07, height)
    outline, inline = circle((x, y), sides), circle((x - 0.022, y - 0.022), sides)
    staves = tube(np.stack([outline] * 2), np.stack([inline] * 2), rail, is_round=True)
    for k in range(count := sides // 2):
        shown = {5} if k == 0 else {3} if k == count - 1 else set()
        builder.add(frame, staves[k].shown(shown))
    for angle in np.linspace(0.12 * np.pi, 0.88 * np.pi, spindles):
        reach = 0.96 * np.cos(np.pi / sides)
        cx, cy = (
            round(float(v), 5)
            for v in ((x - 0.011) * reach * np.cos(angle), (y - 0.011) * reach * np.sin(angle))
        )
        post = box((cx - 0.007, cx + 0.007), (cy - 0.007, cy + 0.007), (seat, rail[0]))
        builder.add(frame, post)
    return builder
