"""Posed RGB-D sequences and annotated scans: readers, the world frame, what `isr inspect` finds."""

from .annotated_mesh import AnnotatedBox, AnnotatedInstance, AnnotatedMesh
from .annotation_truth import truth_from_annotation
from .conventions import CONVENTIONS
from .inspection import ConventionScore, InspectReport, inspect_sequence
from .layouts import detect_format
from .prefetching import prefetch
from .scannet_truth import read_scannet_truth
from .scenenn_truth import read_scenenn_truth
from .sequence import RecordedSequence, open_sequence

VERSION: int = 1

__all__ = [
    "CONVENTIONS",
    "VERSION",
    "AnnotatedBox",
    "AnnotatedInstance",
    "AnnotatedMesh",
    "ConventionScore",
    "InspectReport",
    "RecordedSequence",
    "detect_format",
    "inspect_sequence",
    "open_sequence",
    "prefetch",
    "read_scannet_truth",
    "read_scenenn_truth",
    "truth_from_annotation",
]
