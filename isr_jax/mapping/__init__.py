"""Panoptic mapping: posed frames and their segments to one sparse voxel map (paper, sec. IV)."""

from .map_batch import MapBatch
from .mapper import PanopticMapper

VERSION: int = 2

__all__ = ["VERSION", "MapBatch", "PanopticMapper"]
