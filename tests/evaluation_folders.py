"""A truth folder of boxes, and a result that is perfect until a test spoils it."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np

from isr_jax.classes import class_named
from isr_jax.evaluation import EvaluationReport, evaluate
from isr_jax.evaluation.maps import surface_scores, true_surface
from isr_jax.geometry.boxes import canonical_box
from isr_jax.scene_file import CadRecord, EntityRecord, PlaneRecord, SceneFile, write_scene

from .builders import box_mesh, box_planes, rotation_z

SPECS = (
    # id, name, class, centre, size, yaw, parent
    (1, "floor_1", "floor", (0, 0, -0.01), (3.0, 3.0, 0.02), 0.0, "room"),
    (2, "wall_1", "wall", (0, 1.53, 1.0), (3.0, 0.02, 2.0), 0.0, "room"),
    (3, "wall_2", "wall", (1.53, 0, 1.0), (0.02, 3.0, 2.0), 0.0, "room"),
    (4, "table_1", "table", (0, 0, 0.36), (1.2, 0.8, 0.72), 0.2, "floor_1"),
    (5, "cup_1", "cup", (0.2, 0.1, 0.78), (0.1, 0.1, 0.12), 0.2, "table_1"),
    (6, "cup_2", "cup", (-0.3, 0.1, 0.78), (0.1, 0.1, 0.12), 0.5, "table_1"),
    (7, "chair_1", "chair", (-1.0, -0.8, 0.45), (0.5, 0.5, 0.9), -0.3, "floor_1"),
    (8, "wall_cabinet_1", "wall_cabinet", (0.5, 1.3, 1.6), (0.8, 0.35, 0.7), 0.0, None),
)
PROXIMAL = (("cup_1", "cup_2", 0.01), ("table_1", "chair_1", 0.02))


def record(id, name, class_name, center, size, yaw, parent) -> EntityRecord:
    """A box with one plane, its top."""
    layout = class_named(class_name).kind == "layout"
    T = np.eye(4, dtype=np.float32)
    T[:3, :3], T[:3, 3] = rotation_z(yaw), center
    planes = box_planes(size, center, yaw, faces=(0,))
    top = PlaneRecord(planes.normal[0], float(planes.offset[0]), planes.corners[0], 1.0)
    return EntityRecord(
        id=id,
        name=name,
        class_name=class_name,
        type="layout" if layout else "rigid",
        box=canonical_box(np.array(center), yaw, np.array(size)),
        planes=(top,),
        parent=parent,
        attachment="wall" if parent is None else "none",
        support_plane=None if parent in (None, "room") else 0,
        mesh=None,
        cad=None if layout else CadRecord(f"{class_name}/a", T, np.ones(3, np.float32)),
    )


def ply_bytes(points, faces, **columns) -> bytes:
    """A binary PLY of triangles with more columns a vertex."""
    table = np.zeros(
        len(points),
        [("x", "<f4"), ("y", "<f4"), ("z", "<f4"), ("red", "u1")]
        + [(name, "<i4") for name in columns],
    )
    for k, axis in enumerate("xyz"):
        table[axis] = points[:, k]
    for name, values in columns.items():
        table[name] = values
    kinds = {"<f4": "float", "|u1": "uchar", "<i4": "int"}
    lines = ["ply", "format binary_little_endian 1.0", f"element vertex {len(table)}"]
    lines += [f"property {kinds[kind]} {name}" for name, kind in table.dtype.descr]
    lines += [f"element face {len(faces)}", "property list uchar int vertex_indices", "end_header"]
    listed = np.zeros(len(faces), [("count", "u1"), ("vertex", "<i4", 3)])
    listed["count"], listed["vertex"] = 3, faces
    return "\n".join(lines).encode() + b"\n" + table.tobytes() + listed.tobytes()


@dataclasses.dataclass
class Folders:
    """A truth folder, and a result that a test may spoil before it is written."""

    root: Path
    entities: list[EntityRecord]
    points: np.ndarray
    faces: np.ndarray
    instance: np.ndarray
    class_id: np.ndarray
    proximal: tuple[tuple[str, str, float], ...] = PROXIMAL
    T_world_dataset: np.ndarray = dataclasses.field(default_factory=lambda: np.eye(4))

    @property
    def truth(self) -> Path:
        return self.root / "truth"

    def write(self) -> Path:
        out = self.root / "result"
        (out / "map").mkdir(parents=True, exist_ok=True)
        names = {e.name for e in self.entities}
        proximal = tuple(p for p in self.proximal if {p[0], p[1]} <= names)
        scene = SceneFile(tuple(self.entities), self.T_world_dataset, proximal)
        write_scene(scene, out / "scene.json")
        labels = {"instance": self.instance, "class": self.class_id}
        (out / "map/panoptic.ply").write_bytes(ply_bytes(self.points, self.faces, **labels))
        return out

    def report(self, **options) -> EvaluationReport:
        return evaluate(self.write(), self.truth, **options)

    def edit(self, name: str, **changes) -> None:
        """Change an entity of the result."""
        position = next(i for i, e in enumerate(self.entities) if e.name == name)
        self.entities[position] = dataclasses.replace(self.entities[position], **changes)

    def assign_to(self, which: np.ndarray, name: str) -> None:
        """Give vertices of the map to another entity of the result."""
        entity = next(e for e in self.entities if e.name == name)
        self.instance = np.where(which, entity.id, self.instance).astype(np.int32)
        class_id = class_named(entity.class_name).id
        self.class_id = np.where(which, class_id, self.class_id).astype(np.int32)

    def drop(self, keep: np.ndarray) -> None:
        """Keep only these vertices of the map, and the faces between them."""
        whole = keep[self.faces].all(1)
        self.faces = (np.cumsum(keep) - 1)[self.faces[whole]].astype(np.int32)
        self.points, self.instance = self.points[keep], self.instance[keep]
        self.class_id = self.class_id[keep]

    def add(self, points: np.ndarray, instance: int, class_name: str, faces=()) -> None:
        """More vertices of the map."""
        count, start = len(points), len(self.points)
        more = np.asarray(faces, np.int32).reshape(-1, 3) + start
        self.faces = np.concatenate([self.faces, more])
        self.points = np.concatenate([self.points, np.asarray(points, np.float32)])
        self.instance = np.append(self.instance, np.full(count, instance, np.int32))
        class_id = class_named(class_name).id
        self.class_id = np.append(self.class_id, np.full(count, class_id, np.int32))

    def write_observed(self, points, instance, **columns) -> None:
        """Another ``observed.npz`` of the truth."""
        np.savez(
            self.truth / "observed.npz",
            points=points,
            normals=np.zeros_like(points),
            instance=instance,
            **columns,
        )


def make_folders(root: Path) -> Folders:
    """The truth is written, the result is perfect."""
    truth = root / "truth"
    (truth / "meshes").mkdir(parents=True)
    points, faces, instance, class_id = [], [], [], []
    for id, name, class_name, center, size, yaw, _ in SPECS:
        # 39 cells of floor: no vertex of it lies where one of the table does.
        mesh = box_mesh(size, center, yaw, spacing_m=0.02 if id > 3 else 0.077)
        (truth / "meshes" / f"{name}.ply").write_bytes(ply_bytes(mesh.vertices, mesh.faces))
        faces.append(mesh.faces + sum(map(len, points)))
        points.append(mesh.vertices)
        instance.append(np.full(len(mesh.vertices), id, np.int32))
        class_id.append(np.full(len(mesh.vertices), class_named(class_name).id, np.int32))
    entities = [record(*spec) for spec in SPECS]
    whole = [np.concatenate(v) for v in (points, faces, instance, class_id)]
    folders = Folders(root, entities, *whole)
    write_scene(SceneFile(tuple(entities), np.eye(4), PROXIMAL), truth / "scene.json")
    folders.write_observed(folders.points, folders.instance)
    return folders


def measure_surfaces_fast(monkeypatch, samples: int = 1000) -> None:
    """Fewer samples, and sites farther apart; what is perfect stays so."""
    monkeypatch.setattr(surface_scores, "SAMPLES", samples)
    monkeypatch.setattr(true_surface, "SITE_M", 0.08)
