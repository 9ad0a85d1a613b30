"""CAD models by code: each a function of a few named dimensions that returns a `CadModel`."""

from .appliances import Compartment, fridge, microwave, monitor
from .beds import bed, divan
from .builder import ModelBuilder
from .catalogue import KIT, make
from .fronts import Column, Front, Look
from .seats import office_chair, shell_chair, sofa, wooden_chair
from .small import book, cup, round_bin, square_bin
from .storage import bookshelf, cabinet, counter, wall_cabinet
from .tables import (
    frame_desk,
    panel_desk,
    pedestal_desk,
    rectangular_table,
    round_table,
    tapered_leg_table,
    trestle_table,
)

__all__ = [
    "KIT",
    "Column",
    "Compartment",
    "Front",
    "Look",
    "ModelBuilder",
    "bed",
    "book",
    "bookshelf",
    "cabinet",
    "counter",
    "cup",
    "divan",
    "frame_desk",
    "fridge",
    "make",
    "microwave",
    "monitor",
    "office_chair",
    "panel_desk",
    "pedestal_desk",
    "rectangular_table",
    "round_bin",
    "round_table",
    "shell_chair",
    "sofa",
    "square_bin",
    "tapered_leg_table",
    "trestle_table",
    "wall_cabinet",
    "wooden_chair",
]
