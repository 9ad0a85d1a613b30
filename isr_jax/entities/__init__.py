"""Entities: the surface of a panoptic map cut into things and layout, with boxes and planes."""

from .extract import extract_entities
from .rectangles import facing_direction, gravity_box

VERSION: int = 4

__all__ = ["VERSION", "extract_entities", "facing_direction", "gravity_box"]
