"""Pots with soil, which all plants share.

Pots are 0.09 to 0.4 m wide with walls of 7 to 11 mm, filled with moist soil to 2 cm below the rim.
"""

from __future__ import annotations

import dataclasses

from .. import materials as m
from ..builder import ModelBuilder
from ..shapes.turned import shell, stack
from ..solids import Solid

_SOIL_DROP_M = 0.02


def add_pot(
    builder: ModelBuilder,
    width: float,
    height: float,
    squeeze: float,
    material: m.Material,
    sides: int,
    *,
    taper: float = 0.78,
) -> float:
    """A pot filled with soil; returns the soil's height."""
    rim, wall = width / 2, 0.006 + 0.012 * width
    floor, soil = wall, height - _SOIL_DROP_M

    def radius(z: float) -> float:
        return rim * (taper + (1 - taper) * z / height)

    around = {"squeeze": squeeze, "sides": sides}
    bottom = [(0.0, radius(0.0)), (floor, radius(floor))]
    builder.add(material, *stack(bottom, **around), carries=False)
    side = [(floor, radius(floor)), (height, rim)]
    builder.add(material, *shell(side, [r - wall for _, r in side], **around), carries=False)
    earth = [(z, radius(z) - wall - 0.0005) for z in (floor, soil)]
    builder.add(m.SOIL, *stack(earth, **around), carries=False)
    return soil


def squeezed(solids, squeeze: float) -> list[Solid]:
    """Solids of a round design, scaled along y about its axis."""
    return [dataclasses.replace(s, vertices=s.vertices * (1.0, squeeze, 1.0)) for s in solids]
