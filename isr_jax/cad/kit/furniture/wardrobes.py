"""Wardrobes: with doors that turn or slide, and open ones.

Wardrobes are 0.5 to 0.68 m deep, so that hangers of 0.45 m go in, 1.8 to 2.36 m high, and 0.5 m
wide for each door that turns, 0.75 to 1.2 m for each that slides (makers' catalogues).
"""

from __future__ import annotations

import dataclasses

from .. import materials as m
from ..builder import ModelBuilder
from ..solids import between, box, circle, prism, split
from .fronts import BACK_M, BOARD_M, Bounds, Column, Look, Space, add_carcass, add_hanging_rod
from .storage import Stand, add_feet

_PANEL_M = 0.022
_GAP_M = 0.004
_EDGE_M = 0.03


def wardrobe(
    width: float,
    depth: float,
    height: float,
    *,
    columns: tuple[Column, ...],
    look: Look | None = None,
    plinth: float = 0.08,
    feet: float = 0.0,
    stand: Stand = "square",
    cornice: float = 0.0,
) -> ModelBuilder:
    """A body with doors that turn, a rod for clothes behind tall ones, on a plinth or feet.

    A ``cornice`` is a board on top that overhangs all round.
    """
    look = dataclasses.replace(look or Look(), hang=True)
    builder = ModelBuilder("wardrobe", symmetry=1)
    x, y, c = width / 2, depth / 2, cornice
    low = max(plinth, feet)
    high = height - (0.03 if c else 0.0)
    bx, by = x - c, y - c
    if c:
        builder.add(look.front, box((-x, x), (-y, y), (high, height)))
        look = dataclasses.replace(look, covered=True)
    if plinth:
        builder.add(m.PLINTH, box((-bx, bx), (-by + 0.05, by - 0.02), (0.0, plinth)))
    elif feet:
        add_feet(builder, (bx, by), feet, stand, look.front)
    add_carcass(builder, ((-bx, bx), (-by, by), (low, high)), columns, look)
    return builder


def sliding_wardrobe(
    width: float,
    depth: float,
    height: float,
    *,
    doors: int = 2,
    look: Look | None = None,
    fillings: tuple[m.Material, ...] = (),
    plinth: float = 0.06,
) -> ModelBuilder:
    """A body whose doors slide before one another, each in a track of its own.

    ``fillings`` are what the doors show, one each; those of ``look.front`` by default.
    """
    look = look or Look()
    builder = ModelBuilder("wardrobe", symmetry=1)
    x, y, t = width / 2, depth / 2, BOARD_M
    tracks = doors * (_PANEL_M + _GAP_M) + _GAP_M
    face, body = -y + tracks, (-y, y)
    low, rear = plinth, y - BACK_M
    builder.add(m.PLINTH, box((-x, x), (-y + 0.03, y - 0.02), (0.0, plinth)))
    for side in (-1, 1):
        builder.add(look.board, box(between(side * x, side * (x - t)), body, (low, height)))
    inner = (-x + t, x - t)
    builder.add(look.board, box(inner, body, (low, low + t)))
    builder.add(look.board, box(inner, body, (height - t, height)))
    room = (low + t, height - t)
    builder.add(look.board, box(inner, (rear, y), room))
    edges = split(*inner, doors)
    for k in range(1, doors):
        wall = (edges[k] - t / 2, edges[k] + t / 2)
        builder.add(look.board, box(wall, (face, rear), room))
    for k in range(doors):
        left = edges[k] + (t / 2 if k else 0.0)
        right = edges[k + 1] - (t / 2 if k < doors - 1 else 0.0)
        _furnish(builder, ((left, right), (face, rear), room), look, hang=k % 2 == 0)
    fills = fillings or (look.front,) * doors
    for k in range(doors):
        _add_sliding_door(builder, k, inner, doors, (-y, room), (look.handle, fills[k]))
    return builder


def _furnish(builder, space: Space, look: Look, *, hang: bool) -> None:
    """A rod and a shelf for hats, or shelves all the way up."""
    if hang:
        add_hanging_rod(builder, space, look.board)
        return
    x, (y0, y1), (z0, z1) = space
    count = max(1, round((z1 - z0) / 0.38) - 1)
    for k in range(count):
        z = z0 + round((z1 - z0) * (k + 1) / (count + 1), 3)
        board = box(x, (y0 + 0.02, y1), (z - BOARD_M / 2, z + BOARD_M / 2))
        builder.add(look.board, board)


def _add_sliding_door(
    builder, k: int, inner: Bounds, doors: int, place: tuple[float, Bounds], materials
) -> None:
    """A door between two edge profiles, behind the ones to its left."""
    (front, room), (handle, filling), overlap = place, materials, 0.025
    name, pitch = f"door_{k + 1}", (inner[1] - inner[0] - 2 * _GAP_M) / doors
    start = inner[0] + _GAP_M + k * pitch - (overlap if k else 0.0)
    end = inner[0] + _GAP_M + (k + 1) * pitch + (overlap if k < doors - 1 else 0.0)
    x0, x1 = round(start, 4), round(end, 4)
    near = front + k * (_PANEL_M + _GAP_M)
    y, z = (near, near + _PANEL_M), (room[0] + _GAP_M, room[1] - _GAP_M)
    for edge in ((x0, x0 + _EDGE_M), (x1 - _EDGE_M, x1)):
        builder.add(handle, box(edge, y, z), link=name)
    panel = (near + 0.004, near + _PANEL_M - 0.004)
    builder.add(filling, box((x0 + _EDGE_M, x1 - _EDGE_M), panel, z), link=name)
    to_right = k < doors - 1
    travel = round(pitch - 2 * overlap - _GAP_M, 3)
    # Fingers take the profile at the side that the door opens.
    grip = x0 + _EDGE_M / 2 if to_right else x1 - _EDGE_M / 2
    at = (grip, near, room[0] + 0.5 * (room[1] - room[0]))
    axis = (1, 0, 0) if to_right else (-1, 0, 0)
    builder.slide(name, axis, travel, damping=8.0, friction=4.0, at=at)


def open_wardrobe(
    width: float,
    depth: float,
    height: float,
    *,
    board: m.Material = m.OAK_BOARD,
    frame: m.Material = m.BLACK_TUBE,
    shelves: int = 2,
) -> ModelBuilder:
    """A rack of tubes with a rod for clothes, and boards at its foot."""
    builder = ModelBuilder("wardrobe", symmetry=2)
    x, y, tube = width / 2, depth / 2, 0.025
    for sx in (-1, 1):
        bx = between(sx * x, sx * (x - tube))
        for sy in (-1, 1):
            by = between(sy * y, sy * (y - tube))
            builder.add(frame, box(bx, by, (0.0, height)))
        for z in ((0.05, 0.05 + tube), (height - tube, height)):
            builder.add(frame, box(bx, (-y + tube, y - tube), z))
    inner = (-x + tube, x - tube)
    rod = circle(0.0125, 8, (0.0, height - tube / 2))
    builder.add(frame, prism(rod, "x", inner), carries=False)
    for k in range(shelves):
        z = 0.075 + 0.28 * k
        builder.add(board, box(inner, (-y, y), (z, z + 0.018)))
    return builder
