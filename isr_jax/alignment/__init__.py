"""Alignment (Sec. V-C): shortlist -> scale, yaw, translation and error of every candidate."""

from ..runtime.stage import Stage
from ..types import Alignments
from .builders import problem_of, surfaces_of
from .error import SurfacePairs, alignment_error, alignment_errors
from .problem import AlignmentProblem, AlignmentSolution, AlignmentWeights, default_start
from .shortlists import align_shortlists
from .solve import align

VERSION: int = 7
"""Changes when the results of this stage do."""
STAGE = Stage("alignment", VERSION, Alignments, ("alignment", "support"))

__all__ = [
    "STAGE",
    "VERSION",
    "AlignmentProblem",
    "AlignmentSolution",
    "AlignmentWeights",
    "SurfacePairs",
    "align",
    "align_shortlists",
    "alignment_error",
    "alignment_errors",
    "default_start",
    "problem_of",
    "surfaces_of",
]
