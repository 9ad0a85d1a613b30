"""Figures that others published, as a table of this repository, so that ours stand beside them."""

from .figures import (
    MEAN,
    PAPER,
    PAPER_VOXBLOX,
    POOLED,
    RELEASED,
    PublishedFigure,
    read_published,
    write_published,
)

__all__ = [
    "MEAN",
    "PAPER",
    "PAPER_VOXBLOX",
    "POOLED",
    "RELEASED",
    "PublishedFigure",
    "read_published",
    "write_published",
]
