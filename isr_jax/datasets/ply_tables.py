"""Reads PLY meshes with what they say per vertex, as binary or ASCII. Refuses before allocating."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import BinaryIO

import numpy as np
from jaxtyping import Int

from ..errors import SequenceError

_TYPES = {
    "char": "i1",
    "uchar": "u1",
    "short": "i2",
    "ushort": "u2",
    "int": "i4",
    "uint": "u4",
    "float": "f4",
    "double": "f8",
    "int8": "i1",
    "uint8": "u1",
    "int16": "i2",
    "uint16": "u2",
    "int32": "i4",
    "uint32": "u4",
    "float32": "f4",
    "float64": "f8",
}
_ORDERS = {"binary_little_endian": "<", "binary_big_endian": ">", "ascii": "="}
_MAX_HEADER_LINES = 200
_MAX_LINE_BYTES = 4096
_HINT = "restore the file from the data set"


@dataclasses.dataclass(frozen=True)
class _Element:
    name: str
    count: int
    columns: tuple[tuple[str, str, str | None], ...]
    """(name, NumPy type, type of the count or None for a scalar) of its properties, in order."""

    @property
    def has_lists(self) -> bool:
        return any(counter for _, _, counter in self.columns)


@dataclasses.dataclass(frozen=True, eq=False)
class PlyMesh:
    """The tables of a file."""

    vertices: np.ndarray
    """[vertices], one named column per property."""
    faces: Int[np.ndarray, "faces 3"]


def read_ply_mesh(path: Path) -> PlyMesh:
    """Vertices and triangles of a PLY file; faces with more corners are cut into triangles.

    Raises:
        SequenceError: the file is no PLY, ends early, or names vertices it has not.
    """
    try:
        with path.open("rb") as file:
            order, elements = _header(file, path)
            left = path.stat().st_size - file.tell()
            return _body(file, path, order, elements, left)
    except OSError as error:
        raise SequenceError(f"{path}: {error.strerror}", _HINT) from None


def _header(file: BinaryIO, path: Path) -> tuple[str, list[_Element]]:
    if file.readline(_MAX_LINE_BYTES).strip() != b"ply":
        raise SequenceError(f"{path} is no PLY file", _HINT)
    order, elements = "", []
    for _ in range(_MAX_HEADER_LINES):
        words = file.readline(_MAX_LINE_BYTES).decode("ascii", "replace").split()
        if words == ["end_header"] and order:
            return order, elements
        try:
            if len(words) == 3 and words[0] == "format":
                order = _ORDERS[words[1]]
            elif words[:1] not in (["comment"], ["obj_info"]):
                _declare(elements, words)
        except (KeyError, IndexError, ValueError) as error:
            problem = f"{path}: header line {' '.join(words)[:80]!r} is not understood ({error})"
            raise SequenceError(problem, _HINT) from None
    raise SequenceError(f"{path}: the PLY header does not end", _HINT)


def _declare(elements: list[_Element], words: list[str]) -> None:
    """Take in an ``element`` or ``property`` line."""
    match words:
        case ["element", name, count]:
            elements.append(_Element(name, _count(count), ()))
            return
        case ["property", "list", size, item, name]:
            column = name, _TYPES[item], _TYPES[size]
        case ["property", kind, name]:
            column = name, _TYPES[kind], None
        case _:
            raise ValueError("no element or property")
    elements[-1] = dataclasses.replace(elements[-1], columns=(*elements[-1].columns, column))


def _count(text: str) -> int:
    if not (text.isascii() and text.isdigit() and len(text) < 12):
        raise ValueError("a count is a whole number below 10^11")
    return int(text)


def _body(file: BinaryIO, path: Path, order: str, elements: list[_Element], left: int) -> PlyMesh:
    vertices, faces = None, np.zeros((0, 3), np.int64)
    for element in elements:
        if element.count * max(1, len(element.columns)) > left:
            raise SequenceError(
                f"{path} claims {element.count} of {element.name}, but {left} bytes follow its "
                "header",
                _HINT,
            )
        if element.has_lists:
            rows = _read_lists(file, path, order, element)
            faces = _fans(rows) if element.name == "face" else faces
        else:
            table = _read_table(file, path, order, element)
            vertices = table if element.name == "vertex" else vertices
    if vertices is None or not {"x", "y", "z"} <= set(vertices.dtype.names or ()):
        raise SequenceError(f"{path} has no vertices with x, y, z", _HINT)
    if len(faces) and not (faces.min() >= 0 and faces.max() < len(vertices)):
        raise SequenceError(
            f"{path}: faces name vertices {faces.min()} to {faces.max()} of {len(vertices)}", _HINT
        )
    return PlyMesh(vertices, faces.astype(np.int32))


def _read_table(file: BinaryIO, path: Path, order: str, element: _Element) -> np.ndarray:
    try:
        dtype = np.dtype([(n, order + t) for n, t, _ in element.columns])
    except ValueError as error:
        raise SequenceError(f"{path}: {element.name}: {error}", _HINT) from None
    if order == "=":
        rows = [tuple(_words(file, path, element, i)) for i in range(element.count)]
        short = next((i for i, row in enumerate(rows) if len(row) != len(element.columns)), None)
        if short is not None:
            raise SequenceError(f"{path}: row {short} of {element.name} is cut off", _HINT)
        return np.array(rows, np.dtype([(n, "f8") for n, _, _ in element.columns])).astype(dtype)
    data = _bytes(file, path, element.count * dtype.itemsize, element.name)
    return np.frombuffer(data, dtype).astype(dtype.newbyteorder("="))


def _bytes(file: BinaryIO, path: Path, count: int, name: str) -> bytes:
    at, size = file.tell(), path.stat().st_size
    if at + count > size:
        raise SequenceError(
            f"{path} ends within its {name} table: {count} bytes from byte {at}, of {size}", _HINT
        )
    return file.read(count)


def _words(file: BinaryIO, path: Path, element: _Element, row: int) -> list[float]:
    try:
        return [float(v) for v in file.readline(_MAX_LINE_BYTES).split()]
    except ValueError as error:
        raise SequenceError(f"{path}: row {row} of {element.name}: {error}", _HINT) from None


def _read_lists(
    file: BinaryIO, path: Path, order: str, element: _Element
) -> Int[np.ndarray, "rows 3"] | list[list[int]]:
    """The first list of each row; as an array where all are triples (which is fast)."""
    if order == "=":
        return [
            _text_list(path, element, i, _words(file, path, element, i))
            for i in range(element.count)
        ]
    start = file.tell()
    triples = _triples(file, path, order, element)
    if triples is not None:
        return triples
    file.seek(start)
    return [_binary_list(file, path, order, element) for _ in range(element.count)]


def _triples(
    file: BinaryIO, path: Path, order: str, element: _Element
) -> Int[np.ndarray, "rows 3"] | None:
    """None unless there is one list, of three items in every row."""
    if sum(counter is not None for _, _, counter in element.columns) != 1:
        return None
    fields: list[tuple] = []
    for i, (_, kind, counter) in enumerate(element.columns):
        if counter is None:
            fields.append((f"scalar {i}", order + kind))
        else:
            fields += [("count", order + counter), ("items", order + kind, (3,))]
    dtype = np.dtype(fields)
    if file.tell() + element.count * dtype.itemsize > path.stat().st_size:
        return None
    table = np.frombuffer(file.read(element.count * dtype.itemsize), dtype)
    return table["items"].astype(np.int64) if (table["count"] == 3).all() else None


def _text_list(path: Path, element: _Element, row: int, words: list[float]) -> list[int]:
    at, found = 0, None
    for _, _, counter in element.columns:
        length = int(words[at]) if counter and at < len(words) else 0
        begin = at + (1 if counter else 0)
        at = begin + (length if counter else 1)
        if length < 0 or at > len(words):
            raise SequenceError(f"{path}: row {row} of {element.name} is cut off", _HINT)
        found = [int(v) for v in words[begin:at]] if counter and found is None else found
    return found or []


def _binary_list(file: BinaryIO, path: Path, order: str, element: _Element) -> list[int]:
    found = None
    for _, kind, counter in element.columns:
        length, item = 1, np.dtype(order + kind)
        if counter is not None:
            size = np.dtype(order + counter)
            length = int(np.frombuffer(_bytes(file, path, size.itemsize, element.name), size)[0])
        if length < 0:
            raise SequenceError(f"{path}: {element.name} with {length} items", _HINT)
        data = _bytes(file, path, length * item.itemsize, element.name)
        if counter is not None and found is None:
            found = np.frombuffer(data, item).astype(np.int64).tolist()
    return found or []


def _fans(rows: Int[np.ndarray, "rows 3"] | list[list[int]]) -> Int[np.ndarray, "faces 3"]:
    """Faces cut into triangles that share their first corner."""
    if isinstance(rows, np.ndarray):
        return rows
    triangles = [(r[0], r[k], r[k + 1]) for r in rows for k in range(1, len(r) - 1)]
    return np.array(triangles, np.int64).reshape(-1, 3)
