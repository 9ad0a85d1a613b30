"""From shortlists to `Alignments`: all candidates of all scenes on one flat axis."""

from __future__ import annotations

from collections.abc import Sequence

import jax
import numpy as np

from ..config import DEFAULT_SUPPORT, AlignmentSettings, SupportSettings
from ..library import CadLibrary
from ..types import Alignments, ContactGraph, Entities, Shortlist
from .builders import entities_of, models_of, problem_of, spread, triangles_of
from .error import alignment_errors
from .hidden import slide_hidden
from .problem import AlignmentSolution, AlignmentWeights
from .solve import align


def align_shortlists(
    scenes: Sequence[Entities],
    graphs: Sequence[ContactGraph],
    shortlists: Sequence[Shortlist],
    library: CadLibrary,
    settings: AlignmentSettings,
    support: SupportSettings = DEFAULT_SUPPORT,
) -> list[Alignments]:
    """Align every candidate of every scene in one solve, and measure its alignment error.

    Args:
        scenes: Entities of each scene.
        graphs: What carries them.
        shortlists: Candidates of each scene.
        library: The one that the shortlists were made from.
        settings: Of the solve, the alignment error and half-seen entities.
        support: Says which planes are supporting.

    Raises:
        LibraryError: a shortlist names a model that the library does not hold.
    """
    counts = [len(shortlist.entity) for shortlist in shortlists]
    if sum(counts) == 0:
        return [_nothing() for _ in scenes]
    problem = problem_of(scenes, graphs, shortlists, library, support)
    weights = AlignmentWeights.of(settings)
    solution = jax.tree.map(np.asarray, align(problem, weights, settings))
    points = [entity.mesh.vertices for entity in entities_of(scenes, shortlists)]
    triangles = [triangles_of(model) for model in models_of(shortlists, library)]
    solution = slide_hidden(problem, weights, solution, points, triangles, settings)
    errors = alignment_errors(
        np.asarray(solution.T_world_cad)[: len(points)],
        np.asarray(solution.scale)[: len(points)],
        [spread(p, settings.max_points) for p in points],
        triangles,
    )
    return _split(solution, errors, counts)


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
    return Alignments(
        scale=zero,
        yaw=zero,
        translation=np.zeros((0, 3), np.float32),
        T_world_cad=np.zeros((0, 4, 4), np.float32),
        cost=zero,
        status=np.zeros(0, np.int32),
        alignment_error_m=zero,
    )
