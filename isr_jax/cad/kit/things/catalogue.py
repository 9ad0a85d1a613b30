"""Small things, lamps, plants, boxes, bags, doors and windows of the default set."""

from __future__ import annotations

import dataclasses

from .. import materials as m
from ..rows import Row, row
from . import lamps as shapes
from .bags import backpack, duffel, handbag, shopping_bag, suitcase
from .bins import lidded_bin, pedal_bin, round_bin, square_bin, swing_bin
from .boxes import carton, crate, open_carton, storage_box, tray
from .desk_lamps import arm_lamp, bent_lamp
from .doors import barn_door, door, double_door
from .lamps import floor_lamp, globe_lamp, table_lamp, uplighter, wall_lamp
from .leaves import Leaf
from .paper import book
from .plants import blade_plant, leafy_plant, palm
from .sliders import PROFILE, sliding_door
from .trees import CONE, cactus, tree
from .vessels import bottle, bowl, cup
from .windows import SASH, casement_window, sliding_window

_CUPS = (
    row("mug", cup, 0.082, 0.082, 0.095),
    row("mug_large", cup, 0.093, 0.093, 0.105).having(material=m.BLUE_CERAMIC),
    row("tea_cup", cup, 0.09, 0.09, 0.065).having(foot=0.6, wall=0.003, material=m.RED_CERAMIC),
    row("espresso", cup, 0.062, 0.062, 0.058).having(foot=0.774, wall=0.0035),
    row("tumbler", cup, 0.076, 0.076, 0.12).having(
        foot=0.842, wall=0.0025, bottom=0.008, handle=False, material=m.GLASS
    ),
    row("beaker", cup, 0.08, 0.08, 0.1).having(
        foot=0.875, wall=0.002, bottom=0.003, handle=False, material=m.GREEN_PLASTIC
    ),
    row("mug_conical", cup, 0.09, 0.09, 0.09).having(foot=0.8),
    row("jug_glass", cup, 0.11, 0.11, 0.2).having(
        foot=0.8, wall=0.004, bottom=0.008, material=m.GLASS
    ),
)
_BOWLS = (
    row("cereal_15", bowl, 0.15, 0.15, 0.065),
    row("salad_26", bowl, 0.26, 0.26, 0.1).having(
        foot=0.4, wall=0.007, bottom=0.009, material=m.WOODEN_BOWL
    ),
    row("mixing_24", bowl, 0.24, 0.24, 0.12).having(
        foot=0.5, wall=0.002, bottom=0.002, material=m.THIN_STEEL
    ),
    row("glass_20", bowl, 0.2, 0.2, 0.085).having(foot=0.5, curve=0.4, material=m.GLASS),
    row("oval_30", bowl, 0.3, 0.2, 0.07).having(foot=0.6, wall=0.005, curve=0.7),
    row("conical_16", bowl, 0.16, 0.16, 0.075).having(
        foot=0.35, curve=0.0, rings=1, material=m.GREEN_PLASTIC
    ),
)


def _bottle(name: str, width: float, depth: float, height: float) -> Row:
    """A bottle whose cap grows with its height."""
    return row(name, bottle, width, depth, height).having(follows={"cap": 2}, cap=0.03)


_BOTTLES = (
    _bottle("wine_bordeaux", 0.074, 0.074, 0.3).having(shoulder=0.62, throat=0.72, cap=0.045),
    _bottle("wine_burgundy", 0.084, 0.084, 0.295)
    .having(shoulder=0.5, throat=0.76, cap=0.04, label=(0.14, 0.42))
    .having(cap_material=m.YELLOW_COVER),
    _bottle("water_50", 0.065, 0.065, 0.23)
    .having(neck=0.027, shoulder=0.68, throat=0.86, cap=0.02, label=(0.35, 0.6))
    .having(material=m.WATER_BOTTLE, cap_material=m.BLUE_PLASTIC, label_material=m.BLUE_COVER),
    _bottle("water_150_screw", 0.09, 0.09, 0.32)
    .having(neck=0.03, shoulder=0.68, throat=0.87, cap=0.02, label=(0.4, 0.62), screw=True)
    .having(material=m.WATER_BOTTLE, cap_material=m.RED_PLASTIC, label_material=m.GREEN_COVER),
    _bottle("milk_100", 0.088, 0.088, 0.25)
    .having(neck=0.045, shoulder=0.6, throat=0.82, cap=0.02, label=None)
    .having(material=m.MILK_BOTTLE, cap_material=m.BLUE_PLASTIC),
    _bottle("oil_75", 0.07, 0.07, 0.29)
    .having(neck=0.03, shoulder=0.66, throat=0.78, cap=0.03)
    .having(material=m.OIL_BOTTLE, cap_material=m.BLACK_COVER, label_material=m.GREEN_COVER),
    _bottle("beer_33", 0.061, 0.061, 0.23)
    .having(neck=0.026, shoulder=0.5, throat=0.72, cap=0.008, label=(0.15, 0.42))
    .having(material=m.BEER_BOTTLE, cap_material=m.YELLOW_COVER),
    _bottle("shampoo_30", 0.075, 0.045, 0.19)
    .having(neck=0.03, shoulder=0.74, throat=0.8, cap=0.028, label=(0.2, 0.6))
    .having(material=m.MILK_BOTTLE, cap_material=m.GREEN_PLASTIC, label_material=m.GREEN_COVER),
    _bottle("carafe_open", 0.1, 0.1, 0.28)
    .having(neck=0.045, shoulder=0.45, throat=0.72, wall=0.004)
    .having(material=m.GREEN_GLASS),
)
_BOOKS = (
    row("paperback", book, 0.11, 0.178, 0.02).having(board=0.0005, cover=m.YELLOW_COVER),
    row("novel", book, 0.14, 0.21, 0.032),
    row("a5", book, 0.15, 0.21, 0.018).having(cover=m.BLUE_COVER),
    row("textbook", book, 0.19, 0.245, 0.042).having(cover=m.GREEN_COVER),
    row("a4", book, 0.21, 0.297, 0.025).having(cover=m.BLACK_COVER),
    row("magazine", book, 0.21, 0.28, 0.008).having(board=0.0005, cover=m.RED_COVER),
    row("picture_book", book, 0.26, 0.26, 0.016).having(cover=m.YELLOW_COVER),
    row("dictionary", book, 0.17, 0.24, 0.065).having(board=0.003, cover=m.BLUE_COVER),
)
_BINS = (
    row("round_28", round_bin, 0.26, 0.26, 0.28),
    row("round_40", round_bin, 0.32, 0.32, 0.4).having(foot=0.8125, material=m.STEEL_TUBE),
    row("round_60", round_bin, 0.38, 0.38, 0.6).having(foot=0.895, material=m.WHITE_PLASTIC),
    row("square_30", square_bin, 0.24, 0.24, 0.3),
    row("office_34", square_bin, 0.3, 0.2, 0.34).having(material=m.BLUE_PLASTIC),
    row("kitchen_62", square_bin, 0.4, 0.3, 0.62).having(
        taper=0.95, wall=0.003, material=m.WHITE_PLASTIC
    ),
    row("recycling_45", square_bin, 0.36, 0.26, 0.45).having(taper=0.8, material=m.GREEN_PLASTIC),
    row("oval_32", round_bin, 0.34, 0.22, 0.32).having(material=m.BEECH, wall=0.005, foot=0.85),
    row("pedal_5", pedal_bin, 0.205, 0.24, 0.29).having(lid=0.045),
    row("pedal_30", pedal_bin, 0.29, 0.33, 0.65).having(lid=0.06, material=m.BIN_STEEL),
    row("swing_25", swing_bin, 0.3, 0.24, 0.52),
    row("swing_50", swing_bin, 0.38, 0.32, 0.68).having(material=m.GREY_PLASTIC, hood=0.15),
    row("lidded_40", lidded_bin, 0.36, 0.38, 0.6).having(material=m.GREEN_PLASTIC),
)
_BOXES = (
    row("carton_small", carton, 0.25, 0.2, 0.15).having(board=0.003),
    row("carton_40", carton, 0.4, 0.3, 0.3),
    row("carton_60", carton, 0.6, 0.4, 0.4).having(board=0.005),
    row("carton_flat", carton, 0.45, 0.35, 0.12),
    row("open_carton_55", open_carton, 0.62, 0.52, 0.32),
    row("open_carton_40", open_carton, 0.42, 0.4, 0.22).having(
        board=0.003, material=m.CARDBOARD_INSIDE
    ),
    row("storage_30", storage_box, 0.3, 0.2, 0.16),
    row("storage_60", storage_box, 0.58, 0.39, 0.3).having(
        material=m.CLEAR_PLASTIC, lid_material=m.BLUE_LID
    ),
    row("shoe_box", storage_box, 0.34, 0.21, 0.13)
    .having(wall=0.003, latch=False, opening_rad=1.5)
    .having(material=m.CARDBOARD_INSIDE, lid_material=m.CARDBOARD_LID),
    row("toy_chest", storage_box, 0.75, 0.42, 0.45).having(
        wall=0.012, lid=0.03, material=m.PINE, lid_material=m.BIRCH
    ),
    row("euro_60", tray, 0.6, 0.4, 0.22),
    row("euro_40", tray, 0.4, 0.3, 0.12).having(material=m.BLUE_PLASTIC),
    row("crate_40", crate, 0.4, 0.3, 0.25),
    row("crate_50", crate, 0.5, 0.4, 0.3).having(slats=4, material=m.BIRCH),
)
_BAGS = (
    row("paper_32", shopping_bag, 0.32, 0.17, 0.52),
    row("paper_18", shopping_bag, 0.18, 0.1, 0.32).having(loop=0.08, material=m.WHITE_PAPER),
    row("tote_38", shopping_bag, 0.38, 0.14, 0.62).having(
        loop=0.22, material=m.COTTON, cord=m.COTTON
    ),
    row("handbag_32", handbag, 0.32, 0.15, 0.36),
    row("handbag_26", handbag, 0.26, 0.13, 0.3).having(lean=0.9, material=m.RED_LEATHER),
    row("backpack_30", backpack, 0.31, 0.27, 0.49),
    row("backpack_20", backpack, 0.27, 0.23, 0.42).having(material=m.GREEN_CLOTH),
    row("duffel_55", duffel, 0.55, 0.28, 0.38),
    row("suitcase_cabin", suitcase, 0.37, 0.23, 0.55),
    row("suitcase_large", suitcase, 0.5, 0.3, 0.76).having(material=m.SILVER_CASE),
)
_LAMPS = (
    row("table_urn", table_lamp, 0.3, 0.3, 0.48),
    row("table_column", table_lamp, 0.22, 0.22, 0.5).having(
        body=shapes.COLUMN, shade=0.34, material=m.OAK, narrow=0.9
    ),
    row("table_ball", table_lamp, 0.32, 0.32, 0.52).having(
        body=shapes.BALL, material=m.BLUE_CAST_CERAMIC, shade=0.4, narrow=0.8
    ),
    row("bedside_drum", table_lamp, 0.16, 0.16, 0.28).having(
        body=shapes.DRUM, material=m.WALNUT, shade=0.5, narrow=1.0
    ),
    row("globe_25", globe_lamp, 0.25, 0.25, 0.29),
    row("desk_arm", arm_lamp, 0.18, 0.5, 0.46),
    row("desk_bent", bent_lamp, 0.17, 0.36, 0.42),
    row("floor_150", floor_lamp, 0.4, 0.4, 1.55),
    row("floor_tripod", floor_lamp, 0.52, 0.52, 1.5).having(tripod=True, material=m.OAK, shade=0.2),
    row("uplighter_180", uplighter, 0.32, 0.32, 1.8),
    row("wall_shade", wall_lamp, 0.18, 0.24, 0.3),
)
_PLANTS = (
    row("rubber_tree", leafy_plant, 0.75, 0.7, 1.4).having(pot=0.22, pot_width=0.42, leaves=13),
    row("monstera", leafy_plant, 0.95, 0.9, 1.05)
    .having(pot=0.3, pot_width=0.36, leaf=0.75, leaves=9, rise=0.4, droop=0.15, stem=0.012)
    .having(material=m.CERAMIC),
    row("sill_small", leafy_plant, 0.2, 0.2, 0.28).having(
        pot=0.36, pot_width=0.6, stem=0.004, leaf_material=m.PALE_LEAF, mount="surface"
    ),
    row("palm_160", palm, 1.0, 1.0, 1.6).having(frond=0.2),
    row("snake_plant", blade_plant, 0.34, 0.34, 0.8).having(pot_width=0.78, blade=0.075),
    row("aloe", blade_plant, 0.24, 0.24, 0.26)
    .having(pot=0.42, pot_width=0.6, blade=0.03, outer=0.7, mount="surface")
    .having(leaf_material=m.PALE_LEAF, material=m.TERRACOTTA),
    row("box_ball", tree, 0.5, 0.5, 1.1).having(
        pot=0.27, pot_width=0.66, crowns=((0.54, 1.0, 1.0),)
    ),
    row("box_cone", tree, 0.5, 0.5, 1.35).having(
        pot=0.24, pot_width=0.7, crown=CONE, crowns=((0.27, 1.0, 1.0),), material=m.CONCRETE
    ),
    row("box_tiers", tree, 0.45, 0.45, 1.45).having(
        pot=0.2, pot_width=0.72, crowns=((0.25, 0.5, 1.0), (0.56, 0.76, 0.8), (0.82, 1.0, 0.6))
    ),
    row("herb", tree, 0.18, 0.18, 0.26).having(
        pot=0.42, pot_width=0.66, trunk=0.005, crowns=((0.44, 1.0, 1.0),), mount="surface"
    ),
    row("cactus_arms", cactus, 0.3, 0.22, 0.6),
    row("cactus_small", cactus, 0.1, 0.1, 0.19).having(
        arms=False, pot=0.4, body=0.5, mount="surface"
    ),
)

_OAK_PANELS = Leaf(m.OAK_DOOR, m.OAK_DOOR, fields=(1.3, 1.0), sill=0.2, columns=2, bar=0.1)
_WHITE_PANELS = Leaf(m.WHITE_DOOR, m.WHITE_DOOR, fields=(1.2, 0.5, 1.2), sill=0.2)
_GLAZED = Leaf(m.WHITE_DOOR, m.GLASS, sill=0.25, fields=(1.0,), thickness=0.15)
_GLAZED_BARS = Leaf(
    m.GREY_DOOR,
    m.GLASS,
    stile=0.1,
    sill=0.2,
    fields=(1.0, 1.0, 1.0, 1.0),
    bar=0.03,
    columns=2,
    thickness=0.15,
)
_ENTRANCE = Leaf(m.GREEN_DOOR, m.DOUBLE_GLAZING, stile=0.14, sill=0.75, thickness=0.5)
_PLANKS = Leaf(
    m.OAK_DOOR, m.OAK_DOOR, stile=0.12, sill=0.12, fields=(1.0, 1.0), bar=0.12, thickness=0.7
)
_DARK = dataclasses.replace(PROFILE, material=m.DARK_PROFILE)
_DOORS = (
    row("interior_86", door, 0.985, 0.1, 2.05),
    row("interior_73_right", door, 0.86, 0.1, 2.05).having(
        hinge="right", leaf=Leaf(m.OAK_DOOR), frame=m.OAK_BOARD
    ),
    row("interior_61_knob", door, 0.735, 0.1, 2.05).having(handle="knob", metal=m.BRASS),
    row("panelled_oak", door, 0.985, 0.12, 2.1).having(leaf=_OAK_PANELS, frame=m.OAK_BOARD),
    row("panelled_white", door, 0.9, 0.1, 2.05).having(
        leaf=_WHITE_PANELS, hinge="right", handle="knob", metal=m.BRASS
    ),
    row("glazed_86", door, 0.985, 0.1, 2.05).having(leaf=_GLAZED),
    row("glazed_bars", door, 0.985, 0.1, 2.15).having(leaf=_GLAZED_BARS, frame=m.DARK_BOARD),
    row("entrance_100", door, 1.1, 0.14, 2.2).having(
        leaf=_ENTRANCE, thickness=0.06, jamb=0.06, handle="bar"
    ),
    row("double_160", double_door, 1.6, 0.1, 2.08).having(leaf=_WHITE_PANELS),
    row("double_glazed", double_door, 1.75, 0.12, 2.2).having(
        leaf=_GLAZED_BARS, frame=m.DARK_BOARD
    ),
    row("patio_200", sliding_door, 2.0, 0.14, 2.1),
    row("patio_240_dark", sliding_door, 2.4, 0.15, 2.2).having(leaf=_DARK),
    row("barn_180", barn_door, 1.8, 0.08, 2.15).having(leaf=_PLANKS),
)
_DARK_SASH = dataclasses.replace(SASH, material=m.DARK_PROFILE)
_WOOD_SASH = dataclasses.replace(
    SASH, material=m.PINE, stile=0.055, sill=0.06, columns=2, fields=(1.0, 1.0), bar=0.025
)
_WINDOWS = (
    row("casement_60", casement_window, 0.6, 0.075, 0.9),
    row("casement_80_right", casement_window, 0.8, 0.075, 1.2).having(sashes=("right",)),
    row("double_120", casement_window, 1.2, 0.075, 1.3).having(sashes=("left", "right")),
    row("triple_200", casement_window, 2.0, 0.08, 1.4).having(
        sashes=("left", "fixed", "right"), leaf=_DARK_SASH
    ),
    row("fixed_140", casement_window, 1.4, 0.075, 1.2).having(sashes=("fixed",)),
    row("hopper_90", casement_window, 0.9, 0.075, 0.5).having(sashes=("bottom",)),
    row("hopper_120_dark", casement_window, 1.2, 0.075, 0.6).having(
        sashes=("bottom",), leaf=_DARK_SASH
    ),
    row("barred_100", casement_window, 1.0, 0.08, 1.3).having(
        sashes=("left", "right"), leaf=_WOOD_SASH
    ),
    row("sliding_120", sliding_window, 1.2, 0.09, 1.1),
    row("sliding_160_dark", sliding_window, 1.6, 0.1, 1.2).having(leaf=_DARK_SASH),
)

ROWS: dict[str, tuple[Row, ...]] = {
    "cup": _CUPS,
    "bowl": _BOWLS,
    "bottle": _BOTTLES,
    "book": _BOOKS,
    "bin": _BINS,
    "box": _BOXES,
    "bag": _BAGS,
    "lamp": _LAMPS,
    "plant": _PLANTS,
    "door": _DOORS,
    "window": _WINDOWS,
}
