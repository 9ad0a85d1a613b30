"""Bathtubs: let into a skirt, or free-standing.

Tubs are 1.4 to 1.9 m long, 0.7 to 0.9 m wide and 0.55 to 0.65 m high, 0.40 to 0.48 m deep inside
(EN 198, EN 232 and makers' catalogues); acrylic ones weigh 20 to 45 kg. The long side is in front.
"""

from __future__ import annotations

import numpy as np

from .. import materials as m
from ..builder import ModelBuilder
from ..shapes.shells import Level, layered_wall, loft, squircle
from ..solids import ROUND_SIDES, box, frustum
from .faucets import add_mixer

_DRAIN_M = 0.035


def bathtub(
    width: float,
    depth: float,
    height: float,
    *,
    tap: float = 0.12,
    rim: float = 0.065,
    power: float = 5.0,
    skirt: m.Material = m.TUB_SKIRT,
    metal: m.Material = m.CHROME,
    sides: int = ROUND_SIDES,
) -> ModelBuilder:
    """A tub whose rim is a rectangle on a skirt that reaches the floor; a mixer behind it.

    ``tap`` is how far the mixer stands above the rim (0: none, it is on the wall), ``power`` how
    square the hollow is.
    """
    builder = ModelBuilder("bathtub", symmetry=1 if tap else 2)
    x, y, edge = width / 2, depth / 2, height - tap
    outer, floor = squircle(x, y, np.inf, sides), round(0.2 * edge, 4)
    hollow = (1 - rim / min(x, y)) * squircle(x, y, power, sides)
    builder.add(skirt, box((-x, x), (-y, y), (0.0, floor)))
    levels = [Level(floor, 1.0, 0.76), Level(round(0.35 * edge, 4), 1.0, 0.87)]
    levels += [Level(edge, 1.0, 1.0)]
    builder.add(skirt, *layered_wall(outer, hollow, levels, is_round=False), carries=False)
    _add_drain(builder, floor, sides)
    if tap:
        add_mixer(builder, (0.0, y - rim / 2, edge), tap, reach=0.16, metal=metal)
    return builder


def oval_tub(
    width: float,
    depth: float,
    height: float,
    *,
    wall: float = 0.03,
    feet: float = 0.0,
    power: float = 2.4,
    shell: m.Material = m.TUB_SHELL,
    metal: m.Material = m.CHROME,
    sides: int = ROUND_SIDES,
) -> ModelBuilder:
    """A free-standing tub, wider above than below, if wished on four feet."""
    builder = ModelBuilder("bathtub", symmetry=2)
    x, y = width / 2, depth / 2
    outline, t = squircle(x, y, power, sides), wall / y
    tall = height - feet
    floor = feet + round(min(0.06, 0.12 * tall), 4)
    mid = feet + round(0.5 * tall, 4)
    builder.add(shell, loft(0.66 * outline, 0.72 * outline, (feet, floor)))
    levels = [Level(floor, 0.72, 0.72 - t), Level(mid, 0.88, 0.88 - t), Level(height, 1.0, 1 - t)]
    builder.add(shell, *layered_wall(outline, outline, levels), carries=False)
    _add_drain(builder, floor, sides)
    for sx in (-1, 1):
        for sy in (-1, 1):
            if feet:
                cx, cy, r = sx * 0.42 * x, sy * 0.34 * y, 0.035
                leg = frustum((0.8 * r, r), (0.0, feet), (round(cx, 4), round(cy, 4)), sides)
                builder.add(metal, leg)
    return builder


def _add_drain(builder: ModelBuilder, z: float, sides: int) -> None:
    disc = frustum((_DRAIN_M, _DRAIN_M), (z, z + 0.002), sides=sides)
    builder.add(m.CHROME, disc, carries=False)
