"""Cabinets, counters, drawer units and bookshelves of the catalogue, at sizes of makers'."""

from __future__ import annotations

from .. import materials as m
from ..rows import Row, row
from .fronts import Look, columns_of
from .shelves import bookshelf, door_bookshelf, ladder_shelf, post_rack, wall_shelf
from .storage import cabinet, counter, leg_nightstand, wall_cabinet

_WOOD = Look(m.OAK_BOARD, m.OAK_BOARD, m.BLACK_TUBE)
_BLUE = Look(m.WHITE_BOARD, m.BLUE_BOARD)
_GREY = Look(m.WHITE_BOARD, m.GREY_BOARD)
_GREEN = Look(m.OAK_BOARD, m.GREEN_BOARD)
_DARK = Look(m.DARK_BOARD, m.DARK_BOARD)
_WHITE = Look()
_WALNUT = Look(m.WALNUT_BOARD, m.WALNUT_BOARD, m.BRASS_TUBE, grip="knob")
_COUNTRY = Look(m.WHITE_BOARD, m.SAND_BOARD, m.BLACK_TUBE, panel="frame", grip="knob")
_COUNTRY_GREEN = Look(m.WHITE_BOARD, m.GREEN_BOARD, m.BRASS_TUBE, panel="frame", grip="knob")
_PINE = Look(m.PINE_BOARD, m.PINE_BOARD, m.PINE, panel="frame", grip="knob")
_GLASS = Look(m.WHITE_BOARD, m.WHITE_BOARD, panel="glass", grip="knob")
_GLASS_OAK = Look(m.OAK_BOARD, m.OAK_BOARD, m.BLACK_TUBE, panel="glass")
_METAL = Look(m.GREY_METAL_BOARD, m.GREY_METAL_BOARD, m.BLACK_TUBE)
_SLATS = Look(m.WALNUT_BOARD, m.WALNUT_BOARD, m.BLACK_TUBE, panel="slats", grip="knob")

_CABINETS: tuple[Row, ...] = (
    row("base_40", cabinet, 0.4, 0.58, 0.86).having(
        columns=columns_of("D L3"), look=_WHITE, plinth=0.1
    ),
    row("base_60_drawers", cabinet, 0.6, 0.58, 0.86).having(
        columns=columns_of("D D2 D2"), look=_GREY, plinth=0.1
    ),
    row("base_80", cabinet, 0.8, 0.58, 0.86).having(
        columns=columns_of("D L4", "D R4"), look=_BLUE, plinth=0.1, top=m.OAK
    ),
    row("base_country_100", cabinet, 1.0, 0.6, 0.9).having(
        columns=columns_of("D L4", "D R4"), look=_COUNTRY, plinth=0.1, top=m.OAK
    ),
    row("sideboard_120", cabinet, 1.2, 0.42, 0.78).having(
        columns=columns_of("L", "D D D", "R"), look=_WOOD, plinth=0.0, feet=0.14, top=m.OAK_BOARD
    ),
    row("sideboard_160", cabinet, 1.6, 0.45, 0.72)
    .having(columns=columns_of("L", "R", "O O", "R"), plinth=0.0, feet=0.12)
    .having(look=_GREEN, top=m.OAK_BOARD),
    row("sideboard_walnut_180", cabinet, 1.8, 0.45, 0.75)
    .having(columns=columns_of("L", "D D D", "R", "R"), plinth=0.0, feet=0.18, stand="tapered")
    .having(look=_WALNUT, foot_material=m.WALNUT, top=m.WALNUT),
    row("sideboard_slats_150", cabinet, 1.5, 0.4, 0.7).having(
        columns=columns_of("L", "R", "R"), look=_SLATS, plinth=0.0, feet=0.15, stand="sled"
    ),
    row("tv_160", cabinet, 1.6, 0.42, 0.48)
    .having(columns=columns_of("L", "O O", "R"), plinth=0.0, feet=0.12, stand="tapered")
    .having(look=_WOOD, foot_material=m.OAK),
    row("tv_flaps_180", cabinet, 1.8, 0.4, 0.42).having(
        columns=columns_of("F", "O", "F"), look=_WHITE, plinth=0.05, top=m.OAK_BOARD
    ),
    row("tv_drawers_140", cabinet, 1.4, 0.4, 0.5).having(
        columns=columns_of("D O", "D O"), look=_DARK, plinth=0.0, feet=0.1
    ),
    row("highboard_110", cabinet, 1.1, 0.4, 1.3)
    .having(columns=columns_of("L2 D", "R2 D"), plinth=0.0, feet=0.14, stand="sled")
    .having(look=_GREY, top=m.OAK_BOARD),
    row("highboard_glass_100", cabinet, 1.0, 0.4, 1.4).having(
        columns=columns_of("L", "R"), look=_GLASS_OAK, plinth=0.06
    ),
    row("display_80", cabinet, 0.8, 0.38, 1.85).having(columns=columns_of("L", "R"), look=_GLASS),
    row("buffet_120", cabinet, 1.2, 0.48, 0.95).having(
        columns=columns_of("D L3", "D O3", "D R3"), look=_PINE, plinth=0.08, top=m.PINE
    ),
    row("shoe_75", cabinet, 0.75, 0.3, 1.1).having(
        columns=columns_of("F F F"), look=_WHITE, plinth=0.06, top=m.OAK_BOARD
    ),
    row("filing_doors_80", cabinet, 0.8, 0.42, 1.2).having(
        columns=columns_of("L", "R"), look=_METAL, plinth=0.05
    ),
    row("filing_tall_100", cabinet, 1.0, 0.42, 1.95).having(
        columns=columns_of("L", "R"), look=_METAL, plinth=0.05
    ),
    row("locker_60", cabinet, 0.6, 0.5, 1.8)
    .having(columns=columns_of("L L", "L L"), plinth=0.1)
    .having(look=Look(m.GREY_METAL_BOARD, m.BLUE_METAL_BOARD, m.BLACK_TUBE)),
    row("tall_60", cabinet, 0.6, 0.58, 2.0).having(
        columns=columns_of("L2 L1.2"), look=_WHITE, plinth=0.1
    ),
    row("tall_drawers_60", cabinet, 0.6, 0.58, 2.1).having(
        columns=columns_of("L3 D D D"), look=_BLUE, plinth=0.1
    ),
    row("bathroom_60", cabinet, 0.6, 0.46, 0.82).having(
        columns=columns_of("L", "R"), look=_COUNTRY_GREEN, plinth=0.1
    ),
)
_WALL_CABINETS: tuple[Row, ...] = (
    row("single_40", wall_cabinet, 0.4, 0.36, 0.72).having(columns=columns_of("L")),
    row("single_60", wall_cabinet, 0.6, 0.36, 0.72).having(columns=columns_of("R"), look=_GREY),
    row("double_80", wall_cabinet, 0.8, 0.36, 0.72).having(columns=columns_of("L", "R")),
    row("double_100_tall", wall_cabinet, 1.0, 0.38, 0.9).having(
        columns=columns_of("L", "R"), look=_BLUE
    ),
    row("low_90", wall_cabinet, 0.9, 0.36, 0.4).having(columns=columns_of("L", "R"), look=_WOOD),
    row("open_middle_120", wall_cabinet, 1.2, 0.35, 0.7).having(
        columns=columns_of("L", "O", "R"), look=_GREEN
    ),
    row("double_60_shallow", wall_cabinet, 0.6, 0.2, 0.6).having(
        columns=columns_of("L", "R"), look=_DARK
    ),
    row("glass_80", wall_cabinet, 0.8, 0.34, 0.72).having(
        columns=columns_of("L", "R"), look=_GLASS
    ),
    row("lift_90", wall_cabinet, 0.9, 0.36, 0.4).having(columns=columns_of("U"), look=_WHITE),
    row("lift_two_80", wall_cabinet, 0.8, 0.36, 0.76).having(columns=columns_of("U U"), look=_GREY),
    row("country_80", wall_cabinet, 0.8, 0.34, 0.8).having(
        columns=columns_of("L", "R"), look=_COUNTRY
    ),
    row("mirror_60", wall_cabinet, 0.6, 0.16, 0.7).having(
        columns=columns_of("L", "R"), look=Look(m.WHITE_BOARD, m.MIRROR, grip="none")
    ),
    row("medicine_35", wall_cabinet, 0.35, 0.15, 0.55)
    .having(columns=columns_of("L"), shelf_spacing=0.18)
    .having(look=Look(m.WHITE_BOARD, m.WHITE_BOARD, grip="knob")),
    row("pine_open_100", wall_cabinet, 1.0, 0.32, 0.75).having(
        columns=columns_of("L2 O", "R2 O"), look=_PINE
    ),
)
_COUNTERS: tuple[Row, ...] = (
    row("row_120", counter, 1.2, 0.63, 0.9).having(columns=columns_of("D L4", "D R4")),
    row("row_180", counter, 1.8, 0.63, 0.9).having(
        columns=columns_of("D L4", "D D2 D2", "D R4"), look=_GREY
    ),
    row("row_240", counter, 2.4, 0.63, 1.01).having(
        columns=columns_of("L", "L", "D D2 D2", "R"), look=_BLUE, worktop=m.OAK, upstand=0.1
    ),
    row("island_160", counter, 1.6, 0.9, 0.92).having(
        columns=columns_of("L", "D D2 D2", "R"), look=_GREEN, worktop=m.STONE, thickness=0.03
    ),
    row("row_300", counter, 3.0, 0.63, 0.96)
    .having(columns=columns_of("D L4", "D D2 D2", "R", "R", "D R4"), thickness=0.03, upstand=0.06)
    .having(worktop=m.STONE),
    row("narrow_60", counter, 0.6, 0.63, 0.9).having(columns=columns_of("D R4"), look=_WOOD),
    row("country_200", counter, 2.0, 0.64, 0.91).having(
        columns=columns_of("L", "D D2 D2", "D R4", "R"), look=_COUNTRY, worktop=m.OAK
    ),
    row("drawers_90", counter, 0.9, 0.63, 0.9).having(
        columns=columns_of("D D2 D2"), look=_DARK, worktop=m.WALNUT
    ),
    row("island_seats_180", counter, 1.8, 1.0, 0.92).having(
        columns=columns_of("L", "D D2 D2", "R"), look=_WHITE, worktop=m.OAK, overhang=0.32
    ),
    row("open_end_160", counter, 1.6, 0.63, 0.9).having(
        columns=columns_of("D L4", "D D2 D2", "0.6: O"), look=_WOOD, worktop=m.LAMINATE
    ),
    row("bar_150", counter, 1.5, 0.7, 1.08).having(
        columns=columns_of("L", "R"), look=_DARK, worktop=m.OAK, overhang=0.25
    ),
)
_DRAWER_UNITS: tuple[Row, ...] = (
    row("dresser_90", cabinet, 0.9, 0.48, 1.02)
    .having(columns=columns_of("D D D D"), plinth=0.06, class_name="drawer_unit")
    .having(look=_WHITE, top=m.PINE),
    row("dresser_six_140", cabinet, 1.4, 0.48, 0.8).having(
        columns=columns_of("D D D", "D D D"), look=_WHITE, plinth=0.06, class_name="drawer_unit"
    ),
    row("dresser_walnut_120", cabinet, 1.2, 0.46, 0.82)
    .having(
        columns=columns_of("D D2 D2", "D D2 D2"),
        plinth=0.0,
        feet=0.16,
        stand="tapered",
        class_name="drawer_unit",
    )
    .having(look=_WALNUT, foot_material=m.WALNUT, top=m.WALNUT),
    row("dresser_country_100", cabinet, 1.0, 0.5, 0.9)
    .having(columns=columns_of("D D D", "D D D"), plinth=0.06, class_name="drawer_unit")
    .having(look=_COUNTRY, top=m.OAK_BOARD),
    row("dresser_nine_150", cabinet, 1.5, 0.5, 0.9)
    .having(columns=columns_of("D D D", "D D D", "D D D"), plinth=0.08, class_name="drawer_unit")
    .having(look=_PINE, top=m.PINE),
    row("chest_80", cabinet, 0.8, 0.45, 1.2).having(
        columns=columns_of("D D D D D"), look=_WOOD, plinth=0.0, feet=0.1, class_name="drawer_unit"
    ),
    row("chest_pine_75", cabinet, 0.75, 0.42, 0.75).having(
        columns=columns_of("D D D"), look=_PINE, plinth=0.06, top=m.PINE, class_name="drawer_unit"
    ),
    row("tallboy_50", cabinet, 0.5, 0.42, 1.3).having(
        columns=columns_of("D D D D D D"), look=_GREY, plinth=0.05, class_name="drawer_unit"
    ),
    row("filing_42", cabinet, 0.42, 0.6, 0.72).having(
        columns=columns_of("D D D"), look=_DARK, plinth=0.03, class_name="drawer_unit"
    ),
    row("filing_tall_46", cabinet, 0.46, 0.62, 1.32).having(
        columns=columns_of("D D D D"), look=_METAL, plinth=0.03, class_name="drawer_unit"
    ),
    row("pedestal_castors_42", cabinet, 0.42, 0.55, 0.58)
    .having(
        columns=columns_of("D D D2"),
        plinth=0.0,
        feet=0.07,
        stand="castors",
        class_name="drawer_unit",
    )
    .having(look=_METAL),
    row("pedestal_white_36", cabinet, 0.36, 0.5, 0.62)
    .having(
        columns=columns_of("D D D D"),
        plinth=0.0,
        feet=0.065,
        stand="castors",
        class_name="drawer_unit",
    )
    .having(look=_WHITE),
    row("plan_chest_110", cabinet, 1.1, 0.8, 0.72).having(
        columns=columns_of("D D D D D D"), look=_METAL, plinth=0.1, class_name="drawer_unit"
    ),
    row("legs_three_80", leg_nightstand, 0.8, 0.45, 0.85)
    .having(
        columns=columns_of("D D D"),
        body=0.55,
        follows={"body": 2},
        leg=0.045,
        shelf=False,
        class_name="drawer_unit",
    )
    .having(look=_WOOD),
)
_SHELVES: tuple[Row, ...] = (
    row("tall_80", bookshelf, 0.8, 0.28, 2.02).having(rows=6),
    row("narrow_40", bookshelf, 0.4, 0.28, 2.02).having(rows=6, board=m.OAK_BOARD),
    row("middle_80", bookshelf, 0.8, 0.28, 1.06).having(rows=3),
    row("cube_77x77", bookshelf, 0.77, 0.39, 0.77).having(
        rows=2, columns=2, back=False, plinth=0.0
    ),
    row("cube_77x147", bookshelf, 0.77, 0.39, 1.47).having(
        rows=4, columns=2, back=False, plinth=0.0, board=m.BIRCH
    ),
    row("cube_147x147", bookshelf, 1.47, 0.39, 1.47).having(
        rows=4, columns=4, back=False, plinth=0.0
    ),
    row("cube_42x147", bookshelf, 0.42, 0.39, 1.47).having(
        rows=4, back=False, plinth=0.0, board=m.DARK_BOARD
    ),
    row("wide_120", bookshelf, 1.2, 0.3, 1.8).having(rows=5, columns=2, board=m.WALNUT),
    row("low_140", bookshelf, 1.4, 0.35, 0.6).having(rows=2, columns=3, board=m.PINE),
    row("low_90", bookshelf, 0.9, 0.3, 0.8).having(rows=2, board=m.GREEN_BOARD),
    row("doors_below_90", door_bookshelf, 0.9, 0.38, 1.95).having(
        columns=columns_of("O3 L", "O3 R"), look=_WHITE
    ),
    row("drawers_below_80", door_bookshelf, 0.8, 0.38, 1.8).having(
        columns=columns_of("O4 D D"), look=_WOOD
    ),
    row("glass_doors_80", door_bookshelf, 0.8, 0.35, 2.0).having(
        columns=columns_of("L", "R"), look=_GLASS
    ),
    row("rack_90", post_rack, 0.9, 0.4, 1.8),
    row("rack_steel_100", post_rack, 1.0, 0.45, 1.9).having(
        frame=m.STEEL_TUBE, board=m.GREY_METAL_BOARD
    ),
    row("rack_low_110", post_rack, 1.1, 0.35, 0.85).having(
        rows=3, board=m.WALNUT_BOARD, frame=m.BRASS_TUBE
    ),
    row("rack_pine_77", post_rack, 0.77, 0.5, 1.74).having(
        rows=4, frame=m.PINE, board=m.PINE_BOARD, post=0.042
    ),
    row("ladder_65", ladder_shelf, 0.65, 0.42, 1.85),
    row("wall_board_90", wall_shelf, 0.9, 0.22, 0.145),
    row("wall_three_80", wall_shelf, 0.8, 0.24, 0.85).having(rows=3, board=m.BIRCH),
    row("wall_box_70", wall_shelf, 0.7, 0.22, 0.6).having(
        rows=2, framed=True, board=m.WALNUT_BOARD
    ),
)

ROWS: dict[str, tuple[Row, ...]] = {
    "cabinet": _CABINETS,
    "wall_cabinet": _WALL_CABINETS,
    "counter": _COUNTERS,
    "drawer_unit": _DRAWER_UNITS,
    "bookshelf": _SHELVES,
}
