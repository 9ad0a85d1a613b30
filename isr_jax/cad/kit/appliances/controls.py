"""Controls of appliances: knobs with a pointer, panels with a display.

Knobs are 35 to 45 mm wide and stand out 20 to 30 mm; those of hobs turn by three quarters of a
circle (makers' catalogues).
"""

from __future__ import annotations

from collections.abc import Sequence

from .. import materials as m
from ..builder import ModelBuilder
from ..furniture.panels import Bounds, Space
from ..shapes.shells import lying_disc
from ..solids import ROUND_SIDES, box

KNOB_RAD = 4.7
_GAP_M = 0.0025
"""Between a knob and the panel."""
_POINTER_M = 0.003


def add_knob(
    builder: ModelBuilder,
    at: tuple[float, float, float],
    radius: float,
    *,
    depth: float = 0.024,
    upper_rad: float = KNOB_RAD,
    material: m.Material = m.BLACK_PLASTIC,
    pointer: m.Material = m.WHITE_PLASTIC,
    sides: int = ROUND_SIDES,
) -> None:
    """A knob before the front face at ``at``, turned clockwise; fingers hold its rim."""
    x, y, z = at
    name = f"knob_{sum(n.startswith('knob') for n in builder.links) + 1}"
    front, half = y - _GAP_M - depth, 0.12 * radius
    disc = lying_disc((0.88 * radius, radius), (front, y - _GAP_M), (x, z), sides)
    builder.add(material, disc, link=name, handle=True)
    mark = box((x - half, x + half), (front - _POINTER_M, front), (z, z + 0.85 * radius))
    builder.add(pointer, mark, link=name, handle=True)
    builder.knob(name, (x, y, z), (0, 1, 0), upper_rad, at=(x, front, z + 0.88 * radius))


def add_knob_row(
    builder: ModelBuilder,
    spans: Sequence[Bounds],
    y: float,
    z: float,
    counts: Sequence[int],
    radius: float,
    **look,
) -> None:
    """Knobs evenly along each span of a panel whose front is at ``y``; smaller where narrow."""
    for (x0, x1), count in zip(spans, counts, strict=True):
        step = (x1 - x0) / max(count, 1)
        for k in range(count):
            at = (round(x0 + (k + 0.5) * step, 4), y, z)
            add_knob(builder, at, min(radius, round(0.38 * step, 4)), **look)


def add_panel_with_display(
    builder: ModelBuilder, space: Space, material: m.Material, display: Bounds
) -> None:
    """A panel whose part between the ``display`` bounds along x is dark glass."""
    (x0, x1), y, z = space
    a, b = display
    rim = round(0.2 * (z[1] - z[0]), 4)
    inner = (z[0] + rim, z[1] - rim)
    builder.add(material, box((x0, a), y, z), box((b, x1), y, z))
    builder.add(material, box((a, b), y, (z[0], inner[0])), box((a, b), y, (inner[1], z[1])))
    builder.add(m.SCREEN, box((a, b), y, inner))
