"""A rectangle of layout less its openings: as rectangles, and as a mesh with reveals."""

from __future__ import annotations

import dataclasses

import numpy as np
from jaxtyping import Float

from ..geometry.rectangles import divided, grid_less, rectangles_less
from ..types import Mesh
from .room import LayoutPatch

WALL_M = 0.12
"""Thickness of walls: an inner wall of light blocks and plaster. Seen in the openings."""
JOINT_M = 0.005
"""Between a frame and the wall around it, on every side. Free in physics; to the eye it is filled,
or rays would find their way out between the two."""


def patch_sides(patch: LayoutPatch) -> tuple[float, float]:
    """Lengths along u and v, metres."""
    a, b, d = (np.asarray(patch.corners[k], np.float64) for k in (0, 1, 3))
    return float(np.linalg.norm(b - a)), float(np.linalg.norm(d - a))


def solid_rectangles(patch: LayoutPatch) -> Float[np.ndarray, "rectangles 4"]:
    """(u0, v0, u1, v1) of disjoint rectangles that make up what is solid; the largest first."""
    return rectangles_less(patch_sides(patch), patch.openings)


def rectangle_corners(
    patch: LayoutPatch, rectangle: Float[np.ndarray, "4"]
) -> Float[np.ndarray, "4 3"]:
    """Corners of (u0, v0, u1, v1) in the frame of the patch, in the order of its own."""
    u0, v0, u1, v1 = rectangle
    return _points(patch, np.array([u0, u1, u1, u0]), np.array([v0, v0, v1, v1]))


def solid_mesh(patch: LayoutPatch, spacing_m: float, reveal_m: float) -> Mesh:
    """What is solid as a mesh without cracks, faces towards the room and into the openings.

    Args:
        patch: With its openings.
        spacing_m: No cell is longer.
        reveal_m: Depth of the faces of an opening, behind the patch; 0 for none. An opening that
            begins at the patch's base has none there.
    """
    u, v, solid = grid_less(patch_sides(patch), patch.openings, spacing_m)
    gu, gv = np.meshgrid(u, v)
    row, column = np.nonzero(solid)
    corner = row * len(u) + column
    quads = np.stack([corner, corner + 1, corner + len(u) + 1, corner + len(u)], 1)
    parts = [_quad_mesh(_points(patch, gu.ravel(), gv.ravel()), quads, patch.normal)]
    if reveal_m > 0:
        for opening in np.asarray(patch.openings, np.float64):
            parts += _reveals(patch, opening, u, v, reveal_m, spacing_m)
    starts = np.cumsum([0, *(len(m.vertices) for m in parts[:-1])])
    return Mesh(
        np.concatenate([m.vertices for m in parts]),
        np.concatenate([m.faces + s for m, s in zip(parts, starts, strict=True)]).astype(np.int32),
        None,
        np.concatenate([m.normals for m in parts if m.normals is not None]),
    )


def joints_filled(patch: LayoutPatch) -> LayoutPatch:
    """The patch as it looks: its openings smaller by `JOINT_M`, but not at the patch's base."""
    inwards = np.tile([1.0, 1.0, -1.0, -1.0], (len(patch.openings), 1)) * JOINT_M
    inwards[patch.openings[:, 1] <= 0, 1] = 0.0
    return dataclasses.replace(patch, openings=(patch.openings + inwards).astype(np.float32))


def _reveals(
    patch: LayoutPatch,
    opening: np.ndarray,
    u: np.ndarray,
    v: np.ndarray,
    reveal_m: float,
    spacing_m: float,
) -> list[Mesh]:
    """The faces around an opening, which look into it."""
    u0, v0, u1, v1 = opening
    along_u, along_v = u[(u >= u0) & (u <= u1)], v[(v >= v0) & (v <= v1)]
    behind = divided(np.array([0.0, reveal_m]), spacing_m)
    axes = _axes(patch)
    faces = [
        (along_v, lambda s: (np.full_like(s, u0), s), axes[0]),
        (along_v, lambda s: (np.full_like(s, u1), s), -axes[0]),
        (along_u, lambda s: (s, np.full_like(s, v1)), -axes[1]),
    ]
    if v0 > 0:
        faces.append((along_u, lambda s: (s, np.full_like(s, v0)), axes[1]))
    meshes = []
    for line, place, normal in faces:
        s, depth = (g.ravel() for g in np.meshgrid(line, behind))
        points = _points(patch, *place(s)) - depth[:, None] * patch.normal
        n = len(line)
        corner = (np.arange(len(behind) - 1)[:, None] * n + np.arange(n - 1)).ravel()
        quads = np.stack([corner, corner + 1, corner + n + 1, corner + n], 1)
        meshes.append(_quad_mesh(points.astype(np.float32), quads, normal))
    return meshes


def _quad_mesh(points: np.ndarray, quads: np.ndarray, normal: np.ndarray) -> Mesh:
    """Two triangles a quad, wound so that they look along ``normal``."""
    used, inverse = np.unique(quads, return_inverse=True)
    points, quads = points[used], inverse.reshape(-1, 4)
    faces = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]]).astype(np.int32)
    first = points[faces[0]] if len(faces) else np.eye(3)
    if np.cross(first[1] - first[0], first[2] - first[0]) @ normal < 0:
        faces = faces[:, ::-1]
    normals = np.tile(np.asarray(normal, np.float32), (len(points), 1))
    return Mesh(points.astype(np.float32), np.ascontiguousarray(faces), None, normals)


def _axes(patch: LayoutPatch) -> np.ndarray:
    """[2, 3] unit u and v."""
    a, b, d = (np.asarray(patch.corners[k], np.float64) for k in (0, 1, 3))
    return np.stack([(b - a) / np.linalg.norm(b - a), (d - a) / np.linalg.norm(d - a)])


def _points(patch: LayoutPatch, u: np.ndarray, v: np.ndarray) -> Float[np.ndarray, "points 3"]:
    across, up = _axes(patch)
    return (patch.corners[0] + u[:, None] * across + v[:, None] * up).astype(np.float32)
