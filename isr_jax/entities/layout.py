"""Layout of a room: floor, ceiling and walls as planes with extents."""

from __future__ import annotations

import logging

import numpy as np

from ..config import EntitySettings
from ..geometry import canonical_box
from ..types import Box, Entity, Mesh, PanopticSurface, PlaneSet
from .planes import FoundPlane, find_planes, plane_rectangle, plane_set, vertex_areas
from .submesh import submesh

_LOG = logging.getLogger("isr_jax")
_LEVEL_COSINE = 0.8
"""Floor and ceiling vertices have normals this near the vertical."""
_UPRIGHT_COSINE = 0.3
"""Wall vertices have normals this near the horizontal (the greatest |n_z|)."""
_MERGE_COSINE = float(np.cos(np.radians(10)))
_MERGE_DISTANCE_M = 0.1
"""Wall planes of like direction and this near are one wall: depth sensors bend flat walls."""
_MAX_WALL_PLANES = 16
_THICKNESS_M = 0.02
"""Of the box of a plane without depth."""
_FLOOR_REACH_M = 0.05
"""Unlabelled vertices this near z = 0 stand in for a floor that nobody labelled."""


def level_layout(
    surface: PanopticSurface, mesh: Mesh, id: int, name: str, settings: EntitySettings
) -> Entity | None:
    """Floor (normal up) or ceiling (normal down); None if less than the least area was seen."""
    up = 1.0 if name == "floor" else -1.0
    assert mesh.normals is not None
    usable = up * mesh.normals[:, 2] > _LEVEL_COSINE
    if vertex_areas(mesh)[usable].sum() < settings.layout_min_area_m2:
        return None
    found = find_planes(
        mesh,
        threshold_m=settings.plane_threshold_m,
        min_ratio=settings.plane_min_ratio,
        max_planes=1,
        iterations=settings.plane_iterations,
        seed=settings.seed,
        usable=usable,
    )
    if not found:
        return None
    margin_m = 2 * surface.voxel_size_m
    planes = plane_set(mesh, found, trim=settings.box_trim, margin_m=margin_m)
    whole = plane_rectangle(
        mesh.vertices, found[0].normal, found[0].offset, settings.box_trim, margin_m
    )
    planes = PlaneSet(planes.normal, planes.offset, whole[None], planes.area_m2, planes.valid)
    return Entity(id, name, name, _slab(planes), planes, mesh, True)


def _slab(planes: PlaneSet) -> Box:
    """The box behind a layout plane: its rectangle, `_THICKNESS_M` deep, its face on the plane."""
    corners, normal = planes.corners[0], planes.normal[0]
    along, across = corners[1] - corners[0], corners[3] - corners[0]
    angle = float(np.arctan2(along[1], along[0]))
    length, width = float(np.linalg.norm(along)), float(np.linalg.norm(across))
    upright = abs(normal[2]) < 0.5
    size = (length, _THICKNESS_M, width) if upright else (length, width, _THICKNESS_M)
    return canonical_box(
        np.asarray(corners.mean(0) - normal * _THICKNESS_M / 2), angle, np.array(size)
    )


def fallback_floor(surface: PanopticSurface, id: int, settings: EntitySettings) -> Entity:
    """A floor at z = 0 under the whole map, for maps in which no floor was labelled; said aloud."""
    _LOG.warning(
        "no floor was labelled: a level floor at z = 0 with the extent of the map stands in for it"
    )
    assert surface.mesh.normals is not None
    vertices, normals = surface.mesh.vertices, surface.mesh.normals
    near = (np.abs(vertices[:, 2]) < _FLOOR_REACH_M) & (normals[:, 2] > _LEVEL_COSINE)
    seen = submesh(surface.mesh, near & (surface.instance == 0))
    margin_m = 2 * surface.voxel_size_m
    up = np.array([0, 0, 1], np.float32)
    corners = plane_rectangle(vertices, up, 0.0, settings.box_trim, margin_m)
    sides = np.linalg.norm(corners[[1, 3]] - corners[0], axis=1)
    area = np.array([min(vertex_areas(seen).sum(), np.prod(sides))], np.float32)
    planes = PlaneSet(up[None], np.zeros(1, np.float32), corners[None], area, np.ones(1, bool))
    faces = np.array([[0, 1, 2], [0, 2, 3]], np.int32)
    grey = np.full((4, 3), 128, np.uint8)
    mesh = seen if len(seen.faces) else Mesh(corners, faces, grey, np.tile(up, (4, 1)))
    return Entity(id, "floor", "floor", _slab(planes), planes, mesh, True)


def _is_wall(mesh: Mesh, plane: FoundPlane, areas: np.ndarray, settings: EntitySettings) -> bool:
    """Large enough and tall enough: what ends at the height of a worktop is furniture's front."""
    top_m = float(np.percentile(mesh.vertices[plane.inside, 2], 98))
    large = areas[plane.inside].sum() >= settings.layout_min_area_m2
    return bool(large and top_m >= settings.wall_min_top_m)


def walls(
    surface: PanopticSurface, mesh: Mesh, id: int, free_id: int, settings: EntitySettings
) -> list[Entity]:
    """Upright planes of the wall class, coplanar ones merged, largest first.

    The largest takes the instance's own ``id``, the others count up from ``free_id``.
    """
    assert mesh.normals is not None
    areas = vertex_areas(mesh)
    usable = np.abs(mesh.normals[:, 2]) < _UPRIGHT_COSINE
    total = areas[usable].sum()
    if total < settings.layout_min_area_m2:
        return []
    found = find_planes(
        mesh,
        threshold_m=settings.plane_threshold_m,
        min_ratio=min(settings.plane_min_ratio, settings.layout_min_area_m2 / total / 2),
        max_planes=_MAX_WALL_PLANES,
        iterations=settings.plane_iterations,
        seed=settings.seed,
        usable=usable,
    )
    found = merge_coplanar(mesh, [_upright(mesh, f) for f in found])
    found = [f for f in found if _is_wall(mesh, f, areas, settings)]
    found.sort(key=lambda f: -areas[f.inside].sum())
    margin_m = 2 * surface.voxel_size_m
    out = []
    for k, wall in enumerate(found):
        planes = plane_set(mesh, [wall], trim=settings.box_trim, margin_m=margin_m)
        part = submesh(mesh, wall.inside)
        wall_id = free_id + k - 1 if k else id
        out.append(Entity(wall_id, f"wall_{k + 1}", "wall", _slab(planes), planes, part, True))
    return out


def _upright(mesh: Mesh, plane: FoundPlane) -> FoundPlane:
    """The plane with an exactly level normal, through the middle of its vertices."""
    level = plane.normal * np.array([1, 1, 0], np.float32)
    level /= np.linalg.norm(level)
    middle = mesh.vertices[plane.inside].mean(0, dtype=np.float64)
    return FoundPlane(level, float(-level @ middle), plane.inside)


def merge_coplanar(mesh: Mesh, found: list[FoundPlane]) -> list[FoundPlane]:
    """Planes of like direction and offset become one, fitted to the vertices of both."""
    merged: list[FoundPlane] = []
    for plane in sorted(found, key=lambda f: -np.count_nonzero(f.inside)):
        middle = mesh.vertices[plane.inside].mean(0)
        for k, other in enumerate(merged):
            near = abs(middle @ other.normal + other.offset) < _MERGE_DISTANCE_M
            if near and plane.normal @ other.normal > _MERGE_COSINE:
                inside = plane.inside | other.inside
                merged[k] = _level_fit(mesh, inside, other.normal)
                break
        else:
            merged.append(plane)
    return merged


def _level_fit(mesh: Mesh, inside, like) -> FoundPlane:
    """Least-squares plane with a level normal."""
    flat = mesh.vertices[inside].astype(np.float64)
    middle = flat.mean(0)
    _, _, axes = np.linalg.svd(flat[:, :2] - middle[:2], full_matrices=False)
    normal = np.array([*axes[1], 0.0])
    normal *= np.sign(normal @ like)
    return FoundPlane(normal.astype(np.float32), float(-normal @ middle), inside)
