"""Wavefront OBJ of one triangle mesh: what is written reads back exactly, byte for byte."""

from __future__ import annotations

import numpy as np

from ..types import Mesh


def obj_text(mesh: Mesh, material: tuple[str, str] | None = None) -> str:
    """Vertices (with colours where there are any), uv, normals, triangles; shortest decimals.

    Args:
        mesh: Its ``uv`` are written once each, in ascending order.
        material: MTL file beside this one, and the name of the material in it.
    """
    columns = [numbers(mesh.vertices.astype(np.float32))]
    if mesh.colors is not None:
        columns.append(np.char.mod("%.4f", mesh.colors.astype(np.float64) / 255.0))
    lines = [] if material is None else [f"mtllib {material[0]}"]
    lines += ["v " + " ".join(row) for row in np.concatenate(columns, 1)]
    vertex = (np.asarray(mesh.faces) + 1).astype(str)
    corners, between = vertex, "//"
    if mesh.uv is not None:
        places, row = np.unique(_plain(mesh.uv).reshape(-1, 2), axis=0, return_inverse=True)
        lines += ["vt " + " ".join(place) for place in numbers(places)]
        texture = (row.reshape(vertex.shape) + 1).astype(str)
        corners, between = np.char.add(np.char.add(corners, "/"), texture), "/"
    if mesh.normals is not None:
        lines += ["vn " + " ".join(row) for row in numbers(mesh.normals.astype(np.float32))]
        corners = np.char.add(np.char.add(corners, between), vertex)
    lines += [] if material is None else [f"usemtl {material[1]}"]
    lines += ["f " + " ".join(row) for row in corners]
    return "\n".join(lines) + "\n"


def read_obj_text(text: str) -> Mesh:
    """The mesh of `obj_text`; raises ValueError for anything but triangles over vertices."""
    rows: dict[str, list[str]] = {"v": [], "vt": [], "vn": [], "f": []}
    for line in text.splitlines():
        kind, _, rest = line.partition(" ")
        if kind in rows:
            rows[kind].append(rest)
    table, uv, normals = (_table(rows[kind]) for kind in ("v", "vt", "vn"))
    if table is None or table.shape[1] not in (3, 6):
        raise ValueError("its vertices have not 3 or 6 numbers each")
    if uv is not None and uv.shape[1] != 2:
        raise ValueError("its texture coordinates are no pairs")
    if normals is not None and normals.shape != (len(table), 3):
        raise ValueError("it has not as many normals as vertices")
    corners = _corners(rows["f"])
    faces = _index(corners, 0, len(table))
    colors = np.rint(table[:, 3:] * 255.0).astype(np.uint8) if table.shape[1] == 6 else None
    return Mesh(
        table[:, :3].astype(np.float32),
        faces,
        colors,
        None if normals is None else normals.astype(np.float32),
        None if uv is None else uv.astype(np.float32)[_index(corners, 1, len(uv))],
    )


def material_library(text: str) -> str | None:
    """Name of the MTL file that an OBJ names, or None."""
    line = next((line for line in text.splitlines() if line.startswith("mtllib ")), None)
    return None if line is None else line.removeprefix("mtllib ").strip()


def numbers(values: np.ndarray) -> np.ndarray:
    """Shortest decimals that read back to the same floats of the array's own precision."""
    return _plain(values).astype(str)


def _plain(values: np.ndarray) -> np.ndarray:
    return values + values.dtype.type(0)  # turns -0.0 into 0.0


def _table(rows: list[str]) -> np.ndarray | None:
    """Numbers of rows that are equally long; None without rows."""
    if not rows:
        return None
    table = np.array([row.split() for row in rows], np.float64)
    if not np.all(np.isfinite(table)):
        raise ValueError("one of its numbers is not finite")
    return table


def _corners(rows: list[str]) -> np.ndarray:
    """[faces, 3, indices] of vertex, and of texture coordinates and normal where there are any."""
    joined = " ".join(rows)
    tokens = joined.split()
    if not rows or len(tokens) != 3 * len(rows) or any(row.count(" ") != 2 for row in rows):
        raise ValueError("it has no faces, or faces that are no triangles")
    for mark in ("/", "//"):
        if joined.count(mark) != tokens[0].count(mark) * len(tokens):
            raise ValueError("its faces are not all of one form")
    flat = np.array(joined.replace("/", " ").split(), np.int64).reshape(len(rows), 3, -1)
    return flat[:, :, :1] if "//" in tokens[0] else flat


def _index(corners: np.ndarray, column: int, count: int) -> np.ndarray:
    """Zero-based indices into a table of ``count`` rows."""
    if corners.shape[2] <= column:
        raise ValueError("its faces name no texture coordinates")
    found = corners[:, :, column].astype(np.int32) - 1
    if found.min() < 0 or found.max() >= count:
        raise ValueError("a face names a vertex that is not there")
    return found
