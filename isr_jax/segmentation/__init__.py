"""Frame to segments: masks from a segmenter, segments from depth, and their fusion."""

from .boxes_semantics import BoxesAndSemantics
from .depth_segments import segment_depth
from .file_masks import FileMasks
from .fusion import label_segments, segment_frame
from .measured_rates import MeasuredRates, measured_rates
from .noise_rates import LEVELS, NoiseRates
from .onnx_model import OnnxModel
from .open_segmenter import open_segmenter
from .panoptic_model import PanopticModel
from .segmenter import BatchSegmenter, Segmenter
from .sidecar import Sidecar, find_sidecar
from .simulated import SimulatedSegmenter, TrueMasks
from .true_views import TrueViews, read_true_views

VERSION: int = 4

__all__ = [
    "LEVELS",
    "VERSION",
    "BatchSegmenter",
    "BoxesAndSemantics",
    "FileMasks",
    "MeasuredRates",
    "NoiseRates",
    "OnnxModel",
    "PanopticModel",
    "Segmenter",
    "Sidecar",
    "SimulatedSegmenter",
    "TrueMasks",
    "TrueViews",
    "find_sidecar",
    "label_segments",
    "measured_rates",
    "open_segmenter",
    "read_true_views",
    "segment_depth",
    "segment_frame",
]
