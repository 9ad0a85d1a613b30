"""Cutting triangles small, so that a surface has vertices as dense as a map's."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float, Int

from ..types import Mesh


def cut_edges(
    vertices: Float[np.ndarray, "vertices 3"], faces: Int[np.ndarray, "faces 3"], longest_m: float
) -> Mesh:
    """Halve each triangle at its longest edge until no edge is longer than ``longest_m``.

    An edge is cut in every triangle that has it, always at its middle, so nothing tears; long
    thin parts (legs, rails) stay cheap, which cutting all three edges at once does not allow.
    """
    vertices = np.asarray(vertices, np.float32)
    faces = np.asarray(faces, np.int32)
    done: list[np.ndarray] = []
    while len(faces):
        corners = vertices[faces]
        lengths = np.linalg.norm(corners - np.roll(corners, -1, axis=1), axis=2)
        worst = lengths.argmax(1)
        long = lengths.max(1) > longest_m
        done.append(faces[~long])
        turned = faces[long][np.arange(long.sum())[:, None], (worst[long, None] + [0, 1, 2]) % 3]
        a, b, c = turned.T
        key = np.minimum(a, b).astype(np.int64) * len(vertices) + np.maximum(a, b)
        _, first, inverse = np.unique(key, return_index=True, return_inverse=True)
        middle = (vertices[a[first]] + vertices[b[first]]) / 2
        m = (len(vertices) + inverse).astype(np.int32)
        vertices = np.concatenate([vertices, middle])
        faces = np.concatenate([np.stack([a, m, c], 1), np.stack([m, b, c], 1)])
    return Mesh(vertices, np.concatenate([*done, np.zeros((0, 3), np.int32)]))


def face_normals(mesh: Mesh) -> Float[np.ndarray, "faces 3"]:
    """Unit normals by the winding; 0 for a face without area."""
    corners = mesh.vertices[mesh.faces]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(normal, axis=1, keepdims=True)
    return (normal / np.maximum(length, 1e-20)).astype(np.float32)


def faceted(mesh: Mesh, face_rgb: Float[np.ndarray, "faces 3"]) -> Mesh:
    """The mesh with vertices shared only within a flat facet; normal and colour per vertex."""
    normal = face_normals(mesh)
    flat = mesh.faces.reshape(-1).astype(np.int64)
    levels = np.rint(normal * 500).astype(np.int64) + 512
    facet = (levels[:, 0] << 10 | levels[:, 1]) << 10 | levels[:, 2]
    key = flat << 30 | np.repeat(facet, 3)
    _, first, inverse = np.unique(key, return_index=True, return_inverse=True)
    return Mesh(
        mesh.vertices[flat[first]],
        inverse.reshape(-1, 3).astype(np.int32),
        np.rint(face_rgb[first // 3] * 255).astype(np.uint8),
        normal[first // 3],
    )
