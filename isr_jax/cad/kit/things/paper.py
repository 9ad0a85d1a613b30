"""Books: paper is A5 to A4 (ISO 216) in blocks of 10 to 45 mm between boards of 2 to 3 mm."""

from __future__ import annotations

from .. import materials as m
from ..builder import ModelBuilder
from ..solids import box


def book(
    width: float,
    depth: float,
    height: float,
    *,
    cover: m.Material = m.RED_COVER,
    board: float = 0.0025,
) -> ModelBuilder:
    """A closed book that lies on its back: spine at -x, text readable from -y."""
    builder = ModelBuilder("book", symmetry=1)
    x, y = width / 2, depth / 2
    builder.add(cover, box((-x, x), (-y, y), (0.0, board)))
    builder.add(cover, box((-x, x), (-y, y), (height - board, height)))
    builder.add(cover, box((-x, -x + board), (-y, y), (board, height - board)))
    page = (-x + board, x - 0.003)
    builder.add(m.PAPER, box(page, (-y + 0.003, y - 0.003), (board, height - board)))
    return builder
