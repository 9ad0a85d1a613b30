"""Whether the surfaces of two placed models keep apart where their boxes overlap."""

from __future__ import annotations

import functools

import numpy as np
from scipy.spatial import KDTree

from ...library import CadModel
from .proposal import Proposal
from .tops import SAMPLE_M, model_samples

_GAP_M = 0.006


def meshes_apart(first: Proposal, second: Proposal) -> bool:
    """Whether all samples keep so far apart that the surfaces between them cannot touch.

    A point of a triangle without edges longer than L lies within L / sqrt(3) of a corner (in the
    equilateral one, its middle). So corners of two surfaces that come within g of each other are
    at most g + 2 L / sqrt(3) apart. Neither may lie wholly inside the other.
    """
    reach = _GAP_M + SAMPLE_M / np.sqrt(3) * (first.scale + second.scale)
    points = second.from_room(first.to_room(model_samples(first.model)))
    near = _in_extent(points, second.model, reach / second.scale)
    if not len(near):
        return True
    distance, _ = _tree(second.model).query(near, distance_upper_bound=reach / second.scale)
    return bool(np.all(np.isinf(distance)))


def _in_extent(points: np.ndarray, model: CadModel, reach: float) -> np.ndarray:
    low, high = _extent(model)
    return points[np.all((points > low - reach) & (points < high + reach), axis=1)]


@functools.lru_cache(maxsize=512)
def _extent(model: CadModel) -> tuple[np.ndarray, np.ndarray]:
    vertices = model.mesh.vertices
    return vertices.min(0), vertices.max(0)


@functools.lru_cache(maxsize=512)
def _tree(model: CadModel) -> KDTree:
    return KDTree(model_samples(model))
