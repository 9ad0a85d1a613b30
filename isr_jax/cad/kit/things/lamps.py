"""Lamps with shades: on tables, on floors, on walls.

Table lamps are 0.25 to 0.7 m high with shades of 0.15 to 0.4 m, floor lamps 1.4 to 1.8 m high on
feet of 4 to 8 kg; feet are of iron or stone, so that a lamp withstands a tilt of 6 degrees
(EN 60598-1 asks for that).
"""

from __future__ import annotations

import math

from ....classes import Mount
from .. import materials as m
from ..builder import ModelBuilder
from ..shapes.strips import strip
from ..shapes.turned import Profile, rounds_of, shell, stack
from ..solids import ROUND_SIDES, box, tapered_box

_SHADE_WALL_M = 0.003
_ROD_M = 0.005
"""Half the thickness of the rod that carries a shade."""
_SPOKE_M = 0.003
URN: Profile = ((0.0, 0.3), (0.1, 0.42), (0.55, 0.4), (0.9, 0.14), (1.0, 0.1))
COLUMN: Profile = ((0.0, 0.13), (1.0, 0.1))
CONE: Profile = ((0.0, 0.45), (0.85, 0.12), (1.0, 0.1))
BALL: Profile = ((0.0, 0.2), (0.15, 0.4), (0.4, 0.52), (0.65, 0.42), (0.85, 0.14), (1.0, 0.1))
DRUM: Profile = ((0.0, 0.4), (0.8, 0.4), (0.88, 0.12), (1.0, 0.1))


def table_lamp(
    width: float,
    depth: float,
    height: float,
    *,
    shade: float = 0.42,
    narrow: float = 0.7,
    body: Profile = URN,
    foot: float = 0.012,
    foot_width: float = 0.5,
    material: m.Material = m.CAST_CERAMIC,
    shade_material: m.Material = m.LAMP_CLOTH,
    foot_material: m.Material = m.CAST_IRON,
    mount: Mount | None = None,
    sides: int = ROUND_SIDES,
) -> ModelBuilder:
    """A shade over a turned body on a foot.

    Args:
        width: Of the shade.
        depth: Of the shade.
        height: With the shade.
        shade: Share of the height that the shade takes.
        narrow: Width of the shade above over that below.
        body: Shares of the height under the bulb, and radii as shares of half the width.
        foot: Thickness of the foot, metres.
        foot_width: Of the foot, a share of the width.
        material: Of the body.
        shade_material: Of the shade.
        foot_material: Of the foot.
        mount: ``floor`` for a tall one.
        sides: Of round parts.
    """
    symmetry, squeeze = rounds_of(width, depth)
    builder = ModelBuilder("lamp", symmetry=_four(symmetry), mount=mount)
    half, under = width / 2, height * (1 - shade)
    base = foot_width * half
    low = [(0.0, base), (foot, 0.96 * base)]
    builder.add(foot_material, *stack(low, squeeze=squeeze, sides=sides), carries=False)
    neck = under + 0.12 * shade * height
    profile = [(foot + share * (neck - foot), radius * half) for share, radius in body]
    builder.add(material, *stack(profile, squeeze=squeeze, sides=sides), carries=False)
    cone = ((under, half), (height, narrow * half))
    _add_lampshade(builder, shade_material, cone, neck, squeeze, sides)
    return builder


def _four(symmetry: int) -> int:
    """Symmetry with the shade's four spokes."""
    return symmetry or 4


def _add_lampshade(builder: ModelBuilder, material, cone, neck: float, squeeze, sides) -> None:
    """A hollow shade, open at both ends, on a rod from ``neck`` up through a bulb; it has spokes.

    ``cone`` holds height and radius of its lower and upper edge.
    """
    (low, below), (high, above) = cone
    hollow = [below - _SHADE_WALL_M, above - _SHADE_WALL_M]
    builder.add(material, *shell(cone, hollow, squeeze=squeeze, sides=sides))
    z0 = high - 0.25 * (high - low)
    z1 = z0 + _SPOKE_M
    bulb = min(0.03, 0.3 * min(above, below) * min(1.0, squeeze))
    top = min(neck + 0.1, z0 - 0.02)
    socket = neck + 0.3 * (top - neck)
    builder.add(m.PLASTIC, *stack([(neck, 0.6 * bulb), (socket, 0.6 * bulb)], sides=sides))
    globe = [(socket, 0.5 * bulb), (socket + 0.6 * (top - socket), bulb), (top, 0.5 * bulb)]
    builder.add(m.BULB, *stack(globe, sides=sides))
    builder.add(m.STEEL, box((-_ROD_M, _ROD_M), (-_ROD_M, _ROD_M), (top, z1)), carries=False)
    inside = min(hollow[0] + (hollow[1] - hollow[0]) * (z - low) / (high - low) for z in (z0, z1))
    # Beside its corner on the axis the hollow is narrower than at it.
    r = _SPOKE_M / 2
    reach = inside - r * math.tan(math.pi / sides) / min(1.0, squeeze) - 0.0002
    for x in ((_ROD_M, reach), (-reach, -_ROD_M)):
        builder.add(m.STEEL, box(x, (-r, r), (z0, z1)))
    for y in ((_ROD_M, squeeze * reach), (-squeeze * reach, -_ROD_M)):
        builder.add(m.STEEL, box((-r, r), y, (z0, z1)))


def floor_lamp(
    width: float,
    depth: float,
    height: float,
    *,
    shade: float = 0.18,
    narrow: float = 0.8,
    foot_width: float = 0.7,
    foot: float = 0.014,
    pole: float = 0.011,
    tripod: bool = False,
    material: m.Material = m.BLACK_TUBE,
    shade_material: m.Material = m.LAMP_CLOTH,
    sides: int = ROUND_SIDES,
) -> ModelBuilder:
    """A shade on a pole of radius ``pole`` over an iron foot, or on three legs of wood."""
    symmetry, squeeze = rounds_of(width, depth)
    turns = 1 if tripod else _four(symmetry)
    builder = ModelBuilder("lamp", symmetry=turns, mount="floor")
    half, under = width / 2, height * (1 - shade)
    neck = under + 0.12 * shade * height
    if tripod:
        _add_tripod(builder, material, 0.95 * half, min(1.0, squeeze), under - 0.03, neck, sides)
    else:
        base = foot_width * half
        low = [(0.0, base), (0.6 * foot, base), (foot, 0.9 * base)]
        builder.add(m.CAST_IRON, *stack(low, squeeze=squeeze, sides=sides), carries=False)
        builder.add(material, *stack([(foot, pole), (neck, pole)], sides=sides))
    cone = ((under, half), (height, narrow * half))
    _add_lampshade(builder, shade_material, cone, neck, squeeze, sides)
    return builder


def _add_tripod(builder, material, reach: float, squeeze: float, hub: float, neck, sides) -> None:
    """Three square legs that lean together under a hub, which carries the neck."""
    leg, heads = 0.011, 0.03
    for k in range(3):
        angle = math.pi * (0.5 + 2 * k / 3)
        c, s = math.cos(angle), math.sin(angle)
        spread = (reach - leg, squeeze * reach - leg)
        ends = [(spread[0] * c, spread[1] * s), ((heads - leg) * c, (heads - leg) * s)]
        rows = [(x - leg, x + leg, y - leg, y + leg) for x, y in ends]
        builder.add(material, tapered_box(rows[0], rows[1], (0.0, hub)))
    builder.add(material, *stack([(hub, 0.045), (hub + 0.03, 0.045)], sides=sides))
    builder.add(m.BLACK_TUBE, *stack([(hub + 0.03, 0.011), (neck, 0.011)], sides=sides))


def uplighter(
    width: float,
    depth: float,
    height: float,
    *,
    bowl: float = 0.06,
    foot: float = 0.016,
    foot_width: float = 0.85,
    pole: float = 0.012,
    material: m.Material = m.BLACK_TUBE,
    shade_material: m.Material = m.WHITE_METAL,
    sides: int = ROUND_SIDES,
) -> ModelBuilder:
    """A pole on an iron foot that carries an open bowl, ``bowl`` of the height, lit upwards."""
    symmetry, squeeze = rounds_of(width, depth)
    builder = ModelBuilder("lamp", symmetry=symmetry, mount="floor")
    half, base = width / 2, foot_width * width / 2
    low = [(0.0, base), (0.6 * foot, base), (foot, 0.9 * base)]
    builder.add(m.CAST_IRON, *stack(low, squeeze=squeeze, sides=sides), carries=False)
    under = height * (1 - bowl)
    builder.add(material, *stack([(foot, pole), (under, pole)], sides=sides))
    floor, wall = under + 0.006, 0.004
    middle = (floor + height) / 2
    profile = [(floor, 0.3 * half), (middle, 0.75 * half), (height, half)]
    disc = [(under, 0.25 * half), (floor, 0.3 * half)]
    builder.add(shade_material, *stack(disc, squeeze=squeeze, sides=sides), carries=False)
    hollow = [0.3 * half - 3 * wall, 0.75 * half - 2 * wall, half - wall]
    builder.add(shade_material, *shell(profile, hollow, squeeze=squeeze, sides=sides))
    return builder


def globe_lamp(
    width: float,
    depth: float,
    height: float,
    *,
    foot: float = 0.18,
    foot_width: float = 0.5,
    material: m.Material = m.BRASS,
    glass: m.Material = m.OPAL_GLASS,
    sides: int = ROUND_SIDES,
) -> ModelBuilder:
    """A ball of opal glass on a foot that takes ``foot`` of the height."""
    symmetry, squeeze = rounds_of(width, depth)
    builder = ModelBuilder("lamp", symmetry=symmetry)
    half, low = width / 2, foot * height
    base = [(0.0, foot_width * half), (0.5 * low, foot_width * half), (low, 0.4 * half)]
    builder.add(material, *stack(base, squeeze=squeeze, sides=sides), carries=False)
    middle, tall = (low + height) / 2, (height - low) / 2
    # Flat where it meets the foot, and a little above.
    shares = (-0.95, -0.8, -0.5, 0.0, 0.5, 0.8, 0.97)
    ball = [(middle + tall * share / 0.97, half * math.sqrt(1 - share**2)) for share in shares]
    ball[0] = (low, ball[0][1])
    builder.add(glass, *stack(ball, squeeze=squeeze, sides=sides), carries=False)
    return builder


def wall_lamp(
    width: float,
    depth: float,
    height: float,
    *,
    plate: float = 0.018,
    shade: float = 0.6,
    narrow: float = 0.7,
    material: m.Material = m.BRASS_TUBE,
    shade_material: m.Material = m.LAMP_CLOTH,
    sides: int = ROUND_SIDES,
) -> ModelBuilder:
    """A shade before a wall, on an arm from a plate at the rear; ``shade`` is of the height."""
    builder = ModelBuilder("lamp", symmetry=1, mount="wall")
    half, y, back = width / 2, depth / 2, depth / 2 - plate
    gap = 0.012
    wide = back - gap + y  # of the shade, front to rear
    center = (0.0, -y + wide / 2)
    under, squeeze = height * (1 - shade), wide / width
    around = {"squeeze": squeeze, "sides": sides, "center": center}
    cone = [(under, half), (height, narrow * half)]
    hollow = [half - _SHADE_WALL_M, narrow * half - _SHADE_WALL_M]
    builder.add(shade_material, *shell(cone, hollow, **around))
    builder.add(material, box((-0.03, 0.03), (back, y), (0.0, 0.7 * height)))
    r = 0.006
    stem = center[1]
    path = [(back, 0.25 * under + r), (stem, 0.25 * under + r)]
    builder.add(material, *strip(path, 2 * r, "x", (-r, r)))
    top = under + 0.35 * (height - under)
    builder.add(material, box((-r, r), (stem - r, stem + r), (0.25 * under + 2 * r, top)))
    z0, inside = top - 0.003, half + (narrow * half - half) * (top - under) / (height - under)
    reach = inside - _SHADE_WALL_M - 0.0002
    reach -= 0.0015 * math.tan(math.pi / sides) / squeeze
    for x in ((r, reach), (-reach, -r)):
        builder.add(material, box(x, (stem - 0.0015, stem + 0.0015), (z0, top)))
    globe = [(top, 0.012), (top + 0.03, 0.02), (top + 0.055, 0.012)]
    builder.add(m.BULB, *stack(globe, sides=sides, center=center))
    return builder
