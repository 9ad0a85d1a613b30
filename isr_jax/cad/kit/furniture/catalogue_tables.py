"""Tables and desks of the catalogue, at sizes of furniture makers' catalogues."""

from __future__ import annotations

from .. import materials as m
from ..rows import Row, row
from .desks import (
    corner_desk,
    frame_desk,
    hutch_desk,
    panel_desk,
    pedestal_desk,
    trestle_desk,
)
from .fronts import Look, columns_of
from .side_tables import c_table, folding_table, glass_table
from .tables import (
    drawer_table,
    drum_table,
    frame_table,
    pedestal_table,
    rectangular_table,
    round_table,
    tapered_leg_table,
    trestle_table,
)

_SHELF = {"shelf": 2}
_WHITE = Look()
_WALNUT = Look(m.WALNUT_BOARD, m.WALNUT_BOARD, m.BRASS_TUBE, grip="knob")

_TABLES: tuple[Row, ...] = (
    row("dining_120x75", rectangular_table, 1.2, 0.75, 0.74),
    row("dining_140x80", rectangular_table, 1.4, 0.8, 0.75).having(frame=m.BEECH, leg=0.07),
    row("dining_180x90", rectangular_table, 1.8, 0.9, 0.75).having(frame=m.WALNUT, leg=0.08),
    row("dining_240x100", rectangular_table, 2.4, 1.0, 0.76).having(frame=m.OAK, leg=0.1, top=0.04),
    row("dining_white_160x80", rectangular_table, 1.6, 0.8, 0.74).having(
        frame=m.WHITE_BOARD, top_material=m.OAK, leg=0.065
    ),
    row("kitchen_80x80", rectangular_table, 0.8, 0.8, 0.74).having(frame=m.BIRCH, leg=0.05),
    row("round_90", round_table, 0.9, 0.9, 0.74),
    row("round_120", round_table, 1.2, 1.2, 0.75).having(material=m.OAK, column=0.06),
    row("bistro_60", round_table, 0.6, 0.6, 0.72).having(material=m.BLACK_WOOD, foot=0.65),
    row("oval_200x100", round_table, 2.0, 1.0, 0.74).having(
        material=m.WHITE_BOARD, column=0.07, frame=m.WHITE_TUBE
    ),
    row("bar_60", round_table, 0.6, 0.6, 1.08).having(
        material=m.WHITE_BOARD, foot=0.75, frame=m.CHROME_TUBE
    ),
    row("round_legs_110", drum_table, 1.1, 1.1, 0.74).having(material=m.OAK, splay=0.2),
    row("oval_legs_180x95", drum_table, 1.8, 0.95, 0.75).having(material=m.WALNUT, splay=0.22),
    row("trestle_160x80", trestle_table, 1.6, 0.8, 0.75),
    row("trestle_200x95", trestle_table, 2.0, 0.95, 0.76).having(material=m.OAK),
    row("splayed_140x80", tapered_leg_table, 1.4, 0.8, 0.74),
    row("splayed_white_120x80", tapered_leg_table, 1.2, 0.8, 0.74).having(
        material=m.WHITE_BOARD, frame=m.BEECH
    ),
    row("steel_180x90", frame_table, 1.8, 0.9, 0.76),
    row("steel_220x100", frame_table, 2.2, 1.0, 0.76).having(
        material=m.WALNUT, bar=0.08, top=0.045
    ),
    row("square_pedestal_75", pedestal_table, 0.75, 0.75, 0.75),
    row("pedestal_120x70", pedestal_table, 1.2, 0.7, 0.74).having(
        material=m.OAK, frame=m.BLACK_TUBE
    ),
    row("glass_160x90", glass_table, 1.6, 0.9, 0.75).having(lower=False, top=0.012),
    row("folding_80x60", folding_table, 0.8, 0.6, 0.72),
    row("coffee_110x60", rectangular_table, 1.1, 0.6, 0.45).having(
        follows=_SHELF, leg=0.05, apron=0.06, shelf=0.16
    ),
    row("coffee_80x80", tapered_leg_table, 0.8, 0.8, 0.4).having(material=m.OAK),
    row("coffee_glass_100x60", glass_table, 1.0, 0.6, 0.42),
    row("coffee_glass_70x70", glass_table, 0.7, 0.7, 0.4).having(frame=m.BLACK_TUBE),
    row("coffee_drawers_115x60", drawer_table, 1.15, 0.6, 0.44).having(
        follows=_SHELF, columns=columns_of("D", "D"), shelf=0.14
    ),
    row("coffee_round_80", drum_table, 0.8, 0.8, 0.4).having(shelf=True),
    row("coffee_round_60", drum_table, 0.6, 0.6, 0.45).having(legs=3, material=m.BIRCH, splay=0.2),
    row("coffee_steel_120x65", frame_table, 1.2, 0.65, 0.42).having(
        follows=_SHELF, shelf=0.15, bar=0.04, inset=0.05
    ),
    row("coffee_oval_120x65", drum_table, 1.2, 0.65, 0.42).having(material=m.WALNUT, splay=0.18),
    row("side_45x45", rectangular_table, 0.45, 0.45, 0.5).having(
        leg=0.035, apron=0.05, frame=m.PINE
    ),
    row("side_round_40", round_table, 0.4, 0.4, 0.52).having(
        material=m.BLACK_WOOD, foot=0.7, column=0.02
    ),
    row("side_c_48x30", c_table, 0.48, 0.30, 0.6),
    row("side_butler_55x40", folding_table, 0.55, 0.40, 0.55).having(material=m.WALNUT),
    row("console_110x35", drawer_table, 1.1, 0.35, 0.8).having(
        follows=_SHELF, columns=columns_of("D", "D"), shelf=0.2, look=_WHITE, frame=m.WHITE_BOARD
    ),
    row("console_steel_120x32", frame_table, 1.2, 0.32, 0.78).having(
        bar=0.03, inset=0.08, top=0.03
    ),
)
_DESKS: tuple[Row, ...] = (
    row("panel_120x60", panel_desk, 1.2, 0.6, 0.74),
    row("panel_140x70", panel_desk, 1.4, 0.7, 0.74).having(material=m.OAK_BOARD),
    row("panel_160x80", panel_desk, 1.6, 0.8, 0.75).having(
        material=m.GREY_BOARD, modesty=0.45, follows={"modesty": 2}
    ),
    row("frame_140x70", frame_desk, 1.4, 0.7, 0.72),
    row("frame_160x80", frame_desk, 1.6, 0.8, 0.74).having(top=m.WHITE_BOARD, frame=m.STEEL_TUBE),
    row("frame_180x80", frame_desk, 1.8, 0.8, 0.76).having(top=m.OAK),
    row("standing_140x70", frame_desk, 1.4, 0.7, 1.1).having(
        top=m.WALNUT, frame=m.WHITE_TUBE, inset=0.25
    ),
    row("pedestal_130x65", pedestal_desk, 1.3, 0.65, 0.74),
    row("pedestal_150x75", pedestal_desk, 1.5, 0.75, 0.75).having(board=m.WALNUT, fronts=m.WALNUT),
    row("pedestal_two_160x80", pedestal_desk, 1.6, 0.8, 0.76).having(
        both=True, drawers=4, board=m.WALNUT_BOARD, fronts=m.WALNUT_BOARD
    ),
    row("pedestal_door_150x70", pedestal_desk, 1.5, 0.7, 0.75).having(
        both=True, door=True, board=m.WHITE_BOARD, fronts=m.BLUE_BOARD, pedestal=0.42
    ),
    row("writing_110x55", drawer_table, 1.1, 0.55, 0.75).having(
        columns=columns_of("D", "D"), class_name="desk", body=0.12
    ),
    row("child_100x55", drawer_table, 1.0, 0.55, 0.62)
    .having(columns=columns_of("D"), class_name="desk")
    .having(frame=m.PINE, look=Look(m.PINE_BOARD, m.GREEN_BOARD)),
    row("corner_160x140", corner_desk, 1.6, 1.4, 0.74),
    row("corner_180x160", corner_desk, 1.8, 1.6, 0.74).having(
        deep=0.7, material=m.WHITE_BOARD, frame=m.STEEL_TUBE
    ),
    row("trestle_150x75", trestle_desk, 1.5, 0.75, 0.74),
    row("hutch_120x65", hutch_desk, 1.2, 0.65, 1.2).having(follows={"top": 2}),
)

ROWS: dict[str, tuple[Row, ...]] = {"table": _TABLES, "desk": _DESKS}
