"""Tables and desks.

Dining tables are 0.72 to 0.76 m high and give each guest 0.6 m by 0.4 m (DIN 68885 and makers'
catalogues); coffee tables are 0.35 to 0.50 m high; desks are 0.72 to 0.76 m high and 0.6 to
0.8 m deep (EN 527-1 asks for 0.8 m by 1.2 m at work).
"""

from __future__ import annotations

from ...cad_types import CadModel
from . import materials as m
from .builder import ModelBuilder
from .fronts import Column, Front, Look, add_carcass
from .solids import between, box, frustum, tapered_box


def rectangular_table(
    name: str,
    width: float,
    depth: float,
    height: float,
    *,
    class_name: str = "table",
    top: float = 0.028,
    leg: float = 0.06,
    overhang: float = 0.02,
    apron: float = 0.09,
    frame: m.Material = m.OAK,
    top_material: m.Material | None = None,
    shelf: float | None = None,
) -> CadModel:
    """Four square legs joined by aprons; ``shelf`` is the height of a board between the legs."""
    builder = ModelBuilder(class_name, name, symmetry=4 if width == depth else 2)
    x, y, under = width / 2, depth / 2, height - top
    builder.add(top_material or frame, box((-x, x), (-y, y), (under, height)))
    lx, ly = x - overhang, y - overhang
    for sx in (-1, 1):
        for sy in (-1, 1):
            bx, by = between(sx * lx, sx * (lx - leg)), between(sy * ly, sy * (ly - leg))
            builder.add(frame, box(bx, by, (0.0, under)))
    if apron:
        _add_aprons(builder, frame, lx, ly, leg, (under - apron, under))
    if shelf is not None:
        inner = (-(ly - leg), ly - leg)
        builder.add(frame, box((-lx + leg, lx - leg), inner, (shelf - 0.018, shelf)))
    return builder.build()


def _add_aprons(builder, frame, lx, ly, leg, z) -> None:
    board, inset = 0.02, leg / 2
    for side in (-1, 1):
        cy, cx = side * (ly - inset), side * (lx - inset)
        along = (-lx + leg, lx - leg)
        across = (-ly + leg, ly - leg)
        builder.add(frame, box(along, (cy - board / 2, cy + board / 2), z))
        builder.add(frame, box((cx - board / 2, cx + board / 2), across, z))


def round_table(
    name: str,
    diameter: float,
    height: float,
    *,
    top: float = 0.026,
    column: float = 0.045,
    foot: float = 0.5,
    material: m.Material = m.BIRCH,
    frame: m.Material = m.BLACK_TUBE,
) -> CadModel:
    """A round top on one column; the foot plate is ``foot`` times as wide as the top."""
    builder = ModelBuilder("table", name, symmetry=0)
    r, under = diameter / 2, height - top
    builder.add(material, frustum((r, r), (under, height), sides=32))
    builder.add(frame, frustum((column, column), (0.03, under)))
    builder.add(
        m.STEEL, frustum((foot * r, foot * r * 0.97), (0.0, 0.012), sides=32), carries=False
    )
    builder.add(frame, frustum((column * 2, column), (0.012, 0.03)))
    return builder.build()


def trestle_table(
    name: str,
    width: float,
    depth: float,
    height: float,
    *,
    top: float = 0.032,
    material: m.Material = m.PINE,
) -> CadModel:
    """A top on two end panels with feet, tied by a beam."""
    builder = ModelBuilder("table", name, symmetry=2)
    x, y, under = width / 2, depth / 2, height - top
    builder.add(material, box((-x, x), (-y, y), (under, height)))
    panel, half, foot = 0.04, 0.3 * depth, 0.05
    for side in (-1, 1):
        center = side * (x - 0.22 * min(width, 1.2))
        across = (center - panel / 2, center + panel / 2)
        builder.add(material, box(across, (-half, half), (foot, under)))
        feet = (center - panel, center + panel)
        builder.add(material, box(feet, (-0.42 * depth, 0.42 * depth), (0.0, foot)))
    inner = x - 0.22 * min(width, 1.2) - panel / 2
    builder.add(
        material, box((-inner, inner), (-0.018, 0.018), (0.32 * height, 0.32 * height + 0.1))
    )
    return builder.build()


def tapered_leg_table(
    name: str,
    width: float,
    depth: float,
    height: float,
    *,
    top: float = 0.022,
    material: m.Material = m.WALNUT,
) -> CadModel:
    """A thin top on legs that splay outwards and taper, as made since the 1950s."""
    builder = ModelBuilder("table", name, symmetry=4 if width == depth else 2)
    x, y, under = width / 2, depth / 2, height - top
    builder.add(material, box((-x, x), (-y, y), (under, height)))
    for sx in (-1, 1):
        for sy in (-1, 1):
            foot, head = (sx * (x - 0.04), sy * (y - 0.04)), (sx * (x - 0.12), sy * (y - 0.12))
            rows = [
                (cx - r, cx + r, cy - r, cy + r) for (cx, cy), r in ((foot, 0.016), (head, 0.028))
            ]
            builder.add(material, tapered_box(rows[0], rows[1], (0.0, under)))
    return builder.build()


def panel_desk(
    name: str,
    width: float,
    depth: float,
    height: float,
    *,
    board: float = 0.022,
    material: m.Material = m.WHITE_BOARD,
    modesty: float = 0.35,
) -> CadModel:
    """A top on two side panels, with a panel of height ``modesty`` behind the knees."""
    builder = ModelBuilder("desk", name, symmetry=1)
    x, y, under = width / 2, depth / 2, height - board
    builder.add(material, box((-x, x), (-y, y), (under, height)))
    for side in (-1, 1):
        bounds = between(side * x, side * (x - board))
        builder.add(material, box(bounds, (-y + 0.02, y - 0.02), (0.0, under)))
    inner = (-x + board, x - board)
    builder.add(material, box(inner, (y - 0.02 - 0.018, y - 0.02), (under - modesty, under)))
    return builder.build()


def pedestal_desk(
    name: str,
    width: float,
    depth: float,
    height: float,
    *,
    drawers: int = 3,
    pedestal: float = 0.4,
    board: m.Material = m.OAK_BOARD,
    fronts: m.Material = m.WHITE_BOARD,
) -> CadModel:
    """A top on a panel at the left and a stack of drawers at the right."""
    builder = ModelBuilder("desk", name, symmetry=1)
    x, y, top, panel = width / 2, depth / 2, 0.025, 0.022
    under = height - top
    builder.add(board, box((-x, x), (-y, y), (under, height)))
    builder.add(board, box((-x, -x + panel), (-y + 0.02, y - 0.02), (0.0, under)))
    edge = x - pedestal
    builder.add(board, box((-x + panel, edge), (y - 0.04, y - 0.022), (under - 0.35, under)))
    space = ((edge, x), (-y + 0.01, y - 0.02), (0.0, under))
    stack = Column((Front("drawer"),) * drawers)
    add_carcass(builder, space, (stack,), Look(board, fronts, covered=True))
    return builder.build()


def frame_desk(
    name: str,
    width: float,
    depth: float,
    height: float,
    *,
    top: m.Material = m.BIRCH,
    frame: m.Material = m.BLACK_TUBE,
) -> CadModel:
    """A top on two steel T legs, as sit-stand desks have."""
    builder = ModelBuilder("desk", name, symmetry=2)
    x, y, board = width / 2, depth / 2, 0.025
    under = height - board
    builder.add(top, box((-x, x), (-y, y), (under, height)))
    for side in (-1, 1):
        c = side * (x - 0.18)
        builder.add(frame, box((c - 0.04, c + 0.04), (-y + 0.05, y - 0.05), (0.0, 0.03)))
        builder.add(frame, box((c - 0.035, c + 0.035), (-0.045, 0.045), (0.03, under - 0.03)))
        builder.add(frame, box((c - 0.03, c + 0.03), (-y + 0.1, y - 0.1), (under - 0.03, under)))
    inner = x - 0.18 - 0.03
    builder.add(frame, box((-inner, inner), (-0.03, 0.03), (under - 0.03, under)))
    return builder.build()
