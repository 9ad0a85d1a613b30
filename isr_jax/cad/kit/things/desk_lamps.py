"""Desk lamps: with jointed arms, and with a bent neck.

They reach 0.3 to 0.5 m and weigh 1.5 to 3 kg. Real arms are held by springs or weights; here a
weight behind the elbow balances the upper arm, and the lower arm stands upright under it, so no
joint bears a moment at rest and its friction holds it elsewhere.
"""

from __future__ import annotations

import dataclasses
import math

import numpy as np

from ....errors import SettingError
from ....robot_model import solid_properties
from .. import materials as m
from ..builder import ModelBuilder
from ..shapes.strips import Point2, strip
from ..shapes.turned import shell, stack
from ..solids import ROUND_SIDES, Solid, between, box

_ARM_M = 0.007
"""Half the thickness of an arm."""
_CHEEK = (0.010, 0.015)
"""Where the arms' forks stand on both sides of what they hold."""
_DOWN_RAD = 0.22
"""Slope of the upper arm towards its head; less for a low lamp."""
_BACK_RAD = 0.5
"""The arms lean back so far."""
_TURN_RAD = 0.7
"""The head turns so far both ways; less on a short arm."""
_TAIL_M = 0.06
"""From the elbow to the weight."""
_WEIGHT_M, _WEIGHT_WIDE_M = 0.018, 0.024
"""Half the thickness of the weight, and half its width."""
_DROP_M = 0.045
"""From the head's joint down to its shade."""
_COLUMN_M = 0.055
_SHADE_WALL_M = 0.002
_OVAL = 0.55
"""A foot is at most so deep, a share of the lamp's depth; a wider one becomes oval."""


@dataclasses.dataclass(frozen=True, eq=False)
class _Part:
    link: str
    material: m.Material
    solids: tuple[Solid, ...]


@dataclasses.dataclass(frozen=True)
class _Arm:
    """The upper arm, and the shade that it carries."""

    reach: float
    """From the elbow to the head's joint."""
    down_rad: float
    """Slope towards the head."""
    cone: float
    """Radius of the shade's lower edge."""

    @property
    def head(self) -> Point2:
        """(y, z) of the head's joint from the elbow."""
        return self.at(-self.reach)

    @property
    def drop(self) -> float:
        """From the head's joint down to the shade's lower edge."""
        return _DROP_M + 0.02 + 1.1 * self.cone

    def at(self, along: float) -> Point2:
        """(y, z) of a point on its line, so far behind the elbow."""
        return along * math.cos(self.down_rad), along * math.sin(self.down_rad)


def arm_lamp(
    width: float,
    depth: float,
    height: float,
    *,
    head: float = 0.85,
    base: float = 0.016,
    material: m.Material = m.BLACK_METAL,
    shade_material: m.Material = m.SHADE_METAL,
    sides: int = ROUND_SIDES,
) -> ModelBuilder:
    """A foot as wide as the box, two arms and a shade ``head`` times as wide, on three hinges.

    The shade is narrower where box and arms are short. Forwards the arms lean only as far as it
    stays above the foot.

    Raises:
        SettingError: the box leaves no room for arms.
    """
    radius = width / 2
    oval = min(1.0, _OVAL * depth / width)
    cone = min(head * radius * oval, 0.16 * depth, 0.17 * height)

    down = min(_DOWN_RAD, 0.25 * height / depth)

    def upper(reach: float) -> list[_Part]:
        return _upper_arm(_Arm(reach, down, cone), material, shade_material, sides)

    def extent(reach: float) -> float:
        low, high = _bounds(upper(reach))
        return max(oval * radius, -low[0]) + max(oval * radius, high[0])

    reach = _solved(extent, depth)
    parts = upper(reach)
    elbow = height - _bounds(parts)[1][1]
    arm = _Arm(reach, down, cone)
    builder = ModelBuilder("lamp", symmetry=1)
    _add_foot(builder, material, (radius, oval), base, sides)
    _add_lower_arm(builder, material, elbow)
    for part in parts:
        moved = [solid.moved(np.array([0.0, 0.0, elbow])) for solid in part.solids]
        builder.add(part.material, *moved, link=part.link, carries=False)
    _add_hinges(builder, elbow, arm, base + 0.01)
    return builder


def _limits(elbow: float, arm: _Arm, floor: float) -> tuple[float, float]:
    """How far (rad) both arms may lean forwards and the head may turn at once.

    However the head is turned, it stays above ``floor`` and off the lower arm.
    """
    for lean in (percent / 100 for percent in range(50, 1, -1)):
        height = _COLUMN_M + (elbow - _COLUMN_M) * math.cos(lean)
        lowest = height - arm.reach * math.sin(arm.down_rad + 2 * lean)
        turn = _head_turn(arm, lean)
        if lowest - math.hypot(arm.drop, arm.cone) > floor and turn > 0.1:
            return lean, turn
    problem = f"a lamp whose elbow is {elbow:.3g} m high, on arms of {arm.reach:.3g} m"
    raise SettingError(problem, "ask for a higher or a deeper one, or use bent_lamp")


def _head_turn(arm: _Arm, lean: float) -> float:
    """How far (rad) the head may turn without touching the lower arm; 0: not at all."""
    room = arm.reach * math.cos(arm.down_rad + lean) - 0.015
    for turn in (percent / 100 for percent in range(round(100 * _TURN_RAD), 0, -1)):
        tilt = turn + lean
        if arm.drop * math.sin(tilt) + arm.cone * math.cos(tilt) < room:
            return turn
    return 0.0


def _upper_arm(arm: _Arm, material, shade_material, sides: int) -> list[_Part]:
    """Upper arm, head and the weight that balances both, the elbow at the origin."""
    line = [arm.at(_TAIL_M), arm.at(-arm.reach - 0.008)]
    parts = [_Part("arm_2", material, strip(line, 2 * _ARM_M, "x", (-_ARM_M, _ARM_M)))]
    parts += _head(arm.head, arm.cone, material, shade_material, sides)
    moment = sum(_moment(part) for part in parts)
    weight = m.CAST_IRON
    per_m = weight.density_kg_m3 * (2 * _WEIGHT_M) * (2 * _WEIGHT_WIDE_M)
    per_m *= math.cos(arm.down_rad)
    long = -_TAIL_M + math.sqrt(_TAIL_M**2 - 2 * moment / per_m)
    tail = [arm.at(_TAIL_M), arm.at(_TAIL_M + long)]
    block = strip(tail, 2 * _WEIGHT_M, "x", (-_WEIGHT_WIDE_M, _WEIGHT_WIDE_M))
    return [*parts, _Part("arm_2", weight, block)]


def _head(joint: Point2, cone: float, material, shade_material, sides: int) -> list[_Part]:
    """Cheeks beside the arm, and a shade that hangs below them, open downwards."""
    y, z = joint
    top = z - _DROP_M
    cheeks = [
        box(between(side * _CHEEK[0], side * _CHEEK[1]), (y - 0.008, y + 0.008), (top, z + 0.008))
        for side in (-1, 1)
    ]
    around = {"sides": sides, "center": (0.0, y)}
    neck, low = 0.45 * cone, top - 0.02 - 1.1 * cone
    edge = neck + 0.0005  # a little beyond the skirt: no edge belongs to both
    cap = stack([(top - 0.02, edge), (top - 0.004, 0.7 * neck), (top, 0.7 * neck)], **around)
    wall = [(low, cone), (top - 0.02, neck)]
    skirt = shell(wall, [cone - _SHADE_WALL_M, neck - _SHADE_WALL_M], **around)
    bulb = min(0.025, 0.8 * (neck - _SHADE_WALL_M))
    globe = stack(
        [
            (top - 0.02 - 3 * bulb, 0.4 * bulb),
            (top - 0.02 - 1.6 * bulb, bulb),
            (top - 0.02, 0.6 * bulb),
        ],
        **around,
    )
    return [
        _Part("head", material, tuple(cheeks)),
        _Part("head", shade_material, (*cap, *skirt)),
        _Part("head", m.BULB, globe),
    ]


def _moment(part: _Part) -> float:
    """First moment along y, kg m."""
    found = [solid_properties(s.mesh(), part.material.density_kg_m3) for s in part.solids]
    return float(sum(mass * com[1] for mass, com, _ in found))


def _bounds(parts: list[_Part]) -> tuple[Point2, Point2]:
    """Least and greatest (y, z)."""
    points = [v for part in parts for solid in part.solids for v in solid.vertices[:, 1:].tolist()]
    ys, zs = zip(*points)
    return (min(ys), min(zs)), (max(ys), max(zs))


def _solved(extent, depth: float) -> float:
    """The reach at which the lamp is ``depth`` deep, by bisection."""
    low, high = 0.06, 2.0
    if not extent(low) < depth < extent(high):
        problem = f"a lamp {depth:.3g} m deep on so wide a foot"
        raise SettingError(problem, f"ask for more than {extent(low):.3g} m, or a narrower one")
    for _ in range(20):
        middle = (low + high) / 2
        low, high = (middle, high) if extent(middle) < depth else (low, middle)
    return round((low + high) / 2, 5)


def _add_foot(builder: ModelBuilder, material, shape: tuple[float, float], base, sides) -> None:
    """``shape`` is the foot's radius along x, and its depth over its width."""
    radius, oval = shape
    disc = [(0.0, radius), (0.7 * base, radius), (base, 0.9 * radius)]
    builder.add(m.CAST_IRON, *stack(disc, squeeze=oval, sides=sides), carries=False)
    tongue = (-_ARM_M, _ARM_M)
    builder.add(material, box(tongue, (-0.014, 0.014), (base, _COLUMN_M + 0.008)), carries=False)


def _add_lower_arm(builder: ModelBuilder, material, elbow: float) -> None:
    """Two bars on both sides of the foot's tongue and of the upper arm, tied halfway up."""
    for side in (-1, 1):
        across = between(side * _CHEEK[0], side * _CHEEK[1])
        z = (_COLUMN_M - 0.009, elbow + 0.009)
        builder.add(material, box(across, (-0.009, 0.009), z), link="arm_1", carries=False)
    middle = (_COLUMN_M + elbow) / 2
    tie = box((-_CHEEK[0], _CHEEK[0]), (-0.006, 0.006), (middle - 0.006, middle + 0.006))
    builder.add(material, tie, link="arm_1", carries=False)


def _add_hinges(builder: ModelBuilder, elbow: float, arm: _Arm, floor: float) -> None:
    lean, turn = _limits(elbow, arm, floor)
    y, z = arm.head[0], elbow + arm.head[1]
    both = {"damping": 0.05, "axis": (1, 0, 0)}
    arms = {"lower_rad": -_BACK_RAD, "upper_rad": lean, **both}
    builder.hinge("arm_1", (0.0, 0.0, _COLUMN_M), friction=0.4, at=(0.0, 0.0, elbow), **arms)
    builder.hinge("arm_2", (0.0, 0.0, elbow), friction=0.25, parent="arm_1", at=(0.0, y, z), **arms)
    builder.hinge(
        "head",
        (0.0, y, z),
        upper_rad=turn,
        lower_rad=-turn,
        friction=0.06,
        parent="arm_2",
        at=(0.0, y - arm.cone, z - arm.drop),
        **both,
    )


def bent_lamp(
    width: float,
    depth: float,
    height: float,
    *,
    head: float = 0.75,
    base: float = 0.016,
    tube: float = 0.012,
    drop: float = 0.45,
    material: m.Material = m.BRASS_TUBE,
    shade_material: m.Material = m.SHADE_METAL,
    sides: int = ROUND_SIDES,
) -> ModelBuilder:
    """A foot as wide as the box, a tube bent forwards, and a shade ``head`` times as wide.

    The shade's lower edge hangs at (1 - ``drop``) of the height.
    """
    builder = ModelBuilder("lamp", symmetry=1)
    radius = width / 2
    # Long enough under its head, and no longer than the lamp has room for.
    oval = min(max(1.0, 0.42 * depth / width), _OVAL * depth / width)
    cone = head * radius * min(1.0, oval)
    rear, front = depth / 2 - oval * radius, -depth / 2 + cone
    disc = [(0.0, radius), (0.7 * base, radius), (base, 0.9 * radius)]
    center = (0.0, rear)
    builder.add(m.CAST_IRON, *stack(disc, squeeze=oval, sides=sides, center=center), carries=False)
    half, low = tube / 2, (1 - drop) * height
    cap, top = low + 0.62 * (height - low), height - half
    bend = 0.35 * (rear - front)
    fall = min(bend, 0.9 * (top - cap))
    path = [
        (rear, base),
        (rear, top - bend),
        (rear - 0.3 * bend, top - 0.3 * bend),
        (rear - bend, top),
        (front + bend, top),
        (front + 0.3 * bend, top - 0.3 * fall),
        (front, top - fall),
        (front, cap),
    ]
    builder.add(material, *strip(path, tube, "x", (-half, half)), carries=False)
    around = {"sides": sides, "center": (0.0, front)}
    neck, wall = 0.4 * cone, _SHADE_WALL_M
    builder.add(shade_material, *stack([(cap - 0.02, neck), (cap, 0.6 * neck)], **around))
    skirt = [(low, cone), (cap - 0.02, neck)]
    builder.add(shade_material, *shell(skirt, [cone - wall, neck - wall], **around))
    globe = [(cap - 0.065, 0.4 * neck), (cap - 0.045, 0.7 * neck), (cap - 0.02, 0.4 * neck)]
    builder.add(m.BULB, *stack(globe, **around))
    return builder
