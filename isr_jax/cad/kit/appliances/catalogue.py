"""Rows of appliances, sanitary ware and electronics."""

from __future__ import annotations

from .. import materials as m
from ..furniture.fronts import Look, columns_of
from ..rows import Row, row
from .cold import Compartment, CompartmentKind, fridge
from .computers import keyboard, laptop
from .cooking import built_in_oven, cooker, hot_plate, microwave, small_oven
from .dishwashers import dishwasher
from .kettles import jug_kettle, stove_kettle
from .laundry import top_loader, washing_machine
from .ovens import OvenLook
from .screens import monitor, wall_screen
from .sinks import kitchen_sink, utility_sink, vanity, vessel, washbasin
from .toilets import toilet
from .tubs import bathtub, oval_tub


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
    row("under_counter_55", fridge, 0.55, 0.58, 0.85).having(columns=_cold("R")),
    row("mini_48", fridge, 0.48, 0.5, 0.52).having(
        columns=_cold("L"), shell=m.DARK_INSULATED, wall=0.035
    ),
    row("tall_60", fridge, 0.6, 0.65, 1.85).having(columns=_cold("R"), shell=m.STEEL_INSULATED),
    row("combi_60", fridge, 0.6, 0.65, 2.0).having(
        columns=_cold("R1.7 R"), shell=m.STEEL_INSULATED
    ),
    row("combi_55", fridge, 0.55, 0.57, 1.77).having(columns=_cold("L2 L")),
    row("top_freezer_70", fridge, 0.7, 0.72, 1.68).having(columns=_cold("R R2.2")),
    row("french_91", fridge, 0.91, 0.74, 1.78).having(
        columns=_cold("B2 D"), shell=m.STEEL_INSULATED
    ),
    row("side_by_side_90", fridge, 0.9, 0.72, 1.78).having(
        columns=_cold("L", "R"), shell=m.DARK_INSULATED
    ),
    row("larder_60", fridge, 0.6, 0.63, 1.45).having(columns=_cold("L")),
    row("chest_drawers_60", fridge, 0.6, 0.6, 0.85).having(columns=_cold("D D D")),
    row("four_doors_83", fridge, 0.83, 0.7, 1.8).having(
        columns=_cold("B1.6 B"), shell=m.DARK_INSULATED
    ),
)

_STEEL = OvenLook(m.STEEL_OVEN, m.STEEL_OVEN)
_DARK = OvenLook(m.BLACK_OVEN, m.BLACK_OVEN)
_CREAM = OvenLook(m.CREAM_OVEN, m.CREAM_OVEN, m.BRASS)
_RED = OvenLook(m.RED_OVEN, m.RED_OVEN)
_MIXED = OvenLook(m.STEEL_OVEN, m.BLACK_OVEN)
_OVENS = (
    row("range_60", cooker, 0.6, 0.6, 0.85),
    row("range_60_gas", cooker, 0.6, 0.6, 0.9).having(hob="gas", knobs=(2, 3), look=_STEEL),
    row("range_76_splash", cooker, 0.76, 0.66, 1.08).having(splash=0.16, look=_MIXED, panel=0.11),
    row("range_90_gas", cooker, 0.9, 0.6, 0.91).having(
        hob="gas", grid=(3, 2), knobs=(3, 3), look=_STEEL
    ),
    row("range_60_red", cooker, 0.6, 0.6, 0.9).having(
        hob="glass", knobs=(2, 2), look=_RED, drawer=0.05
    ),
    row("built_in_60", built_in_oven, 0.595, 0.56, 0.595).having(look=_MIXED),
    row("built_in_45", built_in_oven, 0.595, 0.55, 0.455).having(knobs=1, look=_DARK, panel=0.09),
    row("small_45", small_oven, 0.45, 0.36, 0.28).having(
        look=OvenLook(m.STEEL_OVEN, m.BLACK_OVEN, reach=0.03)
    ),
    row("small_52", small_oven, 0.52, 0.4, 0.33).having(
        knobs=4, panel=0.11, look=OvenLook(m.BLACK_OVEN, m.BLACK_OVEN, reach=0.03)
    ),
    row("hot_plate_50", hot_plate, 0.5, 0.28, 0.085),
    row("hot_plate_30", hot_plate, 0.29, 0.36, 0.07).having(
        zones=1, hob="glass", shell=m.SHEET_BODY
    ),
)
_MICROWAVES = (
    row("black_48", microwave, 0.48, 0.38, 0.28),
    row("white_44", microwave, 0.44, 0.35, 0.26).having(shell=m.WHITE_BODY, panel=0.1, plate=0.115),
    row("silver_51", microwave, 0.51, 0.42, 0.30).having(shell=m.SILVER_BODY, plate=0.15),
    row("silver_46", microwave, 0.46, 0.36, 0.26).having(
        shell=m.SILVER_BODY, panel=0.11, plate=0.12
    ),
    row("black_54", microwave, 0.54, 0.45, 0.31).having(panel=0.13, plate=0.16),
    row("white_50", microwave, 0.5, 0.4, 0.29).having(shell=m.WHITE_BODY, plate=0.14),
    row("white_45_knobs", microwave, 0.45, 0.35, 0.26).having(
        shell=m.WHITE_BODY, panel=0.11, plate=0.12, knobs=2
    ),
    row("black_49_knobs", microwave, 0.49, 0.39, 0.28).having(panel=0.12, plate=0.13, knobs=2),
)
_DISHWASHERS = (
    row("white_60", dishwasher, 0.6, 0.6, 0.85),
    row("steel_60", dishwasher, 0.6, 0.6, 0.85).having(front=m.STEEL_SHEET, shell=m.DARK_SHEET),
    row("slim_45", dishwasher, 0.45, 0.6, 0.85).having(board=m.SILVER_BODY),
    row("slim_45_dark", dishwasher, 0.45, 0.58, 0.84).having(
        shell=m.DARK_SHEET, front=m.DARK_SHEET
    ),
    row("under_counter_60", dishwasher, 0.595, 0.57, 0.82).having(
        worktop=0.0, front=m.STEEL_SHEET, board=m.SHEET_BODY
    ),
    row("under_counter_45", dishwasher, 0.445, 0.56, 0.82).having(worktop=0.0, board=m.SHEET_BODY),
    row("small_55", dishwasher, 0.55, 0.5, 0.44).having(
        worktop=0.02, foot=0.055, racks=1, mount="surface"
    ),
    row("white_60_black", dishwasher, 0.598, 0.6, 0.845).having(board=m.SHEET_BODY),
)
_WASHING_MACHINES = (
    row("white_60", washing_machine, 0.6, 0.6, 0.85),
    row("slim_60x45", washing_machine, 0.6, 0.48, 0.85),
    row("dark_60", washing_machine, 0.6, 0.63, 0.85).having(shell=m.DARK_SHEET, ring=m.SHEET_BODY),
    row("american_69", washing_machine, 0.686, 0.78, 0.98).having(panel=0.13),
    row("top_40", top_loader, 0.4, 0.6, 0.9),
    row("top_69", top_loader, 0.69, 0.68, 1.08).having(console=0.16, knobs=2),
    row("top_61_dark", top_loader, 0.61, 0.63, 1.02).having(
        console=0.13, knobs=3, shell=m.DARK_SHEET, lid=m.DARK_SHEET
    ),
)
_TAP = {"tap": 2}
_SEAT = {"rim": 2}
_SINKS = (
    row("steel_60", kitchen_sink, 0.6, 0.5, 0.48).having(tap=0.3, follows=_TAP),
    row("steel_86_drainer", kitchen_sink, 0.86, 0.5, 0.46).having(
        drainer=0.42, tap=0.28, follows=_TAP
    ),
    row("steel_80_double", kitchen_sink, 0.8, 0.5, 0.5).having(bowls=2, tap=0.3, follows=_TAP),
    row("steel_116_double", kitchen_sink, 1.16, 0.5, 0.49).having(
        bowls=2, drainer=0.33, tap=0.3, follows=_TAP
    ),
    row("fireclay_60", kitchen_sink, 0.6, 0.46, 0.52).having(
        sheet=m.FIRECLAY, thick=0.018, metal=m.BLACK_METAL, tap=0.3, follows=_TAP
    ),
    row("black_50", kitchen_sink, 0.5, 0.5, 0.5).having(
        sheet=m.FIRECLAY_BLACK, thick=0.01, metal=m.BLACK_METAL, tap=0.3, follows=_TAP
    ),
    row("utility_58", utility_sink, 0.58, 0.55, 1.02),
    row("pedestal_55", washbasin, 0.55, 0.45, 0.99),
    row("pedestal_60_pillar", washbasin, 0.6, 0.48, 0.94).having(taps=2, tap=0.09),
    row("wall_60", washbasin, 0.6, 0.46, 0.52).having(pedestal=False, bowl=0.2),
    row("vanity_60", vanity, 0.6, 0.46, 0.99),
    row("vanity_80_drawers", vanity, 0.8, 0.47, 1.0)
    .having(columns=columns_of("D D"))
    .having(look=Look(m.OAK_BOARD, m.OAK_BOARD, m.BLACK_TUBE), metal=m.BLACK_METAL),
    row("vessel_round_40", vessel, 0.4, 0.4, 0.14),
    row("vessel_oval_58", vessel, 0.58, 0.38, 0.14),
    row("vessel_square_42", vessel, 0.42, 0.42, 0.13).having(power=5.0, material=m.STONE_SANITARY),
)
_TOILETS = (
    row("close_coupled_66", toilet, 0.38, 0.66, 0.78).having(rim=0.4, follows=_SEAT),
    row("compact_60", toilet, 0.36, 0.61, 0.75).having(tank=0.15, rim=0.4, follows=_SEAT),
    row("black_66", toilet, 0.37, 0.66, 0.79)
    .having(rim=0.4, follows=_SEAT)
    .having(material=m.BLACK_SANITARY, seat=m.BLACK_PLASTIC),
    row("tall_68", toilet, 0.38, 0.68, 0.84).having(rim=0.46, follows=_SEAT),
    row("floor_55", toilet, 0.36, 0.55, 0.43).having(kind="floor"),
    row("wall_53", toilet, 0.36, 0.53, 0.36).having(kind="wall"),
)
_TUBS = (
    row("skirt_170", bathtub, 1.7, 0.75, 0.69),
    row("skirt_160", bathtub, 1.6, 0.7, 0.57).having(tap=0.0),
    row("oval_170", oval_tub, 1.7, 0.8, 0.58),
    row("feet_168", oval_tub, 1.68, 0.76, 0.62).having(feet=0.13, metal=m.BRASS),
    row("soaking_120", bathtub, 1.2, 0.8, 0.8).having(tap=0.12),
)
_LIFT = {"lift": 2}
_MONITORS = (
    row("screen_22", monitor, 0.51, 0.22, 0.42).having(lift=0.12, follows=_LIFT),
    row("screen_24", monitor, 0.55, 0.22, 0.45).having(lift=0.12, follows=_LIFT),
    row("screen_27", monitor, 0.61, 0.22, 0.51).having(
        lift=0.15, shell=m.SILVER_SHELL, follows=_LIFT
    ),
    row("screen_34_wide", monitor, 0.81, 0.22, 0.49).having(lift=0.13, follows=_LIFT),
    row("tv_32", monitor, 0.73, 0.23, 0.49).having(lift=0.06, thickness=0.06, stand="feet"),
    row("tv_43", monitor, 0.97, 0.23, 0.63).having(lift=0.07, thickness=0.06, stand="feet"),
    row("tv_55", monitor, 1.23, 0.23, 0.79).having(lift=0.08, thickness=0.055, stand="feet"),
    row("tv_65", monitor, 1.45, 0.3, 0.91).having(lift=0.08, thickness=0.05, stand="feet"),
    row("wall_43", wall_screen, 0.96, 0.09, 0.56),
    row("wall_55", wall_screen, 1.23, 0.085, 0.71),
    row("wall_65", wall_screen, 1.45, 0.08, 0.83),
    row("wall_27", wall_screen, 0.61, 0.11, 0.36).having(gap=0.06),
)
_LAPTOPS = (
    row("open_13", laptop, 0.305, 0.295, 0.21),
    row("open_14", laptop, 0.32, 0.31, 0.22).having(shell=m.DARK_DEVICE),
    row("open_15", laptop, 0.358, 0.335, 0.245).having(base=0.018),
    row("open_17", laptop, 0.4, 0.39, 0.265).having(shell=m.DARK_DEVICE, base=0.02, lid=0.006),
    row("open_11", laptop, 0.285, 0.25, 0.195).having(shell=m.BLUE_DEVICE, keys=m.GREY_KEYS),
    row("open_15_wide", laptop, 0.36, 0.37, 0.225).having(base=0.018),
    row("closed_13", laptop, 0.305, 0.215, 0.018).having(closed=True, lid=0.005),
    row("closed_15", laptop, 0.358, 0.245, 0.021).having(closed=True, shell=m.DARK_DEVICE),
)
_KEYBOARDS = (
    row("full_45", keyboard, 0.45, 0.15, 0.03),
    row("full_44_white", keyboard, 0.44, 0.135, 0.026).having(
        case=m.KEYBOARD_SILVER, keys=m.WHITE_KEYS
    ),
    row("full_46_deep", keyboard, 0.46, 0.18, 0.034).having(keys=m.GREY_KEYS),
    row("compact_36", keyboard, 0.36, 0.135, 0.032).having(pad=False),
    row("compact_28", keyboard, 0.28, 0.115, 0.016).having(
        pad=False, case=m.KEYBOARD_SILVER, keys=m.WHITE_KEYS
    ),
    row("compact_30", keyboard, 0.3, 0.105, 0.038).having(pad=False, rows=5, keys=m.GREY_KEYS),
)
_KETTLES = (
    row("steel_17", jug_kettle, 0.24, 0.155, 0.24),
    row("steel_12", jug_kettle, 0.22, 0.138, 0.2),
    row("black_17", jug_kettle, 0.245, 0.16, 0.235).having(body=m.BLACK_PLASTIC, top=0.85),
    row("white_15", jug_kettle, 0.235, 0.15, 0.23).having(body=m.WHITE_PLASTIC, trim=m.GREY_KEYS),
    row("glass_17", jug_kettle, 0.245, 0.16, 0.245).having(body=m.KETTLE_GLASS, top=0.88),
    row("stove_steel_25", stove_kettle, 0.29, 0.19, 0.225),
)

ROWS: dict[str, tuple[Row, ...]] = {
    "fridge": _FRIDGES,
    "oven": _OVENS,
    "microwave": _MICROWAVES,
    "dishwasher": _DISHWASHERS,
    "washing_machine": _WASHING_MACHINES,
    "sink": _SINKS,
    "toilet": _TOILETS,
    "bathtub": _TUBS,
    "monitor": _MONITORS,
    "laptop": _LAPTOPS,
    "keyboard": _KEYBOARDS,
    "kettle": _KETTLES,
}
