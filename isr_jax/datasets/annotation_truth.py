"""From an annotated scan to a truth folder, as the evaluation reads it.

The truth of a scan is its mesh, as far as it was annotated: things with oriented boxes, floors,
walls and ceilings as layout, other stuff as labelled points. What carries what, and CAD models, are
not annotated; ``settings`` of the scene says so.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
from jaxtyping import Float, Int

from ..classes import class_named
from ..errors import OutputError, SequenceError
from ..geometry.boxes import canonical_box
from ..geometry.tight_box import tight_box
from ..scene_file import NOT_ANNOTATED, ROOM_NAME, EntityRecord, SceneFile, write_scene
from ..types import Box, Mesh
from .annotated_mesh import AnnotatedBox, AnnotatedInstance, AnnotatedMesh

SPACING_M = 0.02
"""One point is kept a cube of this side and instance, as in the truth of rendered rooms."""
REMAINDER = "remainder"
"""The mesh of all surface that is no entity's."""
_MAX_EXTENT_M = 1000.0
_TILTED_DEG = 10.0
"""Boxes that lean farther are refitted to the vertices: a gravity-aligned box cannot be them."""


def truth_from_annotation(
    annotated: AnnotatedMesh,
    T_world_dataset: Float[np.ndarray, "4 4"],
    folder: str | Path,
    *,
    write_mesh: Callable[[Path, Mesh], None] | None = None,
) -> SceneFile:
    """Write ``scene.json`` and ``observed.npz`` (and meshes); the scene that was written.

    Args:
        annotated: What was annotated, dataset frame.
        T_world_dataset: As the opened sequence gives it: z up, floor at 0.
        folder: Made if it is not there.
        write_mesh: Writes one entity's mesh, world frame, to ``meshes/<name>.ply``, and what is
            no entity's to ``meshes/remainder.ply``; without it, the scene names no meshes.

    Raises:
        SequenceError: the world frame is none, or the mesh is not of a room in metres.
        OutputError: the folder cannot be written.
    """
    folder = Path(folder)
    T = np.asarray(T_world_dataset, np.float64)
    if not np.isfinite(T).all():
        raise SequenceError(f"T_world_dataset = {T.tolist()}", "give that of the opened sequence")
    world = np.asarray(annotated.mesh.vertices, np.float64) @ T[:3, :3].T + T[:3, 3]
    extent_m = float(np.ptp(world, axis=0).max()) if len(world) else 0.0
    if not 0 < extent_m <= _MAX_EXTENT_M:
        raise SequenceError(
            f"the mesh of {annotated.name} extends over {extent_m:g} m (above 0, at most "
            f"{_MAX_EXTENT_M:g})",
            "give a mesh of a room, in metres",
        )
    rows = _rows_of(annotated.instance)
    records, notes = _records(annotated, world, rows, T, write_mesh is not None)
    scene = SceneFile(
        tuple(records),
        T,
        settings={
            "annotation": annotated.annotation,
            "supports": NOT_ANNOTATED,
            "cad": NOT_ANNOTATED,
            "notes": [*annotated.notes, *notes],
        },
    )
    try:
        folder.mkdir(parents=True, exist_ok=True)
        _write_observed(folder / "observed.npz", annotated, world, T)
        write_scene(scene, folder / "scene.json")
        if write_mesh is not None:
            for name, part in _parts(annotated, world, records):
                write_mesh(folder / "meshes" / f"{name}.ply", part)
    except OSError as error:
        hint = "give a folder that can be written"
        raise OutputError(f"{folder}: {error.strerror}", hint) from None
    return scene


def _rows_of(instance: Int[np.ndarray, " vertices"]) -> dict[int, Int[np.ndarray, " rows"]]:
    """Vertices of each instance that has any."""
    order = np.argsort(instance, kind="stable")
    ids, first = np.unique(instance[order], return_index=True)
    return dict(zip(ids.tolist(), np.split(order, first[1:]), strict=True)) if len(ids) else {}


def _records(
    annotated: AnnotatedMesh,
    world: np.ndarray,
    rows_of: dict[int, np.ndarray],
    T: np.ndarray,
    with_meshes: bool,
) -> tuple[list[EntityRecord], list[str]]:
    """Things and layout that have a class and vertices; what was refitted."""
    records, notes = [], []
    for item in sorted(annotated.instances, key=lambda i: i.id):
        kind = class_named(item.class_name).kind if item.class_name else "none"
        rows = rows_of.get(item.id)
        if kind not in ("thing", "layout") or rows is None:
            continue
        box, tilt_deg = _entity_box(item, world[rows], T)
        if tilt_deg > _TILTED_DEG:
            notes.append(
                f"the box of {item.label!r} (id {item.id}) leans by {tilt_deg:.0f} degrees: "
                "refitted to its vertices"
            )
        records.append(_record(item, kind, box, with_meshes))
    return records, notes


def _record(item: AnnotatedInstance, kind: str, box: Box, with_meshes: bool) -> EntityRecord:
    assert item.class_name is not None
    name = f"{re.sub(r'[^a-z0-9_]', '_', item.class_name)}_{item.id}"
    layout = kind == "layout"
    return EntityRecord(
        id=item.id,
        name=name,
        class_name=item.class_name,
        type="layout" if layout else "scan",
        box=box,
        planes=(),
        parent=ROOM_NAME if layout else None,
        attachment="none",
        support_plane=None,
        mesh=f"meshes/{name}.ply" if with_meshes else None,
        cad=None,
        reason=None if layout else f"annotated as {item.label!r}; no model is annotated",
    )


def _entity_box(
    item: AnnotatedInstance, points: Float[np.ndarray, "points 3"], T: np.ndarray
) -> tuple[Box, float]:
    """The annotated box made gravity-aligned, else the vertices' own; and how far it leans."""
    if item.box is None:
        return tight_box(points), 0.0
    upright, tilt_deg = gravity_aligned(item.box, T)
    return (tight_box(points) if tilt_deg > _TILTED_DEG else upright), tilt_deg


def gravity_aligned(box: AnnotatedBox, T_world_dataset: np.ndarray) -> tuple[Box, float]:
    """The box with its steepest axis made vertical (world frame), and the angle of that."""
    R = T_world_dataset[:3, :3] @ box.R_dataset_box
    center = T_world_dataset[:3, :3] @ box.center + T_world_dataset[:3, 3]
    up = int(np.argmax(np.abs(R[2])))
    x, y = (k for k in range(3) if k != up)
    longer = x if np.hypot(*R[:2, x]) >= np.hypot(*R[:2, y]) else y
    yaw = float(np.arctan2(R[1, longer], R[0, longer])) - (0 if longer == x else np.pi / 2)
    tilt_deg = float(np.rad2deg(np.arccos(np.clip(abs(R[2, up]), 0, 1))))
    return canonical_box(center, yaw, box.size[[x, y, up]]), tilt_deg


def _write_observed(
    path: Path,
    annotated: AnnotatedMesh,
    world: np.ndarray,
    T: np.ndarray,
) -> None:
    """Points a cube and instance; the unlabelled come too, since they are surface all the same."""
    class_of = {
        i.id: class_named(i.class_name).id for i in annotated.instances if i.class_name is not None
    }
    known = np.isin(annotated.instance, list(class_of))
    ids, row = np.unique(annotated.instance, return_inverse=True)
    class_id = np.array([class_of.get(int(i), 0) for i in ids], np.int32)[row.reshape(-1)]
    kept = _one_a_cube(world, row.reshape(-1))
    normals = vertex_normals(annotated.mesh) @ T[:3, :3].T
    np.savez_compressed(
        path,
        points=world[kept].astype(np.float32),
        normals=normals[kept].astype(np.float32),
        instance=np.where(known, annotated.instance, 0)[kept].astype(np.int32),
        class_id=class_id[kept],
    )


def _one_a_cube(
    points: Float[np.ndarray, "points 3"], group: Int[np.ndarray, " points"]
) -> Int[np.ndarray, " kept"]:
    """The first point of each cube and group, in their order."""
    cell = np.floor(points / SPACING_M).astype(np.int64)
    columns = [group, *(cell - cell.min(0, initial=0)).T]
    shape = [int(c.max(initial=0)) + 1 for c in columns]
    return np.sort(np.unique(np.ravel_multi_index(columns, shape), return_index=True)[1])


def vertex_normals(mesh: Mesh) -> Float[np.ndarray, "vertices 3"]:
    """Unit normals, weighted by the area of the faces around; zero where there are none."""
    corners = np.asarray(mesh.vertices, np.float64)[mesh.faces]
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    total = np.zeros((len(mesh.vertices), 3))
    for axis in range(3):
        for k in range(3):
            total[:, axis] += np.bincount(
                mesh.faces[:, k], cross[:, axis], minlength=len(mesh.vertices)
            )
    length = np.linalg.norm(total, axis=1, keepdims=True)
    return total / np.where(length > 0, length, 1.0)


def _parts(
    annotated: AnnotatedMesh, world: np.ndarray, records: list[EntityRecord]
) -> Iterator[tuple[str, Mesh]]:
    """Every face once: with the entity that has all its corners, else in the remainder."""
    corners = annotated.instance[annotated.mesh.faces]
    whole = (corners == corners[:, :1]).all(1)
    owner = np.where(whole & np.isin(corners[:, 0], [r.id for r in records]), corners[:, 0], 0)
    for name, id in (*((r.name, r.id) for r in records), (REMAINDER, 0)):
        rows, faces = np.unique(annotated.mesh.faces[owner == id], return_inverse=True)
        colors = annotated.mesh.colors
        yield (
            name,
            Mesh(
                world[rows].astype(np.float32),
                faces.reshape(-1, 3).astype(np.int32),
                None if colors is None else colors[rows],
            ),
        )
