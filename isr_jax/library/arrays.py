"""What matching reads of all models of a library, as padded arrays."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence

import numpy as np
from jaxtyping import Bool, Float, Int
from numpy.typing import DTypeLike

from ..types import PlaneSet

MAX_MODEL_PLANES = 16
"""Of a model with more planes these many count."""
_SIDES = 6
"""Of them so many are kept for planes that carry nothing: a shelf has more boards than sides, and
without its sides it could stand either way."""


@dataclasses.dataclass(frozen=True, eq=False)
class LibraryArrays:
    """Rows are models; padding of planes is finite: normal +z, everything else 0."""

    size: Float[np.ndarray, "models 3"]
    """Metres, canonical frame."""
    normal: Float[np.ndarray, "models planes 3"]
    """Of the planes that count, in the model's order, canonical frame."""
    offset: Float[np.ndarray, "models planes"]
    """Metres."""
    area_m2: Float[np.ndarray, "models planes"]
    supporting: Bool[np.ndarray, "models planes"]
    valid: Bool[np.ndarray, "models planes"]
    column: Int[np.ndarray, "models planes"]
    """Position among all planes of the model."""
    symmetry: Int[np.ndarray, " models"]

    @property
    def plane_count(self) -> Int[np.ndarray, " models"]:
        """Planes of each model that count."""
        return self.valid.sum(1)


def library_arrays(
    sizes: Sequence[np.ndarray],
    planes: Sequence[PlaneSet],
    supporting: Sequence[np.ndarray],
    symmetry: Sequence[int],
) -> LibraryArrays:
    """Arrays of the models in their order, padded to `MAX_MODEL_PLANES`.

    Of a model with more planes supporting ones count before others and large ones first, with room
    kept for the largest sides. All planes of all models are placed at once, as one flat table: a
    library holds thousands.

    Args:
        sizes: Box of each model, metres.
        planes: Unpadded, canonical frame.
        supporting: Which of the planes carry.
        symmetry: As in `CadModel`.
    """
    counts = np.array([len(p.offset) for p in planes], np.int64)
    owner = np.repeat(np.arange(len(counts)), counts)
    first = np.cumsum(counts) - counts
    carries = _joined([*supporting], (), bool)
    area = _joined([p.area_m2 for p in planes])
    keep = _rows_that_count(_joined([p.valid for p in planes], (), bool), area, carries, owner)
    row = owner[keep]
    slot = np.arange(len(keep)) - np.searchsorted(row, row)

    def padded(values: np.ndarray) -> np.ndarray:
        table = np.zeros((len(counts), MAX_MODEL_PLANES, *values.shape[1:]), values.dtype)
        table[row, slot] = values[keep]
        return table

    normal = padded(_joined([p.normal for p in planes], (3,)))
    valid = padded(np.ones(len(owner), bool))
    normal[~valid] = (0.0, 0.0, 1.0)
    return LibraryArrays(
        size=np.array(sizes, np.float32).reshape(-1, 3),
        normal=normal,
        offset=padded(_joined([p.offset for p in planes])),
        area_m2=padded(area),
        supporting=padded(carries),
        valid=valid,
        column=padded((np.arange(len(owner)) - first[owner]).astype(np.int32)),
        symmetry=np.array(symmetry, np.int32),
    )


def _rows_that_count(
    valid: Bool[np.ndarray, " planes"],
    area_m2: Float[np.ndarray, " planes"],
    supporting: Bool[np.ndarray, " planes"],
    owner: Int[np.ndarray, " planes"],
) -> Int[np.ndarray, " rows"]:
    """Rows of a flat table of planes that count, ascending; ``owner`` ascends too."""
    rows = np.flatnonzero(valid)
    other = ~supporting[rows]
    order = np.lexsort((-area_m2[rows], other, owner[rows]))
    rows, other = rows[order], other[order]
    group, twice = 2 * owner[rows] + other, 2 * owner[rows]
    rank = np.arange(len(rows)) - np.searchsorted(group, group)
    first, between, end = (np.searchsorted(group, twice + k) for k in (0, 1, 2))
    carrying, sides = between - first, end - between
    most_carrying = MAX_MODEL_PLANES - np.minimum(sides, _SIDES)
    most_sides = MAX_MODEL_PLANES - np.minimum(carrying, most_carrying)
    return np.sort(rows[rank < np.where(other, most_sides, most_carrying)])


def _joined(
    parts: Sequence, shape: tuple[int, ...] = (), dtype: DTypeLike = np.float32
) -> np.ndarray:
    empty = np.zeros((0, *shape), dtype)
    return np.concatenate([empty, *(np.asarray(part, dtype) for part in parts)])
