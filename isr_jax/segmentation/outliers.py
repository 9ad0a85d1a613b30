"""Pieces of one instance that lie apart in space (paper, section IV: outlier removal)."""

from __future__ import annotations

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import KDTree

from ..types import Camera

_SPACING = 0.02 / 3
"""Samples are pixels so far apart, as a share of their depth: 2 cm at 3 m."""
_APART_M = 1e4
"""Offset that keeps instances apart in the fourth coordinate of the search."""


def largest_clusters(
    depth_m: Float[np.ndarray, "height width"],
    camera: Camera,
    piece: Int[np.ndarray, "height width"],
    instance: Int[np.ndarray, " pieces"],
    distance_m: float,
) -> Bool[np.ndarray, " pieces"]:
    """True for pieces in the largest cluster of their instance, and where ``instance`` is 0.

    Two pieces of an instance hang together if samples of them come within ``distance_m``. The
    samples are means over cells of half that size. A piece is a connected surface already and is
    not divided (the released code clusters points; grazing surfaces then fall apart).
    """
    several = np.bincount(instance)[instance] > 1
    searched = several & (instance > 0)
    points, owner = _samples(depth_m, camera, np.where(searched[piece], piece, 0), distance_m / 2)
    tree = KDTree(np.column_stack([points, instance[owner] * _APART_M]))
    near = tree.query_pairs(distance_m, output_type="ndarray")
    edges = (owner[near[:, 0]], owner[near[:, 1]])
    count = len(instance)
    links = coo_array((np.ones(len(near), bool), edges), shape=(count, count))
    _, cluster = connected_components(links, directed=False)
    pixels = np.bincount(piece.ravel(), minlength=count)
    weight = np.bincount(cluster, weights=pixels)[cluster]
    heaviest = np.zeros(int(instance.max()) + 1)
    np.maximum.at(heaviest, instance, weight)
    return ~searched | (weight == heaviest[instance])


def _samples(
    depth_m: np.ndarray, camera: Camera, piece: np.ndarray, cell_m: float
) -> tuple[np.ndarray, np.ndarray]:
    """Mean points of the cells that each piece occupies, camera frame, and their pieces."""
    stride = max(1, round(_SPACING * camera.fx))
    v, u = (
        i * stride + stride // 2
        for i in np.nonzero(piece[stride // 2 :: stride, stride // 2 :: stride])
    )
    z, owner = depth_m[v, u].astype(np.float64), piece[v, u].astype(np.int64)
    points = np.stack([(u - camera.cx) / camera.fx * z, (v - camera.cy) / camera.fy * z, z], 1)
    cell = np.floor(points / max(cell_m, 1e-6)).astype(np.int64) & 0xFFFF
    key = ((owner << 48) | (cell[:, 0] << 32)) ^ ((cell[:, 1] << 16) | cell[:, 2])
    _, inverse, count = np.unique(key, return_inverse=True, return_counts=True)
    sums = np.stack([np.bincount(inverse, weights=points[:, k]) for k in range(3)], 1)
    owners = np.zeros(len(count), np.int64)
    owners[inverse] = owner
    return sums.reshape(-1, 3) / np.maximum(count, 1)[:, None], owners
