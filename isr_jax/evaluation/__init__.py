"""Scores of a result against the truth: panoptic quality, instances, boxes, contact graph, CAD
alignment, surface."""

from .average_precision import PrecisionRecall, average_precision, precision_recall
from .boxes import BoxRow, BoxScores, box_iou_matrix
from .cad_alignment import AlignmentLimits, CadPose, rotation_error_rad, score_cads
from .cad_scores import CadRow, CadScores
from .chamfer import ChamferRow, ChamferScores
from .equivalence import EquivalenceRow, EquivalenceScores, PartDetails
from .graph_scores import AttachmentScores, EdgeScores
from .instances import InstanceRow, InstanceScores
from .matches import Match
from .panoptic import (
    ClassQuality,
    PanopticQuality,
    PanopticScores,
    contingency,
    panoptic_quality,
)
from .released_counting import ReleasedCounting
from .replacement import ReplacementScores
from .report import EvaluationReport
from .retrieval import RetrievalRow, RetrievalScores
from .scan2cad import AlignmentAccuracy, PosedCad, Scan2CadScores, score_scan2cad
from .stage import evaluate
from .standing import SetStanding, StandingScores
from .support_planes import SupportPlaneRow, SupportPlaneScores
from .surface_scores import SurfaceRate, SurfaceScores

VERSION: int = 2

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
