"""Dishwashers.

They are 0.45 or 0.6 m wide and 0.82 to 0.87 m high, worktop included (EN 1116); small ones for a
worktop are 0.55 m wide and 0.44 m high. The tub is of steel sheet with bitumen mats; pump, motor
and softener lie below it (makers' catalogues).
"""

from __future__ import annotations

from ....classes import Mount
from .. import materials as m
from ..builder import ModelBuilder
from ..furniture.fronts import CLEARANCE_M
from ..furniture.panels import Bounds, Space
from ..solids import box
from .ovens import OvenLook, add_down_door, seam_above

_DOOR_M = 0.05
_WALL_M = 0.028


def dishwasher(
    width: float,
    depth: float,
    height: float,
    *,
    worktop: float = 0.03,
    foot: float = 0.1,
    racks: int = 2,
    shell: m.Material = m.WHITE_SHEET,
    front: m.Material = m.WHITE_SHEET,
    board: m.Material | None = None,
    mount: Mount | None = None,
) -> ModelBuilder:
    """A tub with fixed racks behind a door that opens down, controls in its upper part.

    ``worktop`` is the thickness of a lid that covers the door, 0 for one that goes below a counter.
    """
    builder = ModelBuilder("dishwasher", symmetry=1, mount=mount)
    x, y = width / 2, depth / 2
    face, roof = -y + _DOOR_M + CLEARANCE_M, height - worktop
    if worktop:
        builder.add(shell, box((-x, x), (-y, y), (roof, height)))
    base = ((-x + 0.015, x - 0.015), (face + 0.05, y - 0.1))
    builder.add(m.MACHINERY, box(*base, (0.0, foot)), carries=False)
    room = _add_tub(builder, ((-x, x), (face, y), (foot, roof)), shell)
    _add_racks(builder, room, racks)
    seam = seam_above(roof - foot, _DOOR_M) if worktop else 0.0
    slab = ((-x, x), (-y, -y + _DOOR_M), (foot, roof - seam))
    look = OvenLook(shell, front, reach=0.045)
    add_down_door(builder, slab, look, window=False, board=board, lining=m.STEEL_LINER)
    return builder


def _add_tub(builder: ModelBuilder, space: Space, shell: m.Material) -> Space:
    """Sheet metal around a liner, open to the front; what is hollow."""
    (x0, x1), y, (z0, z1) = space
    skin, wall = 0.01, _WALL_M
    inner = (x0 + wall, x1 - wall)
    for a, b in ((x0, x0 + skin), (x1 - skin, x1)):
        builder.add(shell, box((a, b), y, (z0, z1)))
    for a, b in ((x0 + skin, inner[0]), (inner[1], x1 - skin)):
        builder.add(m.STEEL_LINER, box((a, b), y, (z0, z1)))
    floor, ceiling = z0 + 0.05, z1 - wall
    builder.add(m.STEEL_LINER, box(inner, y, (z0, floor)))
    builder.add(m.STEEL_LINER, box(inner, y, (ceiling, z1 - skin)))
    builder.add(shell, box(inner, y, (z1 - skin, z1)))
    builder.add(m.STEEL_LINER, box(inner, (y[1] - wall, y[1]), (floor, ceiling)))
    return inner, (y[0], y[1] - wall), (floor, ceiling)


def _add_racks(builder: ModelBuilder, room: Space, count: int) -> None:
    """Baskets of wire from wall to wall, the lowest on wheels, spray arms below them."""
    (x0, x1), (y0, y1), (z0, z1) = room
    plan = ((x0, x1), (y0 + 0.015, y1 - 0.005))
    middle = ((x0 + x1) / 2, (plan[1][0] + plan[1][1]) / 2)
    hub, arm = 0.02, min(0.2, 0.42 * min(x1 - x0, plan[1][1] - plan[1][0]))
    at = [(c - hub, c + hub) for c in middle]
    builder.add(m.PLASTIC, box(at[0], at[1], (z0, z0 + 0.012)), carries=False)
    spray = (middle[0] - arm, middle[0] + arm)
    builder.add(m.PLASTIC, box(spray, at[1], (z0 + 0.012, z0 + 0.022)), carries=False)
    for k in range(count):
        low = z0 + 0.035 + round((z1 - z0 - 0.035) * k / count, 3)
        _add_basket(builder, plan, (low, low + round(0.32 * (z1 - z0) / count, 3)))
    for wheel in ((x0 + 0.02, x0 + 0.03), (x1 - 0.03, x1 - 0.02)):
        for end in (plan[1][0] + 0.05, plan[1][1] - 0.08):
            builder.add(m.PLASTIC, box(wheel, (end, end + 0.03), (z0, z0 + 0.035)), carries=False)


def _add_basket(builder: ModelBuilder, plan: tuple[Bounds, Bounds], z: Bounds) -> None:
    (x0, x1), (y0, y1) = plan
    t, floor = 0.004, z[0] + 0.004
    builder.add(m.WIRE_MESH, box((x0, x1), (y0, y1), (z[0], floor)))
    for bar in ((y0, y0 + t), (y1 - t, y1)):
        builder.add(m.WIRE_MESH, box((x0, x1), bar, (floor, z[1])), carries=False)
    for bar in ((x0, x0 + t), (x1 - t, x1)):
        builder.add(m.WIRE_MESH, box(bar, (y0 + t, y1 - t), (floor, z[1])), carries=False)
