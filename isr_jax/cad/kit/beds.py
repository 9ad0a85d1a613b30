"""Beds.

Mattresses are 1.9 to 2.0 m long, 0.8 to 1.8 m wide (EN 1334) and 0.14 to 0.25 m thick; one lies
0.4 to 0.6 m above the floor; headboards end at 0.8 to 1.2 m.
"""

from __future__ import annotations

from ...cad_types import CadModel
from . import materials as m
from .builder import ModelBuilder
from .solids import between, box

_RAIL_M = 0.03


def bed(
    name: str,
    width: float,
    length: float = 2.0,
    *,
    lying: float = 0.5,
    mattress: float = 0.2,
    headboard: float = 0.95,
    footboard: float = 0.0,
    frame: m.Material = m.OAK,
    pillows: int = 1,
    side_back: float = 0.0,
) -> CadModel:
    """A mattress of ``width`` x ``length`` in a frame on legs; headboard at +y, feet to -y.

    ``lying`` is the height of the mattress' top; a daybed has a ``side_back`` along +x.
    """
    builder = ModelBuilder("bed", name, symmetry=1)
    x, y, rail = width / 2, length / 2, _RAIL_M
    low = lying - mattress
    deck = (low - 0.02, low)
    rails = (max(0.1, low - 0.14), low + 0.06)
    for side in (-1, 1):
        span = between(side * x, side * (x + rail))
        builder.add(frame, box(span, (-y, y), rails))
    builder.add(m.SLATS, box((-x, x), (-y, y), deck))
    builder.add(m.MATTRESS, box((-x, x), (-y, y), (low, lying)))
    ends = ((1, max(headboard, rails[1])), (-1, max(footboard, rails[1])))
    for end, top in ends:
        span = between(end * y, end * (y + 0.04))
        builder.add(frame, box((-x - rail, x + rail), span, (rails[0], top)))
        for side in (-1, 1):
            leg = between(side * (x + rail), side * (x + rail - 0.06))
            builder.add(frame, box(leg, span, (0.0, rails[0])))
    if side_back:
        builder.add(frame, box((x, x + rail), (-y, y), (rails[1], side_back)))
    _add_pillows(builder, pillows, x, y, lying)
    return builder.build()


def _add_pillows(builder: ModelBuilder, count: int, x: float, y: float, lying: float) -> None:
    step = 2 * x / max(count, 1)
    for k in range(count):
        center, half = -x + (k + 0.5) * step, min(0.32, 0.42 * step)
        across = (round(center - half, 3), round(center + half, 3))
        builder.add(
            m.PILLOW, box(across, (y - 0.45, y - 0.05), (lying, lying + 0.1)), carries=False
        )


def divan(
    name: str,
    width: float,
    length: float = 2.0,
    *,
    lying: float = 0.58,
    headboard: float = 1.15,
    fabric: m.Material = m.GREY_FABRIC,
    pillows: int = 2,
) -> CadModel:
    """A mattress on an upholstered box, with an upholstered headboard if it has a height."""
    builder = ModelBuilder("bed", name, symmetry=1)
    x, y, foot, spring = width / 2, length / 2, 0.05, lying - 0.24
    builder.add(fabric, box((-x, x), (-y, y), (foot, spring)))
    builder.add(m.MATTRESS, box((-x, x), (-y, y), (spring, lying)))
    if headboard:
        builder.add(fabric, box((-x, x), (y, y + 0.09), (foot, headboard)))
    for side in (-1, 1):
        for end in (-1, 1):
            cx, cy = side * (x - 0.08), end * (y - 0.08)
            leg = box((cx - 0.03, cx + 0.03), (cy - 0.03, cy + 0.03), (0.0, foot))
            builder.add(m.BLACK_WOOD, leg)
    _add_pillows(builder, pillows, x, y, lying)
    return builder.build()
