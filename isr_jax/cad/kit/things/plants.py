"""Plants with large leaves.

Houseplants are 0.15 to 0.5 m high on a sill and 0.8 to 2 m on the floor. Leaves are flat convex
pieces of 2 mm: the same that are seen are what collides.
"""

from __future__ import annotations

import dataclasses
import math

import numpy as np

from ....classes import Mount
from .. import materials as m
from ..builder import ModelBuilder
from ..shapes.strips import raised, spike
from ..shapes.turned import stack
from ..solids import ROUND_SIDES, Solid
from .pots import add_pot, squeezed

_GOLDEN_RAD = math.pi * (3 - 5**0.5)
_LEAF_M = 0.002
_STEM_SIDES = 8


def _leaf(
    root: tuple[float, float],
    tip: float,
    azimuth: float,
    shape: tuple[float, float, float],
    squeeze: float,
) -> list[Solid]:
    """A leaf of two flat halves, folded across its widest part.

    Its corners are whole multiples of three steps (outwards to the fold, outwards to the tip,
    across), each on the grid of micrometres: so both halves are flat to the last digit.

    Args:
        root: Radius and height where it begins.
        tip: Radius where it ends.
        azimuth: Radians about z.
        shape: Width, height of the fold above the root, of the tip above the root.
        squeeze: Depth over width of the plant.
    """
    (r0, z0), (wide, rise, end) = root, shape
    c, s = math.cos(azimuth), math.sin(azimuth) * squeeze
    start = np.round([r0 * c, r0 * s, z0], 6)
    quarter = (tip - r0) / 4
    inward = np.round([quarter * c, quarter * s, rise / 2], 6)
    outward = np.round([quarter * c, quarter * s, (end - rise) / 2], 6)
    side = wide / 16
    across = np.round([-side * math.sin(azimuth), side * math.cos(azimuth) * squeeze, 0.0], 6)

    def ring(origin: np.ndarray, step: np.ndarray, halves: tuple[int, int, int]) -> np.ndarray:
        right = [origin + k * step - half * across for k, half in enumerate(halves)]
        left = [origin + k * step + half * across for k, half in enumerate(halves)]
        return np.array([*right, *left[::-1]])

    inner = ring(start, inward, (1, 6, 8))
    outer = np.delete(ring(start + 2 * inward, outward, (8, 6, 0)), 3, axis=0)
    # The halves share the face under the fold: side 2 of the inner one, side 4 of the outer.
    pieces = (raised(inner, _LEAF_M), frozenset({2})), (raised(outer, _LEAF_M), frozenset({4}))
    return [dataclasses.replace(piece, hidden=hidden) for piece, hidden in pieces]


def _azimuths(count: int, step: float) -> list[float]:
    """Turned by ``step`` each, with one leaf exactly along each axis, so that the box is known."""
    angles = [math.fmod(k * step, 2 * math.pi) for k in range(count)]
    for quarter in range(4):
        wanted = quarter * math.pi / 2
        off = [abs(math.remainder(a - wanted, 2 * math.pi)) for a in angles]
        angles[off.index(min(off))] = wanted
    return angles


def leafy_plant(
    width: float,
    depth: float,
    height: float,
    *,
    pot: float = 0.25,
    pot_width: float = 0.5,
    leaves: int = 11,
    leaf: float = 0.5,
    rise: float = 0.25,
    droop: float = 0.1,
    bare: float = 0.15,
    stem: float = 0.007,
    material: m.Material = m.TERRACOTTA,
    leaf_material: m.Material = m.LEAF,
    stem_material: m.Material = m.STEM,
    mount: Mount | None = None,
    sides: int = ROUND_SIDES,
) -> ModelBuilder:
    """A stem with leaves all the way up, as a rubber plant has.

    Args:
        width: Across the leaves.
        depth: Across the leaves.
        height: To the upper leaves.
        pot: Height of the pot, a share of the height.
        pot_width: A share of the width.
        leaves: How many, at least 4.
        leaf: Width of a leaf over its length.
        rise: Height of a leaf's fold over its length.
        droop: Height of its tip over its length.
        bare: Share of the stem below the lowest leaf.
        stem: Radius of the stem, metres.
        material: Of the pot.
        leaf_material: Of the leaves.
        stem_material: Of the stem.
        mount: ``surface`` for a small one.
        sides: Of the pot.
    """
    builder = ModelBuilder("plant", symmetry=1, mount=mount)
    reach, squeeze = width / 2, depth / width
    soil = add_pot(builder, pot_width * width, pot * height, squeeze, material, sides)
    long = reach - stem
    shape = (leaf * long, rise * long, droop * long)
    last = height - max(shape[1:]) - _LEAF_M
    first = soil + bare * (last - soil)
    trunk = stack([(soil, 1.3 * stem), (last + 0.01, stem)], sides=_STEM_SIDES)
    builder.add(stem_material, *squeezed(trunk, squeeze), carries=False)
    for k, azimuth in enumerate(_azimuths(leaves, _GOLDEN_RAD)):
        z = first + (last - first) * k / (leaves - 1)
        leaf_solids = _leaf((1.3 * stem, z), reach, azimuth, shape, squeeze)
        builder.add(leaf_material, *leaf_solids, carries=False)
    return builder


def palm(
    width: float,
    depth: float,
    height: float,
    *,
    pot: float = 0.2,
    pot_width: float = 0.32,
    tiers: int = 2,
    fronds: int = 8,
    frond: float = 0.16,
    rise: float = 0.45,
    trunk: float = 0.022,
    material: m.Material = m.CONCRETE,
    leaf_material: m.Material = m.LEAF,
    sides: int = ROUND_SIDES,
) -> ModelBuilder:
    """A trunk under ``tiers`` whorls of arching fronds; ``fronds`` in each, a multiple of 4."""
    builder = ModelBuilder("plant", symmetry=2 if width != depth else 4)
    reach, squeeze = width / 2, depth / width
    soil = add_pot(builder, pot_width * width, pot * height, squeeze, material, sides)
    # The stalks of a whorl stand beside one another about the trunk.
    trunk = max(trunk, 1.15 * frond * reach / 16 / math.tan(math.pi / fronds))
    long = reach - trunk
    high = height - rise * long - _LEAF_M
    wood = stack([(soil, trunk), (high + 0.01, 0.7 * trunk)], sides=_STEM_SIDES)
    builder.add(m.BARK, *squeezed(wood, squeeze), carries=False)
    step = 2 * math.pi / fronds
    for tier in range(tiers):
        z = high - 0.09 * tier * (high - soil)
        shape = (frond * long, rise * long * (1 - 0.55 * tier), -0.1 * long * (1 + 2 * tier))
        for k in range(fronds):
            turn = (k + 0.5 * (tier % 2)) * step
            frond_solids = _leaf(
                (trunk, z), reach if not tier else 0.9 * reach, turn, shape, squeeze
            )
            builder.add(leaf_material, *frond_solids, carries=False)
    return builder


def blade_plant(
    width: float,
    depth: float,
    height: float,
    *,
    pot: float = 0.3,
    pot_width: float = 0.7,
    blade: float = 0.055,
    outer: float = 0.75,
    material: m.Material = m.CERAMIC,
    leaf_material: m.Material = m.DARK_LEAF,
    mount: Mount | None = None,
    sides: int = ROUND_SIDES,
) -> ModelBuilder:
    """Eight stiff blades from the soil, as a snake plant or an aloe has.

    Four lean out as far as the box, ``outer`` times as high as the inner four; ``blade`` is the
    width of a blade in metres, less in a narrow pot.
    """
    builder = ModelBuilder("plant", symmetry=2 if width != depth else 4, mount=mount)
    reach, squeeze = width / 2, depth / width
    soil = add_pot(builder, pot_width * width, pot * height, squeeze, material, sides)
    room = 0.42 * pot_width * reach
    blade = min(blade, 1.05 * room)
    thick, tall = min(0.006, 0.12 * room), height - soil
    for ring, (foot, tip, share) in enumerate(
        ((room, reach, outer), (0.5 * room, 0.4 * reach, 1.0))
    ):
        for k in range(4):
            turn = (k + 0.5 * ring) * math.pi / 2
            solids = _blade((foot, soil), (tip, soil + share * tall), turn, blade, thick)
            builder.add(leaf_material, *squeezed(solids, squeeze), carries=False)
    return builder


def _blade(
    foot: tuple[float, float], tip: tuple[float, float], turn: float, wide: float, thick: float
) -> list[Solid]:
    """A thick leaf, widest in its middle, from (radius, height) to (radius, height)."""
    point = 0.001
    c, s = math.cos(turn), math.sin(turn)
    middle = (foot[0] + 0.38 * (tip[0] - foot[0]), foot[1] + 0.5 * (tip[1] - foot[1]))
    end = (tip[0] - point, tip[1])
    a, b, d = ((r * c, r * s, z) for r, z in (foot, middle, end))
    lower = spike(a, (thick, 0.35 * wide), b, (0.7 * thick, 0.5 * wide), turn, (1,))
    upper = spike(b, (0.7 * thick, 0.5 * wide), d, (point, 0.06 * wide), turn, (0,))
    return [lower, upper]
