"""`evaluate`: a results folder against a truth folder."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from ..scene_file import CadRecord, EntityRecord
from ..types import Box
from .boxes import average_precision, box_iou_matrix
from .cad_alignment import AlignmentLimits, CadPose, score_cads
from .labels import REACH_M, Transfer, transfer
from .report import (
    BoxScores,
    CadRow,
    CadScores,
    EvaluationReport,
    Match,
    SurfaceScores,
)
from .result_files import Result, Truth, moved_box, read_result, read_truth
from .segments import compare_segments, match_entities, observed_ids, panoptic_scores
from .supports import score_supports


def evaluate(
    result_dir: str | Path,
    truth_dir: str | Path,
    *,
    symmetry: Mapping[str, int] | None = None,
    model_size: Mapping[str, Sequence[float]] | None = None,
    unrefined: Mapping[str, Box] | None = None,
    limits: AlignmentLimits | None = None,
) -> EvaluationReport:
    """Score a reconstructed scene; both folders are brought to the truth's world first.

    Only what the camera saw is asked for: `EvaluationReport.unseen` names the rest.

    Args:
        result_dir: Written by `isr run`: ``scene.json`` and ``map/panoptic.ply``.
        truth_dir: ``scene.json`` and ``observed.npz``.
        symmetry: Order of symmetry about z by model id (0 = round); 1 where it is not given.
        model_size: Unscaled box by model id, metres. Without it, sizes of a model other than the
            true one are taken from the entities' boxes, and the row says so.
        unrefined: Boxes by entity name before supports refined them, for mAP beside mAP_re.
        limits: Of the CAD alignment accuracy.
    """
    truth = read_truth(Path(truth_dir))
    result = read_result(Path(result_dir), truth)
    near = transfer(truth.points, result.points)
    quality, true, predicted = compare_segments(truth, result, near)
    matches = match_entities(truth, result, quality, true, predicted)
    seen = observed_ids(truth)
    return EvaluationReport(
        panoptic=panoptic_scores(quality),
        boxes=score_boxes(truth, result, None),
        unrefined_boxes=None if unrefined is None else score_boxes(truth, result, unrefined),
        supports=score_supports(truth.scene, result.scene, matches),
        cad=_score_cads(
            truth, result, matches, symmetry or {}, model_size or {}, limits or AlignmentLimits()
        ),
        surface=score_surface(near),
        matches=matches,
        unseen=tuple(e.name for e in truth.scene.entities if e.id not in seen),
    )


def score_boxes(truth: Truth, result: Result, replaced: Mapping[str, Box] | None) -> BoxScores:
    """AP of things a class at IoU 0.5 and 0.25; the score of a prediction is its vertex count."""
    seen = observed_ids(truth)
    things = [e for e in truth.scene.entities if e.type != "layout" and e.id in seen]
    predicted = [e for e in result.scene.entities if e.type != "layout"]
    counts = np.bincount(result.instance) if len(result.instance) else np.zeros(1, int)
    ap: dict[str, tuple[float, float]] = {}
    for name in sorted({e.class_name for e in things}):
        true = [e.box for e in things if e.class_name == name]
        of_class = [e for e in predicted if e.class_name == name]
        boxes = [
            moved_box((replaced or {}).get(e.name, e.box), result.T_truth_result) for e in of_class
        ]
        score = np.array([counts[e.id] if e.id < len(counts) else 0 for e in of_class], float)
        iou = box_iou_matrix(boxes, true)
        ap[name] = average_precision(iou, score, 0.5), average_precision(iou, score, 0.25)
    return BoxScores.over(ap)


def _score_cads(
    truth: Truth,
    result: Result,
    matches: tuple[Match, ...],
    symmetry: Mapping[str, int],
    model_size: Mapping[str, Sequence[float]],
    limits: AlignmentLimits,
) -> CadScores:
    rows = []
    for match in matches:
        true = truth.scene.entity(match.truth)
        if true.cad is None:
            continue
        found = None if match.predicted is None else result.scene.entity(match.predicted)
        if found is None or found.cad is None:
            reason = "not found" if found is None else f"no model: {found.reason}"
            rows.append(CadRow(true.name, true.class_name, true.cad.id, None, None, reason, ""))
            continue
        sizes, source = _sizes(true, found, model_size)
        errors = score_cads(
            _pose(true.cad, sizes[0], np.eye(4)),
            _pose(found.cad, sizes[1], result.T_truth_result),
            symmetry.get(true.cad.id, 1),
            limits,
        )
        rows.append(
            CadRow(true.name, true.class_name, true.cad.id, found.cad.id, errors, "", source)
        )
    return CadScores.over(tuple(rows), limits)


def _pose(cad: CadRecord, size: np.ndarray, T: np.ndarray) -> CadPose:
    moved = T @ np.asarray(cad.T_world_cad, np.float64)
    return CadPose(cad.id, moved[:3, :3], moved[:3, 3], size)


def _sizes(
    true: EntityRecord, found: EntityRecord, model_size: Mapping[str, Sequence[float]]
) -> tuple[tuple[np.ndarray, np.ndarray], str]:
    """Scaled sizes of both models along their own axes, and where they come from."""
    a, b = true.cad, found.cad
    assert a is not None and b is not None
    if a.id in model_size and b.id in model_size:
        return (a.scale * np.array(model_size[a.id]), b.scale * np.array(model_size[b.id])), "model"
    if a.id == b.id:
        return (np.asarray(a.scale), np.asarray(b.scale)), "scale of the same model"
    return (_box_in_model(true, a), _box_in_model(found, b)), "boxes of the entities"


def _box_in_model(entity: EntityRecord, cad: CadRecord) -> np.ndarray:
    """Size of the entity's box along the axes of the model, whose turns are near multiples of 90
    degrees from it."""
    yaw = float(entity.box.yaw)
    c, s = np.cos(yaw), np.sin(yaw)
    R = np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]]) @ np.asarray(cad.T_world_cad)[:3, :3]
    return np.asarray(entity.box.size)[np.argmax(np.abs(R), axis=0)]


def score_surface(near: Transfer) -> SurfaceScores:
    """Accuracy of the map's surface, and how much of the seen surface it holds."""
    to_truth = near.to_truth_m
    if len(to_truth) == 0:
        return SurfaceScores(None, None, 0.0, 0.0)
    return SurfaceScores(
        float(np.median(to_truth)),
        float(np.percentile(to_truth, 90)),
        float(np.mean(to_truth <= REACH_M)),
        float(np.mean(near.nearest >= 0)),
    )
