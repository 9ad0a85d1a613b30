"""What hands meet on furniture: the panels of doors and fronts, and their handles.

Frames of doors are 50 to 70 mm wide and 18 to 22 mm thick, panes 4 mm of glass, fillings 8 mm
(makers' catalogues); bar handles are 12 mm thick and stand out 35 mm, knobs 26 mm.
"""

from __future__ import annotations

from typing import Literal

import numpy as np

from .. import materials as m
from ..builder import BASE, ModelBuilder
from ..solids import box, circle, prism

Bounds = tuple[float, float]
Space = tuple[Bounds, Bounds, Bounds]
PanelKind = Literal["slab", "frame", "glass", "slats"]
Grip = Literal["bar", "knob", "none"]
_FRAME_M = 0.055
_PANE_M = {"frame": 0.008, "glass": 0.004}
_KNOB_M = 0.014


def add_panel(
    builder: ModelBuilder, space: Space, material: m.Material, kind: PanelKind, link: str = BASE
) -> None:
    """A front: a plain board, a frame around a thinner board or a pane, or slats in a frame.

    What is too small for a frame is a plain board.
    """
    (x0, x1), y, (z0, z1) = space
    rim = min(_FRAME_M, round(0.2 * min(x1 - x0, z1 - z0), 3))
    if kind == "slab" or rim < 0.03:
        builder.add(material, box(*space), link=link)
        return
    inner = (x0 + rim, x1 - rim)
    for upright in ((x0, x0 + rim), (x1 - rim, x1)):
        builder.add(material, box(upright, y, (z0, z1)), link=link)
    for rail in ((z0, z0 + rim), (z1 - rim, z1)):
        builder.add(material, box(inner, y, rail), link=link)
    opening = (z0 + rim, z1 - rim)
    if kind == "slats":
        _add_slats(builder, (inner, y, opening), material, link)
        return
    half, middle = _PANE_M[kind] / 2, (y[0] + y[1]) / 2
    filling = m.GLASS if kind == "glass" else material
    builder.add(filling, box(inner, (middle - half, middle + half), opening), link=link)


def _add_slats(builder: ModelBuilder, space: Space, material: m.Material, link: str) -> None:
    """Level boards that touch one another, every other one set back: louvres, closed."""
    x, (y0, y1), (z0, z1) = space
    count = max(2, round((z1 - z0) / 0.08))
    edges = [round(float(v), 4) for v in np.linspace(z0, z1, 2 * count + 1)]
    for k in range(2 * count):
        back = 0.004 if k % 2 else 0.01
        board = box(x, (y0 + back, y1 - 0.002), (edges[k], edges[k + 1]))
        builder.add(material, board, link=link)


def add_grip(
    builder: ModelBuilder,
    grip: Grip,
    at: tuple[float, float, float],
    length: float,
    upright: bool,
    link: str,
    material: m.Material = m.STEEL,
) -> None:
    """A handle of the given kind before the front face at ``at``."""
    if grip == "bar":
        add_bar_handle(builder, at, length, upright=upright, link=link, material=material)
    elif grip == "knob":
        x, y, z = at
        for radius, depth in ((0.6 * _KNOB_M, (y - 0.012, y)), (_KNOB_M, (y - 0.026, y - 0.012))):
            disc = prism(circle(radius, 8, (z, x)), "y", depth)
            builder.add(material, disc, link=link, handle=True)


def add_bar_handle(
    builder: ModelBuilder,
    at: tuple[float, float, float],
    length: float,
    *,
    upright: bool,
    link: str = BASE,
    material: m.Material = m.STEEL,
    thickness: float = 0.012,
    reach: float = 0.035,
) -> None:
    """A bar on two studs before the front face at ``at``; fingers fit behind it."""
    x, y, z = at
    half, r = length / 2, thickness / 2

    def piece(a: float, b: float, depth: Bounds) -> None:
        across, along = (-r, r), (a, b)
        dx, dz = (across, along) if upright else (along, across)
        shape = box((x + dx[0], x + dx[1]), depth, (z + dz[0], z + dz[1]))
        builder.add(material, shape, link=link, handle=True)

    bar = (y - reach, y - reach + thickness)
    piece(-half, half, bar)
    studs = (bar[1], y)
    piece(-half, -half + thickness, studs)
    piece(half - thickness, half, studs)
