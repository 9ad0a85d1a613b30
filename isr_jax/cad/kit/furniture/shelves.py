"""Bookshelves: of boards, of posts, leaning like ladders, and hung on walls.

Shelves are 0.24 to 0.4 m deep, 0.28 to 0.38 m apart, boards 16 to 25 mm thick; racks of steel have
posts of 30 mm (makers' catalogues).
"""

from __future__ import annotations

import itertools

import numpy as np

from .. import materials as m
from ..builder import ModelBuilder
from ..solids import between, box, prism
from .fronts import BACK_M, BOARD_M, Column, Look, add_carcass


def bookshelf(
    width: float,
    depth: float,
    height: float,
    *,
    rows: int = 5,
    columns: int = 1,
    board: m.Material = m.WHITE_BOARD,
    back: bool = True,
    plinth: float = 0.06,
) -> ModelBuilder:
    """Boards between two sides, open to the front, and to the rear too without ``back``."""
    builder = ModelBuilder("bookshelf", symmetry=1 if back else 2)
    x, y, t = width / 2, depth / 2, BOARD_M
    rear = y - BACK_M if back else y
    for side in (-1, 1):
        bounds = between(side * x, side * (x - t))
        builder.add(board, box(bounds, (-y, y), (0.0, height)))
    inner, low = (-x + t, x - t), plinth
    if plinth:
        kick = (-y + 0.02, -y + 0.038) if back else (-0.009, 0.009)
        builder.add(board, box(inner, kick, (0.0, plinth)))
    levels = [low + round((height - t - low) * i / rows, 3) for i in range(rows)] + [height - t]
    for level in levels:
        builder.add(board, box(inner, (-y, rear), (level, level + t)))
    if back:
        builder.add(board, box(inner, (rear, y), (low, height)))
    for k in range(1, columns):
        c = round((inner[1] - inner[0]) * (k / columns - 0.5), 4)
        for a, b in itertools.pairwise(levels):
            builder.add(board, box((c - t / 2, c + t / 2), (-y, rear), (a + t, b)))
    return builder


def door_bookshelf(
    width: float,
    depth: float,
    height: float,
    *,
    columns: tuple[Column, ...],
    look: Look | None = None,
    plinth: float = 0.06,
) -> ModelBuilder:
    """Open shelves above doors or drawers; or shelves behind glass doors."""
    builder = ModelBuilder("bookshelf", symmetry=1)
    x, y = width / 2, depth / 2
    builder.add(m.PLINTH, box((-x, x), (-y + 0.04, y - 0.01), (0.0, plinth)))
    add_carcass(builder, ((-x, x), (-y, y), (plinth, height)), columns, look or Look())
    return builder


def post_rack(
    width: float,
    depth: float,
    height: float,
    *,
    rows: int = 5,
    post: float = 0.03,
    frame: m.Material = m.BLACK_TUBE,
    board: m.Material = m.OAK_BOARD,
    lowest: float = 0.08,
    braces: bool = True,
) -> ModelBuilder:
    """Boards between four posts, as racks and industrial shelves are."""
    builder = ModelBuilder("bookshelf", symmetry=1 if braces else 2)
    x, y, t = width / 2, depth / 2, 0.022
    for sx in (-1, 1):
        for sy in (-1, 1):
            bx, by = between(sx * x, sx * (x - post)), between(sy * y, sy * (y - post))
            builder.add(frame, box(bx, by, (0.0, height)))
    inner, along = (-x + post, x - post), (-y + post, y - post)
    for k in range(rows):
        top = lowest + t + round((height - 0.01 - lowest - t) * k / (rows - 1), 3)
        z = (top - t, top)
        builder.add(board, box(inner, (-y + 0.004, y - 0.004), z))
        for side in (-1, 1):
            builder.add(frame, box(between(side * x, side * (x - post)), along, z))
    for k in range(1, rows) if braces else ():
        z = lowest + round((height - lowest) * (k - 0.35) / (rows - 1), 3)
        builder.add(frame, box(inner, (y - 0.016, y - 0.01), (z, z + 0.03)))
    return builder


def ladder_shelf(
    width: float,
    depth: float,
    height: float,
    *,
    rows: int = 5,
    frame: m.Material = m.OAK,
    board: m.Material | None = None,
) -> ModelBuilder:
    """Boards between two frames that get shallower upwards; its back stands upright."""
    builder = ModelBuilder("bookshelf", symmetry=1)
    x, y, t, rail = width / 2, depth / 2, 0.02, 0.03
    shallow = 0.5 * depth

    def front(z: float) -> float:
        return -y + (depth - shallow) * z / height

    sides = [between(s * x, s * (x - t)) for s in (-1, 1)]
    for side in sides:
        builder.add(frame, box(side, (y - rail, y), (0.0, height)))
        outline = [
            (front(0), 0.0),
            (front(0) + rail, 0.0),
            (front(height) + rail, height),
            (front(height), height),
        ]
        builder.add(frame, prism(np.round(outline, 6), "x", side))
    for k in range(rows):
        top = round(0.1 + (height - 0.12) * k / (rows - 1), 3)
        low = top - t
        ends = [round(front(z), 6) for z in (low, top)]
        outline = [(ends[0], low), (y, low), (y, top), (ends[1], top)]
        builder.add(board or frame, prism(outline, "x", (-x + t, x - t)))
        for side in sides:
            outline = [
                (ends[0] + rail, low),
                (y - rail, low),
                (y - rail, top),
                (ends[1] + rail, top),
            ]
            builder.add(frame, prism(np.round(outline, 6), "x", side))
    return builder


def wall_shelf(
    width: float,
    depth: float,
    height: float,
    *,
    rows: int = 1,
    board: m.Material = m.OAK,
    framed: bool = False,
) -> ModelBuilder:
    """Boards on brackets, or in a frame, that hang on a wall."""
    builder = ModelBuilder("bookshelf", symmetry=2 if framed else 1, mount="wall")
    x, y, t = width / 2, depth / 2, 0.025
    sides = (-x, x)
    if framed:
        for side in (-1, 1):
            builder.add(board, box(between(side * x, side * (x - t)), (-y, y), (0.0, height)))
        sides = (-x + t, x - t)
        levels = [round((height - t) * k / rows, 3) for k in range(rows)] + [height - t]
    else:
        levels = [
            height - t - round(0.86 * (height - t) * k / max(rows - 1, 1), 3) for k in range(rows)
        ]
    for level in levels:
        builder.add(board, box(sides, (-y, y), (level, level + t)))
    if framed:
        return builder
    for side in (-0.7, 0.7):
        c = round(side * x, 4)
        bar = (c - 0.012, c + 0.012)
        spans = [*levels, 0.0]
        for upper, lower in itertools.pairwise(spans):
            start = lower + t if lower else 0.0
            builder.add(m.BLACK_TUBE, box(bar, (y - 0.006, y), (start, upper)))
        for level in levels:
            drop = min(0.1, 0.8 * level)
            outline = [(y - 0.006, level - drop), (y - 0.006, level), (-0.6 * y, level)]
            builder.add(m.BLACK_TUBE, prism(outline, "x", bar))
    return builder
