"""Border: binary PLY files of meshes."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from ..errors import OutputError
from ..types import Mesh


def write_ply(path: Path, mesh: Mesh, extra: Mapping[str, np.ndarray] | None = None) -> None:
    """Write vertices, normals, colours, and integer columns a vertex, little-endian."""
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
