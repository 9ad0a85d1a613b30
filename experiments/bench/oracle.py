"""Runs that start from the truth of a stage, so that a loss is traced to its stage."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, TypeVar

import numpy as np

from isr_jax.config import Settings
from isr_jax.geometry import CUBE_ROTATIONS
from isr_jax.library import CadLibrary, CadModel
from isr_jax.runtime.reporter import Reporter
from isr_jax.runtime.stage import Stage
from isr_jax.runtime.stage_runner import StageRunner
from isr_jax.scene_file import CadRecord, EntityRecord
from isr_jax.types import (
    Alignments,
    AlignmentStatus,
    Entity,
    MappingResult,
    Placement,
    Shortlist,
)

from .truth_folder import TrueScene

NONE, MASKS = "none", "masks"
STAGES = ("mapping", "entities", "contact_graph", "matching", "alignment", "physical_check")
TRUTH_UP_TO = (MASKS, *STAGES)
"""What may be replaced by the truth, each with all before it."""
TRUE_MODELS = STAGES[STAGES.index("matching") :]
"""From here on the room's own models are given."""
_SAME_PLANE_M = 0.02
"""A plane of a true entity is that of its model whose rectangle's centre lies this near."""

T = TypeVar("T")


class TruthRunner(StageRunner):
    """Takes the truth for the stages that it is given, and computes the others."""

    def __init__(self, given: Mapping[str, Any], reporter: Reporter) -> None:
        super().__init__(reporter=reporter)
        self._given = given

    def run(
        self,
        settings: Settings,
        stage: Stage[T],
        compute: Callable[..., Sequence[T]],
        *inputs: Any,
    ) -> list[T]:
        """The truth of ``stage`` where there is one; see `StageRunner.run`."""
        if stage.name in self._given:
            self.reporter.stage(stage.name, True)
            return [self._given[stage.name]]
        return super().run(settings, stage, compute, *inputs)


def truth_of_stages(
    truth: TrueScene, library: CadLibrary, up_to: str, frames: int
) -> dict[str, Any]:
    """The true result of every stage up to one of `STAGES`.

    Args:
        truth: Of the room.
        library: For ``matching`` and what follows it holds the room's own models.
        up_to: The last stage that is replaced.
        frames: Of the film.
    """
    wanted = STAGES[: STAGES.index(up_to) + 1]
    given: dict[str, Any] = {
        "mapping": MappingResult(truth.surface, frames, ()),
        "entities": truth.entities,
        "contact_graph": truth.graph,
    }
    if "matching" in wanted:
        given["matching"] = true_shortlist(truth, library)
    if "alignment" in wanted:
        given["alignment"] = true_alignments(truth, given["matching"])
    if "physical_check" in wanted:
        # The shortlist stays: models that it names get their collision hulls.
        given["physical_check"] = tuple(map(_placement, truth.scene.entities))
    return {stage: given[stage] for stage in wanted}


def true_shortlist(truth: TrueScene, library: CadLibrary) -> Shortlist:
    """One candidate per entity that has a model: the true one, in its true rotation, D = 0."""
    rows = [(i, r.cad) for i, r in enumerate(truth.scene.entities) if r.cad is not None]
    models = [library.position(cad.id) for _, cad in rows]
    partners = [
        _partners(truth.entities[i], library[m], cad)
        for (i, cad), m in zip(rows, models, strict=True)
    ]
    width = max((len(p) for p in partners), default=0)
    wide = [np.pad(p, (0, width - len(p)), constant_values=-1) for p in partners]
    return Shortlist(
        entity=np.array([i for i, _ in rows], np.int32),
        model=np.array(models, np.int32),
        rotation=np.array([_rotation(truth.scene.entities[i], cad) for i, cad in rows], np.int32),
        error=np.zeros(len(rows), np.float32),
        plane_match=np.array(wide, np.int32).reshape(len(rows), width),
    )


def _rotation(record: EntityRecord, cad: CadRecord) -> int:
    """The row of `CUBE_ROTATIONS` nearest to the model's pose in its entity's box."""
    c, s = np.cos(float(record.box.yaw)), np.sin(float(record.box.yaw))
    in_box = np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]]) @ np.asarray(cad.T_world_cad)[:3, :3]
    return int(np.argmax(np.einsum("kij,ij->k", CUBE_ROTATIONS, in_box)))


def _partners(entity: Entity, model: CadModel, cad: CadRecord) -> np.ndarray:
    """The model's plane for each plane of a true entity; -1 where none lies there."""
    T = np.asarray(cad.T_world_cad, np.float64)
    centers = np.asarray(model.planes.corners, np.float64).mean(1) * np.asarray(cad.scale)
    centers, normals = centers @ T[:3, :3].T + T[:3, 3], model.planes.normal @ T[:3, :3].T
    ours = np.asarray(entity.planes.corners, np.float64).mean(1)
    apart = np.linalg.norm(ours[:, None] - centers[None], axis=2)
    apart += 1.0 - np.asarray(entity.planes.normal, np.float64) @ normals.T
    if apart.size == 0:
        return np.full(len(ours), -1)
    best = apart.argmin(1)
    return np.where(apart.min(1) < _SAME_PLANE_M, best, -1)


def true_alignments(truth: TrueScene, shortlist: Shortlist) -> Alignments:
    """The true poses of the rows of `true_shortlist`, with an alignment error of 0."""
    cads = [r.cad for r in truth.scene.entities if r.cad is not None]
    count = len(cads)
    T = np.array([cad.T_world_cad for cad in cads], np.float32).reshape(count, 4, 4)
    turned = np.einsum("kij,klj->kil", T[:, :3, :3], CUBE_ROTATIONS[shortlist.rotation])
    zero = np.zeros(count, np.float32)
    return Alignments(
        scale=np.array([cad.scale[0] for cad in cads], np.float32),
        yaw=np.arctan2(turned[:, 1, 0], turned[:, 0, 0]).astype(np.float32),
        translation=T[:, :3, 3],
        T_world_cad=T,
        cost=zero,
        status=np.full(count, AlignmentStatus.CONVERGED, np.int32),
        alignment_error_m=zero,
    )


def _placement(record: EntityRecord) -> Placement:
    cad = record.cad
    if cad is None:
        reason = "layout" if record.type == "layout" else "the truth has no model of it"
        return Placement(record.id, None, None, None, None, None, (), reason)
    T, scale = np.asarray(cad.T_world_cad, np.float32), np.asarray(cad.scale, np.float32)
    return Placement(record.id, cad.id, T, scale, 0.0, 0.0, (), None)
