"""Chairs and sofas.

Seats of chairs are 0.43 to 0.47 m high and 0.38 to 0.45 m deep, backs end 0.80 to 0.95 m above
the floor (EN 1335 for work, EN 12520 for homes); sofas have seats 0.40 to 0.45 m high and about
0.55 m deep, 0.6 m wide for each person.
"""

from __future__ import annotations

import itertools

import numpy as np

from ...cad_types import CadModel
from . import materials as m
from .builder import ModelBuilder
from .fronts import Space
from .solids import Solid, between, box, frustum, prism


def _leaning(
    x: tuple[float, float], y: tuple[float, float], z: tuple[float, float], lean: float, base: float
) -> Solid:
    """A board between two heights that leans backwards by ``lean`` a metre above ``base``."""
    (y0, y1), (z0, z1) = y, z
    a, b = lean * (z0 - base), lean * (z1 - base)
    outline = [(y0 + a, z0), (y1 + a, z0), (y1 + b, z1), (y0 + b, z1)]
    return prism(np.round(outline, 6), "x", x)


def wooden_chair(
    name: str,
    width: float = 0.42,
    depth: float = 0.42,
    seat: float = 0.45,
    height: float = 0.86,
    *,
    slats: int = 3,
    upright_slats: bool = False,
    lean: float = 0.16,
    frame: m.Material = m.BEECH,
    cushion: m.Material | None = None,
) -> CadModel:
    """Four legs, a seat board, and two posts that lean back with slats between them."""
    builder = ModelBuilder("chair", name, symmetry=1)
    x, y, leg, board = width / 2, depth / 2, 0.034, 0.02
    pad = 0.03 if cushion else 0.0
    under = seat - pad - board
    builder.add(frame, box((-x, x), (-y, y), (under, under + board)))
    _add_legs(builder, frame, (x, y), leg, under)
    deck = under + board
    rear = (y - 0.03, y)
    if cushion:
        builder.add(cushion, box((-x + 0.01, x - 0.01), (-y + 0.005, rear[0] - 0.01), (deck, seat)))
    for side in (-1, 1):
        post = between(side * x, side * (x - leg))
        builder.add(frame, _leaning(post, rear, (deck, height), lean, deck))
    inner, middle = (-x + leg, x - leg), (rear[0] + 0.008, rear[1] - 0.008)
    add_slats = _add_upright_slats if upright_slats else _add_level_slats
    add_slats(builder, frame, slats, (inner, middle, (deck, height)), lean)
    return builder.build()


def _add_legs(
    builder: ModelBuilder, frame: m.Material, half: tuple[float, float], leg: float, under: float
) -> None:
    """Square legs at the corners and rails between them."""
    x, y = half
    for sx in (-1, 1):
        for sy in (-1, 1):
            bx, by = between(sx * x, sx * (x - leg)), between(sy * y, sy * (y - leg))
            builder.add(frame, box(bx, by, (0.0, under)))
    rail = (under - 0.05, under)
    for side in (-1, 1):
        c = side * (x - leg / 2)
        builder.add(frame, box((c - 0.01, c + 0.01), (-y + leg, y - leg), rail))
        c = side * (y - leg / 2)
        builder.add(frame, box((-x + leg, x - leg), (c - 0.01, c + 0.01), rail))


def _add_upright_slats(
    builder: ModelBuilder, frame: m.Material, slats: int, back: Space, lean: float
) -> None:
    inner, y, (deck, height) = back
    builder.add(frame, _leaning(inner, y, (height - 0.06, height), lean, deck))
    edges = np.linspace(inner[0], inner[1], 2 * slats + 2)
    for a, b in zip(edges[1::2], edges[2::2]):
        span = (round(a, 4), round(b, 4))
        builder.add(frame, _leaning(span, y, (deck, height - 0.06), lean, deck))


def _add_level_slats(
    builder: ModelBuilder, frame: m.Material, slats: int, back: Space, lean: float
) -> None:
    inner, y, (deck, height) = back
    pitch = (height - deck - 0.12) / slats
    for k in range(slats):
        top = round(height - k * pitch, 4)
        builder.add(frame, _leaning(inner, y, (top - 0.65 * pitch, top), lean, deck))


def shell_chair(
    name: str,
    width: float = 0.46,
    depth: float = 0.44,
    seat: float = 0.45,
    height: float = 0.82,
    *,
    lean: float = 0.2,
    shell: m.Material = m.WHITE_PLASTIC,
    frame: m.Material = m.STEEL_TUBE,
    arms: bool = False,
) -> CadModel:
    """A plastic or upholstered seat and back on four straight tubes."""
    builder = ModelBuilder("chair", name, symmetry=1)
    x, y, tube, board = width / 2, depth / 2, 0.022, 0.025
    deck = seat - board
    builder.add(shell, box((-x, x), (-y, y), (deck, seat)))
    for sx in (-1, 1):
        for sy in (-1, 1):
            cx, cy = sx * (x - 0.03), sy * (y - 0.03)
            leg = box((cx - tube / 2, cx + tube / 2), (cy - tube / 2, cy + tube / 2), (0.0, deck))
            builder.add(frame, leg)
    rear = (y - 0.022, y)
    back = (-x + 0.01, x - 0.01)
    low = seat + 0.5 * (height - seat) if not arms else seat
    for side in (-1, 1) if low > seat else ():
        c = side * (x - 0.06)
        builder.add(frame, _leaning((c - 0.011, c + 0.011), rear, (seat, low), lean, seat))
    builder.add(shell, _leaning(back, rear, (low, height), lean, seat))
    for side in (-1, 1) if arms else ():
        c, arm = side * (x - 0.025), seat + 0.2
        span = (c - 0.025, c + 0.025)
        builder.add(shell, box(span, (-y + 0.06, rear[0] - 0.002), (arm, arm + 0.03)))
        builder.add(frame, box((c - 0.011, c + 0.011), (-y + 0.08, -y + 0.102), (seat, arm)))
        builder.add(frame, box((c - 0.011, c + 0.011), (y - 0.1, y - 0.078), (seat, arm)))
    return builder.build()


def office_chair(
    name: str,
    width: float = 0.48,
    depth: float = 0.46,
    seat: float = 0.47,
    height: float = 0.98,
    *,
    arms: bool = True,
    fabric: m.Material = m.GREY_FABRIC,
) -> CadModel:
    """Seat and back on a column over a foot with five arms on casters; it does not turn."""
    builder = ModelBuilder("chair", name, symmetry=1)
    frame, x, y, pad = m.BLACK_TUBE, width / 2, depth / 2, 0.07
    deck = seat - pad
    builder.add(fabric, box((-x, x), (-y, y), (deck, seat)))
    builder.add(frame, box((-0.09, 0.09), (-0.1, 0.1), (deck - 0.025, deck)))
    builder.add(frame, frustum((0.025, 0.025), (0.105, deck - 0.025)))
    builder.add(frame, frustum((0.045, 0.04), (0.06, 0.105)))
    for k in range(5):
        builder.add(m.PLASTIC, *_foot(np.pi / 2 + 2 * np.pi * k / 5), carries=False)
    rear = (y - 0.05, y)
    spine = (-0.03, 0.03)
    low = seat + 0.12
    builder.add(frame, _leaning(spine, (y - 0.03, y), (seat, low), 0.12, seat))
    back = (-x + 0.02, x - 0.02)
    builder.add(fabric, _leaning(back, rear, (low, height), 0.12, seat))
    for side in (-1, 1) if arms else ():
        c, arm = side * (x - 0.03), seat + 0.21
        builder.add(m.PLASTIC, box((c - 0.03, c + 0.03), (-0.12, 0.13), (arm, arm + 0.03)))
        builder.add(frame, box((c - 0.015, c + 0.015), (-0.02, 0.03), (seat, arm)))
    return builder.build()


def _foot(angle: float) -> list[Solid]:
    """One arm of the foot and its caster."""
    along, across = (
        np.array([np.cos(angle), np.sin(angle)]),
        np.array([-np.sin(angle), np.cos(angle)]),
    )
    reach, root = 0.29, 0.06

    def corners(a: float, b: float, half: float) -> np.ndarray:
        return np.array([a * along - half * across, b * along - half * across,
                         b * along + half * across, a * along + half * across])  # fmt: skip

    arm = prism(np.round(corners(root, reach, 0.02), 5), "z", (0.06, 0.085))
    caster = prism(np.round(corners(reach - 0.05, reach, 0.018), 5), "z", (0.0, 0.06))
    return [arm, caster]


def sofa(
    name: str,
    width: float,
    depth: float = 0.88,
    height: float = 0.82,
    *,
    seats: int = 2,
    arm: float = 0.16,
    seat: float = 0.43,
    arm_height: float = 0.60,
    fabric: m.Material = m.GREY_FABRIC,
    chaise: float = 0.0,
) -> CadModel:
    """A base on feet, arms, a back, and seat cushions; ``chaise`` lengthens the right-hand one."""
    builder = ModelBuilder("sofa", name, symmetry=1)
    x, y, foot, cushion, back = width / 2, depth / 2, 0.09, 0.15, 0.22
    front = -y
    low = foot
    deck = seat - cushion
    inner = (-x + arm, x - arm)
    rear = y - back
    builder.add(fabric, box(inner, (front, rear), (low, deck)))
    builder.add(fabric, box(inner, (rear, y), (low, height)))
    for side in (-1, 1) if arm else ():
        span = between(side * x, side * (x - arm))
        builder.add(fabric, box(span, (front, y), (low, arm_height)))
    edges = [round(v, 3) for v in np.linspace(inner[0], inner[1], seats + 1)]
    for i, (a, b) in enumerate(itertools.pairwise(edges)):
        span = (a + (0.0015 if i else 0), b - (0.0015 if i < seats - 1 else 0))
        builder.add(fabric, box(span, (front + 0.01, rear), (deck, seat)))
    if chaise:
        span = (edges[-2] + 0.0015, x)
        builder.add(fabric, box(span, (front - chaise, front), (low, seat)))
    feet = [(-x, front), (x, front - chaise), (-x, y), (x, y)]
    if chaise:
        feet.append((edges[-2] + 0.12, front - chaise))
    _add_feet(builder, feet, foot)
    return builder.build()


def _add_feet(builder: ModelBuilder, corners: list[tuple[float, float]], height: float) -> None:
    """Wooden feet a little inside the given corners."""
    for x, y in corners:
        cx = x + 0.06 if x < 0 else x - 0.06
        cy = y + 0.06 if y < 0 else y - 0.06
        foot = box((cx - 0.025, cx + 0.025), (cy - 0.025, cy + 0.025), (0.0, height))
        builder.add(m.BLACK_WOOD, foot)
