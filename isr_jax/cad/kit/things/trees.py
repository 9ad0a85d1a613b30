"""Clipped trees and cacti.

Potted box and laurel trees are 0.6 to 1.6 m high, small ones on a sill 0.2 to 0.4 m. Crowns are
convex clusters with the density of leaves and twigs and the air between.
"""

from __future__ import annotations

from ....classes import Mount
from .. import materials as m
from ..builder import ModelBuilder
from ..shapes.turned import Profile, rounds_of, stack
from ..solids import ROUND_SIDES, between, box
from .pots import add_pot

BALL: Profile = ((0.0, 0.45), (0.2, 0.85), (0.5, 1.0), (0.8, 0.8), (1.0, 0.35))
CONE: Profile = ((0.0, 0.9), (0.08, 1.0), (0.55, 0.55), (1.0, 0.16))


def tree(
    width: float,
    depth: float,
    height: float,
    *,
    pot: float = 0.22,
    pot_width: float = 0.6,
    trunk: float = 0.014,
    crowns: tuple[tuple[float, float, float], ...] = ((0.4, 1.0, 1.0),),
    crown: Profile = BALL,
    material: m.Material = m.TERRACOTTA,
    leaf_material: m.Material = m.FOLIAGE,
    mount: Mount | None = None,
    sides: int = ROUND_SIDES,
) -> ModelBuilder:
    """A trunk through one or more clipped crowns above one another.

    Args:
        width: Of the widest crown.
        depth: Of the widest crown.
        height: To the top of the last crown.
        pot: Height of the pot, a share of the height.
        pot_width: A share of the width.
        trunk: Radius, metres.
        crowns: From below: height of lower and upper end as shares, width as a share.
        crown: Profile of a crown: shares of its height, and of half its width.
        material: Of the pot.
        leaf_material: Of the crowns.
        mount: ``surface`` for a small one.
        sides: Of round parts.
    """
    symmetry, squeeze = rounds_of(width, depth)
    builder = ModelBuilder("plant", symmetry=symmetry, mount=mount)
    z = add_pot(builder, pot_width * width, pot * height, squeeze, material, sides)
    for low, high, wide in crowns:
        start, tall, half = low * height, (high - low) * height, wide * width / 2
        wood = [(z, trunk), (start, trunk)]
        builder.add(m.BARK, *stack(wood, squeeze=squeeze, sides=sides), carries=False)
        profile = [(start + share * tall, r * half) for share, r in crown]
        foliage = stack(profile, squeeze=squeeze, sides=sides)
        builder.add(leaf_material, *foliage, carries=False)
        z = high * height
    return builder


def cactus(
    width: float,
    depth: float,
    height: float,
    *,
    pot: float = 0.28,
    body: float = 0.55,
    arms: bool = True,
    material: m.Material = m.TERRACOTTA,
    leaf_material: m.Material = m.CACTUS,
    mount: Mount | None = None,
    sides: int = ROUND_SIDES,
) -> ModelBuilder:
    """A column ``body`` times as wide as the pot, which is as deep as the box.

    Two arms reach to the sides of the box; the pot is at most three quarters as wide then.
    """
    builder = ModelBuilder("plant", symmetry=1 if arms else rounds_of(width, depth)[0], mount=mount)
    pot_width = min(depth, 0.75 * width) if arms else width
    squeeze = depth / pot_width
    soil = add_pot(builder, pot_width, pot * height, squeeze, material, sides)
    r, tall = body * pot_width / 2, height - soil
    column = [(soil, 0.8 * r), (soil + 0.12 * tall, r), (height - 0.7 * r, r), (height, 0.45 * r)]
    builder.add(leaf_material, *stack(column, squeeze=squeeze, sides=sides), carries=False)
    if arms:
        thick = 0.42 * r
        for side, low, high in ((-1, 0.35, 0.75), (1, 0.5, 0.9)):
            z0, z1, out = soil + low * tall, soil + high * tall, width / 2 - thick
            elbow = box(
                between(side * r, side * (out - thick)),
                (-0.7 * thick, 0.7 * thick),
                (z0 - 0.7 * thick, z0 + 0.7 * thick),
            )
            builder.add(leaf_material, elbow, carries=False)
            arm = [(z0 - thick, 0.6 * thick), (z0, thick), (z1 - thick, thick), (z1, 0.4 * thick)]
            upright = stack(arm, sides=sides, center=(side * out, 0.0))
            builder.add(leaf_material, *upright, carries=False)
    return builder
