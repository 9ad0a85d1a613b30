"""Frame to segments: masks from a segmenter, segments from depth, and their fusion."""

from .boxes_semantics import BoxesAndSemantics
from .depth_segments import segment_depth
from .file_masks import FileMasks
from .fusion import label_segments, segment_frame
from .onnx_model import OnnxModel
from .open_segmenter import open_segmenter
from .segmenter import Segmenter
from .sidecar import Sidecar, find_sidecar
from .simulated import LEVELS, NoiseRates, SimulatedSegmenter

VERSION: int = 1

__all__ = [
    "LEVELS",
    "VERSION",
    "BoxesAndSemantics",
    "FileMasks",
    "NoiseRates",
    "OnnxModel",
    "Segmenter",
    "Sidecar",
    "SimulatedSegmenter",
    "find_sidecar",
    "label_segments",
    "open_segmenter",
    "segment_depth",
    "segment_frame",
]
