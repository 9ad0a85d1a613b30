"""Scores of a result against the truth: panoptic quality, instances, boxes, contact graph, CAD
alignment, surface."""

from .graphs.graph_scores import AttachmentScores, EdgeScores
from .graphs.support_planes import SupportPlaneRow, SupportPlaneScores
from .maps.average_precision import PrecisionRecall, average_precision, precision_recall
from .maps.boxes import BoxRow, BoxScores, box_iou_matrix
from .maps.instances import InstanceRow, InstanceScores
from .maps.panoptic import (
    ClassQuality,
    PanopticQuality,
    PanopticScores,
    contingency,
    panoptic_quality,
)
from .maps.released_counting import ReleasedCounting
from .maps.surface_scores import SurfaceRate, SurfaceScores
from .matches import Match
from .models.cad_alignment import AlignmentLimits, CadPose, rotation_error_rad, score_cads
from .models.cad_scores import CadRow, CadScores
from .models.chamfer import ChamferRow, ChamferScores
from .models.equivalence import EquivalenceRow, EquivalenceScores, PartDetails
from .models.replacement import ReplacementScores
from .models.retrieval import RetrievalRow, RetrievalScores
from .models.scan2cad import AlignmentAccuracy, PosedCad, Scan2CadScores, score_scan2cad
from .report import EvaluationReport
from .stage import evaluate
from .standing import SetStanding, StandingScores

VERSION: int = 4

__all__ = [
    "VERSION",
    "AlignmentAccuracy",
    "AlignmentLimits",
    "AttachmentScores",
    "BoxRow",
    "BoxScores",
    "CadPose",
    "CadRow",
    "CadScores",
    "ChamferRow",
    "ChamferScores",
    "ClassQuality",
    "EdgeScores",
    "EquivalenceRow",
    "EquivalenceScores",
    "EvaluationReport",
    "InstanceRow",
    "InstanceScores",
    "Match",
    "PanopticQuality",
    "PanopticScores",
    "PartDetails",
    "PosedCad",
    "PrecisionRecall",
    "ReleasedCounting",
    "ReplacementScores",
    "RetrievalRow",
    "RetrievalScores",
    "Scan2CadScores",
    "SetStanding",
    "StandingScores",
    "SupportPlaneRow",
    "SupportPlaneScores",
    "SurfaceRate",
    "SurfaceScores",
    "average_precision",
    "box_iou_matrix",
    "contingency",
    "evaluate",
    "panoptic_quality",
    "precision_recall",
    "rotation_error_rad",
    "score_cads",
    "score_scan2cad",
]
