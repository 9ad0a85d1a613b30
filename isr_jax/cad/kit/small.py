"""Cups, books and bins.

Mugs hold 0.2 to 0.4 l: 80 to 105 mm high, 75 to 95 mm wide, walls of 4 mm; paper is A5 to A4
(ISO 216) in blocks of 10 to 45 mm; waste bins hold 8 to 40 l.
"""

from __future__ import annotations

import numpy as np

from ...cad_types import CadModel
from . import materials as m
from .builder import ModelBuilder
from .solids import box, circle, frustum, tapered_box, tube


def cup(
    name: str,
    height: float = 0.095,
    rim: float = 0.041,
    foot: float = 0.041,
    *,
    wall: float = 0.004,
    bottom: float = 0.005,
    handle: bool = True,
    material: m.Material = m.CERAMIC,
) -> CadModel:
    """A hollow cup, ``rim`` and ``foot`` its outer radii above and below; handle at +x."""
    builder = ModelBuilder("cup", name, symmetry=1 if handle else 0)

    def radius(z: float) -> float:
        return foot + (rim - foot) * z / height

    builder.add(material, frustum((foot, radius(bottom)), (0.0, bottom)))
    outer = np.stack([circle(radius(bottom)), circle(rim)])
    inner = np.stack([circle(radius(bottom) - wall), circle(rim - wall)])
    builder.add(material, *tube(outer, inner, (bottom, height), is_round=True))
    if handle:
        r, heights = 0.0045, (0.25 * height, 0.8 * height)
        end = round(max(radius(z) for z in heights) + 0.024, 4)
        bar = box((end, end + 0.007), (-r, r), (heights[0] - r, heights[1] + r))
        builder.add(material, bar, handle=True)
        for z in heights:
            start = np.ceil(1e4 * max(radius(z - r), radius(z + r))) / 1e4
            builder.add(material, box((start, end), (-r, r), (z - r, z + r)), handle=True)
    return builder.build()


def round_bin(
    name: str,
    height: float,
    rim: float,
    foot: float,
    *,
    wall: float = 0.003,
    material: m.Material = m.PLASTIC,
) -> CadModel:
    """An open, round, tapered bin."""
    builder = ModelBuilder("bin", name, symmetry=0)
    floor = 0.004
    base = foot + (rim - foot) * floor / height
    builder.add(material, frustum((foot, base), (0.0, floor)))
    outer = np.stack([circle(base), circle(rim)])
    inner = np.stack([circle(base - wall), circle(rim - wall)])
    builder.add(material, *tube(outer, inner, (floor, height), is_round=True))
    return builder.build()


def square_bin(
    name: str,
    width: float,
    depth: float,
    height: float,
    *,
    taper: float = 0.85,
    wall: float = 0.004,
    material: m.Material = m.PLASTIC,
) -> CadModel:
    """An open bin with four walls; its foot is ``taper`` times as wide as its rim."""
    builder = ModelBuilder("bin", name, symmetry=4 if width == depth else 2)
    floor = 0.005

    def outline(z: float, inset: float) -> np.ndarray:
        grow = taper + (1 - taper) * z / height
        x, y = width / 2 * grow - inset, depth / 2 * grow - inset
        return np.round([(-x, -y), (x, -y), (x, y), (-x, y)], 6)

    def bounds(z: float) -> tuple[float, float, float, float]:
        (x0, y0), _, (x1, y1), _ = outline(z, 0.0).tolist()
        return x0, x1, y0, y1

    builder.add(material, tapered_box(bounds(0.0), bounds(floor), (0.0, floor)))
    outer = np.stack([outline(floor, 0.0), outline(height, 0.0)])
    inner = np.stack([outline(floor, wall), outline(height, wall)])
    builder.add(material, *tube(outer, inner, (floor, height)))
    return builder.build()


def book(
    name: str,
    width: float,
    depth: float,
    thickness: float,
    *,
    cover: m.Material = m.RED_COVER,
    board: float = 0.0025,
) -> CadModel:
    """A closed book that lies on its back: spine at -x, text readable from -y."""
    builder = ModelBuilder("book", name, symmetry=1)
    x, y = width / 2, depth / 2
    builder.add(cover, box((-x, x), (-y, y), (0.0, board)))
    builder.add(cover, box((-x, x), (-y, y), (thickness - board, thickness)))
    builder.add(cover, box((-x, -x + board), (-y, y), (board, thickness - board)))
    page = (-x + board, x - 0.003)
    builder.add(m.PAPER, box(page, (-y + 0.003, y - 0.003), (board, thickness - board)))
    return builder.build()
