"""Reads what is scored: a results folder and a truth folder, both brought to the truth's world."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
from jaxtyping import Float, Int

from ..borders.ply import read_ply
from ..config import DEFAULT_SUPPORT, SupportSettings, settings_from_dict
from ..errors import SceneError
from ..geometry.boxes import canonical_box
from ..scene_file import SceneFile, read_scene
from ..types import Box, Mesh

_COLUMNS = ("x", "y", "z", "instance", "class")
_TRUTH_HINT = "give the folder truth/ of a rendered sequence"


@dataclasses.dataclass(frozen=True, eq=False)
class Result:
    """A reconstructed scene and its map."""

    scene: SceneFile
    points: Float[np.ndarray, "vertices 3"]
    """Of the panoptic map, in the truth's world."""
    faces: Int[np.ndarray, "faces 3"]
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
    """Id of the entity or of the item of stuff; 0 = none."""
    class_id: Int[np.ndarray, " points"] | None
    """Row of `classes.CLASSES`, so that stuff is known that is no entity; None in files that do
    not say, whose stuff is layout alone."""
    mesh: Mesh | None
    """The whole open surface of all that stands in the room; None where the folder has none."""


def read_truth(folder: Path) -> Truth:
    """Read ``scene.json``, ``observed.npz`` and ``meshes/`` of a truth folder.

    Raises:
        SceneError: a file is missing or damaged.
    """
    scene = read_scene(folder / "scene.json")
    path = folder / "observed.npz"
    try:
        with path.open("rb") as file, np.load(file, allow_pickle=False) as data:
            points, instance = data["points"], data["instance"]
            class_id = data["class_id"].astype(np.int64) if "class_id" in data else None
    except (OSError, ValueError, KeyError) as error:
        raise SceneError(f"{path} cannot be read: {error}", _TRUTH_HINT) from None
    columns = [instance.shape] + ([] if class_id is None else [class_id.shape])
    if points.shape != (len(points), 3) or any(c != (len(points),) for c in columns):
        raise SceneError(f"{path}: points {points.shape}, but {columns}", "render anew")
    mesh = _whole_surface(folder / "meshes")
    return Truth(scene, points.astype(np.float64), instance.astype(np.int64), class_id, mesh)


def _whole_surface(folder: Path) -> Mesh | None:
    """All meshes of a folder as one."""
    parts = [read_ply(path, ("x", "y", "z"), _TRUTH_HINT) for path in sorted(folder.glob("*.ply"))]
    if not parts:
        return None
    starts = np.cumsum([0, *(len(table) for table, _ in parts[:-1])])
    vertices = np.concatenate([_positions(table) for table, _ in parts])
    faces = np.concatenate([f + start for (_, f), start in zip(parts, starts, strict=True)])
    return Mesh(vertices.astype(np.float32), faces.astype(np.int32))


def _positions(table: np.ndarray) -> Float[np.ndarray, "vertices 3"]:
    return np.stack([table[c] for c in "xyz"], 1).astype(np.float64)


def read_result(folder: Path, truth: Truth) -> Result:
    """Read ``scene.json`` and ``map/panoptic.ply`` of a results folder.

    Raises:
        SceneError: a file is missing or damaged.
    """
    scene = read_scene(folder / "scene.json")
    hint = "map/panoptic.ply is written by `isr run`"
    table, faces = read_ply(folder / "map" / "panoptic.ply", _COLUMNS, hint)
    T = truth.scene.T_world_dataset @ np.linalg.inv(scene.T_world_dataset)
    return Result(
        scene,
        _positions(table) @ T[:3, :3].T + T[:3, 3],
        faces,
        table["instance"].astype(np.int64),
        table["class"].astype(np.int64),
        T,
    )


def support_of(scene: SceneFile) -> SupportSettings:
    """What counted as a support in the run that wrote a scene; the defaults where it is silent.

    Raises:
        SettingError: what the scene says is not what it should be.
    """
    said = scene.settings.get("support")
    return DEFAULT_SUPPORT if said is None else settings_from_dict({"support": said}).support


def moved_box(box: Box, T: Float[np.ndarray, "4 4"]) -> Box:
    """A gravity-aligned box in another world, whose up is (nearly) the same."""
    yaw = float(np.arctan2(T[1, 0], T[0, 0]))
    center = T[:3, :3] @ np.asarray(box.center, np.float64) + T[:3, 3]
    return canonical_box(center, float(box.yaw) + yaw, np.asarray(box.size))
