"""Laptops and keyboards.

Laptops with screens of 11 to 17 inches are 0.28 to 0.40 m wide and 0.19 to 0.28 m deep, closed 15
to 25 mm high; lids open to 130 degrees or so. Keyboards are 0.28 to 0.46 m wide; keys stand 19 mm
apart (ISO 9995, ISO 9241-410 and makers' catalogues).
"""

from __future__ import annotations

import dataclasses
import math

from ....errors import SettingError
from .. import materials as m
from ..builder import ModelBuilder
from ..furniture.panels import Bounds
from ..shapes.shells import turned
from ..solids import box

_GAP_M = 0.0035
"""Between the closed lid and the deck."""
_BAR_M = 0.004
_BEHIND_M = 0.0085
"""From the rear edge of the base to the axis of the hinge."""
_KEY_M = 0.001
_WIDEST_RAD = 2.3
_HOLDING = 1.25
"""Friction of the hinge over the largest moment of the lid's weight: it stays at any angle."""


@dataclasses.dataclass(frozen=True)
class _Shape:
    """A laptop in profile; the axis of its hinge lies at y = 0."""

    base: float
    """Height of the base."""
    lid: float
    """Thickness."""
    deck: float
    """From the axis to the front edge of the base."""
    reach: float
    """From the axis to the lid's far edge."""
    open_rad: float

    @property
    def axis_z(self) -> float:
        return self.base + _GAP_M / 2

    @property
    def corners(self) -> list[tuple[float, float]]:
        """Profile of the lid as it stands: (behind the axis, above the axis)."""
        near, far = _GAP_M / 2, _GAP_M / 2 + self.lid
        cos, sin = math.cos(self.open_rad), math.sin(self.open_rad)
        points = [
            (self.reach, near),
            (self.reach, far),
            (-_BAR_M, far),
            (-_BAR_M, -_BAR_M),
            (_BAR_M, -_BAR_M),
        ]
        return [(e * sin - d * cos, d * sin + e * cos) for d, e in points]

    @property
    def depth(self) -> float:
        return self.deck + max(0.0, *(behind for behind, _ in self.corners))

    @property
    def height(self) -> float:
        return self.axis_z + max(above for _, above in self.corners)


def _opened(base: float, lid: float, depth: float, height: float) -> _Shape:
    """The laptop whose lid is as long as its base and whose profile fills depth and height.

    Where it would have to lean to the front, it stands upright and is longer than the base.
    """
    low, high = math.pi / 2, 2.75

    def at(open_rad: float) -> _Shape:
        reach = (height - base - _GAP_M / 2) / math.sin(open_rad)
        for _ in range(4):
            shape = _Shape(base, lid, reach, reach, open_rad)
            reach += (height - shape.height) / math.sin(open_rad)
        return _Shape(base, lid, reach, reach, open_rad)

    if depth > at(high).depth:
        problem = f"no laptop with an open lid is {depth:.3g} m deep and {height:.3g} m high"
        raise SettingError(problem, "ask for a depth of at most 4 times the height")
    if depth < at(low).depth:
        upright = at(round(low, 7))
        return dataclasses.replace(upright, deck=upright.deck + depth - upright.depth)
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if at(middle).depth < depth else (low, middle)
    return at(round((low + high) / 2, 7))


def laptop(
    width: float,
    depth: float,
    height: float,
    *,
    closed: bool = False,
    base: float = 0.016,
    lid: float = 0.0055,
    shell: m.Material = m.ALUMINIUM_DEVICE,
    keys: m.Material = m.DARK_KEYS,
) -> ModelBuilder:
    """A laptop as it stands about: its lid open so that the profile fills depth and height.

    The lid is as long as the base, so the box alone says how far it stands open; there its joint is
    at zero, closed at its lower limit. A ``closed`` one has its lid down at zero, and ``lid`` says
    how the height is shared.

    Raises:
        SettingError: No angle of the lid fills depth and height.
    """
    builder = ModelBuilder("laptop", symmetry=1)
    if closed:
        base = height - _GAP_M - lid
        shape = _Shape(base, lid, depth - _BAR_M, depth - _BAR_M, 0.0)
    else:
        shape = _opened(base, lid, depth, height)
    x, front = width / 2, -shape.deck
    builder.add(shell, box((-x, x), (front, -_BEHIND_M), (0.0, base)))
    _add_keys(builder, x, (front, -_BEHIND_M), base, keys, shell)
    _add_lid(builder, x, shape, shell)
    widest = max(_WIDEST_RAD, shape.open_rad + 0.1)
    behind, above = shape.corners[0]
    friction = _holding_nm(width, shape, shell)
    builder.hinge(
        "lid",
        (0.0, 0.0, shape.axis_z),
        (-1, 0, 0),
        round(widest - shape.open_rad, 4),
        lower_rad=-shape.open_rad,
        damping=0.05,
        friction=friction,
        at=(0.0, behind, shape.axis_z + above),
    )
    return builder


def _holding_nm(width: float, shape: _Shape, shell: m.Material) -> float:
    kg_m2 = shape.lid * shell.density_kg_m3
    return round(_HOLDING * kg_m2 * width * shape.reach * 9.81 * shape.reach / 2, 3)


def _add_lid(builder: ModelBuilder, x: float, shape: _Shape, shell: m.Material) -> None:
    """Screen in a bezel before a thin shell, on a bar along the hinge."""
    z, t = shape.axis_z, 0.001
    near, far = z + _GAP_M / 2, z + _GAP_M / 2 + shape.lid
    front, rear, rim = -shape.reach, -_BAR_M, 0.008
    inner, screen = (-x + rim, x - rim), (front + rim, rear - 0.02)
    face = (near, near + t)
    parts = [(shell, box((-x, x), (front, rear), (near + t, far)))]
    parts += [
        (m.BLACK_PLASTIC, box(a, (front, rear), face)) for a in ((-x, inner[0]), (inner[1], x))
    ]
    parts += [
        (m.BLACK_PLASTIC, box(inner, (front, screen[0]), face)),
        (m.BLACK_PLASTIC, box(inner, (screen[1], rear), face)),
        (m.SCREEN, box(inner, screen, face)),
        (m.BLACK_PLASTIC, box((-0.8 * x, 0.8 * x), (-_BAR_M, _BAR_M), (z - _BAR_M, near + t))),
        (shell, box((-0.8 * x, 0.8 * x), (-_BAR_M, _BAR_M), (near + t, far))),
    ]
    for material, part in parts:
        builder.add(material, turned(part, "x", -shape.open_rad, (0.0, 0.0, z)), link="lid")


def _add_keys(builder, x: float, y: Bounds, z: float, keys: m.Material, shell: m.Material) -> None:
    """Rows of keys as strips, and a touch pad before them."""
    deep = y[1] - y[0]
    wide = min(0.9 * x, 0.15)
    start, step = y[0] + 0.42 * deep, 0.5 * deep / 6
    for k in range(6):
        row = (start + k * step, start + (k + 0.86) * step)
        spans = [(-wide, wide)]
        if k == 0:
            spans = [(-wide, -0.42 * wide), (-0.4 * wide, 0.3 * wide), (0.32 * wide, wide)]
        for span in spans:
            builder.add(keys, box(span, row, (z, z + _KEY_M)), carries=False)
    pad = (y[0] + 0.05 * deep, y[0] + 0.36 * deep)
    builder.add(m.GREY_KEYS, box((-0.3 * x, 0.3 * x), pad, (z, z + _KEY_M / 2)), carries=False)


def keyboard(
    width: float,
    depth: float,
    height: float,
    *,
    pad: bool = True,
    rows: int = 6,
    case: m.Material = m.BLACK_CASE,
    keys: m.Material = m.DARK_KEYS,
) -> ModelBuilder:
    """A case with strips of keys; ``pad`` adds the block of arrows and that of numbers."""
    builder = ModelBuilder("keyboard", symmetry=1)
    x, y = width / 2, depth / 2
    top = height - min(0.008, 0.4 * height)
    builder.add(case, box((-x, x), (-y, y), (0.0, top)), carries=False)
    rim = min(0.01, 0.05 * width)
    left, right = -x + rim, x - rim
    wide = right - left
    main = (left, left + (0.66 * wide if pad else wide))
    blocks = [main]
    if pad:
        blocks += [(left + 0.68 * wide, left + 0.81 * wide), (left + 0.83 * wide, right)]
    step = (depth - 2 * rim) / rows
    for k in range(rows):
        strip = (-y + rim + (k + 0.04) * step, -y + rim + (k + 0.96) * step)
        for i, block in enumerate(blocks):
            for span in _spans(block, k, rows, i):
                builder.add(keys, box(span, strip, (top, height)), carries=False)
    return builder


def _spans(block: Bounds, row: int, rows: int, index: int) -> list[Bounds]:
    """Strips of one row of a block: the space bar stands alone, arrows have a free row behind."""
    a, wide = block[0], block[1] - block[0]
    if index == 0 and row == 0:
        return [
            (a, a + 0.24 * wide),
            (a + 0.25 * wide, a + 0.68 * wide),
            (a + 0.69 * wide, a + wide),
        ]
    if index == 0 and row == rows - 1:
        groups = [(0.0, 0.06), (0.12, 0.38), (0.42, 0.68), (0.72, 1.0)]
        return [(a + u * wide, a + v * wide) for u, v in groups]
    if index == 1 and row == 1:
        return [(a + 0.35 * wide, a + 0.65 * wide)]
    if index == 1 and row == 2:
        return []
    return [block]
