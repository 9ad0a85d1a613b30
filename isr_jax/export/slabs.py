"""Layout in the exported scene: boxes behind planes, open where a door or window fills them."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence

import numpy as np
from jaxtyping import Float

from ..config import ExportSettings
from ..geometry.convex import ConvexPart, box_part
from ..geometry.rectangles import rectangles_less
from ..types import Entity, Mesh

_LEVEL_COSINE = 0.98
"""A floor this level is made exactly level: the world frame says that it is."""
_JOINT_M = 0.005
"""Between what fills an opening and the wall around it."""
_LEAST_M = 0.01
"""Thinner strips beside an opening belong to its joint."""


@dataclasses.dataclass(frozen=True, eq=False)
class Slab:
    """A piece of layout: a box behind its plane, its +z face in the plane."""

    name: str
    entity_name: str
    """Of the wall that it is a part of; its own name where the wall is one slab."""
    class_name: str
    T_world_slab: np.ndarray
    """Centre of the box; z = the plane's normal."""
    size: np.ndarray
    scan: Mesh
    """World frame; of a wall in parts, the faces nearest to this one."""


def slabs_of(
    entity: Entity,
    settings: ExportSettings,
    above: Float[np.ndarray, "points 3"],
    fillings: Sequence[Float[np.ndarray, "_ 3"]] = (),
) -> tuple[Slab, ...]:
    """The slabs behind each plane of a piece of layout: one for each rectangle between openings.

    The first is named as the entity, the others ``wall_2_b``, ``wall_2_c`` and so on. A wall that
    was seen with a door in it is one plane, so the door's opening is cut here.

    Args:
        entity: Of layout.
        settings: Thickness and margin.
        above: Corners of all things: the floor is rarely seen under furniture.
        fillings: Vertices of each door and window, world frame.
    """
    rows = np.flatnonzero(np.asarray(entity.planes.valid)).tolist() or [0]
    whole = [_slab(entity, settings, above, row) for row in rows]
    parts = [part for slab in whole for part in _around(slab, fillings)]
    if len(parts) == 1:
        return (parts[0],)
    scans = _scan_parts(entity.mesh, parts)
    return tuple(
        dataclasses.replace(part, name=_part_name(entity.name, k), scan=scans[k])
        for k, part in enumerate(parts)
    )


def _part_name(name: str, k: int) -> str:
    """``wall_2``, ``wall_2_b``, ..., ``wall_2_z``, ``wall_2_ba``, ..."""
    if k == 0:
        return name
    letters = ""
    while k:
        k, digit = divmod(k, 26)
        letters = chr(ord("a") + digit) + letters
    return f"{name}_{letters}"


def _slab(entity: Entity, settings: ExportSettings, above: np.ndarray, plane: int) -> Slab:
    """The slab behind a plane; a floor reaches past what was seen of it, and under things."""
    planes = entity.planes
    normal = np.asarray(planes.normal[plane], np.float64)
    corners = np.asarray(planes.corners[plane], np.float64)
    center, level = corners.mean(0), abs(normal[2]) > _LEVEL_COSINE
    along = corners[1] - corners[0]
    if level:
        normal, along = np.array([0, 0, np.sign(normal[2])]), along * [1, 1, 0]
    x = along / np.linalg.norm(along)
    x = x - normal * (normal @ x)
    x /= np.linalg.norm(x)
    across = np.cross(normal, x)
    is_floor = entity.class_name == "floor"
    inside = np.concatenate([corners, above]) if is_floor else corners
    axes = np.stack([x, across], 1)
    low, high = (inside @ axes).min(0), (inside @ axes).max(0)
    margin_m = settings.floor_margin_m if is_floor else 0.0
    size = np.array([*(high - low + 2 * margin_m), settings.layout_thickness_m])
    T = np.eye(4)
    T[:3, :3] = np.stack([x, across, normal], 1)
    face = axes @ ((low + high) / 2) + normal * (normal @ center)
    T[:3, 3] = face - normal * size[2] / 2
    return Slab(entity.name, entity.name, entity.class_name, T, size, entity.mesh)


def _around(slab: Slab, fillings: Sequence[np.ndarray]) -> list[Slab]:
    """What is left of a slab around the doors and windows that reach into it."""
    holes = [hole for points in fillings if (hole := _hole(slab, points)) is not None]
    if not holes:
        return [slab]
    width, height = slab.size[:2].tolist()
    parts = []
    for u0, v0, u1, v1 in rectangles_less((width, height), np.array(holes)).astype(np.float64):
        if min(u1 - u0, v1 - v0) < _LEAST_M:
            continue
        middle = np.array([(u0 + u1 - width) / 2, (v0 + v1 - height) / 2, 0.0])
        T = slab.T_world_slab.copy()
        T[:3, 3] = T[:3, :3] @ middle + T[:3, 3]
        size = np.array([u1 - u0, v1 - v0, slab.size[2]])
        parts.append(dataclasses.replace(slab, T_world_slab=T, size=size))
    return parts


def _hole(slab: Slab, points: np.ndarray) -> np.ndarray | None:
    """(u0, v0, u1, v1) from the slab's corner, of what reaches into it; None for what does not."""
    T = slab.T_world_slab
    local = (np.asarray(points, np.float64) - T[:3, 3]) @ T[:3, :3] + slab.size / 2
    low, high = local.min(0), local.max(0)
    if np.any(high <= 0) or np.any(low >= slab.size):
        return None
    return np.concatenate([low[:2] - _JOINT_M, high[:2] + _JOINT_M])


def _scan_parts(mesh: Mesh, slabs: list[Slab]) -> list[Mesh]:
    """The scan of a wall, each face with the slab to which its middle is nearest."""
    middle = np.asarray(mesh.vertices, np.float64)[mesh.faces].mean(1)
    beyond = []
    for slab in slabs:
        local = (middle - slab.T_world_slab[:3, 3]) @ slab.T_world_slab[:3, :3]
        local[:, 2] -= slab.size[2] / 2
        inside = np.clip(local, [*(-slab.size[:2] / 2), 0], [*(slab.size[:2] / 2), 0])
        beyond.append(np.linalg.norm(local - inside, axis=1))
    nearest = np.argmin(beyond, axis=0) if len(middle) else np.zeros(0, int)
    return [
        _faces_of(mesh, nearest == k) if np.any(nearest == k) else _face_of(slab)
        for k, slab in enumerate(slabs)
    ]


def _face_of(slab: Slab) -> Mesh:
    """Two triangles over the face of a slab so small that no face of the scan is nearest to it."""
    x, y, z = slab.size / 2
    corners = np.array([(-x, -y, z), (x, -y, z), (x, y, z), (-x, y, z)])
    moved = corners @ slab.T_world_slab[:3, :3].T + slab.T_world_slab[:3, 3]
    return Mesh(moved.astype(np.float32), np.array([[0, 1, 2], [0, 2, 3]], np.int32))


def _faces_of(mesh: Mesh, chosen: np.ndarray) -> Mesh:
    used, inverse = np.unique(mesh.faces[chosen], return_inverse=True)
    colors, normals = (None if c is None else c[used] for c in (mesh.colors, mesh.normals))
    faces = inverse.reshape(-1, 3).astype(np.int32)
    return Mesh(mesh.vertices[used], faces, colors, normals)


def slab_part(slab: Slab) -> ConvexPart:
    """The box of a slab, world frame."""
    return box_part(slab.size, slab.T_world_slab)
