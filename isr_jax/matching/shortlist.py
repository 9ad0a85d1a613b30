"""From entities and a library to shortlists, many scenes at once (host)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from jaxtyping import Int

from ..config import DEFAULT_SUPPORT, MatchingSettings, SupportSettings
from ..library import CadLibrary
from ..types import ContactGraph, Entities, Shortlist
from .plane_matches import plane_matches
from .queries import MAX_ENTITY_PLANES, Query, queries_of
from .scoring import all_errors
from .selection import Best, best_of


def match(
    scenes: Sequence[Entities],
    graphs: Sequence[ContactGraph],
    library: CadLibrary,
    settings: MatchingSettings,
    support: SupportSettings = DEFAULT_SUPPORT,
) -> list[Shortlist]:
    """The models of smallest matching distance D for every functional entity of every scene.

    Layout, classes without function and classes without models get no rows; nor does an entity
    that no model can hold on to where it is (`queries.mountable`), or that every model fails (a
    plane that carries a child finds no partner, or ``unmatched_cost`` is inf and a plane is left
    over). At most 8 planes of an entity count, those that carry children first, then by area; at
    most 16 of a model, supporting ones first.

    Args:
        scenes: Entities of each scene.
        graphs: Their contact graphs.
        library: The models.
        settings: Of matching.
        support: Says which planes are supporting.
    """
    queries = queries_of(scenes, graphs, library, settings.wall_distance_m)
    errors = all_errors(queries, library, settings, support.up_cosine)
    best = best_of(queries, errors, library, settings)
    matches = plane_matches(queries, best, library, settings.unmatched_cost, support.up_cosine)
    return [_shortlist_of(scene, queries, best, matches) for scene in range(len(scenes))]


def _shortlist_of(
    scene: int, queries: list[Query], best: Best, matches: Int[np.ndarray, "best planes"]
) -> Shortlist:
    """The rows of one scene."""
    widths = [len(q.entity.planes.offset) for q in queries if q.scene == scene]
    rows = [row for row, number in enumerate(best.query.tolist()) if queries[number].scene == scene]
    return Shortlist(
        entity=np.array([queries[n].position for n in best.query[rows].tolist()], np.int32),
        model=best.model[rows],
        rotation=best.rotation[rows],
        error=best.error[rows],
        plane_match=matches[rows, : max([MAX_ENTITY_PLANES, *widths])],
    )
