"""A scan's mesh with instances annotated on its vertices, as SceneNN and ScanNet give it."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
from jaxtyping import Float, Int

from ..errors import SequenceError
from ..types import Mesh
from .ply_tables import read_ply_mesh


@dataclasses.dataclass(frozen=True, eq=False)
class AnnotatedBox:
    """An oriented box as annotated, dataset frame, metres."""

    center: Float[np.ndarray, "3"]
    size: Float[np.ndarray, "3"]
    """Full extent along the box's own axes."""
    R_dataset_box: Float[np.ndarray, "3 3"]


@dataclasses.dataclass(frozen=True, eq=False)
class AnnotatedInstance:
    """One annotated object, or a piece of the room."""

    id: int
    """As in `AnnotatedMesh.instance`; at least 1."""
    label: str
    """What the annotators call it."""
    class_name: str | None
    """Ours; None where we have no such class."""
    box: AnnotatedBox | None
    """None where none is annotated."""


@dataclasses.dataclass(frozen=True, eq=False)
class AnnotatedMesh:
    """The ground truth of a scan, in the frame of its poses."""

    name: str
    annotation: str
    """Which version of which data set's annotation this is: they score differently."""
    mesh: Mesh
    """Dataset frame, metres."""
    instance: Int[np.ndarray, " vertices"]
    """Id of an instance; 0 = not annotated."""
    instances: tuple[AnnotatedInstance, ...]
    notes: tuple[str, ...]
    """What had to be left out or assumed: names without a class, instances without vertices."""
    T_aligned_dataset: Float[np.ndarray, "4 4"] | None = None
    """ScanNet's axisAlignment, where given: turns walls along the axes. Nothing is moved by it."""


def read_mesh(path: Path) -> tuple[Mesh, dict[str, np.ndarray]]:
    """A PLY file's mesh, and its other columns per vertex.

    Raises:
        SequenceError: the file cannot be read, or positions are not finite.
    """
    found = read_ply_mesh(path)
    table = found.vertices
    vertices = np.stack([table[c] for c in "xyz"], 1).astype(np.float32)
    bad = int((~np.isfinite(vertices)).any(1).sum())
    if bad:
        raise SequenceError(
            f"{path}: {bad} of {len(vertices)} vertices are not finite", "restore the file"
        )
    names = table.dtype.names or ()
    colored = {"red", "green", "blue"} <= set(names)
    colors = (
        np.stack([table[c] for c in ("red", "green", "blue")], 1).astype(np.uint8)
        if colored
        else None
    )
    return Mesh(vertices, found.faces, colors), {n: table[n] for n in names if n not in "xyz"}


def annotation_notes(
    instances: tuple[AnnotatedInstance, ...], instance: Int[np.ndarray, " vertices"]
) -> tuple[str, ...]:
    """Says which names have no class, which instances have no vertices, how much is labelled."""
    notes = []
    unknown = [i for i in instances if i.class_name is None]
    if unknown:
        names = sorted({repr(i.label) for i in unknown})
        notes.append(
            f"{len(unknown)} of {len(instances)} instances have names that no class stands for; "
            f"nothing is asked of them: {', '.join(names)}"
        )
    present = set(np.unique(instance).tolist())
    empty = sorted(i.id for i in instances if i.id not in present)
    if empty:
        notes.append(f"instances without any vertex: {', '.join(map(str, empty))}")
    bare = float(np.mean(instance == 0)) if len(instance) else 1.0
    notes.append(f"{bare:.1%} of the vertices are not annotated")
    return tuple(notes)
