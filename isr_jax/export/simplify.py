"""Fewer faces for a mesh to look at: vertices of a grid cell become one."""

from __future__ import annotations

import numpy as np

from ..types import Mesh

_ROUNDS = 24


def simplified(mesh: Mesh, max_faces: int) -> Mesh:
    """The mesh with at most ``max_faces``, by the finest grid that gets there."""
    if len(mesh.faces) <= max_faces:
        return mesh
    extent = float(np.ptp(mesh.vertices, axis=0).max())
    # A surface of n cells across has about n^2 faces; start finer and coarsen by a quarter.
    cell = extent / (2.0 * max_faces**0.5)
    for _ in range(_ROUNDS):
        small = clustered(mesh, cell)
        if len(small.faces) <= max_faces:
            return small
        cell *= 1.25
    return small


def clustered(mesh: Mesh, cell_m: float) -> Mesh:
    """One vertex a grid cell, the mean of those in it; faces that collapse go."""
    keys = np.floor((mesh.vertices - mesh.vertices.min(0)) / cell_m).astype(np.int64)
    _, cluster, count = np.unique(keys, axis=0, return_inverse=True, return_counts=True)
    cluster = cluster.reshape(-1)
    vertices = _cluster_mean(mesh.vertices, cluster, count).astype(np.float32)
    faces = cluster[mesh.faces]
    a, b, c = faces.T
    faces = faces[(a != b) & (b != c) & (c != a)]
    _, rows = np.unique(np.sort(faces, 1), axis=0, return_index=True)
    colors = None
    if mesh.colors is not None:
        colors = np.round(_cluster_mean(mesh.colors, cluster, count)).astype(np.uint8)
    return Mesh(vertices, faces[np.sort(rows)].astype(np.int32), colors)


def _cluster_mean(values: np.ndarray, cluster: np.ndarray, count: np.ndarray) -> np.ndarray:
    sums = [np.bincount(cluster, weights=values[:, i], minlength=len(count)) for i in range(3)]
    return np.stack(sums, 1) / count[:, None]
