"""Carcasses with doors and drawers: what cabinets, counters, desks and wall units share.

Boards are 18 mm, backs 8 mm, as furniture of particle board is made. Fronts lie before the
carcass with 2 mm between, and 3 mm between one another; a door turns about the outer edge of its
front face, so that it never leaves its own width while it opens to 90 degrees.
"""

from __future__ import annotations

import dataclasses
from typing import Literal

from . import materials as m
from .builder import BASE, ModelBuilder
from .solids import box

BOARD_M = 0.018
BACK_M = 0.008
FRONT_M = 0.018
CLEARANCE_M = 0.002
OPEN_RAD = 1.57
_SEAM_M = 0.0015
"""Half the gap between fronts."""
_RAIL_M = 0.013
"""Drawer rails take this on each side."""
_DRAWER_BOARD_M = 0.012

FrontKind = Literal["door_left", "door_right", "drawer", "open"]
Bounds = tuple[float, float]
Space = tuple[Bounds, Bounds, Bounds]


@dataclasses.dataclass(frozen=True)
class Front:
    """What closes one opening. ``door_left`` has its hinge at the left, seen from the front."""

    kind: FrontKind
    share: float = 1.0
    """Of the column's height, relative to the other fronts of the column."""


@dataclasses.dataclass(frozen=True)
class Column:
    """Fronts above one another, from the top down."""

    fronts: tuple[Front, ...]
    share: float = 1.0
    """Of the width, relative to the other columns."""


@dataclasses.dataclass(frozen=True)
class Look:
    """Materials of a unit, and its shelves."""

    board: m.Material = m.WHITE_BOARD
    front: m.Material = m.WHITE_BOARD
    handle: m.Material = m.STEEL
    shelf_spacing: float = 0.38
    """A closed opening gets a shelf for about every so many metres."""
    covered: bool = False
    """A top lies over the fronts, which then end below it."""


def add_carcass(
    builder: ModelBuilder, space: Space, columns: tuple[Column, ...], look: Look
) -> None:
    """A hollow body that fills ``space`` (fronts included, handles not), with its fronts."""
    (x0, x1), (y0, y1), (z0, z1) = space
    face = y0 + FRONT_M + CLEARANCE_M
    t = BOARD_M
    body = (face, y1)
    builder.add(look.board, box((x0, x0 + t), body, (z0, z1)), box((x1 - t, x1), body, (z0, z1)))
    builder.add(look.board, box((x0 + t, x1 - t), body, (z0, z0 + t)))
    builder.add(look.board, box((x0 + t, x1 - t), body, (z1 - t, z1)))
    builder.add(look.board, box((x0 + t, x1 - t), (y1 - BACK_M, y1), (z0 + t, z1 - t)))
    edges = _edges(x0, x1, [c.share for c in columns])
    for i, column in enumerate(columns):
        left, right = edges[i], edges[i + 1]
        inner = (left + (t if i == 0 else t / 2), right - (t if i == len(columns) - 1 else t / 2))
        if i:
            wall = (left - t / 2, left + t / 2)
            builder.add(look.board, box(wall, (face, y1 - BACK_M), (z0 + t, z1 - t)))
        outer = (left, right)
        _add_column(builder, column, outer, inner, ((x0, x1), (y0, y1), (z0, z1)), look)


def _edges(low: float, high: float, shares: list[float]) -> list[float]:
    """Bounds of consecutive spans, on whole millimetres between the ends."""
    total, run, edges = sum(shares), 0.0, [low]
    for share in shares[:-1]:
        run += share
        edges.append(low + round((high - low) * run / total, 3))
    return [*edges, high]


def _add_column(
    builder: ModelBuilder, column: Column, outer: Bounds, inner: Bounds, space: Space, look: Look
) -> None:
    (x0, x1), (y0, y1), (z0, z1) = space
    edges = _edges(z0, z1, [f.share for f in reversed(column.fronts)])
    fronts = column.fronts[::-1]
    depth = (y0 + FRONT_M + CLEARANCE_M, y1 - BACK_M)
    for i, front in enumerate(fronts):
        low, high = edges[i], edges[i + 1]
        boarded = [
            k == 0 or k == len(fronts) or {fronts[k - 1].kind, fronts[k].kind} != {"drawer"}
            for k in (i, i + 1)
        ]
        if i > 0 and boarded[0]:
            builder.add(look.board, box(inner, depth, (low - BOARD_M / 2, low + BOARD_M / 2)))
        floor = low + (BOARD_M if i == 0 else BOARD_M / 2 if boarded[0] else _SEAM_M)
        roof = high - (BOARD_M if i == len(fronts) - 1 else BOARD_M / 2 if boarded[1] else _SEAM_M)
        opening = (inner, depth, (floor, roof))
        wide, tall = _seam(outer, (x0, x1)), _seam((low, high), (z0, z1))
        if look.covered and high == z1:
            tall = (tall[0], z1 - CLEARANCE_M)
        panel = (wide, (y0, y0 + FRONT_M), tall)
        if front.kind == "drawer":
            _add_drawer(builder, panel, opening, look)
        else:
            _add_shelves(builder, opening, look)
            if front.kind != "open":
                _add_door(builder, panel, front.kind == "door_left", look)


def _seam(bounds: Bounds, whole: Bounds) -> Bounds:
    """Front bounds: half a seam from neighbours, flush with the body at its outside."""
    low, high = bounds
    return (
        low if low == whole[0] else low + _SEAM_M,
        high if high == whole[1] else high - _SEAM_M,
    )


def _add_shelves(builder: ModelBuilder, opening: Space, look: Look) -> None:
    x, (y0, y1), (z0, z1) = opening
    count = round((z1 - z0) / look.shelf_spacing) - 1
    for k in range(count):
        z = z0 + round((z1 - z0) * (k + 1) / (count + 1), 3)
        builder.add(look.board, box(x, (y0 + 0.02, y1), (z - BOARD_M / 2, z + BOARD_M / 2)))


def _new_link(builder: ModelBuilder, kind: str) -> str:
    return f"{kind}_{sum(name.startswith(kind) for name in builder.links) + 1}"


def _add_door(builder: ModelBuilder, panel: Space, hinge_left: bool, look: Look) -> None:
    (x0, x1), (y0, y1), (z0, z1) = panel
    name = _new_link(builder, "door")
    builder.add(look.front, box((x0, x1), (y0, y1), (z0, z1)), link=name)
    # Hands reach for the free edge: halfway up, or low on what hangs on a wall.
    along = min(0.16, 0.5 * (z1 - z0))
    center = z0 + (z1 - z0) * (0.5 if z0 < 1.0 else 0.25)
    grip = x1 - 0.045 if hinge_left else x0 + 0.045
    add_bar_handle(
        builder, (grip, y0, center), along, upright=True, link=name, material=look.handle
    )
    hinge = x0 if hinge_left else x1
    axis = (0, 0, -1) if hinge_left else (0, 0, 1)
    builder.hinge(name, (hinge, y0, (z0 + z1) / 2), axis, OPEN_RAD)


def _add_drawer(builder: ModelBuilder, panel: Space, opening: Space, look: Look) -> None:
    (px0, px1), (y0, y1), (pz0, pz1) = panel
    (ix0, ix1), (_, back), (floor, roof) = opening
    name, t = _new_link(builder, "drawer"), _DRAWER_BOARD_M
    builder.add(look.front, box((px0, px1), (y0, y1), (pz0, pz1)), link=name)
    x0, x1, end = ix0 + _RAIL_M, ix1 - _RAIL_M, back - 0.02
    z0 = floor + 0.008
    z1 = z0 + max(0.03, round(0.72 * (roof - z0), 3))
    sides = [box((x0, x0 + t), (y1, end), (z0, z1)), box((x1 - t, x1), (y1, end), (z0, z1))]
    builder.add(look.board, *sides, link=name)
    builder.add(look.board, box((x0 + t, x1 - t), (end - t, end), (z0, z1)), link=name)
    builder.add(look.board, box((x0 + t, x1 - t), (y1, end - t), (z0, z0 + t)), link=name)
    middle, height = (px0 + px1) / 2, pz1 - min(0.06, (pz1 - pz0) / 2)
    along = min(0.20, 0.5 * (px1 - px0))
    add_bar_handle(
        builder, (middle, y0, height), along, upright=False, link=name, material=look.handle
    )
    builder.slide(name, (0, -1, 0), round(0.75 * (end - y1), 2))


def add_bar_handle(
    builder: ModelBuilder,
    at: tuple[float, float, float],
    length: float,
    *,
    upright: bool,
    link: str = BASE,
    material: m.Material = m.STEEL,
    thickness: float = 0.012,
    reach: float = 0.035,
) -> None:
    """A bar on two studs before the front face at ``at``; fingers fit behind it."""
    x, y, z = at
    half, r = length / 2, thickness / 2

    def piece(a: float, b: float, depth: Bounds) -> None:
        across, along = (-r, r), (a, b)
        dx, dz = (across, along) if upright else (along, across)
        shape = box((x + dx[0], x + dx[1]), depth, (z + dz[0], z + dz[1]))
        builder.add(material, shape, link=link, handle=True)

    bar = (y - reach, y - reach + thickness)
    piece(-half, half, bar)
    studs = (bar[1], y)
    piece(-half, -half + thickness, studs)
    piece(half - thickness, half, studs)
