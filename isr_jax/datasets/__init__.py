"""Posed RGB-D sequences: readers, the world frame, and what `isr inspect` finds."""

from .conventions import CONVENTIONS
from .inspection import ConventionScore, InspectReport, inspect_sequence
from .layouts import detect_format
from .prefetching import prefetch
from .sequence import RecordedSequence, open_sequence

VERSION: int = 1

__all__ = [
    "CONVENTIONS",
    "VERSION",
    "ConventionScore",
    "InspectReport",
    "RecordedSequence",
    "detect_format",
    "inspect_sequence",
    "open_sequence",
    "prefetch",
]
