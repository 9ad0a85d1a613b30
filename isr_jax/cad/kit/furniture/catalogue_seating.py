"""Chairs, stools and sofas of the catalogue, at sizes of furniture makers' catalogues."""

from __future__ import annotations

from .. import materials as m
from ..rows import Row, row
from .office import office_chair
from .seats import cafe_chair, folding_chair, shell_chair, wooden_chair
from .sofas import armchair, corner_sofa, frame_armchair, sofa, tub_chair
from .stools import column_stool, leg_stool, pouf, step_stool

_SEAT = {"seat": 2}
_SOFA = {"seat": 2, "arm_height": 2, "foot": 2}

_FRAME = {"seat": 2, "arm_height": 2}
_TUB = {"seat": 2, "foot": 2}

_CHAIRS: tuple[Row, ...] = (
    row("ladder_42", wooden_chair, 0.42, 0.486, 0.86).having(follows=_SEAT),
    row("ladder_45", wooden_chair, 0.45, 0.504, 0.92).having(
        follows=_SEAT, seat=0.46, slats=4, frame=m.OAK
    ),
    row("ladder_arms_56", wooden_chair, 0.56, 0.52, 0.95)
    .having(follows=_SEAT, seat=0.46, slats=4, arms=True, stretchers=True)
    .having(frame=m.OAK, cushion=m.BEIGE_FABRIC),
    row("spindle_43", wooden_chair, 0.43, 0.489, 0.88).having(
        follows=_SEAT, upright_slats=True, slats=4
    ),
    row("spindle_dark_44", wooden_chair, 0.44, 0.508, 0.95).having(
        follows=_SEAT, seat=0.46, upright_slats=True, slats=5, frame=m.BLACK_WOOD, stretchers=True
    ),
    row("spindle_white_45", wooden_chair, 0.45, 0.52, 1.02).having(
        follows=_SEAT, seat=0.46, upright_slats=True, slats=7, frame=m.WHITE_BOARD
    ),
    row("padded_44", wooden_chair, 0.44, 0.514, 0.9).having(
        follows=_SEAT, seat=0.47, slats=2, frame=m.WALNUT, cushion=m.BEIGE_FABRIC
    ),
    row("padded_high_47", wooden_chair, 0.47, 0.55, 1.06).having(
        follows=_SEAT, seat=0.48, slats=1, frame=m.BLACK_WOOD, cushion=m.RED_FABRIC, lean=0.14
    ),
    row("panel_40", wooden_chair, 0.40, 0.445, 0.80).having(
        follows=_SEAT, seat=0.44, slats=1, frame=m.BIRCH, lean=0.12
    ),
    row("child_30", wooden_chair, 0.30, 0.315, 0.56).having(
        follows=_SEAT, seat=0.30, slats=2, frame=m.PINE, lean=0.12, leg=0.028
    ),
    row("cafe_42", cafe_chair, 0.42, 0.42, 0.84).having(follows=_SEAT),
    row("cafe_oak_45", cafe_chair, 0.45, 0.44, 0.76).having(follows=_SEAT, frame=m.OAK, spindles=7),
    row("folding_44", folding_chair, 0.44, 0.48, 0.80).having(follows=_SEAT),
    row("folding_black_45", folding_chair, 0.45, 0.46, 0.78).having(
        follows=_SEAT, boards=m.BLACK_WOOD, frame=m.BLACK_TUBE
    ),
    row("shell_46", shell_chair, 0.46, 0.514, 0.82).having(follows=_SEAT),
    row("shell_blue_50", shell_chair, 0.50, 0.53, 0.80).having(follows=_SEAT, shell=m.BLUE_PLASTIC),
    row("shell_green_44", shell_chair, 0.44, 0.5, 0.79).having(
        follows=_SEAT, shell=m.GREEN_PLASTIC, frame=m.BLACK_TUBE
    ),
    row("visitor_54", shell_chair, 0.54, 0.556, 0.84).having(
        follows=_SEAT, seat=0.46, shell=m.LEATHER, arms=True, frame=m.BLACK_TUBE
    ),
    row("cantilever_48", shell_chair, 0.48, 0.56, 0.85).having(
        follows=_SEAT, seat=0.46, skids=True, shell=m.BLACK_LEATHER, frame=m.CHROME_TUBE
    ),
    row("cantilever_arms_55", shell_chair, 0.55, 0.58, 0.86).having(
        follows=_SEAT, seat=0.46, skids=True, arms=True, shell=m.COGNAC_LEATHER, frame=m.CHROME_TUBE
    ),
    row("office_48", office_chair, 0.66, 0.64, 0.98).having(follows=_SEAT),
    row("office_low_46", office_chair, 0.62, 0.60, 0.86)
    .having(follows=_SEAT, seat=0.46, across=0.46, deep=0.44, arms="none", back="low")
    .having(fabric=m.BLUE_FABRIC),
    row("office_mesh_50", office_chair, 0.68, 0.66, 1.04).having(
        follows=_SEAT, seat=0.48, across=0.5, back="mesh", fabric=m.BLACK_FABRIC
    ),
    row("office_head_52", office_chair, 0.70, 0.68, 1.26)
    .having(follows=_SEAT, seat=0.49, across=0.52, deep=0.48, arms="loop", headrest=True)
    .having(fabric=m.BLACK_LEATHER),
    row("armchair_82", armchair, 0.82, 0.84, 0.84).having(follows=_SOFA, fabric=m.BLUE_FABRIC),
    row("armchair_wing_76", armchair, 0.76, 0.86, 1.08).having(
        follows=_SOFA, seat=0.45, arm_height=0.64, wings=True, fabric=m.BEIGE_FABRIC, feet=m.WALNUT
    ),
    row("armchair_leather_78", armchair, 0.78, 0.8, 0.82).having(
        follows=_SOFA, arm=0.14, foot=0.1, fabric=m.COGNAC_LEATHER, feet=m.BLACK_WOOD
    ),
    row("armchair_tub_72", tub_chair, 0.72, 0.7, 0.74).having(follows=_TUB),
    row("armchair_frame_68", frame_armchair, 0.68, 0.82, 0.86).having(follows=_FRAME),
    row("armchair_frame_dark_70", frame_armchair, 0.70, 0.80, 0.78).having(
        follows=_FRAME, seat=0.40, arm_height=0.56, frame=m.WALNUT, fabric=m.GREEN_FABRIC
    ),
)
_STOOLS: tuple[Row, ...] = (
    row("round_35", leg_stool, 0.35, 0.35, 0.45),
    row("round_three_32", leg_stool, 0.32, 0.32, 0.42).having(legs=3, frame=m.OAK),
    row("milking_28", leg_stool, 0.28, 0.28, 0.3).having(legs=3, frame=m.PINE, thickness=0.035),
    row("square_36", leg_stool, 0.36, 0.36, 0.46).having(
        is_round=False, frame=m.BIRCH, rest=0.12, follows={"rest": 2}
    ),
    row("bench_stool_60", leg_stool, 0.60, 0.34, 0.46).having(
        is_round=False, frame=m.WALNUT, cushion=m.GREY_FABRIC
    ),
    row("bar_round_34", leg_stool, 0.34, 0.34, 0.75).having(rest=0.28, follows={"rest": 2}),
    row("bar_square_38", leg_stool, 0.38, 0.36, 0.65).having(
        is_round=False, rest=0.22, follows={"rest": 2}, frame=m.OAK
    ),
    row("bar_column_42", column_stool, 0.42, 0.42, 0.76),
    row("bar_column_back_45", column_stool, 0.45, 0.45, 0.94).having(
        low_back=0.2, seat=0.8, follows={"low_back": 2}, cushion=m.BLACK_LEATHER
    ),
    row("work_castors_52", column_stool, 0.54, 0.52, 0.5).having(
        plate=False, seat=0.68, cushion=m.BLACK_LEATHER
    ),
    row("piano_38", column_stool, 0.38, 0.38, 0.5).having(
        cushion=m.BLACK_FABRIC, frame=m.BLACK_TUBE
    ),
    row("step_40", step_stool, 0.40, 0.42, 0.42),
    row("step_three_42", step_stool, 0.42, 0.60, 0.66).having(steps=3, material=m.PINE),
    row("step_one_36", step_stool, 0.36, 0.24, 0.22).having(steps=1, material=m.WHITE_BOARD),
    row("pouf_round_45", pouf, 0.45, 0.45, 0.40),
    row("pouf_round_60", pouf, 0.60, 0.60, 0.38).having(fabric=m.GREEN_FABRIC),
    row("pouf_square_40", pouf, 0.40, 0.40, 0.42).having(is_round=False, fabric=m.GREY_FABRIC),
    row("ottoman_65", pouf, 0.65, 0.5, 0.42).having(
        is_round=False, foot=0.12, fabric=m.BLUE_FABRIC
    ),
)
_SOFAS: tuple[Row, ...] = (
    row("seats_1", sofa, 0.92, 0.88, 0.82).having(follows=_SOFA, seats=1, fabric=m.GREEN_FABRIC),
    row("seats_2", sofa, 1.6, 0.88, 0.82).having(follows=_SOFA, seats=2),
    row("seats_3", sofa, 2.15, 0.92, 0.84).having(follows=_SOFA, seats=3, fabric=m.BLUE_FABRIC),
    row("seats_3_leather", sofa, 2.05, 0.9, 0.78).having(
        follows=_SOFA, seats=3, fabric=m.LEATHER, arm=0.2
    ),
    row("loveseat", sofa, 1.35, 0.8, 0.8).having(
        follows=_SOFA, seats=2, fabric=m.BEIGE_FABRIC, arm=0.1, arm_height=0.56
    ),
    row("armless_2", sofa, 1.4, 0.86, 0.76).having(
        follows=_SOFA, seats=2, fabric=m.RED_FABRIC, arm=0.0
    ),
    row("chaise_240", sofa, 2.4, 1.6, 0.8).having(
        follows=_SOFA | {"chaise": 1}, seats=3, chaise=0.65
    ),
    row("cushions_3_220", sofa, 2.2, 0.98, 0.82).having(
        follows=_SOFA, seats=3, loose=True, back=0.16, fabric=m.BEIGE_FABRIC, foot=0.06
    ),
    row("cushions_2_170", sofa, 1.7, 0.92, 0.86)
    .having(follows=_SOFA, seats=2, loose=True, back=0.15, arm=0.12, foot=0.15)
    .having(feet=m.OAK, fabric=m.YELLOW_FABRIC),
    row("chesterfield_200", sofa, 2.0, 0.92, 0.74).having(
        follows=_SOFA, seats=3, arm=0.2, arm_height=0.73, fabric=m.COGNAC_LEATHER, foot=0.08
    ),
    row("high_legs_185", sofa, 1.85, 0.84, 0.8)
    .having(follows=_SOFA, seats=2, arm=0.09, foot=0.17, arm_height=0.58)
    .having(feet=m.WALNUT, fabric=m.ROSE_FABRIC),
    row("black_leather_160", sofa, 1.6, 0.84, 0.74).having(
        follows=_SOFA, seats=2, arm=0.14, fabric=m.BLACK_LEATHER, feet=m.CHROME_TUBE, foot=0.12
    ),
    row("frame_2_140", frame_armchair, 1.40, 0.82, 0.84).having(
        follows=_FRAME, seats=2, class_name="sofa", fabric=m.GREY_FABRIC
    ),
    row("frame_3_190", frame_armchair, 1.90, 0.84, 0.84).having(
        follows=_FRAME, seats=3, class_name="sofa", frame=m.WALNUT, fabric=m.GREEN_FABRIC
    ),
    row("corner_250", corner_sofa, 2.5, 2.1, 0.82).having(follows=_SOFA),
    row("corner_290", corner_sofa, 2.9, 2.3, 0.8).having(
        follows=_SOFA, seats=4, deep=0.96, fabric=m.BLUE_FABRIC, arm=0.2
    ),
)

ROWS: dict[str, tuple[Row, ...]] = {"chair": _CHAIRS, "stool": _STOOLS, "sofa": _SOFAS}
