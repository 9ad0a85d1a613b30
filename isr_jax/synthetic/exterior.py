"""What of a model can be seen from outside: no map has the insides of closed cabinets."""

from __future__ import annotations

import functools
from collections.abc import Iterator

import numpy as np

from ..borders.raycast import RayScene
from ..library import CadModel
from ..robot_model import link_transforms
from ..types import Mesh
from .cutting import cut_edges, face_normals

_PIECE_M = 0.10
"""Faces are kept or dropped in pieces of this size."""
_RAYS = 32
_MIN_ESCAPES = 2
"""Rays of a piece that must leave the model: one alone slips through the gap of a door."""
_LIFT_M = 0.002
_PLANE_GRID = 6
_PLANE_SHARE = 0.2
"""Of a plane's rectangle that must be open for the plane to be seen."""


@functools.lru_cache(maxsize=512)
def exterior_parts(model: CadModel) -> tuple[tuple[Mesh, tuple[float, float, float]], ...]:
    """The open surface of each visual with its colour, canonical frame, joints closed."""
    parts = []
    poses = link_transforms(model.robot)
    for link in model.robot.links:
        T = poses[link.name]
        for visual in link.visuals:
            moved = visual.mesh.vertices @ T[:3, :3].T + T[:3, 3]
            pieces = cut_edges(moved.astype(np.float32), visual.mesh.faces, _PIECE_M)
            centers = pieces.vertices[pieces.faces].mean(1)
            escapes = _escapes(model, centers, face_normals(pieces))
            faces = pieces.faces[escapes >= _MIN_ESCAPES]
            if len(faces):
                r, g, b = visual.rgba[:3]
                parts.append((Mesh(pieces.vertices, faces), (r, g, b)))
    return tuple(parts)


@functools.lru_cache(maxsize=512)
def _open_planes(model: CadModel) -> tuple[bool, ...]:
    steps = (np.arange(_PLANE_GRID) + 0.5) / _PLANE_GRID
    u, v = (g.reshape(-1, 1) for g in np.meshgrid(steps, steps))
    seen = []
    for normal, corners in _plane_rows(model):
        points = corners[0] + u * (corners[1] - corners[0]) + v * (corners[3] - corners[0])
        escapes = _escapes(model, points, np.broadcast_to(normal, points.shape))
        seen.append(bool(np.mean(escapes >= _MIN_ESCAPES) >= _PLANE_SHARE))
    return tuple(seen)


def _plane_rows(model: CadModel) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Normal and corners of each plane."""
    return zip(np.asarray(model.planes.normal), np.asarray(model.planes.corners), strict=True)


def open_planes(model: CadModel) -> np.ndarray:
    """[planes] bool: which planes of a model can be seen from outside, joints closed."""
    return np.array(_open_planes(model), bool)


@functools.lru_cache(maxsize=512)
def _closed_scene(model: CadModel) -> RayScene:
    return RayScene([model.mesh], [1])


@functools.cache
def _sphere_directions() -> np.ndarray:
    """Directions spread evenly over the sphere (golden spiral)."""
    i = np.arange(2 * _RAYS) + 0.5
    z = 1 - i / _RAYS
    turn = np.pi * (1 + np.sqrt(5)) * i
    level = np.sqrt(1 - z * z)
    return np.stack([level * np.cos(turn), level * np.sin(turn), z], 1)


def _escapes(model: CadModel, points: np.ndarray, normals: np.ndarray) -> np.ndarray:
    """How many rays from each point, on the side of its normal, meet nothing of the model."""
    directions = _sphere_directions()
    outward = normals @ directions.T > 0.05
    row, column = np.nonzero(outward)
    origins = points[row] + _LIFT_M * normals[row]
    free = _closed_scene(model).cast(origins, directions[column]).instance == 0
    return np.bincount(row[free], minlength=len(points))
