"""Fewer faces for a mesh to look at: vertices of a grid cell become one."""

from __future__ import annotations

import numpy as np

from ..types import Mesh

_ROUNDS = 12


def simplified(mesh: Mesh, max_faces: int) -> Mesh:
    """The mesh with at most ``max_faces``, by a grid not much coarser than that takes."""
    small, cell = mesh, float(np.ptp(mesh.vertices, axis=0).max()) / (2.0 * max_faces**0.5)
    for _ in range(_ROUNDS):
        if len(small.faces) <= max_faces:
            break
        small = clustered(mesh, cell)
        # Faces go with the square of the cell; a tenth more, since that is a rule of thumb.
        cell *= 1.1 * max(1.0, len(small.faces) / max_faces) ** 0.5
    return small


def clustered(mesh: Mesh, cell_m: float) -> Mesh:
    """One vertex a grid cell and side, the mean of those in it; faces that collapse go.

    The side is the axis that a vertex's normal is nearest to: without it the two faces of a thin
    board would become one sheet, seen from one side only.
    """
    cells = np.floor((mesh.vertices - mesh.vertices.min(0)) / cell_m).astype(np.int64)
    keys = _as_one(cells) * 6 + _sides(mesh)
    _, cluster, count = np.unique(keys, return_inverse=True, return_counts=True)
    vertices = _cluster_mean(mesh.vertices, cluster, count).astype(np.float32)
    faces = cluster[mesh.faces]
    a, b, c = faces.T
    faces = faces[(a != b) & (b != c) & (c != a)]
    # Turned so that the smallest comes first, equal faces are equal and opposite ones are not.
    turn = (np.argmin(faces, 1)[:, None] + np.arange(3)) % 3
    _, rows = np.unique(_as_one(np.take_along_axis(faces, turn, 1)), return_index=True)
    colors = None
    if mesh.colors is not None:
        colors = np.round(_cluster_mean(mesh.colors, cluster, count)).astype(np.uint8)
    return Mesh(vertices, faces[np.sort(rows)].astype(np.int32), colors)


def _sides(mesh: Mesh) -> np.ndarray:
    """0 to 5: the signed axis nearest to each vertex's normal."""
    corners = mesh.vertices[mesh.faces].astype(np.float64)
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    total = np.zeros((len(mesh.vertices), 3))
    for k in range(3):
        for axis in range(3):
            total[:, axis] += np.bincount(mesh.faces[:, k], normal[:, axis], len(total))
    axis = np.argmax(np.abs(total), 1)
    return 2 * axis + (total[np.arange(len(total)), axis] < 0)


def _as_one(rows: np.ndarray) -> np.ndarray:
    """One integer a row of three, each below 2^20: `np.unique` over an axis is 20 times slower."""
    rows = np.asarray(rows, np.int64)
    return (rows[:, 0] << 40) | (rows[:, 1] << 20) | rows[:, 2]


def _cluster_mean(values: np.ndarray, cluster: np.ndarray, count: np.ndarray) -> np.ndarray:
    sums = [np.bincount(cluster, weights=values[:, i], minlength=len(count)) for i in range(3)]
    return np.stack(sums, 1) / count[:, None]
