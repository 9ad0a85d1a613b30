"""Synthetic rooms: a furnished room from a seed, its RGB-D sequence, and the truth about it."""

from ..config import NoiseModel
from .film.render import render_sequence
from .furnishing.furnish import builtin_room, make_room
from .image.noise import NO_NOISE
from .room import LayoutPatch, PlacedModel, Room
from .truth import true_entities, true_graph, true_placements, truth_scene
from .truth_files import write_truth

VERSION: int = 3

__all__ = [
    "NO_NOISE",
    "VERSION",
    "LayoutPatch",
    "NoiseModel",
    "PlacedModel",
    "Room",
    "builtin_room",
    "make_room",
    "render_sequence",
    "true_entities",
    "true_graph",
    "true_placements",
    "truth_scene",
    "write_truth",
]
