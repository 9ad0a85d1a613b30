"""The best (model, rotation) pairs of every query (host)."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence

import numpy as np
from jaxtyping import Float, Int

from ..config import MatchingSettings
from ..geometry import CUBE_ROTATIONS
from ..library import CadLibrary
from .queries import Query

_UPRIGHT_TURNS = 4
"""The first of `CUBE_ROTATIONS` are the turns about z."""
_TIE = 1e-5
"""Errors nearer than this are equal: float32 leaves no more, and symmetry makes exact ties."""


@dataclasses.dataclass(frozen=True, eq=False)
class Best:
    """The chosen (query, model, rotation) on one flat axis, sorted by query, then error."""

    query: Int[np.ndarray, " best"]
    model: Int[np.ndarray, " best"]
    """Position in the library."""
    rotation: Int[np.ndarray, " best"]
    """Row of `CUBE_ROTATIONS`."""
    error: Float[np.ndarray, " best"]
    """D."""


def best_of(
    queries: Sequence[Query],
    errors: Sequence[Float[np.ndarray, "_ 24"]],
    library: CadLibrary,
    settings: MatchingSettings,
) -> Best:
    """The best of each query.

    Args:
        queries: Entities and their models.
        errors: D of each query's models in all rotations; inf is never chosen.
        library: The models.
        settings: How many of them.
    """
    none = np.zeros(0, np.int32)
    parts = [(none, none, none, np.zeros(0, np.float32))]
    for number, (query, error) in enumerate(zip(queries, errors, strict=True)):
        slot, rotation = _best_pairs(query.models, error, library, settings)
        owner = np.full(len(slot), number, np.int32)
        model = query.models[slot].astype(np.int32)
        parts.append((owner, model, rotation, error[slot, rotation]))
    return Best(*(np.concatenate(column) for column in zip(*parts, strict=True)))


def _best_pairs(
    models: Int[np.ndarray, " models"],
    error: Float[np.ndarray, "models 24"],
    library: CadLibrary,
    settings: MatchingSettings,
) -> tuple[Int[np.ndarray, " best"], Int[np.ndarray, " best"]]:
    """(row, rotation) of the ``shortlist`` smallest errors of one query, best first.

    Ties go to the first model, then the first rotation. Of an entity that was seen from one side
    only, D says little about which way a model turns: the first ``turned_models`` of its models
    also come in the upright turns that are missing.
    """
    slot, rotation = (a.ravel().astype(np.int32) for a in np.indices(error.shape))
    flat, model = error.ravel(), models[slot].astype(np.int32)
    keep = np.flatnonzero(np.isfinite(flat))
    order = keep[np.lexsort((rotation[keep], model[keep], np.round(flat[keep] / _TIE)))]
    if settings.merge_symmetric:
        order = _without_twins(order, model, rotation, library)
    best = order[: settings.shortlist]
    models_first = model[best][np.sort(np.unique(model[best], return_index=True)[1])]
    turned = np.isin(model[order], models_first[: settings.turned_models])
    turned &= rotation[order] < _UPRIGHT_TURNS
    turned[: settings.shortlist] = True
    order = order[turned]
    return slot[order], rotation[order]


def _without_twins(
    order: np.ndarray, model: np.ndarray, rotation: np.ndarray, library: CadLibrary
) -> np.ndarray:
    """Drop rotations that a model's symmetry about its z makes equal to a better one.

    The paper keeps them; of ten places a round table would take ten.
    """
    symmetry = library.arrays.symmetry[model[order]]
    key = rotation[order].copy()
    for order_of_symmetry, turns in _TURNS.items():
        key = np.where(symmetry == order_of_symmetry, turns[rotation[order]], key)
    first = np.unique(np.stack([model[order], key]), axis=1, return_index=True)[1]
    return order[np.sort(first)]


def _first_equal(quarters: int) -> Int[np.ndarray, " 24"]:
    """For each rotation R the first row equal to R Rz(90 degrees ``quarters`` k) for any k."""
    turn = np.linalg.matrix_power(CUBE_ROTATIONS[1], quarters)
    moved = CUBE_ROTATIONS
    first = np.arange(24, dtype=np.int32)
    for _ in range(3):
        moved = moved @ turn
        same = np.all(np.abs(moved[:, None] - CUBE_ROTATIONS) < 0.5, axis=(-1, -2))
        first = np.minimum(first, same.argmax(1).astype(np.int32))
    return first


_TURNS = {2: _first_equal(2), 4: _first_equal(1), 0: _first_equal(1)}
"""By order of symmetry; the others share no turn with the cube."""
