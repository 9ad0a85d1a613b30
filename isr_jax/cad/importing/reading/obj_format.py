"""Wavefront OBJ of other programs: groups, materials, polygons, texture coordinates."""

from __future__ import annotations

import dataclasses

import numpy as np
from jaxtyping import Float, Int

from ....errors import LibraryError
from .mesh_parts import MeshPart, check_finite
from .polygons import triangulated


@dataclasses.dataclass(eq=False)
class _Faces:
    """Polygons while lines are read: texts of corners, and what was set when they came."""

    corners: list[str] = dataclasses.field(default_factory=list)
    counts: list[int] = dataclasses.field(default_factory=list)
    material: list[int] = dataclasses.field(default_factory=list)
    group: list[int] = dataclasses.field(default_factory=list)


@dataclasses.dataclass(frozen=True, eq=False)
class ObjFile:
    """Triangles with their material and group."""

    vertices: Float[np.ndarray, "vertices 3"]
    colors: Float[np.ndarray, "vertices 3"] | None
    uv: Float[np.ndarray, "coordinates 2"]
    faces: Int[np.ndarray, "faces 3"]
    face_uv: Int[np.ndarray, "faces 3"]
    """Rows of ``uv``, -1 = none."""
    material: Int[np.ndarray, " faces"]
    group: Int[np.ndarray, " faces"]
    materials: tuple[str, ...]
    groups: tuple[str, ...]
    libraries: tuple[str, ...]
    """Names of its MTL files."""


def face_count(content: bytes) -> int:
    """Lines that start a face; polygons have more triangles."""
    return content.count(b"\nf ") + content.count(b"\nf\t") + content.startswith(b"f ")


def read_obj(content: bytes, source: str) -> ObjFile:
    """Parse; raises `LibraryError` for lines that cannot be what they claim."""
    text = _decoded(content).replace("\\\r\n", " ").replace("\\\n", " ")
    vertex, coordinate, faces = [], [], _Faces()
    materials: dict[str, int] = {"": 0}
    groups: dict[str, int] = {"": 0}
    libraries: list[str] = []
    material = group = 0
    for line in text.splitlines():
        head, _, rest = line.strip().replace("\t", " ").partition(" ")
        if head == "v":
            vertex.append(rest)
        elif head == "f":
            corners = rest.split()
            if "-" in rest:
                corners = [_absolute(c, len(vertex), len(coordinate)) for c in corners]
            if len(corners) >= 3:
                faces.corners += corners
                faces.counts.append(len(corners))
                faces.material.append(material)
                faces.group.append(group)
        elif head == "vt":
            coordinate.append(rest)
        elif head == "usemtl":
            material = materials.setdefault(rest.strip(), len(materials))
        elif head in ("o", "g"):
            group = groups.setdefault(rest.strip(), len(groups))
        elif head == "mtllib":
            libraries.append(rest.strip())
    try:
        return _triangles(vertex, coordinate, faces, (materials, groups, libraries), source)
    except ValueError as error:
        problem = f"{source}: a line is no OBJ: {error}"
        raise LibraryError(
            problem, "export it again, or give it the ending of its format"
        ) from None


def _decoded(content: bytes) -> str:
    try:
        return content.decode()
    except UnicodeDecodeError:
        return content.decode("latin-1")


def _absolute(corner: str, vertices: int, coordinates: int) -> str:
    """A corner counted from the end, counted from the start."""
    parts = corner.split("/")
    for k, count in ((0, vertices), (1, coordinates)):
        if len(parts) > k and parts[k].startswith("-"):
            parts[k] = str(count + 1 + int(parts[k]))
    return "/".join(parts)


def _triangles(vertex, coordinate, faces: _Faces, names, source: str) -> ObjFile:
    materials, groups, libraries = names
    if not vertex or not faces.counts:
        raise LibraryError(f"{source} holds no faces", "export the surface, not points or lines")
    table = _table(vertex, (3, 4, 6, 7, 8))
    uv = _table(coordinate, (1, 2, 3))[:, :2] if coordinate else np.zeros((0, 2))
    if uv.shape[1] == 1:
        uv = np.concatenate([uv, np.zeros_like(uv)], 1)
    corner, corner_uv = _corner_rows(faces.corners)
    if corner.min() < 0 or corner.max() >= len(table):
        problem = f"{source}: a face names a vertex that is not among its {len(table)}"
        raise LibraryError(problem, "export the mesh again")
    check_finite(table[np.unique(corner), :3], source)
    corner_uv = np.where((corner_uv >= 0) & (corner_uv < len(uv)), corner_uv, -1)
    vertices = np.ascontiguousarray(table[:, :3])
    triangle, owner = triangulated(vertices[corner], np.array(faces.counts))
    return ObjFile(
        vertices=vertices,
        colors=table[:, 3:6] if table.shape[1] == 6 else None,
        uv=uv,
        faces=corner[triangle],
        face_uv=corner_uv[triangle],
        material=np.array(faces.material)[owner],
        group=np.array(faces.group)[owner],
        materials=tuple(materials),
        groups=tuple(groups),
        libraries=tuple(libraries),
    )


def _table(rows: list[str], widths: tuple[int, ...]) -> np.ndarray:
    """Numbers of equally long rows; longer ones are cut to the shortest."""
    cells = [row.split() for row in rows]
    width = min(map(len, cells))
    if width not in widths:
        raise ValueError(f"{rows[0][:40]!r} has {width} numbers")
    if max(map(len, cells)) > width:
        cells = [row[:width] for row in cells]
    return np.array(cells).astype(np.float64)


def _corner_rows(corners: list[str]) -> tuple[np.ndarray, np.ndarray]:
    """Rows [corners] of vertices and of coordinates; -1 where no coordinate is named."""
    if not any("/" in corner for corner in corners):
        rows = np.array(corners).astype(np.int64) - 1
        return rows, np.full(len(rows), -1)
    parts = [corner.split("/") for corner in corners]
    rows = np.array([p[0] for p in parts]).astype(np.int64) - 1
    coordinates = [p[1] if len(p) > 1 and p[1] else "0" for p in parts]
    return rows, np.array(coordinates).astype(np.int64) - 1


def parts_of(obj: ObjFile, by_group: bool) -> list[MeshPart]:
    """One part per material, or per group and material; colours and textures come later.

    Args:
        obj: The file.
        by_group: Keep the file's objects apart.
    """
    key = obj.material * len(obj.groups) + obj.group if by_group else obj.material
    parts = []
    for value in np.unique(key):
        rows = np.flatnonzero(key == value)
        row = rows[0]
        uv = None
        if np.all(obj.face_uv[rows] >= 0):
            uv = obj.uv[obj.face_uv[rows]]
        colors = None
        if obj.colors is not None:
            top = 255.0 if obj.colors.max() <= 1.0 else 1.0
            colors = np.rint(np.clip(top * obj.colors, 0, 255)).astype(np.uint8)
        parts.append(
            MeshPart(
                name=obj.materials[obj.material[row]],
                vertices=obj.vertices,
                faces=obj.faces[rows],
                uv=uv,
                colors=colors,
                group=obj.groups[obj.group[row]] if by_group else "",
            )
        )
    return parts
