"""Carcasses with doors and drawers: what cabinets, counters, desks and wall units share.

Boards are 18 mm, backs 8 mm, as furniture of particle board is made. Fronts lie before the
carcass with 2 mm between, and 3 mm between one another; a door turns about the outer edge of its
front face, so that it never leaves its own width while it opens to 90 degrees. Bar handles are
12 mm thick and stand out 35 mm, knobs 26 mm (furniture makers' catalogues).
"""

from __future__ import annotations

import dataclasses
from typing import Literal

from .. import materials as m
from ..builder import ModelBuilder
from ..solids import box, circle, prism
from .panels import Bounds, Grip, PanelKind, Space, add_grip, add_panel
from .panels import add_bar_handle as add_bar_handle  # the appliances use the same

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

_ROD_M = 0.0125
_ROD_BELOW_M = 0.06
FrontKind = Literal["door_left", "door_right", "drawer", "open", "flap", "lift"]
_KINDS: dict[str, FrontKind] = {
    "D": "drawer",
    "L": "door_left",
    "R": "door_right",
    "O": "open",
    "F": "flap",
    "U": "lift",
}


@dataclasses.dataclass(frozen=True)
class Front:
    """What closes one opening. ``door_left`` has its hinge at the left, seen from the front; a
    ``flap`` has it below, a ``lift`` above."""

    kind: FrontKind
    share: float = 1.0
    """Of the column's height, relative to the other fronts of the column."""


@dataclasses.dataclass(frozen=True)
class Column:
    """Fronts above one another, from the top down."""

    fronts: tuple[Front, ...]
    share: float = 1.0
    """Of the width, relative to the other columns."""


def columns_of(*texts: str) -> tuple[Column, ...]:
    """Columns from words, fronts from the top down: ``D`` a drawer, ``L``/``R`` a door hinged
    there, ``F`` a flap, ``U`` a lift, ``O`` open; digits after a letter are its share, digits
    at the start of a text that of the column: ``"2: D L3"``."""
    columns = []
    for text in texts:
        share, _, words = text.rpartition(":")
        fronts = tuple(Front(_KINDS[w[0]], float(w[1:] or 1)) for w in words.split())
        columns.append(Column(fronts, float(share or 1)))
    return tuple(columns)


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
    beside: bool = False
    """Legs stand beside the fronts, which then end before them."""
    panel: PanelKind = "slab"
    grip: Grip = "bar"
    hang: bool = False
    """Openings taller than 1.1 m get a shelf above a rod for clothes."""


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
        sides = (x0 + CLEARANCE_M, x1 - CLEARANCE_M) if look.beside else (x0, x1)
        # The rear edge of a door that turns reaches that much beyond its own width.
        swing = FRONT_M**2 / (2 * (outer[1] - outer[0]))
        wide = _seam(outer, (x0, x1), sides, max(_SEAM_M, round(0.00105 + swing, 4)))
        tall = _seam((low, high), (z0, z1), (z0, z1), _SEAM_M)
        if look.covered and high == z1:
            # The rear edge of a flap rises a little when it turns.
            tall = (tall[0], z1 - CLEARANCE_M - (_SEAM_M if front.kind == "flap" else 0.0))
        panel = (wide, (y0, y0 + FRONT_M), tall)
        if front.kind == "drawer":
            add_drawer(builder, panel, opening, look)
        else:
            _add_shelves(builder, opening, look)
            if front.kind != "open":
                _add_door(builder, panel, front.kind, look)


def _seam(bounds: Bounds, whole: Bounds, ends: Bounds, seam: float) -> Bounds:
    """Front bounds: ``seam`` from the middle to neighbours, ``ends`` outside."""
    low, high = bounds
    return (
        ends[0] if low == whole[0] else low + seam,
        ends[1] if high == whole[1] else high - seam,
    )


def _add_shelves(builder: ModelBuilder, opening: Space, look: Look) -> None:
    x, (y0, y1), (z0, z1) = opening
    if look.hang and z1 - z0 > 1.1:
        add_hanging_rod(builder, opening, look.board)
        return
    count = round((z1 - z0) / look.shelf_spacing) - 1
    for k in range(count):
        z = z0 + round((z1 - z0) * (k + 1) / (count + 1), 3)
        builder.add(look.board, box(x, (y0 + 0.02, y1), (z - BOARD_M / 2, z + BOARD_M / 2)))


def add_hanging_rod(builder: ModelBuilder, opening: Space, board: m.Material) -> None:
    """A shelf for hats, and a rod for clothes below it from wall to wall."""
    x, (y0, y1), (_, z1) = opening
    shelf = z1 - 0.24
    builder.add(board, box(x, (y0 + 0.02, y1), (shelf - BOARD_M, shelf)))
    rod = circle(_ROD_M, 8, ((y0 + y1) / 2, shelf - BOARD_M - _ROD_BELOW_M))
    builder.add(m.STEEL_TUBE, prism(rod, "x", x), carries=False)


def _new_link(builder: ModelBuilder, kind: str) -> str:
    return f"{kind}_{sum(name.startswith(kind) for name in builder.links) + 1}"


def _add_door(builder: ModelBuilder, panel: Space, kind: FrontKind, look: Look) -> None:
    (x0, x1), (y0, _), (z0, z1) = panel
    name = _new_link(builder, "door")
    add_panel(builder, panel, look.front, look.panel, link=name)
    middle = ((x0 + x1) / 2, (z0 + z1) / 2)
    # Hands reach for the free edge: halfway up, or low on what hangs on a wall.
    height = z0 + (z1 - z0) * (0.5 if z0 < 1.0 else 0.25)
    edge = min(0.045, 0.25 * (z1 - z0))
    at, hinge, axis = {
        "door_left": ((x1 - 0.045, height), (x0, middle[1]), (0, 0, -1)),
        "door_right": ((x0 + 0.045, height), (x1, middle[1]), (0, 0, 1)),
        "flap": ((middle[0], z1 - edge), (middle[0], z0), (1, 0, 0)),
        "lift": ((middle[0], z0 + edge), (middle[0], z1), (-1, 0, 0)),
    }[kind]
    upright = kind in ("door_left", "door_right")
    length = min(0.16, 0.5 * ((z1 - z0) if upright else (x1 - x0)))
    add_grip(builder, look.grip, (at[0], y0, at[1]), length, upright, name, look.handle)
    # Dampers and gas springs hold what opens upwards or downwards.
    damping, friction = (0.4, 0.3) if upright else (1.0, 1.5)
    origin = (hinge[0], y0, hinge[1])
    builder.hinge(name, origin, axis, OPEN_RAD, damping=damping, friction=friction)


def add_drawer(builder: ModelBuilder, panel: Space, opening: Space, look: Look) -> None:
    """A front over a box on rails, open above; ``opening`` is the room that the box has."""
    (px0, px1), (y0, y1), (pz0, pz1) = panel
    (ix0, ix1), (_, back), (floor, roof) = opening
    name, t = _new_link(builder, "drawer"), _DRAWER_BOARD_M
    add_panel(builder, panel, look.front, "slab" if look.panel == "glass" else look.panel, name)
    x0, x1, end = ix0 + _RAIL_M, ix1 - _RAIL_M, back - 0.02
    z0 = floor + 0.008
    z1 = z0 + max(0.03, round(0.72 * (roof - z0), 3))
    sides = [box((x0, x0 + t), (y1, end), (z0, z1)), box((x1 - t, x1), (y1, end), (z0, z1))]
    builder.add(look.board, *sides, link=name)
    builder.add(look.board, box((x0 + t, x1 - t), (end - t, end), (z0, z1)), link=name)
    builder.add(look.board, box((x0 + t, x1 - t), (y1, end - t), (z0, z0 + t)), link=name)
    middle, height = (px0 + px1) / 2, pz1 - min(0.06, (pz1 - pz0) / 2)
    along = min(0.20, 0.5 * (px1 - px0))
    add_grip(builder, look.grip, (middle, y0, height), along, False, name, look.handle)
    builder.slide(name, (0, -1, 0), round(0.75 * (end - y1), 2))
