"""What is seen of solids, with texture coordinates in metres: one unit of a texture is 1 m."""

from __future__ import annotations

import numpy as np

from ...types import Mesh
from .solids import Solid, fan_triangles, plane_axes, rounded

_UV_DIGITS = 4
"""Tenths of a millimetre: files stay short, and no texture shows finer steps."""


def visual_mesh(solids: list[Solid]) -> Mesh:
    """The skin of the solids; staves of one wall share corners, so that it stays closed.

    Each polygon is projected along its own normal (`plane_axes`), so wood grain and fabric have
    their true size everywhere, and polygons of one plane continue each other's texture.
    """
    vertices: list[tuple[float, ...]] = []
    rows: dict[tuple, int] = {}
    polygons, flats = [], []
    for i, solid in enumerate(solids):
        # Only staves share corners with others; touching boxes stay closed bodies of their own.
        body = -1 if solid.hidden else i
        corners = [tuple(v) for v in rounded(solid.vertices).tolist()]
        for k, face in enumerate(solid.faces):
            if k in solid.hidden:
                continue
            for c in face:
                if (body, corners[c]) not in rows:
                    rows[body, corners[c]] = len(vertices)
                    vertices.append(corners[c])
            polygons.append([rows[body, corners[c]] for c in face])
            flats.append(solid.vertices[list(face)] @ plane_axes(solid.planes[k, :3]).T)
    fans = [[(0, i, i + 1) for i in range(1, len(f) - 1)] for f in polygons]
    uv = np.concatenate([flat[fan] for flat, fan in zip(flats, fans)])
    uv = (np.round(uv, _UV_DIGITS) + 0.0).astype(np.float32)
    return Mesh(np.array(vertices, np.float32), fan_triangles(polygons), uv=uv)
