"""Parts of a surface as readers find them: checked, cleaned, and made visuals of a link."""

from __future__ import annotations

import dataclasses

import numpy as np
from jaxtyping import Float, Int, UInt8

from ....errors import LibraryError
from ....robot_model import Texture, Visual
from ....types import Mesh
from ..names import Unique, fit_name

GREY = (0.7, 0.7, 0.7, 1.0)
"""What has no colour of its own."""
_FARTHEST = 1e15  # beyond, squares of lengths overflow single precision


@dataclasses.dataclass(frozen=True, eq=False)
class MeshPart:
    """Triangles of one material, in the file's frame and unit."""

    name: str
    vertices: Float[np.ndarray, "vertices 3"]
    faces: Int[np.ndarray, "faces 3"]
    uv: Float[np.ndarray, "faces 3 2"] | None = None
    colors: UInt8[np.ndarray, "vertices 3"] | None = None
    rgba: tuple[float, float, float, float] = GREY
    texture: Texture | None = None
    group: str = ""
    """Name of the object of the file that it is a part of."""


@dataclasses.dataclass(frozen=True, eq=False)
class Shape:
    """What one mesh file holds, and what it says about itself."""

    parts: tuple[MeshPart, ...]
    unit_m: float | None = None
    up: Float[np.ndarray, "3"] | None = None
    front: Float[np.ndarray, "3"] | None = None
    notes: tuple[str, ...] = ()
    creator: str | None = None
    licence: str | None = None

    @property
    def face_count(self) -> int:
        return sum(len(part.faces) for part in self.parts)


def cleaned(part: MeshPart, source: str) -> MeshPart:
    """Equal vertices are one, triangles have three corners, and every vertex is used.

    Raises:
        LibraryError: A vertex is not finite, or a face names a vertex that is not there.
    """
    vertices, faces = np.asarray(part.vertices, np.float64), part.faces
    if len(faces) and (faces.min() < 0 or faces.max() >= len(vertices)):
        problem = f"{source}: a face names a vertex that is not among its {len(vertices)}"
        raise LibraryError(problem, "export the mesh again")
    check_finite(vertices[np.unique(faces)], source)
    key = vertices + 0.0  # -0 and 0 are one place
    if part.colors is not None:
        key = np.concatenate([key, part.colors], 1)
    _, first, place = np.unique(key, axis=0, return_index=True, return_inverse=True)
    faces = place.reshape(-1)[faces]
    kept = np.flatnonzero(_has_area(vertices[first], faces))
    used_rows, corners = np.unique(faces[kept], return_inverse=True)
    rows = first[used_rows]
    return dataclasses.replace(
        part,
        vertices=vertices[rows],
        faces=corners.reshape(-1, 3).astype(np.int32),
        uv=None if part.uv is None else np.asarray(part.uv, np.float32)[kept],
        colors=None if part.colors is None else part.colors[rows],
    )


def check_finite(vertices: Float[np.ndarray, "vertices 3"], source: str) -> None:
    """Refuse vertices that are not finite, or farther than anything is.

    Raises:
        LibraryError: There is such a vertex.
    """
    bad = ~(np.abs(vertices) < _FARTHEST).all(1)
    if bad.any():
        problem = f"{source}: {int(bad.sum())} vertices are not finite"
        raise LibraryError(problem, "export the mesh again")


def _has_area(vertices: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """[faces]: the corners differ and are not on one line."""
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    longest = np.maximum(np.abs(b - a).max(1), np.abs(c - a).max(1))
    return np.linalg.norm(normal, axis=1) > 1e-12 * longest**2


def shape_of(parts: list[MeshPart], source: str, **said) -> Shape:
    """A shape of cleaned parts; raises `LibraryError` where no triangle is left."""
    clean = [cleaned(part, source) for part in parts]
    kept = [part for part in clean if len(part.faces)]
    if not kept:
        raise LibraryError(f"{source} holds no faces", "export the surface, not points or lines")
    seen = [part for part in kept if part.rgba[3] > 0]
    notes = list(said.pop("notes", ()))
    if not seen:
        notes.append("all of it is fully transparent: shown opaque")
        seen = [dataclasses.replace(s, rgba=(*s.rgba[:3], 1.0)) for s in kept]
    elif len(seen) < len(kept):
        notes.append(f"{len(kept) - len(seen)} invisible parts left out")
    return Shape(tuple(seen), notes=tuple(notes), **said)


def moved(shape: Shape, T: Float[np.ndarray, "4 4"]) -> Shape:
    """All parts under an affine map; one that mirrors turns the faces round."""
    mirrored = bool(np.linalg.det(T[:3, :3]) < 0)
    return dataclasses.replace(
        shape, parts=tuple(_moved(part, T, mirrored) for part in shape.parts)
    )


def _moved(part: MeshPart, T: np.ndarray, mirrored: bool) -> MeshPart:
    uv = part.uv[:, ::-1] if mirrored and part.uv is not None else part.uv
    return dataclasses.replace(
        part,
        vertices=part.vertices @ T[:3, :3].T + T[:3, 3],
        faces=part.faces[:, ::-1] if mirrored else part.faces,
        uv=uv,
    )


def as_visuals(parts: tuple[MeshPart, ...], unique: Unique, link: str) -> tuple[Visual, ...]:
    """Visuals of a link, named after their materials.

    Args:
        parts: Cleaned.
        unique: Of the model: ``<link>_<visual>`` is the stem of a file.
        link: Name of the link.
    """
    visuals = []
    for i, part in enumerate(parts):
        stem = fit_name(part.name, f"part_{i}")
        name = unique(f"{link}_{stem}")[len(link) + 1 :]
        textured = part.texture is not None and part.uv is not None
        mesh = Mesh(
            part.vertices,
            part.faces,
            colors=part.colors,
            uv=part.uv if textured else None,
        )
        texture = part.texture if textured else None
        visuals.append(Visual(name, mesh, part.rgba, texture))
    return tuple(visuals)
