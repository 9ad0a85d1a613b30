"""Border: binary PLY files of meshes, written and read."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from jaxtyping import Int

from ..errors import OutputError, SceneError
from ..types import Mesh

_TYPES = {
    "char": "i1",
    "uchar": "u1",
    "short": "<i2",
    "ushort": "<u2",
    "int": "<i4",
    "uint": "<u4",
    "float": "<f4",
    "double": "<f8",
    "int8": "i1",
    "uint8": "u1",
    "int16": "<i2",
    "uint16": "<u2",
    "int32": "<i4",
    "uint32": "<u4",
    "float32": "<f4",
    "float64": "<f8",
}


def write_ply(path: Path, mesh: Mesh, extra: Mapping[str, np.ndarray] | None = None) -> None:
    """Write vertices, normals, colours, and integer columns of the vertices, little-endian.

    Raises:
        OutputError: the file cannot be written.
    """
    columns = _columns(mesh) | {k: np.asarray(v, np.int32) for k, v in (extra or {}).items()}
    kinds = {"f": "float", "u": "uchar", "i": "int"}
    table = np.zeros(
        len(mesh.vertices), [(k, v.dtype.newbyteorder("<")) for k, v in columns.items()]
    )
    for name, values in columns.items():
        table[name] = values
    faces = np.zeros(len(mesh.faces), [("count", "u1"), ("rows", "<i4", (3,))])
    faces["count"], faces["rows"] = 3, mesh.faces
    header = ["ply", "format binary_little_endian 1.0", f"element vertex {len(table)}"]
    header += [f"property {kinds[v.dtype.kind]} {k}" for k, v in columns.items()]
    header += [f"element face {len(faces)}", "property list uchar int vertex_indices", "end_header"]
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes("\n".join(header).encode() + b"\n" + table.tobytes() + faces.tobytes())
    except OSError as error:
        raise OutputError(
            f"{path}: {error.strerror}", "give a folder that can be written"
        ) from None


def _columns(mesh: Mesh) -> dict[str, np.ndarray]:
    columns = dict(zip("xyz", np.asarray(mesh.vertices, np.float32).T, strict=True))
    if mesh.normals is not None:
        columns |= dict(
            zip(("nx", "ny", "nz"), np.asarray(mesh.normals, np.float32).T, strict=True)
        )
    if mesh.colors is not None:
        columns |= dict(zip(("red", "green", "blue"), np.asarray(mesh.colors).T, strict=True))
    return columns


def read_mesh(path: Path, hint: str) -> Mesh:
    """A mesh as `write_ply` wrote it, with normals and colours where the file has them.

    Raises:
        SceneError: as `read_ply`.
    """
    table, faces = read_ply(path, ("x", "y", "z"), hint)

    def columns(names: tuple[str, ...]) -> np.ndarray | None:
        if not set(names) <= set(table.dtype.names or ()):
            return None
        return np.stack([table[name] for name in names], 1)

    return Mesh(
        vertices=np.stack([table[axis] for axis in "xyz"], 1),
        faces=faces,
        colors=columns(("red", "green", "blue")),
        normals=columns(("nx", "ny", "nz")),
    )


def read_ply(
    path: Path, columns: tuple[str, ...], hint: str
) -> tuple[np.ndarray, Int[np.ndarray, "faces 3"]]:
    """The table of vertices, whose columns are named as in the file, and the triangles.

    Args:
        path: Binary little-endian; vertices first, then faces (there may be none).
        columns: What the vertices must have.
        hint: The way out, for messages.

    Raises:
        SceneError: it is no such file, is cut short, or has faces that are no triangles.
    """
    try:
        data = path.read_bytes()
    except OSError as error:
        raise SceneError(f"{path}: {error.strerror}", hint) from None
    head, mark, body = data.partition(b"end_header\n")
    lines = [line.split() for line in head.decode("ascii", "replace").splitlines()]
    if not mark or ["format", "binary_little_endian", "1.0"] not in lines:
        raise SceneError(f"{path} is no binary little-endian PLY", hint)
    try:
        count, rows = _element(lines, "vertex")
        dtype = np.dtype([(row[2], _TYPES[row[1]]) for row in rows])
        faces, face_dtype = _face_table(lines)
    except (ValueError, IndexError, KeyError) as error:
        raise SceneError(f"{path} has a header of another kind: {error}", hint) from None
    missing = [c for c in columns if c not in (dtype.names or ())]
    if missing or len(body) < count * dtype.itemsize:
        raise SceneError(f"{path} lacks {', '.join(missing) or 'some of its vertices'}", hint)
    start = count * dtype.itemsize
    if len(body) < start + faces * face_dtype.itemsize:
        raise SceneError(f"{path} lacks some of its faces, or they are no triangles", hint)
    table = np.frombuffer(body, face_dtype, faces, start)
    triangles = table["vertex"].astype(np.int32)
    if np.any(table["corners"] != 3) or np.any((triangles < 0) | (triangles >= count)):
        raise SceneError(f"{path} has faces that are no triangles of its vertices", hint)
    return np.frombuffer(body, dtype, count), triangles


def _element(lines: list[list[str]], name: str) -> tuple[int, list[list[str]]]:
    """Count and properties of an element; (0, []) where the file has none."""
    first = next((i for i, line in enumerate(lines) if line[:2] == ["element", name]), None)
    if first is None:
        return 0, []
    rows = lines[first + 1 :]
    end = next((i for i, line in enumerate(rows) if line[:1] != ["property"]), len(rows))
    return int(lines[first][2]), rows[:end]


def _face_table(lines: list[list[str]]) -> tuple[int, np.dtype]:
    """Count and layout of faces that are triangles and nothing else."""
    count, rows = _element(lines, "face")
    if count == 0:
        return 0, np.dtype([("corners", "u1"), ("vertex", "<i4", 3)])
    ((_, kind, of_count, of_vertex, _),) = rows
    if kind != "list":
        raise ValueError(f"faces are {kind}")
    return count, np.dtype([("corners", _TYPES[of_count]), ("vertex", _TYPES[of_vertex], 3)])
