"""Wavefront OBJ of one triangle mesh: what is written reads back exactly, byte for byte."""

from __future__ import annotations

import numpy as np

from ..types import Mesh


def obj_text(mesh: Mesh) -> str:
    """Vertices (with colours where there are any), normals, triangles; shortest decimals."""
    columns = [numbers(mesh.vertices.astype(np.float32))]
    if mesh.colors is not None:
        columns.append(np.char.mod("%.4f", mesh.colors.astype(np.float64) / 255.0))
    lines = ["v " + " ".join(row) for row in np.concatenate(columns, 1)]
    corners = (np.asarray(mesh.faces) + 1).astype(str)
    if mesh.normals is not None:
        lines += ["vn " + " ".join(row) for row in numbers(mesh.normals.astype(np.float32))]
        corners = np.char.add(np.char.add(corners, "//"), corners)
    lines += ["f " + " ".join(row) for row in corners]
    return "\n".join(lines) + "\n"


def read_obj_text(text: str) -> Mesh:
    """The mesh of `obj_text`; raises ValueError for anything but triangles over vertices."""
    lines = text.splitlines()
    vertex = [line[2:] for line in lines if line.startswith("v ")]
    normal = [line[3:] for line in lines if line.startswith("vn ")]
    faces = np.array([line[2:].split() for line in lines if line.startswith("f ")])
    if not vertex or faces.ndim != 2 or faces.shape[1] != 3:
        raise ValueError("it holds no vertices or faces that are not triangles")
    if np.char.find(faces, "/").max() >= 0:
        faces = np.char.partition(faces, "/")[..., 0]
    faces = faces.astype(np.int32) - 1
    table = np.array([row.split() for row in vertex], np.float64)
    if table.shape[1] not in (3, 6) or faces.min() < 0 or faces.max() >= len(table):
        raise ValueError("its vertices have not 3 or 6 numbers, or a face names no vertex")
    colors = np.rint(table[:, 3:] * 255.0).astype(np.uint8) if table.shape[1] == 6 else None
    normals = np.array([row.split() for row in normal], np.float32) if normal else None
    return Mesh(table[:, :3].astype(np.float32), faces, colors, normals)


def numbers(values: np.ndarray) -> np.ndarray:
    """Shortest decimals that read back to the same floats of the array's own precision."""
    return (values + values.dtype.type(0)).astype(str)  # + 0 turns -0.0 into 0.0
