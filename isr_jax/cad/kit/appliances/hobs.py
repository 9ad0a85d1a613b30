"""Hobs: zones on glass, plates of iron, gas burners under grates.

Zones and plates are 145 to 220 mm wide, four on a hob of 0.6 m, five or six on wider ones; pans
stand 20 to 35 mm above a gas hob (EN 60335-2-6, EN 30-1-1 and makers' catalogues).
"""

from __future__ import annotations

from typing import Literal

from .. import materials as m
from ..builder import ModelBuilder
from ..furniture.panels import Bounds
from ..solids import ROUND_SIDES, between, box, frustum

HobKind = Literal["glass", "plates", "gas"]
HOB_RISE_M: dict[str, float] = {"glass": 0.0015, "plates": 0.012, "gas": 0.03}
"""How far each kind stands above its deck, metres."""
_BAR_M = 0.01


def add_hob(
    builder: ModelBuilder,
    plan: tuple[Bounds, Bounds],
    deck: float,
    kind: HobKind,
    grid: tuple[int, int],
    sides: int = ROUND_SIDES,
) -> None:
    """Zones in a ``grid`` (along x, along y) on a deck at height ``deck``."""
    (x0, x1), (y0, y1) = plan
    step = ((x1 - x0) / grid[0], (y1 - y0) / grid[1])
    largest = round(min(0.105, 0.43 * step[0], 0.43 * step[1]), 4)
    for i in range(grid[0]):
        for k in range(grid[1]):
            center = (round(x0 + (i + 0.5) * step[0], 4), round(y0 + (k + 0.5) * step[1], 4))
            radius = largest if (i + k) % 2 else round(0.82 * largest, 4)
            z = (deck, deck + HOB_RISE_M[kind])
            if kind == "gas":
                _add_burner(builder, center, largest, z, sides)
            else:
                material = m.HOB_ZONE if kind == "glass" else m.CAST_IRON
                builder.add(material, frustum((radius, radius), z, center, sides))


def _add_burner(builder, center: tuple[float, float], radius: float, z: Bounds, sides) -> None:
    """A burner whose cap is level with the four bars of the grate around it."""
    cap, half = round(0.55 * radius, 4), _BAR_M / 2
    builder.add(m.HOB_ZONE, frustum((0.8 * cap, cap), z, center, sides))
    bars = (z[1] - 0.012, z[1])
    cx, cy = center
    for side in (-1, 1):
        reach = between(side * (cap + 0.003), side * radius)
        foot = between(side * (radius - _BAR_M), side * radius)
        across = (-half, half)
        for dx, dy, height in (
            (reach, across, bars),
            (across, reach, bars),
            (foot, across, (z[0], bars[0])),
            (across, foot, (z[0], bars[0])),
        ):
            spot = ((cx + dx[0], cx + dx[1]), (cy + dy[0], cy + dy[1]))
            builder.add(m.CAST_IRON, box(*spot, height), carries=False)
