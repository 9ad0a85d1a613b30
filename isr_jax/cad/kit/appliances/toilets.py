"""Toilets: a bowl with seat and lid, with or without a tank.

Bowls are 0.35 to 0.38 m wide, their rims 0.38 to 0.43 m above the floor; with a tank behind they
are 0.62 to 0.72 m deep and 0.74 to 0.80 m high, on a wall 0.48 to 0.56 m deep (EN 997, EN 33 and
makers' catalogues).
"""

from __future__ import annotations

import itertools
from typing import Literal

import numpy as np

from .. import materials as m
from ..builder import ModelBuilder
from ..furniture.panels import Bounds
from ..shapes.shells import Level, d_outline, layered_wall, loft
from ..solids import ROUND_SIDES, box, frustum, tube

ToiletKind = Literal["tank", "floor", "wall"]
_GAP_M = 0.003
_SEAT_M = 0.016
_LID_M = 0.014
_TOP_M = 2 * _GAP_M + _SEAT_M + _LID_M
"""From the rim to the top of the lid."""
_OPEN_RAD = 1.6
"""A little past upright, so that seat and lid stay up."""
_BEHIND_M = 0.068
"""What the open lid needs behind its hinge."""


def toilet(
    width: float,
    depth: float,
    height: float,
    *,
    kind: ToiletKind = "tank",
    rim: float = 0.4,
    tank: float = 0.17,
    bowl: float = 0.95,
    material: m.Material = m.SANITARY,
    seat: m.Material = m.WHITE_PLASTIC,
    sides: int = ROUND_SIDES,
) -> ModelBuilder:
    """A hollow bowl; its seat turns about its rear edge, and its lid about that of the seat.

    The lid is carried by the seat. Both open to just past upright; only one may: with the seat up,
    the lid has no room left.

    Args:
        width: Of the tank; of the bowl where there is none.
        depth: From the front of the bowl to the wall.
        height: To the top of the tank, or of the lid.
        kind: With a tank on the bowl; without one (it is in the wall), on the floor or the wall.
        rim: Height of the bowl with a tank; else the box says it.
        tank: Depth of the tank.
        bowl: Width of the bowl over that of the tank.
        material: Of bowl and tank.
        seat: Of seat and lid.
        sides: Of a full circle.
    """
    builder = ModelBuilder("toilet", symmetry=1, mount="wall" if kind == "wall" else "floor")
    y, edge = depth / 2, rim if kind == "tank" else height - _TOP_M
    half = (bowl if kind == "tank" else 1.0) * width / 2
    behind = _BEHIND_M + (tank if kind == "tank" else 0.0)
    wall = y - behind
    straight = round(0.36 * (wall + y), 4)
    outline = d_outline(half, wall + y - straight, straight, 0.8 * half, sides)
    _add_bowl(builder, outline, (wall, straight), edge, kind, material)
    _add_back(builder, half, (wall, y), edge, kind, material)
    if kind == "tank":
        _add_tank(builder, width, (y - tank, y), (edge, height), material, sides)
    _add_seat(builder, outline, (wall, straight, -y), edge, seat)
    return builder


def _add_bowl(builder, outline, back: tuple[float, float], rim: float, kind, material) -> None:
    """A foot, and on it a wall around the hollow; the rear face is flat and upright."""
    wall, straight = back

    def level(z: float, outer: float, inner: float = 0.0) -> Level:
        return Level(round(z, 4), outer, inner, (0.0, wall - outer * straight))

    floor = rim - min(0.2, 0.55 * rim)
    foot = [level(0.0, 0.7), level(0.4 * floor, 0.64), level(floor, 0.78)]
    if kind == "wall":
        foot = [level(0.0, 0.5), level(floor, 0.74)]
    for a, b in itertools.pairwise(foot):
        ends = [np.asarray(v.center) + v.outer * outline for v in (a, b)]
        builder.add(material, loft(ends[0], ends[1], (a.z, b.z)))
    high = rim - floor
    levels = [level(floor, foot[-1].outer, 0.34), level(floor + 0.5 * high, 0.92, 0.66)]
    levels += [level(floor + 0.85 * high, 1.0, 0.8), level(rim, 1.0, 0.76)]
    builder.add(material, *layered_wall(outline, outline, levels))


def _add_back(builder, half: float, y: Bounds, rim: float, kind, material) -> None:
    """What carries the tank, or goes to the wall."""
    low = 0.12 if kind == "wall" else 0.0
    wide = 0.58 * half if kind == "tank" else 0.7 * half
    split = rim - 0.1
    builder.add(material, box((-wide, wide), y, (min(low, 0.5 * split), split)), carries=False)
    builder.add(material, box((-0.8 * half, 0.8 * half), y, (split, rim)), carries=False)


def _add_tank(builder, width: float, y: Bounds, z: Bounds, material, sides: int) -> None:
    """Hollow, under a lid with a button."""
    x, t, lid, button = width / 2, 0.015, 0.03, 0.004
    (y0, y1), (z0, z1) = y, (z[0], z[1] - lid - button)
    back = y1 - 0.008
    for a, b in ((-x + 0.01, -x + 0.01 + t), (x - 0.01 - t, x - 0.01)):
        builder.add(material, box((a, b), (y0 + 0.006, back), (z0, z1)))
    inner = (-x + 0.01 + t, x - 0.01 - t)
    for a, b in ((y0 + 0.006, y0 + 0.006 + t), (back - t, back)):
        builder.add(material, box(inner, (a, b), (z0, z1)))
    builder.add(material, box(inner, (y0 + 0.006 + t, back - t), (z0, z0 + t)), carries=False)
    builder.add(material, box((-x, x), (y0, y1), (z1, z1 + lid)))
    disc = frustum((0.022, 0.022), (z1 + lid, z[1]), (0.0, (y0 + y1) / 2), sides)
    builder.add(m.CHROME, disc, carries=False)


def _add_seat(builder, outline, y: tuple[float, float, float], rim: float, material) -> None:
    """A ring, and on it a lid; both turn about the rear edge, and are lifted in front."""
    wall, straight, front = y
    center = np.array([0.0, wall - straight])
    low = rim + _GAP_M
    rims = [np.stack([center + s * outline] * 2) for s in (1.0, 0.7)]
    builder.add(
        material,
        *tube(rims[0], rims[1], (low, low + _SEAT_M), is_round=True),
        link="seat",
        carries=False,
    )
    top = low + _SEAT_M + _GAP_M
    lid = loft(center + outline, center + 0.97 * outline, (top, top + _LID_M))
    builder.add(material, lid, link="lid")
    axis, origin = (-1, 0, 0), (0.0, wall, low + 0.003)
    builder.hinge(
        "seat",
        origin,
        axis,
        _OPEN_RAD,
        damping=0.6,
        friction=0.6,
        at=(0.0, front, low + _SEAT_M / 2),
    )
    builder.hinge(
        "lid",
        origin,
        axis,
        _OPEN_RAD,
        parent="seat",
        damping=0.4,
        friction=0.4,
        at=(0.0, front, top + _LID_M / 2),
    )
