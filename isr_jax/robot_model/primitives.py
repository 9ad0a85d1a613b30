"""Axis-aligned boxes among meshes: simulators collide true boxes faster and steadier than hulls."""

from __future__ import annotations

from decimal import Decimal

import numpy as np

from ..types import Mesh

_CORNERS = np.array([[x, y, z] for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))])
BOX_QUADS = ((3, 2, 1, 0), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7))
"""Faces over corners listed bottom four counter-clockwise, then top four; seen from outside."""
BOX_FACES = np.array([f for a, b, c, d in BOX_QUADS for f in ((a, b, c), (a, c, d))], np.int32)
"""[12, 3]: `BOX_QUADS` as triangles."""


def box_between(low: np.ndarray, high: np.ndarray) -> Mesh:
    """Closed box mesh with 8 vertices between two opposite corners, metres."""
    bounds = np.stack([low, high]).astype(np.float32)
    return Mesh(bounds[_CORNERS, np.arange(3)], BOX_FACES.copy())


def as_box(mesh: Mesh) -> tuple[np.ndarray, np.ndarray] | None:
    """Low and high corner if the mesh is exactly a `box_between` two corners, else None."""
    if mesh.vertices.shape != (8, 3) or not np.array_equal(mesh.faces, BOX_FACES):
        return None
    if mesh.colors is not None or mesh.normals is not None:
        return None
    low, high = mesh.vertices[0], mesh.vertices[6]
    same = np.array_equal(box_between(low, high).vertices, mesh.vertices)
    return (low, high) if same and np.all(high > low) else None


def center_and_size(low: np.ndarray, high: np.ndarray) -> tuple[list[str], list[str]]:
    """Decimal texts of a box's centre and size, from which `bounds_of` recovers it exactly."""
    pairs = [(_decimal(a), _decimal(b)) for a, b in zip(low, high, strict=True)]
    return [_text((a + b) / 2) for a, b in pairs], [_text(b - a) for a, b in pairs]


def bounds_of(center: list[str], size: list[str]) -> tuple[np.ndarray, np.ndarray]:
    """Low and high corner (float32) of a box given by decimal texts."""
    pairs = [(Decimal(c), Decimal(s) / 2) for c, s in zip(center, size, strict=True)]
    low, high = [float(c - h) for c, h in pairs], [float(c + h) for c, h in pairs]
    return np.array(low, np.float32), np.array(high, np.float32)


def _decimal(value: np.floating) -> Decimal:
    return Decimal(str(np.float32(value) + np.float32(0)))


def _text(value: Decimal) -> str:
    text = format(value.normalize(), "f")
    return "0" if text == "-0" else text
