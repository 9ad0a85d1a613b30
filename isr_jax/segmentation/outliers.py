"""Pieces of one instance that lie apart in space (paper, section IV: outlier removal)."""

from __future__ import annotations

import dataclasses

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


@dataclasses.dataclass(frozen=True, eq=False)
class _Samples:
    """Mean points of the cells that each piece occupies."""

    points: Float[np.ndarray, "samples 3"]
    """Camera frame, metres."""
    owner: Int[np.ndarray, " samples"]
    """Piece."""
    image: Int[np.ndarray, "rows columns"]
    """Sample of every few pixels; -1 = none."""


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
    searched = (np.bincount(instance)[instance] > 1) & (instance > 0)
    samples = _samples(depth_m, camera, piece, searched, distance_m / 2)
    near = _image_pairs(samples, instance, distance_m)
    cluster = _joined(samples.owner[near], len(instance))
    near = np.concatenate([near, _space_pairs(samples, instance, cluster, distance_m)])
    cluster = _joined(samples.owner[near], len(instance))
    pixels = np.bincount(piece.ravel(), minlength=len(instance))
    weight = np.bincount(cluster, weights=pixels)[cluster]
    heaviest = np.zeros(int(instance.max()) + 1)
    np.maximum.at(heaviest, instance, weight)
    return ~searched | (weight == heaviest[instance])


def _joined(pairs: Int[np.ndarray, "pairs 2"], count: int) -> Int[np.ndarray, " count"]:
    """Cluster of each piece."""
    links = coo_array((np.ones(len(pairs), bool), tuple(pairs.T)), shape=(count, count))
    return connected_components(links, directed=False)[1]


def _image_pairs(
    samples: _Samples, instance: Int[np.ndarray, " pieces"], distance_m: float
) -> Int[np.ndarray, "pairs 2"]:
    """Samples of different pieces of an instance, side by side in the image and near in space."""
    image = samples.image
    sides = ((image[:, :-1], image[:, 1:]), (image[:-1], image[1:]))
    one, other = (np.concatenate([side[k].ravel() for side in sides]) for k in (0, 1))
    both = (one >= 0) & (other >= 0)
    one, other = one[both], other[both]
    owners = samples.owner[one], samples.owner[other]
    joins = (owners[0] != owners[1]) & (instance[owners[0]] == instance[owners[1]])
    one, other = one[joins], other[joins]
    gap = samples.points[one] - samples.points[other]
    near = np.einsum("ij,ij->i", gap, gap) <= distance_m**2
    return np.stack([one[near], other[near]], 1)


def _space_pairs(
    samples: _Samples,
    instance: Int[np.ndarray, " pieces"],
    cluster: Int[np.ndarray, " pieces"],
    distance_m: float,
) -> Int[np.ndarray, "pairs 2"]:
    """Samples of different clusters of an instance that are near in space: enough to join them.

    All such pairs of the lesser clusters, and for each of their samples its nearest one in the
    cluster of the instance that has most samples.
    """
    size = np.bincount(cluster[samples.owner], minlength=len(cluster))
    instance_of = np.zeros(len(cluster), instance.dtype)
    instance_of[cluster] = instance
    most = np.zeros(int(instance.max()) + 1, int)
    by_size = np.argsort(size, kind="stable")
    most[instance_of[by_size]] = by_size
    in_main = (cluster == most[instance])[samples.owner]
    main, lesser = np.flatnonzero(in_main), np.flatnonzero(~in_main)
    where = np.column_stack([samples.points, instance[samples.owner] * _APART_M])
    among = KDTree(where[lesser]).query_pairs(distance_m, output_type="ndarray")
    divided = np.isin(instance[samples.owner[main]], instance[samples.owner[lesser]])
    main = main[divided]
    limit = np.nextafter(distance_m, np.inf)
    gap, nearest = KDTree(where[main]).query(where[lesser], distance_upper_bound=limit)
    reached = np.isfinite(gap)
    to_main = np.stack([lesser[reached], main[np.asarray(nearest)[reached]]], 1)
    return np.concatenate([lesser[among], to_main])


def _samples(
    depth_m: np.ndarray, camera: Camera, piece: np.ndarray, searched: np.ndarray, cell_m: float
) -> _Samples:
    """Samples of the pieces that are searched."""
    stride = max(1, round(_SPACING * camera.fx))
    grid = (slice(stride // 2, None, stride),) * 2
    kept = searched[piece[grid]]
    v, u = (i * stride + stride // 2 for i in np.nonzero(kept))
    z, owner = depth_m[v, u].astype(np.float64), piece[v, u].astype(np.int64)
    points = np.stack([(u - camera.cx) / camera.fx * z, (v - camera.cy) / camera.fy * z, z], 1)
    cell = np.floor(points / max(cell_m, 1e-6)).astype(np.int64) & 0xFFFF
    key = ((owner << 48) | (cell[:, 0] << 32)) ^ ((cell[:, 1] << 16) | cell[:, 2])
    _, inverse, count = np.unique(key, return_inverse=True, return_counts=True)
    sums = np.stack([np.bincount(inverse, weights=points[:, k]) for k in range(3)], 1)
    owners = np.zeros(len(count), np.int64)
    owners[inverse] = owner
    image = np.full(kept.shape, -1)
    image[kept] = inverse
    return _Samples(sums.reshape(-1, 3) / np.maximum(count, 1)[:, None], owners, image)
