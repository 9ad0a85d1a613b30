"""Boards: level planes of furniture too small beside the rest of it for the search of planes."""

from __future__ import annotations

from ..config import EntitySettings
from ..types import Mesh
from .planes import FoundPlane, find_planes, plane_area, vertex_areas

_LEVEL_COSINE = 0.9
"""Vertices of boards have normals this near the vertical. Not a_th: that says which of the planes
found here and elsewhere carry, and belongs to the contact graph."""
_APART_M = 0.1
"""Level planes nearer than this in height are rims of one another, not boards."""


def find_boards(
    mesh: Mesh, found: list[FoundPlane], threshold_m: float, settings: EntitySettings
) -> list[FoundPlane]:
    """Up-facing planes of at least the area of a board, among the vertices of no found plane.

    A shelf is a twentieth of what is seen of its bookcase, and carries books all the same.
    """
    assert mesh.normals is not None
    usable = mesh.normals[:, 2] > _LEVEL_COSINE
    for plane in found:
        usable &= ~plane.inside
    area = float(vertex_areas(mesh)[usable].sum())
    if area < settings.board_min_area_m2:
        return []
    boards = find_planes(
        mesh,
        threshold_m=threshold_m,
        min_ratio=min(1.0, settings.board_min_area_m2 / area),
        max_planes=settings.max_boards,
        iterations=settings.plane_iterations,
        seed=settings.seed,
        usable=usable,
    )
    heights = [_height(mesh, f) for f in found if f.normal[2] > _LEVEL_COSINE]
    kept = []
    for board in sorted(boards, key=lambda b: -plane_area(mesh, b)):
        height = _height(mesh, board)
        large = plane_area(mesh, board) >= settings.board_min_area_m2
        if large and board.normal[2] > _LEVEL_COSINE and _is_apart(height, heights):
            heights.append(height)
            kept.append(board)
    return kept


def _height(mesh: Mesh, plane: FoundPlane) -> float:
    return float(mesh.vertices[plane.inside, 2].mean())


def _is_apart(height: float, others: list[float]) -> bool:
    return all(abs(height - other) >= _APART_M for other in others)
