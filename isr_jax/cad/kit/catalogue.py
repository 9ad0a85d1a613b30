"""The default set: at least six sizes and styles of each class."""

from __future__ import annotations

from collections.abc import Callable

from ...cad_types import CadModel
from . import materials as m
from .appliances import Compartment, CompartmentKind, fridge, microwave, monitor
from .beds import bed, divan
from .fronts import Column, Front, FrontKind, Look
from .seats import office_chair, shell_chair, sofa, wooden_chair
from .small import book, cup, round_bin, square_bin
from .storage import bookshelf, cabinet, counter, wall_cabinet
from .tables import (
    frame_desk,
    panel_desk,
    pedestal_desk,
    rectangular_table,
    round_table,
    tapered_leg_table,
    trestle_table,
)

Maker = Callable[..., CadModel]
_Row = tuple[str, Maker, tuple, dict]


def _row(name: str, maker: Maker, *args, **options) -> _Row:
    return name, maker, args, options


def _columns(*texts: str) -> tuple[Column, ...]:
    """Columns from words: ``D`` a drawer, ``L``/``R`` a door hinged there, ``O`` open; digits
    after a letter are its share."""
    columns = []
    kinds: dict[str, FrontKind] = {
        "D": "drawer",
        "L": "door_left",
        "R": "door_right",
        "O": "open",
    }
    for text in texts:
        words = text.split()
        fronts = tuple(Front(kinds[w[0]], float(w[1:] or 1)) for w in words)
        columns.append(Column(fronts))
    return tuple(columns)


_WOOD = Look(m.OAK_BOARD, m.OAK_BOARD, m.BLACK_TUBE)
_BLUE = Look(m.WHITE_BOARD, m.BLUE_BOARD)
_GREY = Look(m.WHITE_BOARD, m.GREY_BOARD)
_GREEN = Look(m.OAK_BOARD, m.GREEN_BOARD)
_DARK = Look(m.DARK_BOARD, m.DARK_BOARD)
_WHITE = Look()

_TABLES = (
    _row("dining_120x75", rectangular_table, 1.2, 0.75, 0.74),
    _row("dining_140x80", rectangular_table, 1.4, 0.8, 0.75, frame=m.BEECH, leg=0.07),
    _row("dining_180x90", rectangular_table, 1.8, 0.9, 0.75, frame=m.WALNUT, leg=0.08),
    _row("kitchen_80x80", rectangular_table, 0.8, 0.8, 0.74, frame=m.BIRCH, leg=0.05),
    _row("round_90", round_table, 0.9, 0.74),
    _row("round_120", round_table, 1.2, 0.75, material=m.OAK, column=0.06),
    _row("bistro_60", round_table, 0.6, 0.72, material=m.BLACK_WOOD, foot=0.65),
    _row("trestle_160x80", trestle_table, 1.6, 0.8, 0.75),
    _row("trestle_200x95", trestle_table, 2.0, 0.95, 0.76, material=m.OAK),
    _row("splayed_140x80", tapered_leg_table, 1.4, 0.8, 0.74),
    _row("coffee_110x60", rectangular_table, 1.1, 0.6, 0.45, leg=0.05, apron=0.06, shelf=0.16),
    _row("coffee_80x80", tapered_leg_table, 0.8, 0.8, 0.4, material=m.OAK),
    _row("side_45x45", rectangular_table, 0.45, 0.45, 0.5, leg=0.035, apron=0.05, frame=m.PINE),
)
_DESKS = (
    _row("panel_120x60", panel_desk, 1.2, 0.6, 0.74),
    _row("panel_140x70", panel_desk, 1.4, 0.7, 0.74, material=m.OAK_BOARD),
    _row("panel_160x80", panel_desk, 1.6, 0.8, 0.75, material=m.GREY_BOARD, modesty=0.45),
    _row("frame_140x70", frame_desk, 1.4, 0.7, 0.72),
    _row("frame_160x80", frame_desk, 1.6, 0.8, 0.74, top=m.WHITE_BOARD, frame=m.STEEL_TUBE),
    _row("frame_180x80", frame_desk, 1.8, 0.8, 0.76, top=m.OAK),
    _row("pedestal_130x65", pedestal_desk, 1.3, 0.65, 0.74),
    _row("pedestal_150x75", pedestal_desk, 1.5, 0.75, 0.75, board=m.WALNUT, fronts=m.WALNUT),
)
_CHAIRS = (
    _row("ladder_42", wooden_chair),
    _row("ladder_45", wooden_chair, 0.45, 0.43, 0.46, 0.92, slats=4, frame=m.OAK),
    _row("spindle_43", wooden_chair, 0.43, 0.42, 0.45, 0.88, upright_slats=True, slats=4),
    _row("spindle_dark_44", wooden_chair, 0.44, 0.43, 0.46, 0.95, upright_slats=True, slats=5,
         frame=m.BLACK_WOOD),
    _row("padded_44", wooden_chair, 0.44, 0.44, 0.47, 0.9, slats=2, frame=m.WALNUT,
         cushion=m.BEIGE_FABRIC),
    _row("panel_40", wooden_chair, 0.40, 0.40, 0.44, 0.80, slats=1, frame=m.BIRCH, lean=0.12),
    _row("shell_46", shell_chair),
    _row("shell_blue_50", shell_chair, 0.50, 0.46, 0.45, 0.80, shell=m.BLUE_PLASTIC),
    _row("visitor_54", shell_chair, 0.54, 0.48, 0.46, 0.84, shell=m.LEATHER, arms=True,
         frame=m.BLACK_TUBE),
    _row("office_48", office_chair),
    _row("office_low_46", office_chair, 0.46, 0.44, 0.46, 0.86, arms=False, fabric=m.BLUE_FABRIC),
)  # fmt: skip
_CABINETS = (
    _row("base_40", cabinet, 0.4, 0.58, 0.86, _columns("D L3"), look=_WHITE, plinth=0.1),
    _row("base_60_drawers", cabinet, 0.6, 0.58, 0.86, _columns("D D2 D2"), look=_GREY, plinth=0.1),
    _row("base_80", cabinet, 0.8, 0.58, 0.86, _columns("D L4", "D R4"), look=_BLUE, plinth=0.1,
         top=m.OAK),
    _row("sideboard_120", cabinet, 1.2, 0.42, 0.78, _columns("L", "D D D", "R"), look=_WOOD,
         plinth=0.0, feet=0.14, top=m.OAK_BOARD),
    _row("sideboard_160", cabinet, 1.6, 0.45, 0.72, _columns("L", "R", "O O", "R"), look=_GREEN,
         plinth=0.0, feet=0.12, top=m.OAK_BOARD),
    _row("dresser_90", cabinet, 0.9, 0.48, 1.02, _columns("D D D D"), look=_WHITE, plinth=0.06,
         top=m.PINE),
    _row("filing_42", cabinet, 0.42, 0.6, 0.72, _columns("D D D"), look=_DARK, plinth=0.03),
    _row("tall_60", cabinet, 0.6, 0.58, 2.0, _columns("L2 L1.2"), look=_WHITE, plinth=0.1),
    _row("wardrobe_100", cabinet, 1.0, 0.6, 1.95, _columns("L4 D", "R4 D"), look=_WOOD),
    _row("nightstand_45", cabinet, 0.45, 0.4, 0.5, _columns("D O"), look=_WOOD, plinth=0.0,
         feet=0.1),
)  # fmt: skip
_WALL_CABINETS = (
    _row("single_40", wall_cabinet, 0.4, 0.36, 0.72, _columns("L")),
    _row("single_60", wall_cabinet, 0.6, 0.36, 0.72, _columns("R"), look=_GREY),
    _row("double_80", wall_cabinet, 0.8, 0.36, 0.72, _columns("L", "R")),
    _row("double_100_tall", wall_cabinet, 1.0, 0.38, 0.9, _columns("L", "R"), look=_BLUE),
    _row("low_90", wall_cabinet, 0.9, 0.36, 0.4, _columns("L", "R"), look=_WOOD),
    _row("open_middle_120", wall_cabinet, 1.2, 0.35, 0.7, _columns("L", "O", "R"), look=_GREEN),
    _row("double_60_shallow", wall_cabinet, 0.6, 0.2, 0.6, _columns("L", "R"), look=_DARK),
)
_COUNTERS = (
    _row("row_120", counter, 1.2, 0.63, 0.9, _columns("D L4", "D R4")),
    _row("row_180", counter, 1.8, 0.63, 0.9, _columns("D L4", "D D2 D2", "D R4"), look=_GREY),
    _row("row_240", counter, 2.4, 0.63, 0.91, _columns("L", "R", "D D2 D2", "R"), look=_BLUE,
         worktop=m.OAK, upstand=0.1),
    _row("island_160", counter, 1.6, 0.9, 0.92, _columns("L", "D D2 D2", "R"), look=_GREEN,
         worktop=m.STONE, thickness=0.03),
    _row("row_300", counter, 3.0, 0.63, 0.9, _columns("D L4", "D D2 D2", "L", "R", "D R4"),
         worktop=m.STONE, thickness=0.03, upstand=0.06),
    _row("narrow_60", counter, 0.6, 0.63, 0.9, _columns("D R4"), look=_WOOD),
)  # fmt: skip
_SHELVES = (
    _row("tall_80", bookshelf, 0.8, 0.28, 2.02, rows=6),
    _row("narrow_40", bookshelf, 0.4, 0.28, 2.02, rows=6, board=m.OAK_BOARD),
    _row("middle_80", bookshelf, 0.8, 0.28, 1.06, rows=3),
    _row("cube_77x77", bookshelf, 0.77, 0.39, 0.77, rows=2, columns=2, back=False, plinth=0.0),
    _row(
        "cube_77x147",
        bookshelf,
        0.77,
        0.39,
        1.47,
        rows=4,
        columns=2,
        back=False,
        plinth=0.0,
        board=m.BIRCH,
    ),
    _row("wide_120", bookshelf, 1.2, 0.3, 1.8, rows=5, columns=2, board=m.WALNUT),
    _row("low_140", bookshelf, 1.4, 0.35, 0.6, rows=2, columns=3, board=m.PINE),
)
_SOFAS = (
    _row("seats_1", sofa, 0.92, seats=1, fabric=m.GREEN_FABRIC),
    _row("seats_2", sofa, 1.6, seats=2),
    _row("seats_3", sofa, 2.15, 0.92, 0.84, seats=3, fabric=m.BLUE_FABRIC),
    _row("seats_3_leather", sofa, 2.05, 0.9, 0.78, seats=3, fabric=m.LEATHER, arm=0.2),
    _row("loveseat", sofa, 1.35, 0.8, 0.8, seats=2, fabric=m.BEIGE_FABRIC, arm=0.1,
         arm_height=0.56),
    _row("armless_2", sofa, 1.4, 0.86, 0.76, seats=2, fabric=m.RED_FABRIC, arm=0.0),
    _row("chaise_240", sofa, 2.4, 0.95, 0.8, seats=3, chaise=0.65),
)  # fmt: skip
_CUPS = (
    _row("mug", cup),
    _row("mug_large", cup, 0.105, 0.0465, 0.0465, material=m.BLUE_CERAMIC),
    _row("tea_cup", cup, 0.065, 0.045, 0.027, wall=0.003, material=m.RED_CERAMIC),
    _row("espresso", cup, 0.058, 0.031, 0.024, wall=0.0035),
    _row("tumbler", cup, 0.12, 0.038, 0.032, wall=0.0025, bottom=0.008, handle=False,
         material=m.GLASS),
    _row("beaker", cup, 0.1, 0.04, 0.035, wall=0.002, bottom=0.003, handle=False,
         material=m.GREEN_PLASTIC),
    _row("mug_conical", cup, 0.09, 0.045, 0.036),
)  # fmt: skip
_BINS = (
    _row("round_28", round_bin, 0.28, 0.13, 0.1),
    _row("round_40", round_bin, 0.4, 0.16, 0.13, material=m.STEEL_TUBE),
    _row("round_60", round_bin, 0.6, 0.19, 0.17, material=m.WHITE_PLASTIC),
    _row("square_30", square_bin, 0.24, 0.24, 0.3),
    _row("office_34", square_bin, 0.3, 0.2, 0.34, material=m.BLUE_PLASTIC),
    _row("kitchen_62", square_bin, 0.4, 0.3, 0.62, taper=0.95, material=m.WHITE_PLASTIC),
    _row("recycling_45", square_bin, 0.36, 0.26, 0.45, taper=0.8, material=m.GREEN_PLASTIC),
)
_BOOKS = (
    _row("paperback", book, 0.11, 0.178, 0.02, board=0.0005, cover=m.YELLOW_COVER),
    _row("novel", book, 0.14, 0.21, 0.032),
    _row("a5", book, 0.15, 0.21, 0.018, cover=m.BLUE_COVER),
    _row("textbook", book, 0.19, 0.245, 0.042, cover=m.GREEN_COVER),
    _row("a4", book, 0.21, 0.297, 0.025, cover=m.BLACK_COVER),
    _row("magazine", book, 0.21, 0.28, 0.008, board=0.0005, cover=m.RED_COVER),
    _row("picture_book", book, 0.26, 0.26, 0.016, cover=m.YELLOW_COVER),
)
_BEDS = (
    _row("single_90", bed, 0.9),
    _row("double_140", bed, 1.4, frame=m.PINE, pillows=2, footboard=0.6),
    _row("queen_160", bed, 1.6, frame=m.WALNUT, pillows=2, lying=0.52, headboard=1.05),
    _row("king_180", bed, 1.8, frame=m.WHITE_BOARD, pillows=2),
    _row("child_70", bed, 0.7, 1.6, lying=0.38, mattress=0.14, headboard=0.65, frame=m.BIRCH),
    _row("daybed_80", bed, 0.8, frame=m.WHITE_BOARD, headboard=0.8, footboard=0.8, side_back=0.8,
         pillows=0),
    _row("divan_160", divan, 1.6),
    _row("divan_90", divan, 0.9, headboard=0.0, pillows=1, lying=0.52, fabric=m.BLUE_FABRIC),
)  # fmt: skip


def _cold(*columns: str) -> tuple[tuple[Compartment, ...], ...]:
    """Compartments from words, top down: ``L``/``R`` hinged there, ``B`` both, ``D`` a drawer."""
    kinds: dict[str, CompartmentKind] = {
        "L": "left",
        "R": "right",
        "B": "double",
        "D": "drawer",
    }
    return tuple(
        tuple(Compartment(kinds[w[0]], float(w[1:] or 1)) for w in text.split()) for text in columns
    )


_FRIDGES = (
    _row("under_counter_55", fridge, 0.55, 0.58, 0.85, _cold("R")),
    _row("mini_48", fridge, 0.48, 0.5, 0.52, _cold("L"), shell=m.DARK_INSULATED, wall=0.035),
    _row("tall_60", fridge, 0.6, 0.65, 1.85, _cold("R"), shell=m.STEEL_INSULATED),
    _row("combi_60", fridge, 0.6, 0.65, 2.0, _cold("R1.7 R"), shell=m.STEEL_INSULATED),
    _row("combi_55", fridge, 0.55, 0.57, 1.77, _cold("L2 L")),
    _row("top_freezer_70", fridge, 0.7, 0.72, 1.68, _cold("R R2.2")),
    _row("french_91", fridge, 0.91, 0.74, 1.78, _cold("B2 D"), shell=m.STEEL_INSULATED),
    _row("side_by_side_90", fridge, 0.9, 0.72, 1.78, _cold("L", "R"), shell=m.DARK_INSULATED),
)
_MICROWAVES = (
    _row("black_48", microwave),
    _row("white_44", microwave, 0.44, 0.35, 0.26, shell=m.WHITE_BODY, panel=0.1, plate=0.115),
    _row("silver_51", microwave, 0.51, 0.42, 0.30, shell=m.SILVER_BODY, plate=0.15),
    _row("silver_46", microwave, 0.46, 0.36, 0.26, shell=m.SILVER_BODY, panel=0.11, plate=0.12),
    _row("black_54", microwave, 0.54, 0.45, 0.31, panel=0.13, plate=0.16),
    _row("white_50", microwave, 0.5, 0.4, 0.29, shell=m.WHITE_BODY, plate=0.14),
)
_MONITORS = (
    _row("screen_22", monitor, 0.51, 0.3),
    _row("screen_24", monitor, 0.55, 0.33),
    _row("screen_27", monitor, 0.61, 0.36, lift=0.15, shell=m.SILVER_SHELL),
    _row("screen_34_wide", monitor, 0.81, 0.36, lift=0.13),
    _row("tv_32", monitor, 0.73, 0.43, lift=0.06, thickness=0.06, stand="feet"),
    _row("tv_43", monitor, 0.97, 0.56, lift=0.07, thickness=0.06, stand="feet"),
    _row("tv_55", monitor, 1.23, 0.71, lift=0.08, thickness=0.055, stand="feet"),
)

_CLASSES: dict[str, tuple[_Row, ...]] = {
    "table": _TABLES,
    "desk": _DESKS,
    "chair": _CHAIRS,
    "cabinet": _CABINETS,
    "wall_cabinet": _WALL_CABINETS,
    "counter": _COUNTERS,
    "bookshelf": _SHELVES,
    "sofa": _SOFAS,
    "bed": _BEDS,
    "fridge": _FRIDGES,
    "microwave": _MICROWAVES,
    "monitor": _MONITORS,
    "cup": _CUPS,
    "bin": _BINS,
    "book": _BOOKS,
}

KIT: dict[str, _Row] = {
    f"{class_name}/{row[0]}": row for class_name, rows in _CLASSES.items() for row in rows
}
"""What makes each model, by its id."""


def make(cad_id: str) -> CadModel:
    """Build one model of `KIT`."""
    name, maker, args, options = KIT[cad_id]
    return maker(name, *args, **options)
