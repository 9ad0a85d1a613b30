"""A map in memory against the truth: the numbers that the benchmark finds in its files."""

from __future__ import annotations

import dataclasses
import functools
from pathlib import Path

import numpy as np
from jaxtyping import Int

from isr_jax.evaluation import BoxScores, InstanceScores, PanopticScores
from isr_jax.evaluation.maps.boxes import score_boxes
from isr_jax.evaluation.maps.instances import score_instances
from isr_jax.evaluation.maps.labels import transfer
from isr_jax.evaluation.maps.panoptic import panoptic_scores
from isr_jax.evaluation.maps.segments import Comparison, compare_segments
from isr_jax.evaluation.result_files import Result, Truth, read_truth
from isr_jax.export.labels import final_labels
from isr_jax.library import CadLibrary
from isr_jax.scene_file import scene_from_stages
from isr_jax.types import PanopticSurface, Placement

from .map_film import Mapped

_NO_MODELS = CadLibrary((), "", "")


@dataclasses.dataclass(frozen=True)
class MapScores:
    """Scores of a map, named and nested as in `isr_jax.evaluation.EvaluationReport`."""

    panoptic: PanopticScores
    instances: InstanceScores
    boxes: BoxScores
    """Of mAP_re: as supports refined them."""
    observed_boxes: BoxScores
    """Of mAP."""


@dataclasses.dataclass(frozen=True, eq=False)
class Judged:
    """A map, compared with the truth and scored."""

    truth: Truth
    mapped: Mapped
    compared: Comparison
    """With the labels that the entities gave the map: what is scored."""
    before: Comparison
    """With the map's own labels, before entities dropped and joined instances."""
    scores: MapScores


@functools.lru_cache(maxsize=1)
def truth_of(film_dir: Path) -> Truth:
    """What a film was made of."""
    return read_truth(film_dir / "truth")


def judge(mapped: Mapped, truth: Truth) -> Judged:
    """Panoptic quality, instance AP, and the boxes' mAP before and after supports refined them."""
    result, surface = result_of(mapped, truth), mapped.surface
    near = transfer(truth.points, result.points)
    compared = compare_segments(truth, result, near)
    own = dataclasses.replace(
        result, instance=surface.instance.astype(np.int64), class_id=_own_classes(surface)
    )
    scores = MapScores(
        panoptic=panoptic_scores(compared.quality),
        instances=score_instances(compared),
        boxes=score_boxes(truth, result),
        observed_boxes=score_boxes(truth, result, observed=True),
    )
    return Judged(truth, mapped, compared, compare_segments(truth, own, near), scores)


def result_of(mapped: Mapped, truth: Truth) -> Result:
    """What `isr run` writes and the evaluation reads of a map, without the files."""
    found, mesh = mapped.entities, mapped.surface.mesh
    placements = tuple(Placement(e.id, None, None, None, None, None, (), None) for e in found)
    T = truth.scene.T_world_dataset @ np.linalg.inv(found.T_world_dataset)
    instance, class_id = final_labels(found, mapped.surface)
    return Result(
        scene_from_stages(found, mapped.graph, placements, _NO_MODELS, {}),
        mesh.vertices.astype(np.float64) @ T[:3, :3].T + T[:3, 3],
        mesh.faces,
        instance.astype(np.int64),
        class_id.astype(np.int64),
        T,
    )


def _own_classes(surface: PanopticSurface) -> Int[np.ndarray, " vertices"]:
    table = np.zeros(int(surface.instance_ids.max(initial=0)) + 1, np.int64)
    table[surface.instance_ids] = surface.class_ids
    return table[surface.instance]
