"""Entities: the surface of a panoptic map cut into things and layout, with boxes and planes."""

from ..runtime.stage import Stage
from ..types import Entities
from .extract import extract_entities, extract_scenes
from .instances import thing_box
from .rectangles import facing_direction, gravity_box

VERSION: int = 4
STAGE = Stage("entities", VERSION, Entities, ("entities",))

__all__ = [
    "STAGE",
    "VERSION",
    "extract_entities",
    "extract_scenes",
    "facing_direction",
    "gravity_box",
    "thing_box",
]
