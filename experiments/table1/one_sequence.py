"""One SceneNN sequence: mapped, its entities and contact graph found, scored in both countings."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np

from isr_jax import contact_graph, datasets, entities, segmentation
from isr_jax.classes import classes
from isr_jax.config import Settings
from isr_jax.evaluation.maps.boxes import score_boxes
from isr_jax.evaluation.maps.instances import score_instances
from isr_jax.evaluation.maps.labels import transfer
from isr_jax.evaluation.maps.panoptic import panoptic_scores
from isr_jax.evaluation.maps.released_code import (
    MIN_VERTICES,
    ReleasedCounts,
    count_as_released_code,
    released_class,
    released_true_class,
    triangle_soup,
)
from isr_jax.evaluation.maps.segments import compare_segments
from isr_jax.evaluation.result_files import Result, read_truth
from isr_jax.export.labels import final_labels
from isr_jax.geometry.boxes import box_at
from isr_jax.library import CadLibrary
from isr_jax.pipeline import map_sequence
from isr_jax.runtime.reporter import Reporter
from isr_jax.runtime.run_folder import RunFolder
from isr_jax.runtime.stage_runner import StageRunner
from isr_jax.runtime.store import StageStore
from isr_jax.scene_file import scene_from_stages
from isr_jax.types import (
    Box,
    ContactGraph,
    Entities,
    PanopticSurface,
    Placement,
)

from .rows import ExactScores

TEXT = "SceneNN (text)"
"""The annotation whose names the released code reads, also where there is a later one."""
_NOT_ASKED = "models are not looked for here"


@dataclasses.dataclass(frozen=True, eq=False)
class Found:
    """What was found in a sequence."""

    surface: PanopticSurface
    entities: Entities
    graph: ContactGraph


@dataclasses.dataclass(frozen=True, eq=False)
class SequenceScores:
    """One sequence in both countings."""

    annotation: str
    """Which version of the annotation the exact counting took its names from."""
    exact: ExactScores
    released: dict[str, ReleasedCounts]
    released_refined: dict[str, ReleasedCounts]
    """With the boxes that supports refined."""


def score_sequence(
    folder: Path,
    out_dir: Path,
    settings: Settings,
    segmenter: str,
    reporter: Reporter,
    *,
    min_vertices: int = MIN_VERTICES,
) -> SequenceScores:
    """Map a sequence and score it against its annotation.

    Args:
        folder: ``image/``, ``depth/``, ``trajectory.log``, and the mesh and XML of the annotation.
        out_dir: Receives the log, the map (which a second call reuses) and the truth.
        settings: Of a preset.
        segmenter: As in `open_segmenter`.
        reporter: Receives progress.
        min_vertices: Of the released counting.
    """
    with RunFolder(out_dir, settings):
        annotated = datasets.read_scenenn_truth(folder)
        by_text = datasets.read_scenenn_truth(folder, version=TEXT)
        sequence = datasets.open_sequence(folder, settings.input)
        for note in (*sequence.notes, *annotated.notes):
            reporter.note(note)
        runner = StageRunner(StageStore(out_dir / "stages"), reporter)
        masks = segmentation.open_segmenter(segmenter, folder, settings=settings.segmentation)
        found = find(sequence, masks, settings, runner)
        T = sequence.T_world_dataset
        datasets.truth_from_annotation(annotated, T, out_dir / "truth")
        released = [
            _released(found, by_text, T, refined, min_vertices) for refined in (False, True)
        ]
        return SequenceScores(annotated.annotation, _exact(found, out_dir / "truth"), *released)


def find(sequence, segmenter, settings: Settings, runner: StageRunner) -> Found:
    """The paper's way as far as the contact graph; the map is kept."""
    mapped = map_sequence(sequence, segmenter, settings, runner)
    items = entities.extract_entities(mapped.surface, sequence.T_world_dataset, settings.entities)
    graph = contact_graph.build_contact_graphs([items], settings.contact_graph, settings.support)[0]
    return Found(mapped.surface, items, graph)


def _exact(found: Found, truth_dir: Path) -> ExactScores:
    truth = read_truth(truth_dir)
    none = Placement(0, None, None, None, None, None, (), _NOT_ASKED)
    placements = tuple(dataclasses.replace(none, entity_id=e.id) for e in found.entities)
    scene = scene_from_stages(found.entities, found.graph, placements, CadLibrary((), "", ""), {})
    mesh = found.surface.mesh
    vertices = np.asarray(mesh.vertices, np.float64)
    result = Result(
        scene, vertices, mesh.faces, *final_labels(found.entities, found.surface), np.eye(4)
    )
    compared = compare_segments(truth, result, transfer(truth.points, result.points))
    return ExactScores(
        panoptic_scores(compared.quality),
        score_instances(compared),
        score_boxes(truth, result, observed=True),
        score_boxes(truth, result),
    )


def _merged(found: Found) -> np.ndarray:
    """Instance of each vertex, with the parts of one entity under its id."""
    instance = found.surface.instance.astype(np.int64)
    for entity in found.entities:
        instance = np.where(np.isin(instance, entity.merged_ids), entity.id, instance)
    return instance


def _released(
    found: Found,
    annotated: datasets.AnnotatedMesh,
    T_world_dataset: np.ndarray,
    refined: bool,
    min_vertices: int,
) -> dict[str, ReleasedCounts]:
    instance = _merged(found)
    corners, labels = triangle_soup(
        np.asarray(found.surface.mesh.vertices, np.float64), found.surface.mesh.faces, instance
    )
    T = np.asarray(T_world_dataset, np.float64)
    points = np.asarray(annotated.mesh.vertices, np.float64) @ T[:3, :3].T + T[:3, 3]
    true = {i.id: released_true_class(i.label) for i in annotated.instances}
    return count_as_released_code(
        corners,
        labels,
        _predicted_classes(found, instance),
        points,
        annotated.instance,
        {id: name for id, name in true.items() if name is not None},
        boxes=_refined_boxes(found) if refined else None,
        min_vertices=min_vertices,
    )


def _predicted_classes(found: Found, instance: np.ndarray) -> dict[int, str]:
    """Of entities, and of the floor and the walls, which the map holds as one instance each."""
    surface = found.surface
    info = {int(i): classes()[k] for i, k in zip(surface.instance_ids, surface.class_ids)}
    named = {id: one.name for id, one in info.items() if one.kind == "layout"}
    named |= {e.id: e.class_name for e in found.entities if not e.is_layout}
    counted = {id: released_class(name) for id, name in named.items()}
    present = set(np.unique(instance).tolist())
    return {id: name for id, name in counted.items() if name is not None and id in present}


def _refined_boxes(found: Found) -> dict[int, Box]:
    return {e.id: box_at(found.graph.refined_box, i) for i, e in enumerate(found.entities)}
