"""Planes of one mesh: RANSAC on a sample, then refit, extent and area on all vertices."""

from __future__ import annotations

import dataclasses

import jax
import numpy as np
from jaxtyping import Bool, Float

from ..types import Mesh, PlaneSet
from .ransac import peel_planes
from .rectangles import rectangle_corners, robust_rectangle, trimmed_range

MAX_POINTS = 2048
"""Points that RANSAC sees; more are thinned evenly."""
_FEW_POINTS = 512
"""Small meshes go in a smaller bucket; two buckets in all, so little is compiled."""
NORMAL_COSINE = float(np.cos(np.radians(30)))
"""Inliers have normals within 30 degrees of the plane's."""
_SAME_COSINE = float(np.cos(np.radians(10)))
_UPRIGHT = 0.1
"""A plane with |n_z| below this is upright: its rectangle stands on a level side."""


@dataclasses.dataclass(frozen=True, eq=False)
class FoundPlane:
    """One plane of a mesh, and the vertices that lie on it."""

    normal: Float[np.ndarray, "3"]
    offset: float
    inside: Bool[np.ndarray, " vertices"]


def find_planes(
    mesh: Mesh,
    *,
    threshold_m: float,
    min_ratio: float,
    max_planes: int,
    iterations: int,
    seed: int,
    usable: Bool[np.ndarray, " vertices"] | None = None,
) -> list[FoundPlane]:
    """Planes of a mesh by descending order of discovery, refitted to all their vertices."""
    if usable is None:
        usable = np.ones(len(mesh.vertices), bool)
    candidates = np.flatnonzero(usable)
    if len(candidates) < 3:
        return []
    center = mesh.vertices[candidates].mean(0, dtype=np.float64).astype(np.float32)
    points, normals, valid = _sample(mesh, candidates, center)
    normal, offset, count = (
        np.asarray(field)
        for field in peel_planes(
            points,
            normals,
            valid,
            jax.random.key(seed),
            np.float32(threshold_m),
            np.float32(NORMAL_COSINE),
            np.float32(min_ratio),
            np.int32(max_planes),
            iterations=iterations,
        )
    )
    live, found = usable.copy(), []
    for k in np.flatnonzero(count):
        plane = _refit(mesh, live, normal[k], float(offset[k]) - normal[k] @ center, threshold_m)
        if plane is not None and not any(_same(plane, f, mesh, threshold_m) for f in found):
            found.append(plane)
            live &= ~plane.inside
    return found


def _sample(mesh: Mesh, candidates, center):
    """Evenly thinned points in one of two buckets; padding lies at the centre, not valid."""
    assert mesh.normals is not None
    step = -(-len(candidates) // MAX_POINTS)
    chosen = candidates[::step]
    size = _FEW_POINTS if len(chosen) <= _FEW_POINTS else MAX_POINTS
    points, normals = np.zeros((size, 3), np.float32), np.zeros((size, 3), np.float32)
    points[: len(chosen)] = mesh.vertices[chosen] - center
    normals[: len(chosen)] = mesh.normals[chosen]
    return points, normals, np.arange(size) < len(chosen)


def _refit(mesh: Mesh, live, normal, offset, threshold_m) -> FoundPlane | None:
    """Least squares over all live vertices near the plane, twice, in float64."""
    vertices = mesh.vertices.astype(np.float64)
    normal = normal.astype(np.float64)
    for _ in range(3):
        near = np.abs(vertices @ normal + offset) < threshold_m
        inside = live & near & (mesh.normals @ normal > NORMAL_COSINE)
        if np.count_nonzero(inside) < 3:
            return None
        center = vertices[inside].mean(0)
        _, _, axes = np.linalg.svd(vertices[inside] - center, full_matrices=False)
        sign = -1.0 if axes[2] @ normal < 0 else 1.0
        normal = sign * axes[2]
        offset = -normal @ center
    return FoundPlane(normal.astype(np.float32), float(offset), inside)


def _same(a: FoundPlane, b: FoundPlane, mesh: Mesh, threshold_m: float) -> bool:
    """Whether a is b found again on the rim of its inliers."""
    if a.normal @ b.normal < _SAME_COSINE:
        return False
    center = mesh.vertices[a.inside].mean(0)
    return bool(abs(center @ b.normal + b.offset) < 2 * threshold_m)


def vertex_areas(mesh: Mesh) -> Float[np.ndarray, " vertices"]:
    """A third of the area of the faces around each vertex, square metres."""
    p = mesh.vertices[mesh.faces].astype(np.float64)
    area = np.linalg.norm(np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]), axis=1) / 6
    total = np.bincount(mesh.faces.ravel(), np.repeat(area, 3), minlength=len(mesh.vertices))
    return total.astype(np.float64)  # bincount counts nothing in integers


def plane_area(mesh: Mesh, plane: FoundPlane) -> float:
    """Observed area of a plane, square metres."""
    return float(vertex_areas(mesh)[plane.inside].sum())


def plane_set(mesh: Mesh, found: list[FoundPlane], *, trim: float, margin_m: float) -> PlaneSet:
    """The planes with their rectangles and observed areas, without padding."""
    areas = vertex_areas(mesh)
    corners = [
        plane_rectangle(mesh.vertices[f.inside], f.normal, f.offset, trim, margin_m) for f in found
    ]
    sides = [np.linalg.norm(c[[1, 3]] - c[0], axis=1) for c in corners]
    observed = [
        min(float(areas[f.inside].sum()), float(np.prod(s)))
        for f, s in zip(found, sides, strict=True)
    ]
    return PlaneSet(
        np.array([f.normal for f in found], np.float32).reshape(-1, 3),
        np.array([f.offset for f in found], np.float32),
        np.array(corners, np.float32).reshape(-1, 4, 3),
        np.array(observed, np.float32),
        np.ones(len(found), bool),
    )


def plane_rectangle(
    points: Float[np.ndarray, "points 3"], normal, offset: float, trim: float, margin_m: float
) -> Float[np.ndarray, "4 3"]:
    """Least rectangle in the plane around points, counter-clockwise seen against the normal."""
    n = np.asarray(normal, np.float64)
    upright = abs(n[2]) < _UPRIGHT
    side = np.cross([0, 0, 1.0], n) if abs(n[2]) < 0.9 else np.cross([0, 1.0, 0], n)
    side /= np.linalg.norm(side)
    axes = np.stack([side, np.cross(n, side)], 1)
    flat = points.astype(np.float64) @ axes
    if upright:
        ranges = [trimmed_range(flat[:, k], trim, margin_m) for k in range(2)]
        angle, (low, high) = 0.0, np.array(ranges).T
    else:
        angle, low, high = robust_rectangle(flat, trim, margin_m)
    return (rectangle_corners(angle, low, high) @ axes.T - offset * n).astype(np.float32)
