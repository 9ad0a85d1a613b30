"""Ranges, ovens and microwaves.

Ranges are 0.5 to 0.6 m wide in Europe and 0.76 or 0.91 m in America, 0.85 to 0.92 m high; built-in
ovens have fronts of 0.595 m by 0.455 or 0.595 m (EN 1116); small ovens hold 10 to 30 l.
Microwaves of 17 to 32 l are 0.44 to 0.54 m wide, 0.26 to 0.31 m high (makers' catalogues).
"""

from __future__ import annotations

from .. import materials as m
from ..builder import ModelBuilder
from ..furniture.fronts import CLEARANCE_M, OPEN_RAD
from ..furniture.panels import Space, add_bar_handle
from ..solids import ROUND_SIDES, box, frustum, prism
from .controls import add_knob_row, add_panel_with_display
from .hobs import HOB_RISE_M, HobKind, add_hob
from .ovens import OvenLook, add_cavity, add_down_door, add_racks, seam_above

_DOOR_M = 0.045
_TOP_M = 0.03
_WALL_M = 0.05
_SEAM_M = 0.003


def cooker(
    width: float,
    depth: float,
    height: float,
    *,
    hob: HobKind = "glass",
    grid: tuple[int, int] = (2, 2),
    knobs: tuple[int, int] = (2, 3),
    panel: float = 0.1,
    drawer: float = 0.18,
    splash: float = 0.0,
    look: OvenLook = OvenLook(),  # noqa: B008 - frozen
    sides: int = ROUND_SIDES,
) -> ModelBuilder:
    """A free-standing range: hob, knobs beside a clock, oven, and a drawer below if it is high.

    ``drawer`` is the height of what lies below the oven door, ``splash`` that of a board behind the
    hob, ``knobs`` how many are left and right of the clock.
    """
    builder = ModelBuilder("oven", symmetry=1)
    x, y, foot = width / 2, depth / 2, 0.04
    face = -y + _DOOR_M + CLEARANCE_M
    deck = height - max(splash, HOB_RISE_M[hob])
    under, low = deck - _TOP_M, foot + drawer
    board = under - panel
    plinth = ((-x + 0.02, x - 0.02), (face + 0.02, y - 0.02), (0.0, foot))
    builder.add(m.PLINTH, box(*plinth))
    room = add_cavity(builder, ((-x, x), (face, y), (low, board)), _WALL_M, look.shell)
    add_racks(builder, room)
    _add_upper(builder, (x, y, face), (board, under, deck), look, hob)
    if splash:
        builder.add(look.shell, box((-x, x), (y - 0.05, y), (deck, height)))
    ends = (-y + 0.035, y - (0.06 if splash else 0.02))
    add_hob(builder, ((-x + 0.02, x - 0.02), ends), deck, hob, grid, sides)
    seam = seam_above(board - low, _DOOR_M)
    slab = ((-x, x), (-y, -y + _DOOR_M), (low, board - seam))
    add_down_door(builder, slab, look)
    clock = (-0.16 * width, 0.16 * width)
    spans = ((-x + 0.01, clock[0] - 0.01), (clock[1] + 0.01, x - 0.01))
    add_knob_row(builder, spans, -y, board + panel / 2, knobs, 0.021, sides=sides)
    _add_storage(builder, ((-x, x), (-y, face, y), (foot, low)), look, slab[2][1] - low)
    return builder


def _add_upper(builder: ModelBuilder, plan, levels, look: OvenLook, hob: HobKind) -> None:
    """Control panel and deck, and what is behind and below them."""
    (x, y, face), (board, under, deck) = plan, levels
    display = (-0.16 * 2 * x, 0.16 * 2 * x)
    add_panel_with_display(builder, ((-x, x), (-y, face), (board, under)), look.shell, display)
    for wall in ((-x, -x + 0.01), (x - 0.01, x)):
        builder.add(look.shell, box(wall, (face, y), (board, under)))
    builder.add(m.MACHINERY, box((-x + 0.01, x - 0.01), (face, y), (under - 0.04, under)))
    top = m.HOB_GLASS if hob == "glass" else look.shell
    skin = 0.004 if hob == "glass" else 0.01
    builder.add(look.shell, box((-x, x), (-y, y), (under, deck - skin)), carries=False)
    builder.add(top, box((-x, x), (-y, y), (deck - skin, deck)), carries=hob != "gas")


def _add_storage(builder: ModelBuilder, space, look: OvenLook, door_height: float) -> None:
    """The part below an oven: a drawer for trays where it is high enough, else closed."""
    (x0, x1), (front, face, back), (z0, z1) = space
    t = 0.012
    for wall in ((x0, x0 + t), (x1 - t, x1)):
        builder.add(look.shell, box(wall, (face, back), (z0, z1)))
    inner = (x0 + t, x1 - t)
    builder.add(look.shell, box(inner, (face, back), (z0, z0 + t)), carries=False)
    builder.add(look.shell, box(inner, (back - t, back), (z0 + t, z1)))
    panel = ((x0, x1), (front, front + _DOOR_M), (z0, z1 - _SEAM_M))
    if z1 - z0 < 0.1:
        builder.add(look.shell, box((x0, x1), (front, face), panel[2]))
        return
    _add_sheet_drawer(builder, panel, (inner, (face, back - t), (z0 + t, z1)), look, door_height)


def _add_sheet_drawer(builder, panel: Space, room: Space, look: OvenLook, door_height) -> None:
    """A drawer of sheet metal that stays short of the bar of the open door above it."""
    (x0, x1), (_, back), (z0, z1) = room
    name, t, front = "drawer_1", 0.004, panel[1]
    builder.add(look.shell, box(*panel), link=name)
    x0, x1, end = x0 + 0.01, x1 - 0.01, back - 0.02
    floor, rim = z0 + 0.004, z0 + round(0.65 * (z1 - z0), 3)
    sides = [box(w, (front[1], end), (floor, rim)) for w in ((x0, x0 + t), (x1 - t, x1))]
    sides.append(box((x0 + t, x1 - t), (end - t, end), (floor, rim)))
    sides.append(box((x0 + t, x1 - t), (front[1], end - t), (floor, floor + t)))
    builder.add(m.THIN_STEEL, *sides, link=name)
    reach = 0.03
    at = ((x0 + x1) / 2, front[0], panel[2][1] - 0.04)
    add_bar_handle(
        builder,
        at,
        round(0.4 * (x1 - x0), 3),
        upright=False,
        link=name,
        material=look.handle,
        reach=reach,
    )
    # The bar of the open door hangs this far before the front.
    free = door_height - 0.075 - reach - 0.02
    travel = round(min(0.75 * (end - front[1]), free), 2)
    builder.slide(name, (0, -1, 0), travel, damping=10.0, friction=4.0)


def built_in_oven(
    width: float,
    depth: float,
    height: float,
    *,
    knobs: int = 2,
    panel: float = 0.1,
    look: OvenLook = OvenLook(),  # noqa: B008 - frozen
    sides: int = ROUND_SIDES,
) -> ModelBuilder:
    """An oven for a niche of a cabinet: its front overlaps the body behind it."""
    builder = ModelBuilder("oven", symmetry=1, mount="opening")
    x, y = width / 2, depth / 2
    face = -y + _DOOR_M + CLEARANCE_M
    board = height - panel
    body = (-x + 0.02, x - 0.02)
    add_racks(builder, add_cavity(builder, (body, (face, y), (0.01, board)), _WALL_M, look.shell))
    builder.add(m.MACHINERY, box(body, (face, y - 0.03), (board, height - 0.015)))
    display = (-0.2 * width, 0.2 * width)
    add_panel_with_display(builder, ((-x, x), (-y, face), (board, height)), look.shell, display)
    # The collar that a cabinet's edge touches, behind the door's rim.
    for a, b in ((-x, body[0]), (body[1], x)):
        builder.add(look.shell, box((a, b), (face, face + 0.01), (0.01, height)))
    slab = ((-x, x), (-y, -y + _DOOR_M), (0.0, board - seam_above(board, _DOOR_M)))
    add_down_door(builder, slab, look)
    spans = ((-x + 0.02, display[0] - 0.02), (display[1] + 0.02, x - 0.02))
    counts = (knobs // 2, knobs - knobs // 2)
    add_knob_row(
        builder, spans, -y, height - panel / 2, counts, 0.023, sides=sides, material=look.frame
    )
    return builder


def small_oven(
    width: float,
    depth: float,
    height: float,
    *,
    knobs: int = 3,
    panel: float = 0.1,
    look: OvenLook = OvenLook(reach=0.03),  # noqa: B008 - frozen
    sides: int = ROUND_SIDES,
) -> ModelBuilder:
    """An oven that stands on a worktop, its knobs above one another at the right."""
    builder = ModelBuilder("oven", symmetry=1, mount="surface")
    x, y, door, wall = width / 2, depth / 2, 0.025, 0.016
    foot, low = 0.015, 0.045
    face, edge = -y + door + CLEARANCE_M, x - panel
    room = add_cavity(builder, ((-x, edge), (face, y), (low, height)), wall, look.shell)
    add_racks(builder, room, tray=False)
    builder.add(look.shell, box((-x, x), (face, y), (foot, low)))
    builder.add(look.shell, box((edge, x), (-y, y), (low, height)))
    builder.add(look.shell, box((-x, x), (-y, face), (foot, low - _SEAM_M)))
    for sx in (-1, 1):
        for sy in (-1, 1):
            cx, cy = sx * (x - 0.03), sy * (y - 0.035)
            leg = box((cx - 0.012, cx + 0.012), (cy - 0.012, cy + 0.012), (0.0, foot))
            builder.add(m.RUBBER, leg)
    slab = ((-x, edge - _SEAM_M), (-y, -y + door), (low, height))
    add_down_door(builder, slab, look)
    step = (height - low) / knobs
    for k in range(knobs):
        spot = ((edge, x),)
        z = round(low + (k + 0.5) * step, 4)
        radius = min(0.019, round(0.38 * step, 4))
        add_knob_row(builder, spot, -y, z, (1,), radius, sides=sides)
    return builder


def hot_plate(
    width: float,
    depth: float,
    height: float,
    *,
    zones: int = 2,
    hob: HobKind = "plates",
    shell: m.Material = m.SILVER_BODY,
    sides: int = ROUND_SIDES,
) -> ModelBuilder:
    """A hob that stands on a worktop, with one knob a zone at its front."""
    builder = ModelBuilder("oven", symmetry=1, mount="surface")
    x, y, foot = width / 2, depth / 2, 0.012
    deck = height - HOB_RISE_M[hob]
    builder.add(shell, box((-x, x), (-y, y), (foot, deck - 0.004)), carries=False)
    top = m.HOB_GLASS if hob == "glass" else shell
    builder.add(top, box((-x, x), (-y, y), (deck - 0.004, deck)), carries=False)
    for sx in (-1, 1):
        for sy in (-1, 1):
            cx, cy = sx * (x - 0.035), sy * (y - 0.035)
            leg = box((cx - 0.015, cx + 0.015), (cy - 0.015, cy + 0.015), (0.0, foot))
            builder.add(m.RUBBER, leg)
    plan = ((-x + 0.01, x - 0.01), (-y + 0.02, y - 0.01))
    add_hob(builder, plan, deck, hob, (zones, 1), sides)
    radius = min(0.018, round(0.4 * (deck - foot), 4))
    spans = ((-x + 0.02, x - 0.02),)
    add_knob_row(builder, spans, -y, (foot + deck) / 2, (zones,), radius, depth=0.018, sides=sides)
    return builder


def microwave(
    width: float,
    depth: float,
    height: float,
    *,
    shell: m.Material = m.SHEET_BODY,
    panel: float = 0.12,
    plate: float = 0.125,
    knobs: int = 0,
    sides: int = ROUND_SIDES,
) -> ModelBuilder:
    """A cavity with a turntable behind a door with its hinge at the left.

    ``panel`` is the width of the controls at the right, ``plate`` the turntable's radius at most.
    """
    builder = ModelBuilder("microwave", symmetry=1)
    x, y, t, door, foot = width / 2, depth / 2, 0.016, 0.032, 0.012
    face = -y + door + CLEARANCE_M
    edge = x - panel
    body, inner, room = (face, y), (-x + t, x - t), (foot + t, height - t)
    for wall in ((-x, -x + t), (x - t, x)):
        builder.add(shell, box(wall, body, (foot, height)))
    builder.add(shell, box(inner, body, (foot, foot + t)), carries=False)
    builder.add(shell, box(inner, body, (height - t, height)))
    builder.add(shell, box(inner, (y - t, y), room))
    builder.add(shell, box((edge - t, edge), (face, y - t), room))
    builder.add(m.MACHINERY, box((edge, x - t), (face, y - t), room))
    board = shell if knobs else m.SCREEN
    builder.add(board, box((edge + 0.0015, x), (-y, face), (foot, height)))
    for sx in (-1, 1):
        for sy in (face + 0.03, y - 0.03):
            cx = sx * (x - 0.04)
            leg = box((cx - 0.012, cx + 0.012), (sy - 0.012, sy + 0.012), (0.0, foot))
            builder.add(m.PLASTIC, leg)
    _add_turntable(builder, ((-x + t, edge - t), (face, y - t), room), plate, sides)
    _add_window_door(builder, ((-x, edge - 0.0015), (-y, -y + door), (foot, height)), shell)
    for k in range(knobs):
        z = round(foot + (height - foot) * (k + 0.5) / knobs, 4)
        radius = min(0.022, round(0.2 * height, 4))
        add_knob_row(builder, ((edge, x),), -y, z, (1,), radius, sides=sides)
    return builder


def _add_turntable(builder: ModelBuilder, room: Space, plate: float, sides: int) -> None:
    (x0, x1), (y0, y1), (z0, _) = room
    center = ((x0 + x1) / 2, (y0 + y1) / 2)
    r = min(plate, round(min(x1 - x0, y1 - y0) / 2 - 0.006, 4))
    z = (z0 + 0.0025, z0 + 0.0085)
    builder.add(m.GLASS, frustum((r, r), z, center, sides), link="turntable")
    rim = (center[0], center[1] - r, z[1])
    builder.swivel("turntable", (*center, z0), damping=0.01, friction=0.05, at=rim)


def _add_window_door(builder: ModelBuilder, slab: Space, shell: m.Material) -> None:
    """A door of dark glass in a frame, hinge at the left."""
    (x0, x1), (y0, y1), (z0, z1) = slab
    rim, c = 0.03, 0.012
    link = "door_1"
    outer = [(x1 - rim, y0), (x1, y0), (x1, y1 - c), (x1 - c, y1), (x1 - rim, y1)]
    builder.add(shell, box((x0, x0 + rim), (y0, y1), (z0, z1)), link=link)
    builder.add(shell, prism(outer, "z", (z0, z1)), link=link)
    middle = (x0 + rim, x1 - rim)
    builder.add(shell, box(middle, (y0, y1), (z0, z0 + rim)), link=link)
    builder.add(shell, box(middle, (y0, y1), (z1 - rim, z1)), link=link)
    builder.add(m.SCREEN, box(middle, (y0, y1), (z0 + rim, z1 - rim)), link=link)
    at = (x1 - rim / 2, y0, (z0 + z1) / 2)
    add_bar_handle(builder, at, round(0.6 * (z1 - z0), 4), upright=True, link=link)
    builder.hinge(link, (x0, y0, (z0 + z1) / 2), (0, 0, -1), OPEN_RAD, damping=0.1, friction=0.2)
