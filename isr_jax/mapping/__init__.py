"""Panoptic mapping: posed frames and their segments to one sparse voxel map (paper, sec. IV)."""

from ..runtime.stage import Stage
from ..types import MappingResult
from .map_batch import MapBatch
from .mapper import PanopticMapper

VERSION: int = 3
STAGE = Stage("mapping", VERSION, MappingResult, ("mapping", "input", "segmentation"))

__all__ = ["STAGE", "VERSION", "MapBatch", "PanopticMapper"]
