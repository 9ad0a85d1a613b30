"""Office chairs: a seat that turns on a column over a foot with five castors.

Seats are 0.40 to 0.51 m high, at least 0.40 m wide and 0.38 to 0.44 m deep; the back's top is
at least 0.36 m above the seat, armrests 0.20 to 0.25 m (EN 1335-1); feet are 0.6 to 0.72 m
across.
"""

from __future__ import annotations

from typing import Literal

import numpy as np

from .. import materials as m
from ..builder import ModelBuilder
from ..solids import ROUND_SIDES, between, box, frustum, prism, tapered_box
from .castors import add_star_foot
from .seats import leaning

_LINK = "seat"
_GAP_M = 0.002
_LEAN = 0.12


def office_chair(
    width: float,
    depth: float,
    height: float,
    *,
    seat: float = 0.47,
    across: float = 0.48,
    deep: float = 0.46,
    arms: Literal["none", "t", "loop"] = "t",
    back: Literal["low", "high", "mesh"] = "high",
    headrest: bool = False,
    fabric: m.Material = m.GREY_FABRIC,
    frame: m.Material = m.BLACK_TUBE,
    sides: int = ROUND_SIDES,
) -> ModelBuilder:
    """The foot fills width and depth; the seat, ``across`` x ``deep``, turns without end."""
    builder = ModelBuilder("chair", symmetry=1)
    middle = add_star_foot(builder, (width, depth), sides, frame)
    pad = 0.07
    deck = seat - pad
    joint = round(0.6 * deck, 4)
    builder.add(frame, frustum((0.027, 0.025), (0.105, joint), (0.0, middle), sides))
    x = min(across / 2, width / 2 - 0.05)
    # The back's top stays within the foot's depth.
    end = min(middle + deep / 2, depth / 2 - _LEAN * (height - seat) - 0.012)
    y = (end - deep, end)
    piston = frustum((0.016, 0.016), (joint + _GAP_M, deck - 0.035), (0.0, middle), sides)
    builder.add(m.STEEL_TUBE, piston, link=_LINK)
    held = min(middle + 0.1, end - 0.02)
    mechanism = ((-0.09, 0.09), (middle - 0.1, held), (deck - 0.035, deck))
    builder.add(frame, box(*mechanism), link=_LINK)
    _add_seat(builder, fabric, x, y, (deck, seat))
    top = height - (0.17 if headrest else 0.0)
    _add_back(builder, (fabric, frame), back, x, (held, end, seat), (deck, top))
    if headrest:
        _add_headrest(builder, (fabric, frame), (end, seat), (top, height))
    if arms != "none":
        _add_arms(builder, frame, arms, x, y, (deck, seat))
    at = (0.0, end + _LEAN * (top - seat), top - 0.02)
    builder.swivel(_LINK, (0.0, middle, joint), at=at)
    return builder


def _add_seat(builder, fabric, x: float, y, z) -> None:
    """A cushion with a rounded upper edge, lower at the front."""
    (front, rear), (low, high), bevel = y, z, 0.015
    lip = 0.06
    body = (front + lip, rear)
    builder.add(fabric, box((-x, x), body, (low, high - bevel)), link=_LINK)
    whole = (-x, x, *body)
    inner = (-x + bevel, x - bevel, body[0], rear - bevel)
    builder.add(fabric, tapered_box(whole, inner, (high - bevel, high)), link=_LINK)
    outline = [
        (front, low + 0.01),
        (front + lip, low),
        (front + lip, high - bevel),
        (front, high - 0.03),
    ]
    builder.add(fabric, prism(np.round(outline, 6), "x", (-x, x)), link=_LINK)


def _add_back(builder, materials, kind: str, x: float, base, z) -> None:
    """A spine behind the seat, and a cushion or a net before it."""
    (fabric, frame), (start, end, seat), (deck, top) = materials, base, z
    low = seat + (0.16 if kind == "low" else 0.09)
    builder.add(frame, box((-0.035, 0.035), (end, end + 0.012), (deck - 0.02, seat)), link=_LINK)
    builder.add(frame, box((-0.035, 0.035), (start, end), (deck - 0.02, deck)), link=_LINK)
    spine = leaning((-0.035, 0.035), (end, end + 0.012), (seat, top - 0.1), _LEAN, seat)
    builder.add(frame, spine, link=_LINK)
    half = x - 0.02
    thick = 0.02 if kind == "mesh" else 0.05
    rear = (end - thick, end)
    if kind != "mesh":
        middle = round(low + 0.55 * (top - low), 4)
        for span, bounds in (
            ((-half, half), (low, middle)),
            ((-half + 0.015, half - 0.015), (middle, top)),
        ):
            builder.add(fabric, leaning(span, rear, bounds, _LEAN, seat), link=_LINK)
        return
    rim = 0.022
    for span in ((-half, -half + rim), (half - rim, half)):
        builder.add(frame, leaning(span, rear, (low, top), _LEAN, seat), link=_LINK)
    inner = (-half + rim, half - rim)
    for bounds in ((low, low + rim), (top - rim, top)):
        builder.add(frame, leaning(inner, rear, bounds, _LEAN, seat), link=_LINK)
    net = leaning(inner, (end - 0.006, end), (low + rim, top - rim), _LEAN, seat)
    builder.add(m.MESH_FABRIC, net, link=_LINK)


def _add_headrest(builder, materials, base, z) -> None:
    (fabric, frame), (end, seat), (low, high) = materials, base, z
    neck = leaning((-0.02, 0.02), (end - 0.012, end), (low, low + 0.05), _LEAN, seat)
    builder.add(frame, neck, link=_LINK)
    pad = leaning((-0.14, 0.14), (end - 0.045, end), (low + 0.05, high), _LEAN, seat)
    builder.add(fabric, pad, link=_LINK)


def _add_arms(builder, frame, kind: str, x: float, y, z) -> None:
    """Armrests on posts beside the seat: a single one, or two that make a loop."""
    (front, rear), (deck, seat) = y, z
    high, middle = seat + 0.2, (front + rear) / 2
    outer = x + 0.05
    reach = (middle - 0.12, min(middle + 0.13, rear - 0.06))
    feet = [middle] if kind == "t" else [reach[0] + 0.02, reach[1] - 0.02]
    for side in (-1, 1):
        for at in feet:
            along, under = (
                (at - 0.018, at + 0.018),
                between(side * max(x - 0.06, 0.09), side * outer),
            )
            builder.add(frame, box(under, along, (deck - 0.02, deck)), link=_LINK)
            post = between(side * (outer - 0.028), side * outer)
            builder.add(frame, box(post, along, (deck, high)), link=_LINK)
        rest = box(between(side * (x - 0.005), side * outer), reach, (high, high + 0.03))
        builder.add(m.PLASTIC, rest, link=_LINK, carries=False)
