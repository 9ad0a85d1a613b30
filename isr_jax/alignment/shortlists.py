"""From shortlists to `Alignments`: all candidates of all scenes on one flat axis."""

from __future__ import annotations

from collections.abc import Sequence

import jax
import numpy as np

from ..config import AlignmentSettings
from ..geometry import CUBE_ROTATIONS
from ..library import CadLibrary
from ..types import Alignments, ContactGraph, Entities, Shortlist
from .error import alignment_errors
from .hidden import slide_hidden, spread
from .problem import (
    AlignmentProblem,
    AlignmentSolution,
    AlignmentWeights,
    default_start,
)
from .solve import align

_MIN_PAIRS = 16
_MIN_PLANES = 4


def align_shortlists(
    scenes: Sequence[Entities],
    graphs: Sequence[ContactGraph],
    shortlists: Sequence[Shortlist],
    library: CadLibrary,
    settings: AlignmentSettings,
) -> list[Alignments]:
    """Align every candidate of every scene in one solve, and measure its alignment error."""
    counts = [len(shortlist.entity) for shortlist in shortlists]
    if sum(counts) == 0:
        return [_nothing() for _ in scenes]
    problem = _pad_pairs(_problem_of(scenes, graphs, shortlists, library))
    solution = align(
        problem,
        AlignmentWeights.of(settings),
        scale_bounds=(settings.scale_min, settings.scale_max),
        max_steps=settings.max_steps,
        tolerance=settings.tolerance,
        normal_residual=settings.normal_residual,
    )
    host = jax.tree.map(lambda leaf: np.asarray(leaf)[: sum(counts)], solution)
    points, triangles = _pairs(scenes, shortlists, library)
    bounds = (settings.scale_min, settings.scale_max)
    host = slide_hidden(problem, host, points, triangles, settings.slide_hidden_m, bounds)
    errors = alignment_errors(
        np.asarray(host.T_world_cad),
        np.asarray(host.scale),
        [spread(p, settings.max_points) for p in points],
        triangles,
    )
    return _split(host, errors, counts)


def bucket(count: int, least: int) -> int:
    """The power of two that holds ``count``, at least ``least``."""
    return max(least, 1 << (max(count, 1) - 1).bit_length())


def _problem_of(scenes, graphs, shortlists, library) -> AlignmentProblem:
    width = bucket(max(s.plane_match.shape[1] for s in shortlists), _MIN_PLANES)
    parts = [
        _scene_problem(*scene, library, width)
        for scene in zip(scenes, graphs, shortlists, strict=True)
        if len(scene[2].entity)
    ]
    return jax.tree.map(lambda *leaves: np.concatenate(leaves), *parts)


def _scene_problem(entities, graph, shortlist, library, width) -> AlignmentProblem:
    rows = shortlist.entity
    box = jax.tree.map(lambda leaf: np.asarray(leaf, np.float32)[rows], graph.refined_box)
    size = np.stack([library[int(m)].size for m in shortlist.model]).astype(np.float32)
    rotation = CUBE_ROTATIONS[shortlist.rotation]
    planes = [
        _matched_planes(entities[e], library[m], match, width)
        for e, m, match in zip(
            rows.tolist(), shortlist.model.tolist(), shortlist.plane_match, strict=True
        )
    ]
    return AlignmentProblem(
        box=box,
        support_height_m=np.asarray(graph.support_height_m, np.float32)[rows],
        **{name: np.stack([p[name] for p in planes]) for name in planes[0]},
        model_size=size,
        rotation=rotation,
        start=np.asarray(default_start(box, size, rotation)),
        valid=np.ones(len(rows), bool),
    )


def _matched_planes(entity, model, match: np.ndarray, width: int) -> dict[str, np.ndarray]:
    """Planes of the entity that have a partner, beside the model's, padded to ``width``."""
    x = np.flatnonzero(match >= 0)
    y = match[x]

    def padded(values):
        values = np.asarray(values, np.float32)
        out = np.zeros((width, *values.shape[1:]), np.float32)
        out[: len(values)] = values
        return out

    return {
        "entity_normal": padded(np.asarray(entity.planes.normal)[x]),
        "entity_offset": padded(np.asarray(entity.planes.offset)[x]),
        "model_normal": padded(np.asarray(model.planes.normal)[y]),
        "model_offset": padded(np.asarray(model.planes.offset)[y]),
        "plane_valid": np.arange(width) < len(x),
    }


def _pad_pairs(problem: AlignmentProblem) -> AlignmentProblem:
    count = len(problem.valid)
    extra = bucket(count, _MIN_PAIRS) - count
    return jax.tree.map(
        lambda leaf: np.concatenate([leaf, np.zeros((extra, *leaf.shape[1:]), leaf.dtype)]),
        problem,
    )


def _pairs(scenes, shortlists, library) -> tuple[list[np.ndarray], list[np.ndarray]]:
    """Vertices of the entity and triangles of the model of every pair."""
    points = [
        scene[i].mesh.vertices
        for scene, shortlist in zip(scenes, shortlists, strict=True)
        for i in shortlist.entity.tolist()
    ]
    meshes = [library[m].mesh for s in shortlists for m in s.model.tolist()]
    return points, [mesh.vertices[mesh.faces] for mesh in meshes]


def _split(solution: AlignmentSolution, errors: np.ndarray, counts: list[int]) -> list[Alignments]:
    names = ("scale", "yaw", "translation", "T_world_cad", "cost", "status")
    columns = {name: np.asarray(getattr(solution, name)) for name in names}
    columns["alignment_error_m"] = errors
    ends = np.cumsum(counts)
    return [
        Alignments(**{name: column[a:b] for name, column in columns.items()})
        for a, b in zip(ends - counts, ends, strict=True)
    ]


def _nothing() -> Alignments:
    zero = np.zeros(0, np.float32)
    return Alignments(zero, zero, np.zeros((0, 3), np.float32), np.zeros((0, 4, 4), np.float32),
                      zero, np.zeros(0, np.int32), zero)  # fmt: skip
