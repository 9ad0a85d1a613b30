"""Stools: for bars, for steps, round and square, upholstered, and on a screw that turns.

Bar stools are 0.65 (at counters of 0.9 m) to 0.8 m high (at bars of 1.1 m), others 0.4 to 0.5 m;
seats are 0.3 to 0.42 m wide, footrests lie 0.3 m below a bar stool's seat (makers' catalogues);
steps rise 0.2 to 0.25 m (EN 14183).
"""

from __future__ import annotations

import numpy as np

from .. import materials as m
from ..builder import BASE, ModelBuilder
from ..solids import (
    ROUND_SIDES,
    between,
    box,
    circle,
    frustum,
    prism,
    tapered_box,
    tube,
)
from .castors import add_star_foot

_GAP_M = 0.002


def leg_stool(
    width: float,
    depth: float,
    height: float,
    *,
    is_round: bool = True,
    legs: int = 4,
    thickness: float = 0.03,
    rest: float | None = None,
    frame: m.Material = m.BEECH,
    cushion: m.Material | None = None,
    sides: int = ROUND_SIDES,
) -> ModelBuilder:
    """A round or square seat on three or four splayed legs; ``rest``: height of the footrests."""
    square = not is_round
    symmetry = (0 if is_round else 4) if width == depth else 2
    if is_round:
        symmetry = {3: 1, 4: 4 if width == depth else 2}[legs]
    builder = ModelBuilder("stool", symmetry=symmetry)
    x, y, pad = width / 2, depth / 2, 0.035 if cushion else 0.0
    deck = height - pad - thickness
    add_seat(builder, frame, (x, y), (deck, deck + thickness), square, sides)
    if cushion:
        add_seat(builder, cushion, (x, y), (deck + thickness, height), square, sides, soft=True)
    reach = 0.9 if square else 0.62
    directions = [(reach, reach), (-reach, reach), (-reach, -reach), (reach, -reach)]
    if legs == 3:
        directions = [(0.0, 0.95), (-0.8227, -0.475), (0.8227, -0.475)]
    foot, head = 0.014, 0.019
    feet = []
    for c, s in directions:
        far, near = (x - 0.02) * 0.95, (y - 0.02) * 0.95
        ends = [
            (round(f * far * c, 4), round(f * near * s, 4), r) for f, r in ((1, foot), (0.7, head))
        ]
        rows = [(cx - r, cx + r, cy - r, cy + r) for cx, cy, r in ends]
        builder.add(frame, tapered_box(rows[0], rows[1], (0.0, deck)))
        feet.append(ends)
    if rest is not None and legs == 4:
        _add_rests(builder, frame, feet, rest, deck)
    return builder


def _add_rests(builder, frame, feet, rest: float, deck: float) -> None:
    """Bars between neighbouring legs of four, at the height of the footrest."""
    low, high = rest - 0.011, rest + 0.011
    (fx, fy, fr), (hx, hy, hr) = ([abs(v) for v in end] for end in feet[0])
    # The legs lean inwards: the bars end where the lower side of the joint leaves room.
    t = [h / deck for h in (low, high)]
    inner_x = [fx + (hx - fx) * k - (fr + (hr - fr) * k) for k in t]
    inner_y = [fy + (hy - fy) * k - (fr + (hr - fr) * k) for k in t]
    at_x, at_y = (fx + (hx - fx) * t[0], fy + (hy - fy) * t[0])
    for side in (-1, 1):
        span = between(side * (at_x - 0.008), side * (at_x + 0.008))
        outline = [(-inner_y[0], low), (inner_y[0], low), (inner_y[1], high), (-inner_y[1], high)]
        builder.add(frame, prism(np.round(outline, 6), "x", span), carries=False)
        span = between(side * (at_y - 0.008), side * (at_y + 0.008))
        outline = [(low, -inner_x[0]), (high, -inner_x[1]), (high, inner_x[1]), (low, inner_x[0])]
        builder.add(frame, prism(np.round(outline, 6), "y", span), carries=False)


def add_seat(
    builder: ModelBuilder,
    material: m.Material,
    half: tuple[float, float],
    z: tuple[float, float],
    square: bool,
    sides: int,
    *,
    soft: bool = False,
    link: str = BASE,
    center_y: float = 0.0,
) -> None:
    """A round or square seat of the given half-widths; a soft one has a rounded upper edge."""
    (x, y), (low, high) = half, z
    bevel = min(0.012, 0.4 * (high - low)) if soft else 0.0
    mid, shrink = round(high - bevel, 6), 1 - bevel / min(x, y)
    rows = [((x, y), (x, y), (low, mid))]
    if soft:
        rows.append(((x, y), (shrink * x, shrink * y), (mid, high)))
    for bottom, top, span in rows:
        if square:
            flat = [(-a, a, center_y - b, center_y + b) for a, b in (bottom, top)]
            solid = tapered_box(flat[0], flat[1], span)
        else:
            solid = frustum((bottom, top), span, (0.0, center_y), sides)
        builder.add(material, solid, link=link)


def column_stool(
    width: float,
    depth: float,
    height: float,
    *,
    seat: float = 0.9,
    plate: bool = True,
    turns: bool = True,
    low_back: float = 0.0,
    cushion: m.Material = m.LEATHER,
    frame: m.Material = m.CHROME_TUBE,
    sides: int = ROUND_SIDES,
) -> ModelBuilder:
    """A seat that turns on a column over a round plate, or over five castors.

    ``seat`` is its share of the width of the foot; ``low_back`` the height of a rail around its
    rear. The footrest of a bar stool is a ring around the column.
    """
    has_ring = plate and height - low_back > 0.6
    symmetry = 1 if low_back or not plate else 2 if width != depth else 4 if has_ring else 0
    builder = ModelBuilder("stool", symmetry=symmetry)
    x, y = width / 2, depth / 2
    link = "seat" if turns else BASE
    if plate:
        middle = 0.0
        builder.add(frame, frustum(((x, y), (x, y)), (0.0, 0.006), sides=sides), carries=False)
        cone = frustum(((0.6 * x, 0.6 * y), (0.03, 0.03 * y / x)), (0.006, 0.03), sides=sides)
        builder.add(frame, cone, carries=False)
        low = 0.03
    else:
        middle = add_star_foot(builder, (width, depth), sides)
        low = 0.105
    top = height - low_back
    pad = 0.06
    joint = round(top - pad - 0.13, 4)
    column = frustum((0.026, 0.026), (low, joint), (0.0, middle), sides)
    builder.add(frame, column)
    if has_ring:
        _add_foot_ring(builder, frame, min(0.75 * x, 0.75 * y), top - 0.36, sides)
    sx, sy = round(seat * x, 4), round(seat * y, 4)
    start = joint + (_GAP_M if turns else 0.0)
    piston = frustum((0.016, 0.016), (start, top - pad - 0.015), (0.0, middle), sides)
    builder.add(m.STEEL_TUBE, piston, link=link)
    plate_r = (0.5 * sx, 0.5 * sy)
    pan = frustum((plate_r, plate_r), (top - pad - 0.015, top - pad), (0.0, middle), sides)
    builder.add(frame, pan, link=link)
    seat_z = (top - pad, top)
    add_seat(
        builder, cushion, (sx, sy), seat_z, False, sides, soft=True, link=link, center_y=middle
    )
    if low_back:
        _add_low_back(builder, cushion, (sx, sy), (top - pad + 0.012, height), middle, link, sides)
    if turns:
        edge = (0.0, middle - sy, top - pad)
        builder.swivel("seat", (0.0, middle, joint), damping=0.05, friction=0.15, at=edge)
    return builder


def _add_foot_ring(builder, frame, radius: float, z: float, sides: int) -> None:
    """A ring around the column, held by four spokes."""
    # Flat sides, not corners, meet the spokes.
    flat = np.cos(np.pi / sides)
    outline, inline = (
        _turned(circle(r / flat, sides), np.pi / sides) for r in (radius, radius - 0.02)
    )
    ring = tube(np.stack([outline] * 2), np.stack([inline] * 2), (z, z + 0.02), is_round=True)
    builder.add(frame, *ring, carries=False)
    span = (z + 0.004, z + 0.016)
    for axis in "xy":
        for side in (-1, 1):
            along = between(side * 0.026, side * (radius - 0.02))
            bar = ((along, (-0.005, 0.005)), ((-0.005, 0.005), along))[axis == "y"]
            builder.add(frame, box(*bar, span), carries=False)


def _turned(points: np.ndarray, angle_rad: float) -> np.ndarray:
    c, s = np.cos(angle_rad), np.sin(angle_rad)
    return points @ np.array([[c, s], [-s, c]])


def _add_low_back(
    builder, material, half: tuple[float, float], z, middle: float, link: str, sides: int
) -> None:
    """A wall around the rear half of a round seat, outside it."""
    x, y = half
    thick = 0.03
    outer = circle((x + thick, y + thick), sides, (0.0, middle))
    inner = circle((x, y), sides, (0.0, middle))
    staves = tube(np.stack([outer] * 2), np.stack([inner] * 2), z, is_round=True)
    count = sides // 2
    for k in range(count):
        shown = {5} if k == 0 else {3} if k == count - 1 else set()
        builder.add(material, staves[k].shown(shown), link=link, carries=False)


def step_stool(
    width: float,
    depth: float,
    height: float,
    *,
    steps: int = 2,
    board: float = 0.02,
    material: m.Material = m.BIRCH,
) -> ModelBuilder:
    """Treads between two sides that rise in steps to the rear."""
    builder = ModelBuilder("stool", symmetry=1)
    x, y = width / 2, depth / 2
    run, rise = depth / steps, height / steps
    for k in range(steps):
        front, top = round(-y + k * run, 5), round((k + 1) * rise, 5)
        rear = round(-y + (k + 1) * run, 5) if k < steps - 1 else y
        for side in (-1, 1):
            panel = between(side * x, side * (x - board))
            builder.add(material, box(panel, (front, rear), (0.0, top - board)))
        builder.add(material, box((-x, x), (front, rear), (top - board, top)))
        riser = (max(0.0, top - 0.08), top - board)
        inner = (-x + board, x - board)
        builder.add(material, box(inner, (front + 0.02, front + 0.02 + board), riser))
    return builder


def pouf(
    width: float,
    depth: float,
    height: float,
    *,
    is_round: bool = True,
    foot: float = 0.0,
    fabric: m.Material = m.BEIGE_FABRIC,
    sides: int = ROUND_SIDES,
) -> ModelBuilder:
    """An upholstered cylinder or box, its edges rounded, if wished on wooden feet."""
    symmetry = 0 if is_round else 4
    if width != depth or (is_round and foot):
        symmetry = 4 if width == depth else 2
    builder = ModelBuilder("stool", symmetry=symmetry)
    x, y, bevel = width / 2, depth / 2, min(0.02, 0.2 * height)
    if not is_round:
        low = (-x + bevel, x - bevel, -y + bevel, y - bevel)
        below = tapered_box(low, (-x, x, -y, y), (foot, foot + bevel))
    else:
        shrink = 1 - bevel / min(x, y)
        small = (shrink * x, shrink * y)
        below = frustum((small, (x, y)), (foot, foot + bevel), sides=sides)
    builder.add(fabric, below)
    body = (foot + bevel, height)
    add_seat(builder, fabric, (x, y), body, not is_round, sides, soft=True)
    reach = 0.6 if is_round else 0.8
    for sx in (-1, 1) if foot else ():
        for sy in (-1, 1):
            cx, cy = round(sx * reach * x, 4), round(sy * reach * y, 4)
            leg = box((cx - 0.018, cx + 0.018), (cy - 0.018, cy + 0.018), (0.0, foot))
            builder.add(m.BLACK_WOOD, leg)
    return builder
