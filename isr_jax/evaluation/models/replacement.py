"""How well CAD models replace what stands in the room: retrieval, alignment, surface, function."""

from __future__ import annotations

import dataclasses

from rich.table import Table

from ...config import DEFAULT_SUPPORT, SupportSettings
from ...library import CadLibrary
from ..figures import Headline, millimetres, percent
from ..matches import Match
from ..result_files import Result, Truth
from .cad_alignment import AlignmentLimits
from .cad_cases import PosedModel, cad_cases, posed_model
from .chamfer import ChamferRow, ChamferScores, mean_distance_m
from .equivalence import EquivalenceScores, score_equivalence
from .retrieval import RetrievalScores, score_retrieval
from .scan2cad import PosedCad, Scan2CadScores, score_scan2cad


@dataclasses.dataclass(frozen=True)
class ReplacementScores:
    """Measures that read the models themselves."""

    retrieval: RetrievalScores
    scan2cad: Scan2CadScores
    chamfer: ChamferScores
    equivalence: EquivalenceScores

    def headline(self) -> Headline:
        r, s, c = self.retrieval, self.scan2cad, self.chamfer
        return (
            ("retrieval within 2 cm, top-1 / top-10", percent(r.top1, r.top10)),
            ("  of the things found", percent(r.top1_of_found, r.top10_of_found)),
            ("  within 2 % of the diagonal", percent(r.top1_relative, r.top10_relative)),
            ("Scan2CAD strict: instances / classes", percent(s.strict.instances, s.strict.classes)),
            ("  official counting", percent(s.official.instances, s.official.classes)),
            (
                "AE / Chamfer to the true model, median",
                millimetres(c.alignment_error_median_m, c.two_way_median_m),
            ),
            *self.equivalence.headline(),
        )

    def table(self) -> Table:
        """One row per true model: retrieval, distance, and the parts of its equivalence."""
        parts_of_score = ("relations", "affordance", "geometry", "appearance", "score")
        table = Table("true entity", "model", "hit rank", "Chamfer", *parts_of_score)
        for r, e in zip(self.retrieval.rows, self.equivalence.rows, strict=True):
            parts = (e.relations, e.affordance, e.geometry, e.appearance, e.score)
            rank = "-" if r.rank is None else str(r.rank)
            table.add_row(
                r.truth, r.id or "-", rank, millimetres(r.placed_m), *(percent(p) for p in parts)
            )
        return table


def score_replacement(
    truth: Truth,
    result: Result,
    matches: tuple[Match, ...],
    library: CadLibrary,
    truth_library: CadLibrary,
    limits: AlignmentLimits,
    support: SupportSettings = DEFAULT_SUPPORT,
) -> ReplacementScores:
    """All measures of CAD replacement.

    Args:
        truth: What is there.
        result: What was reconstructed.
        matches: Which predicted entity stands for which seen true thing.
        library: The result's models.
        truth_library: The room's models.
        limits: Of alignment accuracy.
        support: Which planes may carry (a_th).

    Raises:
        SceneError: a model is in neither library.
    """
    cases = cad_cases(truth, result, matches, library, truth_library)
    seen = [_posed_cad(case.true_model) for case in cases]
    placed = [
        _posed_cad(posed_model(e.cad, library, result.T_truth_result))
        for e in result.scene.entities
        if e.cad is not None
    ]
    return ReplacementScores(
        retrieval=score_retrieval(cases, library),
        scan2cad=score_scan2cad(seen, placed, limits),
        chamfer=ChamferScores.over(tuple(row for case in cases for row in _chamfer_rows(case))),
        equivalence=score_equivalence(truth, result, matches, cases, support),
    )


def _posed_cad(posed: PosedModel) -> PosedCad:
    model = posed.model
    return PosedCad(
        model.id,
        model.class_name,
        posed.rotation,
        posed.center,
        posed.scale,
        posed.size,
        model.symmetry,
    )


def _chamfer_rows(case) -> list[ChamferRow]:
    """One row where a model stands, else none."""
    if case.placed is None or case.distance is None:
        return []
    return [
        ChamferRow(
            truth=case.true.name,
            class_name=case.true.class_name,
            id=case.placed.model.id,
            alignment_error_m=case.found.cad.alignment_error_m,
            seen_to_placed_m=mean_distance_m(case.seen_points, case.placed.surface),
            true_to_placed_m=case.distance.forward_m,
            placed_to_true_m=case.distance.backward_m,
            two_way_m=case.distance.two_way_m,
        )
    ]
