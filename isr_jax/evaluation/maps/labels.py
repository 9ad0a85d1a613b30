"""Border: SciPy's k-d tree. Carries the labels of a map to true points and counts its surface.

A true point takes the label of the nearest map vertex within 5 cm. What the map has farther than
that from any true point is false surface; it is counted on the grid of the true points, so that a
denser mesh does not count more.
"""

from __future__ import annotations

import dataclasses

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.spatial import KDTree

REACH_M = 0.05
GRID_M = 0.02
"""Spacing of the true points."""
FAR_M = 0.5
"""Distances are cut here: far points that see many neighbours equally far take a tree seconds."""


@dataclasses.dataclass(frozen=True, eq=False)
class Transfer:
    """How map and truth lie to each other."""

    nearest: Int[np.ndarray, " points"]
    """Map vertex nearest to each true point; -1 beyond `REACH_M`."""
    to_truth_m: Float[np.ndarray, " vertices"]
    """Distance from each map vertex to the nearest true point, at most `FAR_M`."""


def transfer(
    truth: Float[np.ndarray, "points 3"], vertices: Float[np.ndarray, "vertices 3"]
) -> Transfer:
    """Nearest neighbours both ways."""
    if len(vertices) == 0 or len(truth) == 0:
        return Transfer(np.full(len(truth), -1), np.full(len(vertices), FAR_M))
    distance, nearest = KDTree(vertices).query(truth, distance_upper_bound=REACH_M, workers=-1)
    to_truth_m, _ = KDTree(truth).query(vertices, distance_upper_bound=FAR_M, workers=-1)
    return Transfer(np.where(np.isfinite(distance), nearest, -1), np.minimum(to_truth_m, FAR_M))


def false_cells(
    vertices: Float[np.ndarray, "vertices 3"],
    segment: Int[np.ndarray, " vertices"],
    far: Bool[np.ndarray, " vertices"],
    count: int,
) -> Int[np.ndarray, " segments"]:
    """Grid cells that the far vertices of each segment occupy; segment -1 is none."""
    keep = far & (segment >= 0)
    cells = np.floor(vertices[keep] / GRID_M).astype(np.int64)
    unique = np.unique(np.column_stack([segment[keep], cells]), axis=0)
    return np.bincount(unique[:, 0], minlength=count)
