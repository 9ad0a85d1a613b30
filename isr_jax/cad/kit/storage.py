"""Cabinets, wall cabinets, counters and bookshelves.

Kitchen base units are 0.72 m on a plinth of 0.08 to 0.15 m, 0.56 m deep plus fronts, in widths
of 0.3 to 1.2 m; wall units are 0.35 to 0.4 m deep and 0.35 to 0.9 m high; worktops stand 0.86 to
0.94 m high and 0.6 to 0.65 m deep (EN 1116). Bookshelves are 0.24 to 0.4 m deep.
"""

from __future__ import annotations

import dataclasses
import itertools

from ...cad_types import CadModel
from . import materials as m
from .builder import ModelBuilder
from .fronts import BACK_M, BOARD_M, Column, Look, add_carcass
from .solids import between, box


def cabinet(
    name: str,
    width: float,
    depth: float,
    height: float,
    columns: tuple[Column, ...],
    *,
    look: Look | None = None,
    plinth: float = 0.08,
    top: m.Material | None = None,
    feet: float = 0.0,
) -> CadModel:
    """A hollow body with doors and drawers on a plinth or feet, with a separate top if given."""
    look = dataclasses.replace(look or Look(), covered=top is not None)
    builder = ModelBuilder("cabinet", name, symmetry=1)
    x, y = width / 2, depth / 2
    low = max(plinth, feet)
    high = height - (0.022 if top else 0.0)
    if top:
        builder.add(top, box((-x, x), (-y, y), (high, height)))
    if plinth:
        builder.add(m.PLINTH, box((-x + 0.01, x - 0.01), (-y + 0.06, y - 0.02), (0.0, plinth)))
    else:
        for side in (-1, 1):
            for front in (-1, 1):
                cx, cy = side * (x - 0.06), front * (y - 0.06)
                leg = box((cx - 0.02, cx + 0.02), (cy - 0.02, cy + 0.02), (0.0, feet))
                builder.add(m.BLACK_TUBE, leg)
    add_carcass(builder, ((-x, x), (-y, y), (low, high)), columns, look)
    return builder.build()


def wall_cabinet(
    name: str,
    width: float,
    depth: float,
    height: float,
    columns: tuple[Column, ...],
    *,
    look: Look | None = None,
) -> CadModel:
    """A hollow body that hangs on a wall by its back."""
    builder = ModelBuilder("wall_cabinet", name, symmetry=1)
    x, y = width / 2, depth / 2
    look = dataclasses.replace(look or Look(), shelf_spacing=0.26)
    # Fronts see that it hangs and put handles low.
    add_carcass(builder, ((-x, x), (-y, y), (1.4, 1.4 + height)), columns, look)
    return builder.build()


def counter(
    name: str,
    width: float,
    depth: float,
    height: float,
    columns: tuple[Column, ...],
    *,
    look: Look | None = None,
    worktop: m.Material = m.LAMINATE,
    plinth: float = 0.1,
    thickness: float = 0.038,
    upstand: float = 0.0,
) -> CadModel:
    """Base units in a row under one worktop that overhangs the fronts by 20 mm."""
    look = dataclasses.replace(look or Look(), covered=True)
    builder = ModelBuilder("counter", name, symmetry=1)
    x, y = width / 2, depth / 2
    under = height - thickness
    builder.add(worktop, box((-x, x), (-y, y), (under, height)))
    builder.add(m.PLINTH, box((-x, x), (-y + 0.07, y - 0.05), (0.0, plinth)))
    add_carcass(builder, ((-x, x), (-y + 0.02, y), (plinth, under)), columns, look)
    if upstand:
        builder.add(worktop, box((-x, x), (y - 0.02, y), (height, height + upstand)))
    return builder.build()


def bookshelf(
    name: str,
    width: float,
    depth: float,
    height: float,
    *,
    rows: int = 5,
    columns: int = 1,
    board: m.Material = m.WHITE_BOARD,
    back: bool = True,
    plinth: float = 0.06,
) -> CadModel:
    """Boards between two sides, open to the front, and to the rear too without ``back``."""
    builder = ModelBuilder("bookshelf", name, symmetry=1 if back else 2)
    x, y, t = width / 2, depth / 2, BOARD_M
    rear = y - BACK_M if back else y
    for side in (-1, 1):
        bounds = between(side * x, side * (x - t))
        builder.add(board, box(bounds, (-y, y), (0.0, height)))
    inner, low = (-x + t, x - t), plinth
    if plinth:
        kick = (-y + 0.02, -y + 0.038) if back else (-0.009, 0.009)
        builder.add(board, box(inner, kick, (0.0, plinth)))
    levels = [low + round((height - t - low) * i / rows, 3) for i in range(rows + 1)]
    for level in levels:
        builder.add(board, box(inner, (-y, rear), (level, level + t)))
    if back:
        builder.add(board, box(inner, (rear, y), (low, height)))
    for k in range(1, columns):
        c = inner[0] + round((inner[1] - inner[0]) * k / columns, 3)
        for a, b in itertools.pairwise(levels):
            builder.add(board, box((c - t / 2, c + t / 2), (-y, rear), (a + t, b)))
    return builder.build()
