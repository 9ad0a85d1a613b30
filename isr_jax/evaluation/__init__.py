"""Scores of a result against the truth: panoptic quality, supports, CAD alignment, boxes."""

from .boxes import average_precision, box_iou_matrix
from .cad_alignment import AlignmentLimits, CadPose, rotation_error_rad, score_cads
from .panoptic import PanopticQuality, contingency, panoptic_quality
from .report import (
    BoxScores,
    CadRow,
    CadScores,
    ClassQuality,
    EvaluationReport,
    Match,
    PanopticScores,
    SupportScores,
    SurfaceScores,
)
from .stage import evaluate

VERSION: int = 1

__all__ = [
    "VERSION",
    "AlignmentLimits",
    "BoxScores",
    "CadPose",
    "CadRow",
    "CadScores",
    "ClassQuality",
    "EvaluationReport",
    "Match",
    "PanopticQuality",
    "PanopticScores",
    "SupportScores",
    "SurfaceScores",
    "average_precision",
    "box_iou_matrix",
    "contingency",
    "evaluate",
    "panoptic_quality",
    "rotation_error_rad",
    "score_cads",
]
