"""Tables of panes, tubes and crossing legs, most of them small.

Side tables are 0.45 to 0.6 m high and 0.3 to 0.55 m wide, C-shaped ones reach over a sofa's seat
and are 0.55 to 0.65 m high (makers' catalogues); panes are 6 to 12 mm thick.
"""

from __future__ import annotations

import numpy as np

from .. import materials as m
from ..builder import ModelBuilder
from ..solids import between, box, prism


def glass_table(
    width: float,
    depth: float,
    height: float,
    *,
    top: float = 0.01,
    frame: m.Material = m.CHROME_TUBE,
    lower: bool = True,
) -> ModelBuilder:
    """A pane on a frame of tube, a second pane below."""
    builder = ModelBuilder("table", symmetry=4 if width == depth and not lower else 2)
    x, y, under, t = width / 2, depth / 2, height - top, 0.025
    builder.add(m.GLASS, box((-x, x), (-y, y), (under, height)))
    for sx in (-1, 1):
        for sy in (-1, 1):
            bx, by = between(sx * x, sx * (x - t)), between(sy * y, sy * (y - t))
            builder.add(frame, box(bx, by, (0.0, under)))
    levels = [under - t] + ([0.3 * height] if lower else [])
    for z in levels:
        span = (round(z, 4), round(z + t, 4))
        for side in (-1, 1):
            builder.add(frame, box((-x + t, x - t), between(side * y, side * (y - t)), span))
            builder.add(frame, box(between(side * x, side * (x - t)), (-y + t, y - t), span))
    if lower:
        z = round(0.3 * height + t, 4)
        builder.add(m.GLASS, box((-x + t, x - t), (-y, y), (z, z + 0.006)))
    return builder


def c_table(
    width: float,
    depth: float,
    height: float,
    *,
    material: m.Material = m.WALNUT,
    frame: m.Material = m.BLACK_TUBE,
) -> ModelBuilder:
    """A side table whose foot slides under a sofa: a top, one upright, and a foot below it."""
    builder = ModelBuilder("table", symmetry=1)
    x, y, top, t = width / 2, depth / 2, 0.02, 0.025
    under = height - top
    builder.add(material, box((-x, x), (-y, y), (under, height)))
    for side in (-1, 1):
        by = between(side * (y - 0.03), side * (y - 0.03 - t))
        builder.add(frame, box((-x + 0.01, x - 0.02), by, (0.0, t)), carries=False)
        builder.add(frame, box((x - 0.02 - t, x - 0.02), by, (t, under)))
    inner = (-y + 0.03 + t, y - 0.03 - t)
    builder.add(frame, box((x - 0.02 - t, x - 0.02), inner, (0.0, t)), carries=False)
    return builder


def folding_table(
    width: float,
    depth: float,
    height: float,
    *,
    material: m.Material = m.PINE,
    frame: m.Material | None = None,
) -> ModelBuilder:
    """A top on two pairs of crossing legs, as camping and butler's tables have."""
    builder = ModelBuilder("table", symmetry=2)
    x, y, top, leg, t = width / 2, depth / 2, 0.022, 0.035, 0.02
    under = height - top
    wood = frame or material
    builder.add(material, box((-x, x), (-y, y), (under, height)))
    for end in (-1, 1):
        for lean in (-1, 1):
            a = lean * (y - 0.03)
            low, high = sorted((a, a - lean * leg)), sorted((-a, -a + lean * leg))
            outline = [(low[0], 0.0), (low[1], 0.0), (high[1], under), (high[0], under)]
            # A half turn swaps the two legs of one end with those of the other.
            offset = 0.05 + (0.0 if lean * end > 0 else t + 0.004)
            span = between(end * (x - offset), end * (x - offset - t))
            builder.add(wood, prism(np.round(outline, 6), "x", span))
    bar = x - 0.05 - 2 * t - 0.004
    builder.add(wood, box((-bar, bar), (-0.015, 0.015), (under - 0.04, under)))
    return builder
