"""From entities and a library to shortlists, many scenes at once (host)."""

from __future__ import annotations

from collections.abc import Sequence

import jax
import numpy as np
from jaxtyping import Float, Int
from scipy.optimize import linear_sum_assignment

from ..classes import class_named
from ..config import DEFAULT_SUPPORT, MatchingSettings, SupportSettings
from ..geometry import CUBE_ROTATIONS
from ..library import CadLibrary
from ..library.arrays import MAX_MODEL_PLANES
from ..types import ContactGraph, Entities, Shortlist
from .costs import pair_terms
from .features import (
    MAX_ENTITY_PLANES,
    carrying_planes,
    entity_rows,
    model_features,
)
from .mounts import mountable
from .scoring import Query, all_errors, blocks, stack, take, unmatched_price
from .selection import Picked, pick_best
from .walls import wall_normal


def match(
    scenes: Sequence[Entities],
    graphs: Sequence[ContactGraph],
    library: CadLibrary,
    settings: MatchingSettings,
    support: SupportSettings = DEFAULT_SUPPORT,
) -> list[Shortlist]:
    """The models of smallest matching distance D for every functional entity of every scene.

    Layout, classes without function and classes without models get no rows; nor does an entity
    that no model can hold on to where it is (`mounts.mountable`), or that every model fails (a
    plane that carries a child finds no partner, or ``unmatched_cost`` is inf and a plane is left
    over). At most 8 planes of an entity count, those that carry children first, then by area; at
    most 16 of a model, supporting ones first.

    Args:
        support: Says which planes are supporting.
    """
    queries = _queries(scenes, graphs, library, settings)
    errors = all_errors(queries, library, settings, support.up_cosine)
    picked = [
        pick_best(query.models, error, library, settings)
        for query, error in zip(queries, errors, strict=True)
    ]
    matches = _plane_matches(queries, picked, library, settings, support.up_cosine)
    ours = [[i for i, q in enumerate(queries) if q.scene == s] for s in range(len(scenes))]
    return [
        _shortlist_of([queries[i] for i in o], [picked[i] for i in o], [matches[i] for i in o])
        for o in ours
    ]


def _queries(
    scenes: Sequence[Entities],
    graphs: Sequence[ContactGraph],
    library: CadLibrary,
    settings: MatchingSettings,
) -> list[Query]:
    found = []
    for number, (scene, graph) in enumerate(zip(scenes, graphs, strict=True)):
        for position, entity in enumerate(scene):
            if entity.is_layout or not class_named(entity.class_name).functional:
                continue
            models = library.matching_class(entity.class_name)
            models = mountable(models, library, graph, position)
            if not len(models):
                continue
            rows = entity_rows(entity.planes, carrying_planes(graph, position))
            wall = wall_normal(scene, entity, settings.wall_distance_m)
            found.append(Query(number, position, entity, graph, models, rows, wall))
    return found


_winner_terms = jax.jit(jax.vmap(pair_terms, (0, 0, 0, None)))


def _plane_matches(
    queries: list[Query],
    picked: list[Picked],
    library: CadLibrary,
    settings: MatchingSettings,
    up_cosine: float,
) -> list[Int[np.ndarray, "picked planes"]]:
    """f of each chosen candidate: the model's plane for each plane of the entity, else -1.

    The batched programme gives values only; the few winners are assigned again, one by one.
    """
    widths = [max(MAX_ENTITY_PLANES, len(query.entity.planes.offset)) for query in queries]
    matches = [
        np.full((len(p.model), width), -1, np.int32)
        for p, width in zip(picked, widths, strict=True)
    ]
    members = [(n, rank) for n, p in enumerate(picked) for rank in range(len(p.model))]
    if not members:
        return matches
    number, rank = np.array(members).T
    model = np.concatenate([p.model for p in picked])
    turn = CUBE_ROTATIONS[np.concatenate([p.rotation for p in picked])]
    asked, y_row = np.unique(model, return_inverse=True)
    x = stack([query.features(MAX_ENTITY_PLANES) for query in queries])
    y = model_features(library.arrays, asked, MAX_MODEL_PLANES)
    up = np.asarray(up_cosine, np.float32)
    price = np.asarray(unmatched_price(x, np.asarray(settings.unmatched_cost, np.float32)))
    for block, count in blocks(len(members)):
        terms = _winner_terms(take(x, number[block]), take(y, y_row[block]), turn[block], up)
        for row, cost in zip(block[:count].tolist(), np.asarray(terms.plane_cost), strict=False):
            planes = queries[number[row]].rows
            chosen = _assign(cost[: len(planes)], price[number[row], : len(planes)])
            found = chosen >= 0
            match = matches[number[row]][rank[row]]
            match[planes[found]] = library.arrays.column[model[row], chosen[found]]
    return matches


def _assign(
    cost: Float[np.ndarray, "rows columns"], unmatched: Float[np.ndarray, " rows"]
) -> Int[np.ndarray, " rows"]:
    """The column of each row, -1 = none: one extra column a row stands for "without partner"."""
    alone = np.full((len(cost), len(cost)), np.inf)
    np.fill_diagonal(alone, unmatched)
    _, column = linear_sum_assignment(np.concatenate([cost, alone], axis=1))
    return np.where(column < cost.shape[1], column, -1)


def _shortlist_of(
    queries: list[Query], picked: list[Picked], matches: list[np.ndarray]
) -> Shortlist:
    """Rows of the entities of one scene, end to end."""
    width = max([MAX_ENTITY_PLANES, *(m.shape[1] for m in matches)])
    wide = [np.pad(m, ((0, 0), (0, width - m.shape[1])), constant_values=-1) for m in matches]
    none = Picked(np.zeros(0, np.int32), np.zeros(0, np.int32), np.zeros(0, np.float32))
    counts = [len(p.model) for p in picked]
    picked = [none, *picked]
    return Shortlist(
        entity=np.repeat(np.array([q.position for q in queries], np.int32), counts),
        model=np.concatenate([p.model for p in picked]),
        rotation=np.concatenate([p.rotation for p in picked]),
        error=np.concatenate([p.error for p in picked]),
        plane_match=np.concatenate([np.zeros((0, width), np.int32), *wide]),
    )
