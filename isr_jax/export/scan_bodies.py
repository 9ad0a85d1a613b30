"""Bodies for entities without a CAD model: their scan to look at, convex hulls to collide.

A scan is an open, noisy surface, so its body is a stated simplification: one convex hull of the
vertices, of at most 64 corners, solid, with the density of its class. Its base is flat: the lowest
part of the scan is extruded down to the height of its support (what lies below is noise, a gap is
unseen), widened until the centre of mass stands above it. What an entity carries needs room: its
vertices are parted below, above and beside each carried box, level with the plane that carries it,
and every part has a hull of its own (a shelf becomes boards and sides, not a block).
"""

from __future__ import annotations

import dataclasses

import numpy as np
from scipy.spatial import ConvexHull, QhullError

from ..classes import class_named
from ..robot_model import Link, RobotModel, Visual, combined_properties, solid_properties
from ..types import Entity, Mesh
from .hull_meshes import extreme_points, hull_mesh
from .simplify import simplified

_BASE_SHARES = (0.2, 0.4, 0.7, 1.0)
"""Lowest part of the height whose outline becomes the base, tried in turn."""
_BASE_CORNERS = 16
_RISE_M = 0.03
"""What sticks out less above a carrying plane is noise of the plane."""


@dataclasses.dataclass(frozen=True, eq=False)
class Niche:
    """Room for one carried entity: its box, grown a little, from the carrying plane upwards."""

    plane_m: float
    """Height of the plane that carries it."""
    top_m: float
    center: np.ndarray
    """[2], world."""
    yaw: float
    half: np.ndarray
    """[2]: half its extent along its own axes."""


def scan_robot(
    entity: Entity,
    bottom_m: float | None,
    niches: tuple[Niche, ...],
    origin: np.ndarray,
    *,
    max_vertices: int,
    max_faces: int,
    friction: float,
) -> RobotModel:
    """One link with the scan as visual, about ``origin`` with world axes.

    Args:
        entity: Its mesh is in the world frame.
        bottom_m: Height of what supports it; None where nothing does.
        niches: Room for what it carries.
        origin: Where the link's frame goes, world, metres.
        max_vertices: Of a hull.
        max_faces: Of the visual mesh.
        friction: Sliding friction of the body.
    """
    points = np.asarray(entity.mesh.vertices, np.float64)
    hulls = [recentred(h, origin) for h in scan_hulls(points, bottom_m, niches, max_vertices)]
    visual = simplified(entity.mesh, max_faces)
    rgba = mean_color(visual)
    link = solid_link(entity.name, tuple(hulls), class_named(entity.class_name).density_kg_m3)
    seen = Visual("scan", recentred(visual, origin), rgba)
    link = dataclasses.replace(link, visuals=(seen,), friction=friction)
    return RobotModel(entity.name, (link,), ())


def scan_hulls(
    points: np.ndarray, bottom_m: float | None, niches: tuple[Niche, ...], max_vertices: int
) -> list[Mesh]:
    """Convex hulls of a scan, world frame; the lowest part gets the base."""
    parts = [points]
    for niche in sorted(niches, key=lambda n: n.plane_m):
        parts = [piece for part in parts for piece in _parted(part, niche)]
    parts.sort(key=lambda part: part[:, 2].min())
    hulls = [_standing_hull(parts[0], bottom_m, max_vertices)]
    return hulls + [hull_mesh(part, max_vertices) for part in parts[1:]]


def _parted(points: np.ndarray, niche: Niche) -> list[np.ndarray]:
    """Points below a niche, above it and beside it; those inside go."""
    c, s = np.cos(niche.yaw), np.sin(niche.yaw)
    local = (points[:, :2] - niche.center) @ np.array([[c, -s], [s, c]])
    beside = np.any(local.min(0) >= niche.half) or np.any(local.max(0) <= -niche.half)
    if beside or points[:, 2].max() <= niche.plane_m or points[:, 2].min() >= niche.top_m:
        return [points]
    noise = (points[:, 2] > niche.plane_m) & (points[:, 2] <= niche.plane_m + _RISE_M)
    points = points.copy()
    points[noise, 2] = niche.plane_m
    height, left = points[:, 2], np.ones(len(points), bool)
    sides = [height <= niche.plane_m, height >= niche.top_m]
    sides += [s * local[:, k] >= niche.half[k] for k in (0, 1) for s in (1, -1)]
    parts = []
    for side in sides:
        parts.append(points[left & side])
        left &= ~side
    return [part for part in parts if len(part) >= 4] or [points]


def _standing_hull(points: np.ndarray, bottom_m: float | None, max_vertices: int) -> Mesh:
    if bottom_m is None or bottom_m >= points[:, 2].max():
        return hull_mesh(points, max_vertices)
    points = points[points[:, 2] >= bottom_m]
    upper = points
    if len(points) > max_vertices - _BASE_CORNERS:
        upper = points[extreme_points(points, max_vertices - _BASE_CORNERS)]
    for share in _BASE_SHARES:
        limit = bottom_m + share * (points[:, 2].max() - bottom_m)
        base = _outline(points[points[:, 2] <= limit][:, :2])
        if base is None:
            continue
        corners = np.column_stack([base, np.full(len(base), bottom_m)])
        hull = hull_mesh(np.concatenate([upper, corners]), max_vertices)
        if _inside(solid_properties(hull, 1.0)[1][:2], base):
            return hull
    return hull_mesh(points, max_vertices)


def _outline(points: np.ndarray) -> np.ndarray | None:
    """Convex outline in the plane, thinned; None where the points lie on a line."""
    if len(points) < 3:
        return None
    try:
        outline = points[ConvexHull(points).vertices]
    except QhullError:
        return None
    if len(outline) > _BASE_CORNERS:
        angle = 2 * np.pi * np.arange(_BASE_CORNERS) / _BASE_CORNERS
        far = np.argmax(outline @ np.stack([np.cos(angle), np.sin(angle)]), 0)
        outline = outline[np.unique(far)]
    return outline


def _inside(point: np.ndarray, outline: np.ndarray, margin: float = 0.1) -> bool:
    """Whether the point lies in the outline shrunk by ``margin`` about its middle."""
    middle = outline.mean(0)
    equations = ConvexHull(middle + (1 - margin) * (outline - middle)).equations
    return bool(np.all(equations[:, :2] @ point + equations[:, 2] <= 0))


def solid_link(name: str, hulls: tuple[Mesh, ...], density_kg_m3: float) -> Link:
    """A link of solid hulls; where they overlap, the overlap counts twice."""
    mass, com, inertia = combined_properties([solid_properties(h, density_kg_m3) for h in hulls])
    return Link(name, (), hulls, mass, com, inertia)


def recentred(mesh: Mesh, origin: np.ndarray) -> Mesh:
    """The mesh with ``origin`` moved to zero."""
    moved = (np.asarray(mesh.vertices, np.float64) - origin).astype(np.float32)
    return Mesh(moved, mesh.faces, mesh.colors, mesh.normals)


def mean_color(mesh: Mesh) -> tuple[float, float, float, float]:
    """Mean colour of the vertices; grey without colours."""
    if mesh.colors is None or len(mesh.colors) == 0:
        return (0.6, 0.6, 0.6, 1.0)
    r, g, b = (float(c) for c in np.round(mesh.colors.mean(0) / 255, 3))
    return (r, g, b, 1.0)
