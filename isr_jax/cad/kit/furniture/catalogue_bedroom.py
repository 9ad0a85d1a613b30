"""Beds, nightstands and wardrobes of the catalogue, at sizes of furniture makers' catalogues."""

from __future__ import annotations

from .. import materials as m
from ..rows import Row, row
from .beds import bed, divan
from .bunks import bunk_bed, cot, four_poster
from .fronts import Look, columns_of
from .storage import cabinet, leg_nightstand
from .wardrobes import open_wardrobe, sliding_wardrobe, wardrobe

_LIES = {"lying": 2}
_BODY = {"body": 2}
_WOOD = Look(m.OAK_BOARD, m.OAK_BOARD, m.BLACK_TUBE)
_WHITE = Look()
_WALNUT = Look(m.WALNUT_BOARD, m.WALNUT_BOARD, m.BRASS_TUBE)
_COUNTRY = Look(m.WHITE_BOARD, m.WHITE_BOARD, m.BLACK_TUBE, panel="frame", grip="knob")
_PINE = Look(m.PINE_BOARD, m.PINE_BOARD, m.PINE, panel="frame", grip="knob")
_SAND = Look(m.SAND_BOARD, m.SAND_BOARD, m.BLACK_TUBE)

_BEDS: tuple[Row, ...] = (
    row("single_90", bed, 0.96, 2.08, 0.95).having(follows=_LIES),
    row("double_140", bed, 1.46, 2.08, 0.95).having(
        follows=_LIES | {"footboard": 2}, frame=m.PINE, pillows=2, footboard=0.6
    ),
    row("queen_160", bed, 1.66, 2.08, 1.05).having(
        follows=_LIES, frame=m.WALNUT, pillows=2, lying=0.52, blanket=m.GREY_BLANKET
    ),
    row("king_180", bed, 1.86, 2.08, 0.95).having(follows=_LIES, frame=m.WHITE_BOARD, pillows=2),
    row("child_70", bed, 0.76, 1.68, 0.65).having(
        follows=_LIES, lying=0.38, mattress=0.14, frame=m.BIRCH
    ),
    row("daybed_80", bed, 0.86, 2.08, 0.8)
    .having(
        follows=_LIES | {"footboard": 2, "side_back": 2}, footboard=0.8, side_back=0.8, pillows=0
    )
    .having(frame=m.WHITE_BOARD),
    row("slatted_90", bed, 0.96, 2.08, 1.0)
    .having(follows=_LIES | {"footboard": 2}, footboard=0.7, slatted=True)
    .having(frame=m.PINE, blanket=m.BLUE_BLANKET),
    row("slatted_160", bed, 1.66, 2.08, 1.1)
    .having(follows=_LIES | {"footboard": 2}, footboard=0.65, slatted=True, pillows=2)
    .having(frame=m.BLACK_WOOD, blanket=m.ROSE_BLANKET),
    row("storage_140", bed, 1.46, 2.08, 0.9)
    .having(follows=_LIES, pillows=2, drawers=2, lying=0.52)
    .having(frame=m.WHITE_BOARD, blanket=m.GREEN_BLANKET),
    row("storage_180", bed, 1.86, 2.1, 1.0).having(
        follows=_LIES, frame=m.OAK_BOARD, pillows=2, drawers=2, lying=0.54
    ),
    row("divan_160", divan, 1.6, 2.09, 1.15).having(follows=_LIES),
    row("divan_90", divan, 0.9, 2.0, 0.62).having(headboard=False, pillows=1, fabric=m.BLUE_FABRIC),
    row("divan_180_panels", divan, 1.8, 2.12, 1.2).having(
        follows=_LIES, padded=6, fabric=m.BEIGE_FABRIC, blanket=m.GREY_BLANKET
    ),
    row("divan_140_leather", divan, 1.4, 2.1, 1.05).having(
        follows=_LIES, padded=2, lying=0.54, fabric=m.BLACK_LEATHER
    ),
    row("bunk_90", bunk_bed, 1.07, 2.06, 1.6).having(follows={"upper": 2, "lower": 2}),
    row("loft_90", bunk_bed, 1.07, 2.06, 1.85).having(
        follows={"upper": 2}, upper=1.45, lower=None, frame=m.BIRCH
    ),
    row("four_poster_160", four_poster, 1.72, 2.12, 2.05).having(follows=_LIES),
    row("cot_60", cot, 0.66, 1.25, 0.86).having(follows={"level": 2}),
    row("cot_70", cot, 0.76, 1.45, 0.9).having(follows={"level": 2}, frame=m.BEECH),
)
_NIGHTSTANDS: tuple[Row, ...] = (
    row("open_45", cabinet, 0.45, 0.4, 0.5).having(
        columns=columns_of("D O"), look=_WOOD, plinth=0.0, feet=0.1, class_name="nightstand"
    ),
    row("two_drawers_45", cabinet, 0.45, 0.4, 0.52)
    .having(
        columns=columns_of("D D"), plinth=0.0, feet=0.12, stand="tapered", class_name="nightstand"
    )
    .having(look=_WHITE, foot_material=m.OAK),
    row("three_drawers_40", cabinet, 0.40, 0.38, 0.6)
    .having(columns=columns_of("D D D"), plinth=0.05, class_name="nightstand")
    .having(look=_WALNUT, top=m.WALNUT),
    row("door_42", cabinet, 0.42, 0.36, 0.58)
    .having(columns=columns_of("D L2"), plinth=0.06, class_name="nightstand")
    .having(look=_COUNTRY, top=m.OAK_BOARD),
    row("tall_open_38", cabinet, 0.38, 0.35, 0.66).having(
        columns=columns_of("D O O"), look=_PINE, plinth=0.05, top=m.PINE, class_name="nightstand"
    ),
    row("wide_60", cabinet, 0.60, 0.42, 0.48)
    .having(columns=columns_of("D D"), plinth=0.0, feet=0.15, stand="sled", class_name="nightstand")
    .having(look=_SAND),
    row("legs_48", leg_nightstand, 0.48, 0.4, 0.58).having(
        follows=_BODY, columns=columns_of("D"), look=_WOOD
    ),
    row("legs_two_44", leg_nightstand, 0.44, 0.38, 0.65)
    .having(follows=_BODY, body=0.3, columns=columns_of("D D"))
    .having(look=Look(m.WALNUT_BOARD, m.WALNUT_BOARD, m.BRASS_TUBE, grip="knob")),
    row("legs_white_40", leg_nightstand, 0.40, 0.36, 0.6).having(
        follows=_BODY, columns=columns_of("D"), body=0.16, look=_COUNTRY, shelf=False
    ),
)
_WARDROBES: tuple[Row, ...] = (
    row("doors_100", wardrobe, 1.0, 0.6, 1.95).having(
        columns=columns_of("L4 D", "R4 D"), look=_WOOD
    ),
    row("doors_90", wardrobe, 0.9, 0.58, 1.9).having(columns=columns_of("L", "R"), look=_WHITE),
    row("doors_150", wardrobe, 1.5, 0.6, 2.01).having(
        columns=columns_of("L", "L", "R"), look=_SAND
    ),
    row("doors_200", wardrobe, 2.0, 0.6, 2.2).having(
        columns=columns_of("L", "L", "R", "R"), look=Look(m.WHITE_BOARD, m.GREY_BOARD)
    ),
    row("doors_drawers_150", wardrobe, 1.5, 0.6, 2.0).having(
        columns=columns_of("L", "L3 D D", "R"), look=_WALNUT
    ),
    row("single_50", wardrobe, 0.5, 0.52, 1.85).having(columns=columns_of("L5 D"), look=_WHITE),
    row("country_120", wardrobe, 1.2, 0.62, 2.0).having(
        columns=columns_of("L4 D", "R4 D"), look=_COUNTRY, cornice=0.02
    ),
    row("armoire_130", wardrobe, 1.3, 0.64, 2.05).having(
        columns=columns_of("L5 D", "R5 D"), look=_PINE, plinth=0.0, feet=0.1, cornice=0.025
    ),
    row("mirror_100", wardrobe, 1.0, 0.58, 2.0).having(
        columns=columns_of("L", "R"), look=Look(m.OAK_BOARD, m.MIRROR, m.BLACK_TUBE)
    ),
    row("slats_100", wardrobe, 1.0, 0.55, 1.9).having(
        columns=columns_of("L", "R"),
        look=Look(m.WHITE_BOARD, m.WHITE_BOARD, m.STEEL, panel="slats", grip="knob"),
    ),
    row("sliding_150", sliding_wardrobe, 1.5, 0.66, 2.1),
    row("sliding_200", sliding_wardrobe, 2.0, 0.66, 2.2).having(
        look=_WOOD, fillings=(m.OAK_BOARD, m.MIRROR)
    ),
    row("sliding_270", sliding_wardrobe, 2.7, 0.68, 2.25)
    .having(doors=3)
    .having(
        look=Look(m.GREY_BOARD, m.WHITE_BOARD, m.STEEL),
        fillings=(m.WHITE_BOARD, m.MIRROR, m.WHITE_BOARD),
    ),
    row("sliding_dark_180", sliding_wardrobe, 1.8, 0.66, 2.16).having(
        look=Look(m.DARK_BOARD, m.DARK_BOARD, m.BLACK_TUBE)
    ),
    row("open_120", open_wardrobe, 1.2, 0.48, 1.8),
    row("open_80", open_wardrobe, 0.8, 0.45, 1.65).having(
        frame=m.WHITE_TUBE, board=m.PINE, shelves=1
    ),
)

ROWS: dict[str, tuple[Row, ...]] = {
    "bed": _BEDS,
    "nightstand": _NIGHTSTANDS,
    "wardrobe": _WARDROBES,
}
