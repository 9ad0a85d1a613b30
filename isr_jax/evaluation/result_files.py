"""Reads what is scored: a results folder and a truth folder, both brought to the truth's world."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
from jaxtyping import Float, Int

from ..errors import SceneError
from ..geometry.boxes import canonical_box
from ..scene_file import SceneFile, read_scene
from ..types import Box

_TYPES = {
    "char": "i1", "uchar": "u1", "short": "<i2", "ushort": "<u2", "int": "<i4", "uint": "<u4",
    "float": "<f4", "double": "<f8", "int8": "i1", "uint8": "u1", "int16": "<i2", "uint16": "<u2",
    "int32": "<i4", "uint32": "<u4", "float32": "<f4", "float64": "<f8",
}  # fmt: skip
_COLUMNS = ("x", "y", "z", "instance", "class")


@dataclasses.dataclass(frozen=True, eq=False)
class Result:
    """A reconstructed scene and its map."""

    scene: SceneFile
    points: Float[np.ndarray, "vertices 3"]
    """Of the panoptic map, in the truth's world."""
    instance: Int[np.ndarray, " vertices"]
    """0 = none."""
    class_id: Int[np.ndarray, " vertices"]
    T_truth_result: Float[np.ndarray, "4 4"]
    """From the result's world to the truth's: both know the dataset's frame."""


@dataclasses.dataclass(frozen=True, eq=False)
class Truth:
    """The true scene and the part of its surface that the camera saw."""

    scene: SceneFile
    points: Float[np.ndarray, "points 3"]
    instance: Int[np.ndarray, " points"]
    """Id of the entity; 0 = none."""


def read_truth(folder: Path) -> Truth:
    """Read ``scene.json`` and ``observed.npz`` of a truth folder."""
    scene = read_scene(folder / "scene.json")
    path = folder / "observed.npz"
    try:
        with path.open("rb") as file, np.load(file, allow_pickle=False) as data:
            points, instance = data["points"], data["instance"]
    except (OSError, ValueError, KeyError) as error:
        raise SceneError(
            f"{path} cannot be read: {error}", "give the folder truth/ of a rendered sequence"
        ) from None
    if not (points.ndim == 2 and points.shape == (len(instance), 3)):
        raise SceneError(f"{path}: points {points.shape}, instance {instance.shape}", "render anew")
    return Truth(scene, points.astype(np.float64), instance.astype(np.int64))


def read_result(folder: Path, truth: Truth) -> Result:
    """Read ``scene.json`` and ``map/panoptic.ply`` of a results folder."""
    scene = read_scene(folder / "scene.json")
    table = read_vertices(folder / "map" / "panoptic.ply")
    T = truth.scene.T_world_dataset @ np.linalg.inv(scene.T_world_dataset)
    points = np.stack([table[c] for c in "xyz"], 1).astype(np.float64)
    return Result(
        scene,
        points @ T[:3, :3].T + T[:3, 3],
        table["instance"].astype(np.int64),
        table["class"].astype(np.int64),
        T,
    )


def moved_box(box: Box, T: Float[np.ndarray, "4 4"]) -> Box:
    """A gravity-aligned box in another world, whose up is (nearly) the same."""
    yaw = float(np.arctan2(T[1, 0], T[0, 0]))
    center = T[:3, :3] @ np.asarray(box.center, np.float64) + T[:3, 3]
    return canonical_box(center, float(box.yaw) + yaw, np.asarray(box.size))


def read_vertices(path: Path) -> np.ndarray:
    """The vertex table of a binary PLY; `SceneError` unless it has a label a vertex."""
    hint = "map/panoptic.ply is written by `isr run`"
    try:
        data = path.read_bytes()
    except OSError as error:
        raise SceneError(f"{path}: {error.strerror}", hint) from None
    head, mark, body = data.partition(b"end_header\n")
    lines = [line.split() for line in head.decode("ascii", "replace").splitlines()]
    if not mark or ["format", "binary_little_endian", "1.0"] not in lines:
        raise SceneError(f"{path} is no binary little-endian PLY", hint)
    first = next((i for i, line in enumerate(lines) if line[:2] == ["element", "vertex"]), None)
    if first is None:
        raise SceneError(f"{path} has no vertices", hint)
    rows = lines[first + 1 :]
    end = next((i for i, line in enumerate(rows) if line[:1] != ["property"]), len(rows))
    dtype = np.dtype([(line[-1], _TYPES[line[1]]) for line in rows[:end]])
    missing = [c for c in _COLUMNS if c not in (dtype.names or ())]
    count = int(lines[first][2])
    if missing or len(body) < count * dtype.itemsize:
        raise SceneError(f"{path} lacks {', '.join(missing) or 'some of its vertices'}", hint)
    return np.frombuffer(body, dtype, count)
