"""Parts of a mesh: the faces of some vertices, and the pieces that belong together."""

from __future__ import annotations

import numpy as np
from jaxtyping import Bool, Int
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import KDTree

from ..types import Mesh


def submesh(mesh: Mesh, keep: Bool[np.ndarray, " vertices"]) -> Mesh:
    """The faces whose three vertices are kept; vertices of no such face go too."""
    a, b, c = mesh.faces.T
    faces = mesh.faces[keep[a] & keep[b] & keep[c]]  # an axis at a time: several times faster
    used = np.zeros(len(mesh.vertices), bool)
    used[faces] = True
    place = np.cumsum(used) - 1
    return Mesh(
        mesh.vertices[used],
        place[faces].astype(np.int32),
        None if mesh.colors is None else mesh.colors[used],
        None if mesh.normals is None else mesh.normals[used],
    )


def piece_of_vertices(mesh: Mesh, link_m: float) -> Int[np.ndarray, " vertices"]:
    """Piece of each vertex: vertices whose cells of side ``link_m`` touch are of one piece."""
    cell = np.floor(mesh.vertices / link_m).astype(np.int64)
    cells, cell_of = np.unique(cell, axis=0, return_inverse=True)
    pairs = KDTree(cells).query_pairs(1.8, output_type="ndarray")  # corner neighbours: sqrt(3)
    links = coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(len(cells),) * 2)
    _, piece = connected_components(links, directed=False)
    return piece[cell_of.ravel()]


def main_pieces(mesh: Mesh, link_m: float, min_ratio: float) -> Mesh:
    """The mesh without far, small pieces: labels that strayed onto other surfaces.

    Kept are the largest piece and those with at least ``min_ratio`` of its vertices.
    """
    if len(mesh.vertices) == 0:
        return mesh
    piece = piece_of_vertices(mesh, link_m)
    size = np.bincount(piece)
    return submesh(mesh, (size >= min_ratio * size.max())[piece])
