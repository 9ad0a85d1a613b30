"""Alignment (Sec. V-C): shortlist -> scale, yaw, translation and error of every candidate."""

from .error import PointSets, Surfaces, alignment_error, alignment_errors
from .problem import AlignmentProblem, AlignmentSolution, AlignmentWeights, default_start
from .shortlists import align_shortlists
from .solve import align

VERSION: int = 6
"""Changes when the results of this stage do."""

__all__ = [
    "VERSION",
    "AlignmentProblem",
    "AlignmentSolution",
    "AlignmentWeights",
    "PointSets",
    "Surfaces",
    "align",
    "align_shortlists",
    "alignment_error",
    "alignment_errors",
    "default_start",
]
