"""Shapes and hulls as bytes, for worker processes and the cache: arrays and JSON, no code."""

from __future__ import annotations

import io
import json
import zipfile
import zlib

import numpy as np

from ...types import Mesh
from .model_hulls import LinkShape, ModelHulls


def packed_shapes(shapes: tuple[LinkShape, ...], method: str) -> bytes:
    """A task for a worker."""
    arrays = {}
    for k, shape in enumerate(shapes):
        arrays |= {f"v{k}": shape.vertices, f"f{k}": shape.faces, f"T{k}": shape.T_model_link}
    return _packed({"names": [s.name for s in shapes], "method": method}, arrays)


def unpacked_shapes(data: bytes) -> tuple[tuple[LinkShape, ...], str]:
    """The task again: shapes and method."""
    head, arrays = _unpacked(data)
    shapes = tuple(
        LinkShape(name, arrays[f"v{k}"], arrays[f"f{k}"], arrays[f"T{k}"])
        for k, name in enumerate(head["names"])
    )
    return shapes, head["method"]


def packed_hulls(hulls: ModelHulls) -> bytes:
    """A result."""
    arrays = {}
    for i, link in enumerate(hulls.links):
        for k, mesh in enumerate(link):
            arrays |= {f"v{i}_{k}": mesh.vertices, f"f{i}_{k}": mesh.faces}
    counts = [len(link) for link in hulls.links]
    head = {"counts": counts, "swelling_m": hulls.swelling_m, "notes": list(hulls.notes)}
    return _packed(head, arrays)


def unpacked_hulls(data: bytes) -> ModelHulls:
    """The result again.

    Raises:
        ValueError: The bytes are none.
        KeyError: They lack a part of one.
    """
    head, arrays = _unpacked(data)
    links = tuple(
        tuple(Mesh(arrays[f"v{i}_{k}"], arrays[f"f{i}_{k}"]) for k in range(count))
        for i, count in enumerate(head["counts"])
    )
    return ModelHulls(links, head["swelling_m"], tuple(head["notes"]))


def _packed(head: dict, arrays: dict[str, np.ndarray]) -> bytes:
    stream = io.BytesIO()
    arrays = {"head": np.array(json.dumps(head)), **arrays}
    np.savez(stream, allow_pickle=False, **arrays)
    return stream.getvalue()


def _unpacked(data: bytes) -> tuple[dict, dict[str, np.ndarray]]:
    try:
        with np.load(io.BytesIO(data), allow_pickle=False) as stored:
            arrays = {name: stored[name] for name in stored.files}
    except (OSError, EOFError, zipfile.BadZipFile, zlib.error) as error:
        raise ValueError(str(error)) from None
    return json.loads(str(arrays.pop("head"))), arrays
