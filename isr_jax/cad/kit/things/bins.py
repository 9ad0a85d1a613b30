"""Bins: open baskets, pedal bins and swing bins.

Waste baskets hold 8 to 40 l; pedal bins of 3 to 50 l are 170 to 400 mm wide and 260 to 700 mm
high; walls are 1 mm of steel or 3 mm of plastic.
"""

from __future__ import annotations

import numpy as np

from .. import materials as m
from ..builder import ModelBuilder
from ..shapes.turned import rounds_of, shell, stack
from ..solids import ROUND_SIDES, box, tapered_box, tube

_GAP_M = 0.003
"""Between a lid and what it closes."""
_LID_RAD = 1.35
"""A lid falls shut from here by itself."""


def round_bin(
    width: float,
    depth: float,
    height: float,
    *,
    foot: float = 0.77,
    wall: float = 0.003,
    floor: float = 0.004,
    material: m.Material = m.PLASTIC,
    sides: int = ROUND_SIDES,
) -> ModelBuilder:
    """An open, round, tapered bin; its foot is ``foot`` times as wide as its rim."""
    symmetry, squeeze = rounds_of(width, depth)
    builder = ModelBuilder("bin", symmetry=symmetry)
    _add_round_body(
        builder, (width / 2, squeeze), (0.0, height), foot, wall, floor, material, sides
    )
    return builder


def _add_round_body(builder, rim, z, foot, wall, floor, material, sides) -> None:
    (radius, squeeze), (low, high) = rim, z
    base = radius * (foot + (1 - foot) * floor / (high - low))
    bottom = [(low, foot * radius), (low + floor, base)]
    builder.add(material, *stack(bottom, squeeze=squeeze, sides=sides))
    side, hollow = [(low + floor, base), (high, radius)], [base - wall, radius - wall]
    builder.add(material, *shell(side, hollow, squeeze=squeeze, sides=sides))


def square_bin(
    width: float,
    depth: float,
    height: float,
    *,
    taper: float = 0.85,
    wall: float = 0.004,
    material: m.Material = m.PLASTIC,
) -> ModelBuilder:
    """An open bin with four walls; its foot is ``taper`` times as wide as its rim."""
    builder = ModelBuilder("bin", symmetry=4 if width == depth else 2)
    _add_square_body(builder, (width, depth, height), taper, wall, material)
    return builder


def _add_square_body(builder, size, taper: float, wall: float, material, shift=0.0) -> None:
    """Four walls on a floor; ``shift`` moves them along y."""
    width, depth, height = size
    floor = 0.005

    def outline(z: float, inset: float) -> np.ndarray:
        grow = taper + (1 - taper) * z / height
        x, y = width / 2 * grow - inset, depth / 2 * grow - inset
        near, far = shift - y, shift + y
        return np.round([(-x, near), (x, near), (x, far), (-x, far)], 6)

    def bounds(z: float) -> tuple[float, float, float, float]:
        (x0, y0), _, (x1, y1), _ = outline(z, 0.0).tolist()
        return x0, x1, y0, y1

    builder.add(material, tapered_box(bounds(0.0), bounds(floor), (0.0, floor)))
    outer = np.stack([outline(floor, 0.0), outline(height, 0.0)])
    inner = np.stack([outline(floor, wall), outline(height, wall)])
    builder.add(material, *tube(outer, inner, (floor, height)))


def pedal_bin(
    width: float,
    depth: float,
    height: float,
    *,
    lid: float = 0.05,
    wall: float = 0.002,
    pedal: float = 0.035,
    material: m.Material = m.BIN_STEEL,
    lid_material: m.Material = m.BLACK_LID,
    sides: int = ROUND_SIDES,
) -> ModelBuilder:
    """A round bin on a black foot, its domed lid hinged at the rear, its pedal before it."""
    builder = ModelBuilder("bin", symmetry=1)
    body = depth - pedal
    r, squeeze, back = width / 2, body / width, depth / 2
    center, foot, top = (0.0, back - body / 2), 0.03, height - lid
    around = {"squeeze": squeeze, "sides": sides, "center": center}
    builder.add(m.BLACK_LID, *stack([(0.0, r), (foot, r)], **around))
    inset = r - 0.002
    builder.add(material, *stack([(foot, inset), (foot + 0.004, inset)], **around))
    side = [(foot + 0.004, inset), (top - _GAP_M, inset)]
    builder.add(material, *shell(side, [inset - wall] * 2, **around))
    dome = [(top, r), (top + 0.35 * lid, r), (top + 0.8 * lid, 0.75 * r), (height, 0.4 * r)]
    builder.add(lid_material, *stack(dome, **around), link="lid")
    grip = (0.0, back - body, top + 0.2 * lid)
    builder.hinge(
        "lid", (0.0, back, top), (-1, 0, 0), _LID_RAD, damping=0.1, friction=0.05, at=grip
    )
    plate = box((-0.2 * width, 0.2 * width), (-back, back - body), (0.008, 0.014))
    builder.add(material, plate, carries=False)
    return builder


def lidded_bin(
    width: float,
    depth: float,
    height: float,
    *,
    lid: float = 0.03,
    wall: float = 0.003,
    taper: float = 0.9,
    lip: float = 0.012,
    material: m.Material = m.WHITE_PLASTIC,
    lid_material: m.Material = m.BLACK_LID,
) -> ModelBuilder:
    """A square bin under a lid that is hinged at the rear and stands ``lip`` out at the front."""
    builder = ModelBuilder("bin", symmetry=1)
    x, y, top = width / 2, depth / 2, height - lid
    size = (width, depth - lip, top - _GAP_M)
    _add_square_body(builder, size, taper, wall, material, shift=lip / 2)
    slab = top + 0.45 * lid
    builder.add(lid_material, box((-x, x), (-y, y), (top, slab)), link="lid")
    crown = tapered_box((-x, x, -y, y), (-0.86 * x, 0.86 * x, -0.86 * y, 0.86 * y), (slab, height))
    builder.add(lid_material, crown, link="lid")
    grip = (0.0, -y, (top + slab) / 2)
    builder.hinge("lid", (0.0, y, top), (-1, 0, 0), _LID_RAD, damping=0.2, friction=0.1, at=grip)
    return builder


def swing_bin(
    width: float,
    depth: float,
    height: float,
    *,
    hood: float = 0.12,
    lean: float = 0.03,
    wall: float = 0.003,
    taper: float = 0.9,
    material: m.Material = m.WHITE_PLASTIC,
    flap_material: m.Material = m.PLASTIC,
) -> ModelBuilder:
    """A square bin under a hood in which a flap swings both ways about its middle.

    The hood is ``hood`` high and leans in by ``lean`` on each side.
    """
    builder = ModelBuilder("bin", symmetry=4 if width == depth else 2)
    x, y, under = width / 2, depth / 2, height - hood
    _add_square_body(builder, (width, depth, under), taper, wall, material)
    corners = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)], np.float64)
    outer = np.stack([corners * (x, y), corners * (x - lean, y - lean)])
    inner = outer - wall * corners
    builder.add(flap_material, *tube(outer, inner, (under, height)))
    fx, fy, thick = x - lean - wall - _GAP_M, y - lean - wall - _GAP_M, 0.005
    axis = height - 0.002
    builder.add(material, box((-fx, fx), (-fy, fy), (axis - thick, axis)), link="flap")
    # The axis lies above the flap's middle, which therefore swings back.
    builder.hinge(
        "flap",
        (0.0, 0.0, axis),
        (-1, 0, 0),
        0.9,
        lower_rad=-0.9,
        damping=0.01,
        friction=0.003,
        at=(0.0, -fy, axis),
    )
    return builder
