"""Scores of the placed models: each against the model that truly stands there."""

from __future__ import annotations

import dataclasses

import numpy as np
from rich.table import Table

from ...library import CadLibrary
from ...scene_file import CadRecord, EntityRecord
from ..figures import Headline, mean, median, percent
from ..matches import Match
from ..result_files import Result, Truth
from .cad_alignment import AlignmentLimits, CadErrors, CadPose, score_cads


@dataclasses.dataclass(frozen=True)
class CadRow:
    """One true CAD and what stands for it."""

    truth: str
    class_name: str
    true_id: str
    id: str | None
    errors: CadErrors | None
    reason: str
    """Why there is nothing to compare; empty otherwise."""
    size_source: str
    """Where the compared sizes come from."""


@dataclasses.dataclass(frozen=True)
class CadScores:
    """The model of every matched thing against the true one, thing by thing.

    What stands for a thing is found by its mask; Scan2CAD's measure pairs models by class and
    place instead (`Scan2CadScores`), and is the one of the headline.
    """

    accuracy: float | None
    """Share of the true CADs within all limits."""
    class_accuracy: float | None
    """The same, averaged over classes."""
    placed: float | None
    """Share for which any model stands."""
    same_model: float | None
    """Share for which the true model stands."""
    median_center_m: float | None
    median_rotation_deg: float | None
    median_size_ratio: float | None
    limits: AlignmentLimits
    rows: tuple[CadRow, ...]

    @staticmethod
    def over(rows: tuple[CadRow, ...], limits: AlignmentLimits) -> CadScores:
        """Average the rows."""
        names = sorted({row.class_name for row in rows})
        aligned = {c: [_aligned(r) for r in rows if r.class_name == c] for c in names}
        errors = [r.errors for r in rows if r.errors is not None]
        rotation_rad = median(e.rotation_rad for e in errors)
        return CadScores(
            mean(_aligned(r) for r in rows),
            mean(mean(v) or 0.0 for v in aligned.values()),
            mean(float(r.id is not None) for r in rows),
            mean(float(r.id == r.true_id) for r in rows),
            median(e.center_m for e in errors),
            None if rotation_rad is None else float(np.rad2deg(rotation_rad)),
            median(e.size_ratio for e in errors),
            limits,
            rows,
        )

    def headline(self) -> Headline:
        return (("CAD placed / same model", percent(self.placed, self.same_model)),)

    def table(self) -> Table:
        """One row per true model."""
        table = Table("true entity", "true model", "model", "centre", "rotation", "size", "aligned")
        for row in self.rows:
            e = row.errors
            if e is None:
                table.add_row(row.truth, row.true_id, row.reason, "", "", "", "no")
                continue
            table.add_row(
                row.truth,
                row.true_id,
                row.id,
                f"{e.center_m * 100:.1f} cm",
                f"{np.rad2deg(e.rotation_rad):.1f} deg",
                f"{e.size_ratio:.1%}",
                "yes" if e.aligned else "no",
            )
        return table


def _aligned(row: CadRow) -> float:
    return float(row.errors is not None and row.errors.aligned)


def score_cad_scene(
    truth: Truth,
    result: Result,
    matches: tuple[Match, ...],
    library: CadLibrary | None,
    truth_library: CadLibrary | None,
    limits: AlignmentLimits,
) -> CadScores:
    """Compare the model of every matched thing with the true one (libraries: see `evaluate`)."""
    true_models = {m.id: m for m in truth_library.models} if truth_library else {}
    size_of = {m.id: np.asarray(m.size) for m in library.models} if library else {}
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
        model = true_models.get(true.cad.id)
        true_size = None if model is None else np.asarray(model.size)
        sizes, source = _sizes(true, found, true_size, size_of.get(found.cad.id))
        errors = score_cads(
            _pose(true.cad, sizes[0], np.eye(4)),
            _pose(found.cad, sizes[1], result.T_truth_result),
            1 if model is None else model.symmetry,
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
    true: EntityRecord,
    found: EntityRecord,
    true_size: np.ndarray | None,
    found_size: np.ndarray | None,
) -> tuple[tuple[np.ndarray, np.ndarray], str]:
    """Scaled sizes of both models along their own axes, and where they come from."""
    a, b = true.cad, found.cad
    assert a is not None and b is not None
    if true_size is not None and found_size is not None:
        return (a.scale * true_size, b.scale * found_size), "model"
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
