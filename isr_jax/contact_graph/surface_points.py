"""Points of a mesh near a plane, as dense as the vertices of a scan (host)."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float

from ..types import Mesh


def points_near_plane(
    mesh: Mesh, normal: Float[np.ndarray, "3"], offset: float, near_m: float, spacing_m: float
) -> Float[np.ndarray, "points 3"]:
    """Vertices within ``near_m`` of a plane, and points on the coarse faces that lie there.

    A scan has a vertex every voxel. A modelled table top may be two triangles; it carries all
    the same, so faces with a side longer than ``2 spacing_m`` are filled with points.
    """
    vertices = np.asarray(mesh.vertices, np.float32)
    near = np.abs(vertices @ normal + np.float32(offset)) <= near_m
    corners = vertices[mesh.faces[near[mesh.faces].all(-1)]]
    sides = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=-1)
    longest = sides.max(-1, initial=0.0)
    coarse = longest > 2 * spacing_m
    doublings = np.ceil(np.log2(longest[coarse] / spacing_m)).astype(int)
    filled = [
        _lattice(1 << int(level)) @ corners[coarse][doublings == level]
        for level in np.unique(doublings)
    ]
    points = [vertices[near], *(block.reshape(-1, 3) for block in filled)]
    return np.concatenate(points).astype(np.float32)


def _lattice(steps: int) -> Float[np.ndarray, "points 3"]:
    """Weights of the corners at the nodes that cut each side of a triangle into ``steps``."""
    i, j = np.indices((steps + 1, steps + 1))
    inside = i + j <= steps
    a, b = i[inside] / steps, j[inside] / steps
    return np.stack([1 - a - b, a, b], -1)
