"""`evaluate`: a results folder against a truth folder."""

from __future__ import annotations

from pathlib import Path

from ..config import SupportSettings
from ..library import CadLibrary
from .graphs.graph_scores import score_attachments, score_proximal, score_supports
from .graphs.support_planes import score_support_planes
from .maps.boxes import BoxScores, score_boxes
from .maps.instances import score_instances
from .maps.labels import transfer
from .maps.panoptic import panoptic_scores
from .maps.released_counting import score_released_counting
from .maps.segments import compare_segments, observed_ids
from .maps.surface_scores import score_surface
from .matches import match_entities
from .models.cad_alignment import AlignmentLimits
from .models.cad_scores import score_cad_scene
from .models.replacement import score_replacement
from .report import EvaluationReport
from .result_files import Result, Truth, read_result, read_truth, support_of
from .standing import read_standing


def evaluate(
    result_dir: str | Path,
    truth_dir: str | Path,
    *,
    library: CadLibrary | None = None,
    truth_library: CadLibrary | None = None,
    limits: AlignmentLimits | None = None,
    support: SupportSettings | None = None,
    released_counting: bool = False,
) -> EvaluationReport:
    """Score a reconstructed scene; both folders are brought to the truth's world first.

    Only what the camera saw is asked for: `EvaluationReport.unseen` names the rest.

    Args:
        result_dir: Written by `isr run`: ``scene.json`` and ``map/panoptic.ply``.
        truth_dir: ``scene.json``, ``observed.npz``, and ``meshes/`` for the surface's accuracy.
        library: The models of the result. Without them, sizes of a model other than the true one
            are taken from the entities' boxes, and the row says so.
        truth_library: The models of the truth; by default the same. Without any, models have no
            symmetry.
        limits: Of the CAD alignment accuracy.
        support: Which planes may carry something (a_th), in both scenes. By default as in the run
            that is scored, from its scene.json; give one for all where runs are compared that
            differ in it.
        released_counting: Also count as the released code does, for comparison only.

    Raises:
        SceneError: a file is missing or damaged, or a model is in no library.
        SettingError: the support settings of the run are not what they should be.
    """
    truth_library = library if truth_library is None else truth_library
    truth = read_truth(Path(truth_dir))
    result = read_result(Path(result_dir), truth)
    compared = compare_segments(truth, result, transfer(truth.points, result.points))
    matches = match_entities(truth, result, compared)
    seen = observed_ids(truth)
    limits = limits or AlignmentLimits()
    support = support or support_of(result.scene)
    replacement = None
    if library is not None and truth_library is not None:
        replacement = score_replacement(
            truth, result, matches, library, truth_library, limits, support
        )
    return EvaluationReport(
        panoptic=panoptic_scores(compared.quality),
        instances=score_instances(compared),
        boxes=score_boxes(truth, result),
        observed_boxes=_score_observed_boxes(truth, result),
        supports=score_supports(truth.scene, result.scene, matches),
        proximal=score_proximal(truth.scene, result.scene, matches),
        attachments=score_attachments(truth.scene, result.scene, matches),
        support_planes=score_support_planes(truth, result, matches),
        cad=score_cad_scene(truth, result, matches, library, truth_library, limits),
        replacement=replacement,
        standing=read_standing(Path(result_dir)),
        surface=score_surface(truth, result),
        matches=matches,
        unseen=tuple(e.name for e in truth.scene.entities if e.id not in seen),
        released_counting=score_released_counting(truth, result) if released_counting else None,
    )


def _score_observed_boxes(truth: Truth, result: Result) -> BoxScores | None:
    """None where the result keeps no boxes but those that supports refined."""
    if all(entity.observed_box is None for entity in result.scene.entities):
        return None
    return score_boxes(truth, result, observed=True)
