"""Alignment (Sec. V-C): shortlist -> scale, yaw, translation and error of every candidate."""

from ..runtime.stage import Stage
from ..types import Alignments
from .error import PointSets, Surfaces, alignment_error, alignment_errors
from .problem import AlignmentProblem, AlignmentSolution, AlignmentWeights, default_start
from .shortlists import align_shortlists
from .solve import align

VERSION: int = 6
"""Changes when the results of this stage do."""
STAGE = Stage("alignment", VERSION, Alignments, ("alignment",))

__all__ = [
    "STAGE",
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
