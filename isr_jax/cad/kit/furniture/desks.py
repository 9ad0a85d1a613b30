"""Desks.

Desks are 0.72 to 0.76 m high and 0.6 to 0.8 m deep (EN 527-1 asks for 0.8 m by 1.2 m at work),
pedestals with drawers 0.35 to 0.45 m wide (makers' catalogues).
"""

from __future__ import annotations

from .. import materials as m
from ..builder import ModelBuilder
from ..solids import between, box, prism
from .fronts import Column, Front, Look, add_carcass

_PLINTH_M = 0.03


def panel_desk(
    width: float,
    depth: float,
    height: float,
    *,
    board: float = 0.022,
    material: m.Material = m.WHITE_BOARD,
    modesty: float = 0.35,
) -> ModelBuilder:
    """A top on two side panels, with a panel of height ``modesty`` behind the knees."""
    builder = ModelBuilder("desk", symmetry=1)
    x, y, under = width / 2, depth / 2, height - board
    builder.add(material, box((-x, x), (-y, y), (under, height)))
    for side in (-1, 1):
        bounds = between(side * x, side * (x - board))
        builder.add(material, box(bounds, (-y + 0.02, y - 0.02), (0.0, under)))
    inner = (-x + board, x - board)
    builder.add(material, box(inner, (y - 0.02 - 0.018, y - 0.02), (under - modesty, under)))
    return builder


def pedestal_desk(
    width: float,
    depth: float,
    height: float,
    *,
    drawers: int = 3,
    pedestal: float = 0.4,
    both: bool = False,
    door: bool = False,
    board: m.Material = m.OAK_BOARD,
    fronts: m.Material = m.WHITE_BOARD,
) -> ModelBuilder:
    """A top on a stack of drawers at the right, and at the left on a panel or on another stack.

    With ``door`` that other stack is one drawer over a door.
    """
    builder = ModelBuilder("desk", symmetry=1)
    x, y, top, panel = width / 2, depth / 2, 0.025, 0.022
    under = height - top
    builder.add(board, box((-x, x), (-y, y), (under, height)))
    inner = -x + (pedestal if both else panel)
    if not both:
        builder.add(board, box((-x, inner), (-y + 0.02, y - 0.02), (0.0, under)))
    edge = x - pedestal
    builder.add(board, box((inner, edge), (y - 0.04, y - 0.022), (under - 0.35, under)))
    look = Look(board, fronts, covered=True)
    depth_of_body, stack = (-y + 0.01, y - 0.02), Column((Front("drawer"),) * drawers)
    _add_pedestal(builder, (edge, x), depth_of_body, under, stack, look)
    if both:
        left = Column((Front("drawer"), Front("door_left", drawers - 1.0))) if door else stack
        _add_pedestal(builder, (-x, inner), depth_of_body, under, left, look)
    return builder


def _add_pedestal(
    builder: ModelBuilder,
    across: tuple[float, float],
    depth,
    under: float,
    column: Column,
    look: Look,
) -> None:
    """A body with fronts from a low plinth, so that drawers clear the floor, to the top."""
    (x0, x1), (y0, y1) = across, depth
    builder.add(m.PLINTH, box((x0 + 0.01, x1 - 0.01), (y0 + 0.05, y1 - 0.02), (0.0, _PLINTH_M)))
    add_carcass(builder, (across, depth, (_PLINTH_M, under)), (column,), look)


def frame_desk(
    width: float,
    depth: float,
    height: float,
    *,
    top: m.Material = m.BIRCH,
    frame: m.Material = m.BLACK_TUBE,
    inset: float = 0.18,
) -> ModelBuilder:
    """A top on two steel T legs, as sit-stand desks have."""
    builder = ModelBuilder("desk", symmetry=2)
    x, y, board = width / 2, depth / 2, 0.025
    under = height - board
    builder.add(top, box((-x, x), (-y, y), (under, height)))
    for side in (-1, 1):
        c = side * (x - inset)
        foot = box((c - 0.04, c + 0.04), (-y + 0.05, y - 0.05), (0.0, 0.03))
        builder.add(frame, foot, carries=False)
        builder.add(frame, box((c - 0.035, c + 0.035), (-0.045, 0.045), (0.03, under - 0.03)))
        builder.add(frame, box((c - 0.03, c + 0.03), (-y + 0.1, y - 0.1), (under - 0.03, under)))
    inner = x - inset - 0.03
    builder.add(frame, box((-inner, inner), (-0.03, 0.03), (under - 0.03, under)))
    return builder


def corner_desk(
    width: float,
    depth: float,
    height: float,
    *,
    deep: float = 0.6,
    board: float = 0.025,
    material: m.Material = m.OAK_BOARD,
    frame: m.Material = m.BLACK_TUBE,
) -> ModelBuilder:
    """An L: one top along the rear, one along the right side, ``deep`` each, on five legs."""
    builder = ModelBuilder("desk", symmetry=1)
    x, y, under, leg = width / 2, depth / 2, height - board, 0.05
    front = y - deep
    builder.add(material, box((-x, x), (front, y), (under, height)))
    builder.add(material, box((x - deep, x), (-y, front), (under, height)))
    corners = [(-x, y - leg), (-x, front), (x - leg, y - leg), (x - leg, -y), (x - deep, -y)]
    for cx, cy in corners:
        dx = 0.02 if cx < x - leg else -0.02
        dy = 0.02 if cy < y - leg else -0.02
        post = ((cx + dx, cx + dx + leg), (cy + dy, cy + dy + leg), (0.0, under))
        builder.add(frame, box(*post))
    builder.add(frame, box((-x + 0.07, x - 0.07), (y - 0.06, y - 0.04), (under - 0.06, under)))
    side = (-y + 0.07, y - 0.07)
    builder.add(frame, box((x - 0.06, x - 0.04), side, (under - 0.06, under)))
    return builder


def trestle_desk(
    width: float,
    depth: float,
    height: float,
    *,
    material: m.Material = m.BIRCH,
    frame: m.Material = m.PINE,
    top: float = 0.025,
) -> ModelBuilder:
    """A top on two A-shaped trestles."""
    builder = ModelBuilder("desk", symmetry=2)
    x, y, leg = width / 2, depth / 2, 0.035
    under = height - top
    builder.add(material, box((-x, x), (-y, y), (under, height)))
    head = under - 0.04
    half = min(0.34, 0.28 * width / 1.2)
    for side in (-1, 1):
        c = side * (x - 0.12 - half / 2)
        beam = (c - 0.03, c + 0.03)
        builder.add(frame, box(beam, (-y + 0.05, y - 0.05), (head, under)))
        for lean in (-1, 1):
            for sy in (-1, 1):
                by = between(sy * (y - 0.08), sy * (y - 0.08 - leg))
                foot = c + lean * half / 2
                low, high = (foot - leg / 2, foot + leg / 2), between(c, c + lean * 0.03)
                outline = [(0.0, low[0]), (head, high[0]), (head, high[1]), (0.0, low[1])]
                builder.add(frame, prism(outline, "y", by))
    return builder


def hutch_desk(
    width: float,
    depth: float,
    height: float,
    *,
    top: float = 0.74,
    hutch: float = 0.26,
    drawers: int = 3,
    board: m.Material = m.WHITE_BOARD,
    fronts: m.Material = m.OAK_BOARD,
) -> ModelBuilder:
    """A desk with drawers at the right and open compartments on the rear of its top.

    ``top`` is the height of the worktop, ``hutch`` the depth of the compartments.
    """
    builder = ModelBuilder("desk", symmetry=1)
    x, y, t, panel = width / 2, depth / 2, 0.025, 0.022
    under, edge = top - t, x - 0.38
    builder.add(board, box((-x, x), (-y, y), (under, top)))
    builder.add(board, box((-x, -x + panel), (-y + 0.02, y - 0.02), (0.0, under)))
    builder.add(board, box((-x + panel, edge), (y - 0.04, y - 0.022), (under - 0.3, under)))
    look = Look(board, fronts, covered=True)
    stack = Column((Front("drawer"),) * drawers)
    _add_pedestal(builder, (edge, x), (-y + 0.01, y - 0.02), under, stack, look)
    rows = Column((Front("open"), Front("open")))
    space = ((-x, x), (y - hutch, y), (top, height))
    add_carcass(builder, space, (rows, Column((Front("open"),)), rows), Look(board, fronts))
    return builder
