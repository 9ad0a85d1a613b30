"""Border: trimesh. A truth folder read back as what the stages would have found."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any

import numpy as np
import trimesh
from scipy.spatial import KDTree

from isr_jax.classes import class_named
from isr_jax.entities.submesh import submesh
from isr_jax.errors import SceneError
from isr_jax.evaluation.maps.segments import observed_ids
from isr_jax.evaluation.result_files import Truth, read_truth
from isr_jax.scene_file import SceneFile, entities_of_scene, graph_of_scene
from isr_jax.types import (
    ContactGraph,
    Entities,
    Mesh,
    PanopticSurface,
)

_SEEN_WITHIN_M = 0.03
"""A true vertex was seen if a point of its own entity lies this near: seen points come on a 2 cm
grid, whose cells have a diagonal of 3.5 cm, and true meshes have vertices 2.5 cm apart."""
_GREY = 128
_NO_ID = np.iinfo(np.int32).max
"""Of a class of which nothing was seen; it stands for nothing then."""


@dataclasses.dataclass(frozen=True, eq=False)
class TrueScene:
    """What stands in a truth folder, as the stages state it."""

    scene: SceneFile
    entities: Entities
    graph: ContactGraph
    surface: PanopticSurface
    """The part of the true surface that the camera saw, with true labels."""


def read_true_scene(truth_dir: Path, voxel_size_m: float) -> TrueScene:
    """Read ``scene.json``, ``meshes/`` and ``observed.npz``.

    What the camera hardly saw is left out, as it is left out of the scores, unless it carries
    something that was seen.

    Args:
        truth_dir: Written with a film.
        voxel_size_m: What entities and surface say their grid is: that of the map they stand for.

    Raises:
        SceneError: a file is missing or is not what it should be.
    """
    scene = _seen_scene(read_truth(truth_dir))
    entities = entities_of_scene(
        scene,
        lambda record: _mesh(truth_dir / (record.mesh or f"meshes/{record.name}.ply")),
        voxel_size_m,
    )
    return TrueScene(
        scene, entities, graph_of_scene(scene, entities), _seen_surface(entities, truth_dir)
    )


def _seen_scene(truth: Truth) -> SceneFile:
    """The scene without the things that were not seen and carry nothing that was."""
    seen, parent = observed_ids(truth), {e.name: e.parent for e in truth.scene.entities}
    kept = {e.name for e in truth.scene.entities if e.id in seen or e.type == "layout"}
    for name in list(kept):
        above = parent[name]
        while above in parent:
            kept.add(above)
            above = parent[above]
    return dataclasses.replace(
        truth.scene,
        entities=tuple(e for e in truth.scene.entities if e.name in kept),
        proximal=tuple(p for p in truth.scene.proximal if p[0] in kept and p[1] in kept),
    )


def _mesh(path: Path) -> Mesh:
    try:
        found = trimesh.load(path, process=False, force="mesh")
    except (OSError, ValueError) as error:
        raise SceneError(f"{path} cannot be read: {error}", "film the room anew") from None
    assert isinstance(found, trimesh.Trimesh)
    visual: Any = found.visual
    return Mesh(
        np.asarray(found.vertices, np.float32),
        np.asarray(found.faces, np.int32),
        np.asarray(visual.vertex_colors, np.uint8)[:, :3].copy(),
        np.asarray(found.vertex_normals, np.float32),
    )


def _seen_surface(entities: Entities, truth_dir: Path) -> PanopticSurface:
    """What was seen of the true surfaces, one instance per thing and one per class of all else.

    Of entities it is the faces of their meshes whose three corners were seen; of windows, pictures
    and rugs, which are none, it is the seen points alone.
    """
    seen = _observed(truth_dir / "observed.npz")
    parts: list[tuple[int, int, Mesh]] = []
    for entity in entities:
        class_id = class_named(entity.class_name).id
        near = _near(entity.mesh.vertices, seen.points[seen.instance == entity.id])
        instance = entity.id if not entity.is_layout else _first_of_class(seen, class_id)
        parts.append((instance, class_id, submesh(entity.mesh, near)))
    loose = ~np.isin(seen.instance, [entity.id for entity in entities])
    for class_id in np.unique(seen.class_id[loose]).tolist():
        rows = loose & (seen.class_id == class_id)
        parts.append((_first_of_class(seen, class_id), class_id, _cloud(seen, rows)))
    return _surface([part for part in parts if len(part[2].vertices)], entities.voxel_size_m)


def _surface(parts: list[tuple[int, int, Mesh]], voxel_size_m: float) -> PanopticSurface:
    """One surface of (instance, class, mesh)."""
    starts = np.cumsum([0, *(len(mesh.vertices) for *_, mesh in parts)])
    faces = [mesh.faces + start for (*_, mesh), start in zip(parts, starts)]
    joined = {
        name: np.concatenate([getattr(mesh, name) for *_, mesh in parts])
        for name in ("vertices", "colors", "normals")
    }
    class_of = {instance: class_id for instance, class_id, _ in parts}
    return PanopticSurface(
        Mesh(faces=np.concatenate(faces).astype(np.int32), **joined),
        np.concatenate([np.full(len(m.vertices), i, np.int32) for i, _, m in parts]),
        np.array(sorted(class_of), np.int32),
        np.array([class_of[i] for i in sorted(class_of)], np.int32),
        voxel_size_m,
    )


@dataclasses.dataclass(frozen=True, eq=False)
class _Seen:
    points: np.ndarray
    normals: np.ndarray
    instance: np.ndarray
    class_id: np.ndarray


def _observed(path: Path) -> _Seen:
    names = [field.name for field in dataclasses.fields(_Seen)]
    try:
        with path.open("rb") as file, np.load(file, allow_pickle=False) as data:
            seen = _Seen(*(data[name] for name in names))
    except (OSError, ValueError, KeyError) as error:
        raise SceneError(f"{path} cannot be read: {error}", "film the room anew") from None
    if not len(seen.points):
        raise SceneError(f"{path}: the camera saw nothing", "give a longer film")
    return seen


def _first_of_class(seen: _Seen, class_id: int) -> int:
    """The id that stands for all of a class."""
    return int(seen.instance[seen.class_id == class_id].min(initial=_NO_ID))


def _near(vertices: np.ndarray, points: np.ndarray) -> np.ndarray:
    if not len(points):
        return np.zeros(len(vertices), bool)
    distance, _ = KDTree(points).query(vertices, distance_upper_bound=_SEEN_WITHIN_M)
    return np.isfinite(distance)


def _cloud(seen: _Seen, rows: np.ndarray) -> Mesh:
    points = seen.points[rows].astype(np.float32)
    grey = np.full(points.shape, _GREY, np.uint8)
    none = np.zeros((0, 3), np.int32)
    return Mesh(points, none, grey, seen.normals[rows].astype(np.float32))
