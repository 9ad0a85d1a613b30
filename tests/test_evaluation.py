"""`evaluate` on folders: the truth scores 100, nothing scores 0, damage costs."""

from __future__ import annotations

import dataclasses
import io
import json
from pathlib import Path

import numpy as np
import pytest
from rich.console import Console

from isr_jax.classes import class_named
from isr_jax.errors import SceneError
from isr_jax.evaluation import evaluate
from isr_jax.geometry.boxes import canonical_box
from isr_jax.scene_file import CadRecord, EntityRecord, SceneFile, write_scene

from .builders import box_mesh, rotation_z

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


def record(id, name, class_name, center, size, yaw, parent) -> EntityRecord:
    layout = class_named(class_name).kind == "layout"
    T = np.eye(4, dtype=np.float32)
    T[:3, :3], T[:3, 3] = rotation_z(yaw), center
    return EntityRecord(
        id=id,
        name=name,
        class_name=class_name,
        type="layout" if layout else "rigid",
        box=canonical_box(np.array(center), yaw, np.array(size)),
        planes=(),
        parent=parent,
        attachment="wall" if parent is None else "none",
        support_plane=None,
        mesh=None,
        cad=None if layout else CadRecord(f"{class_name}/a", T, np.ones(3, np.float32)),
    )


@dataclasses.dataclass
class Folders:
    """A truth folder, and a result that a test may spoil before it is written."""

    root: Path
    entities: list[EntityRecord]
    points: np.ndarray
    instance: np.ndarray
    class_id: np.ndarray
    T_world_dataset: np.ndarray = dataclasses.field(default_factory=lambda: np.eye(4))

    def write(self) -> Path:
        out = self.root / "result"
        (out / "map").mkdir(parents=True, exist_ok=True)
        write_scene(SceneFile(tuple(self.entities), self.T_world_dataset), out / "scene.json")
        columns = [("x", "<f4"), ("y", "<f4"), ("z", "<f4"), ("red", "u1")]
        table = np.zeros(len(self.points), [*columns, ("instance", "<i4"), ("class", "<i4")])
        for k, axis in enumerate("xyz"):
            table[axis] = self.points[:, k]
        table["instance"], table["class"] = self.instance, self.class_id
        kinds = {"<f4": "float", "|u1": "uchar", "<i4": "int"}
        lines = ["ply", "format binary_little_endian 1.0", f"element vertex {len(table)}"]
        lines += [f"property {kinds[kind]} {name}" for name, kind in table.dtype.descr]
        lines += ["element face 0", "property list uchar int vertex_indices", "end_header"]
        (out / "map/panoptic.ply").write_bytes("\n".join(lines).encode() + b"\n" + table.tobytes())
        return out

    def report(self, **options):
        return evaluate(self.write(), self.root / "truth", **options)

    def edit(self, name: str, **changes) -> None:
        position = next(i for i, e in enumerate(self.entities) if e.name == name)
        self.entities[position] = dataclasses.replace(self.entities[position], **changes)


@pytest.fixture
def folders(tmp_path) -> Folders:
    entities, points, instance, class_id = [], [], [], []
    for spec in SPECS:
        id, _, class_name, center, size, yaw, _ = spec
        entities.append(record(*spec))
        vertices = box_mesh(size, center, yaw, spacing_m=0.02 if id > 3 else 0.04).vertices
        points.append(vertices)
        instance.append(np.full(len(vertices), id, np.int32))
        class_id.append(np.full(len(vertices), class_named(class_name).id, np.int32))
    truth = tmp_path / "truth"
    truth.mkdir()
    write_scene(SceneFile(tuple(entities), np.eye(4)), truth / "scene.json")
    whole, ids = np.concatenate(points), np.concatenate(instance)
    np.savez(truth / "observed.npz", points=whole, normals=np.zeros_like(whole), instance=ids)
    return Folders(tmp_path, entities, whole, ids, np.concatenate(class_id))


def drop(folders: Folders, keep: np.ndarray) -> None:
    folders.points, folders.instance = folders.points[keep], folders.instance[keep]
    folders.class_id = folders.class_id[keep]


def check_perfect(report) -> None:
    p = report.panoptic
    assert p.pq == p.sq == p.rq == p.pq_matched == pytest.approx(1.0)
    assert p.pq_things == p.pq_stuff == pytest.approx(1.0)
    assert {c.class_name for c in p.classes} == {"floor", "wall", "table", "cup", "chair",
                                                 "wall_cabinet"}  # fmt: skip
    assert report.boxes.map50 == report.boxes.map25 == 1.0
    s = report.supports
    assert (s.precision, s.recall, s.recall_of_found) == (1.0, 1.0, 1.0)
    assert (s.true, s.attached_correct, s.attached) == (4, 1, 1)
    c = report.cad
    assert c.accuracy == c.class_accuracy == c.placed == c.same_model == 1.0
    assert c.median_center_m < 1e-5 and c.median_rotation_deg < 0.1
    assert report.surface.median_m < 1e-5 and report.surface.completeness == 1.0
    assert all(m.truth == m.predicted and m.by == "segments" for m in report.matches)
    assert len(report.matches) == 5 and report.unseen == ()


def test_the_truth_scores_everything(folders):
    check_perfect(folders.report())


def test_another_world_of_the_same_dataset_changes_nothing(folders):
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = rotation_z(1.1), (0.5, -2.0, 0.03)
    folders.T_world_dataset = T
    folders.points = folders.points @ T[:3, :3].T + T[:3, 3]
    for e in list(folders.entities):
        box = canonical_box(T[:3, :3] @ e.box.center + T[:3, 3], float(e.box.yaw) + 1.1, e.box.size)
        cad = e.cad and dataclasses.replace(
            e.cad, T_world_cad=(T @ e.cad.T_world_cad).astype(np.float32)
        )
        folders.edit(e.name, box=box, cad=cad)
    check_perfect(folders.report())


def test_ids_names_and_order_change_nothing(folders):
    folders.instance = (folders.instance * 7 + 3).astype(np.int32)
    names = {e.name: f"renamed_{e.id}" for e in folders.entities} | {"room": "room", None: None}
    folders.entities = [
        dataclasses.replace(e, id=e.id * 7 + 3, name=names[e.name], parent=names[e.parent])
        for e in reversed(folders.entities)
    ]
    report = folders.report()
    assert {m.truth: m.predicted for m in report.matches} == {
        e[1]: names[e[1]] for e in SPECS if class_named(e[2]).kind == "thing"
    }
    assert report.panoptic.pq == pytest.approx(1.0) and report.boxes.map50 == 1.0
    assert (report.supports.precision, report.cad.accuracy) == (1.0, 1.0)


def test_nothing_scores_nothing(folders):
    folders.entities = []
    drop(folders, np.zeros(len(folders.points), bool))
    report = folders.report()
    assert report.panoptic.pq == report.boxes.map50 == report.cad.accuracy == 0.0
    assert report.supports.recall == 0.0 and report.supports.precision is None
    assert report.surface.completeness == 0.0 and report.surface.median_m is None
    assert all(m.predicted is None for m in report.matches)
    json.dumps(report.to_json(), allow_nan=False)


def test_quality_falls_as_a_segment_is_eaten(folders):
    rng = np.random.default_rng(0)
    table, scores = folders.instance == 4, []
    original = folders.instance.copy()
    order = rng.permutation(np.flatnonzero(table))
    for share in (0.0, 0.1, 0.3, 0.45, 0.6):
        folders.instance = original.copy()
        eaten = order[: int(share * len(order))]
        folders.instance[eaten] = 7  # the chair takes them
        folders.class_id[eaten] = class_named("chair").id
        quality = {c.class_name: c for c in folders.report().panoptic.classes}
        scores.append((quality["table"].pq, quality["chair"].pq))
        assert quality["cup"].pq == pytest.approx(1.0)
    tables, chairs = zip(*scores, strict=True)
    assert list(tables) == sorted(tables, reverse=True) and tables[-1] == 0.0
    assert list(chairs) == sorted(chairs, reverse=True)
    assert tables[2] == pytest.approx(0.7, abs=0.02)


def test_false_surface_costs_by_area_not_by_density(folders):
    rng = np.random.default_rng(1)
    scores = []
    for count in (4000, 40000):
        ghost = rng.uniform([-1, -1, 3], [0, 0, 3.001], (count, 3))  # 1 m^2 far from all
        spoiled = dataclasses.replace(
            folders,
            points=np.concatenate([folders.points, ghost]),
            instance=np.concatenate([folders.instance, np.full(count, 4, np.int32)]),
            class_id=np.concatenate(
                [folders.class_id, np.full(count, class_named("table").id, np.int32)]
            ),
        )
        quality = {c.class_name: c for c in spoiled.report().panoptic.classes}
        scores.append(quality["table"].pq)
    cells = 2500  # 1 m^2 on the 2 cm grid
    table = int((folders.instance == 4).sum())
    assert scores[1] == pytest.approx(table / (table + cells), abs=0.01)
    assert scores[0] == pytest.approx(scores[1], abs=0.1)


def test_a_wrong_class_is_a_miss_and_a_false_alarm(folders):
    folders.class_id[folders.instance == 7] = class_named("sofa").id
    folders.edit("chair_1", class_name="sofa")
    report = folders.report()
    quality = {c.class_name: c for c in report.panoptic.classes}
    assert (quality["chair"].false_negatives, quality["sofa"].false_positives) == (1, 1)
    assert report.panoptic.pq == pytest.approx(5 / 7)
    assert report.panoptic.pq_matched == pytest.approx(1.0)
    assert report.boxes.ap["chair"] == (0.0, 0.0)
    assert (report.supports.correct, report.supports.predicted, report.supports.true) == (3, 4, 4)
    assert report.supports.recall_of_found == 1.0
    row = next(r for r in report.cad.rows if r.truth == "chair_1")
    assert row.errors is None and row.reason == "not found"


def test_wrong_parents_cost_precision_and_recall(folders):
    folders.edit("cup_1", parent="floor_1")
    folders.edit("cup_2", parent=None)
    s = folders.report().supports
    assert (s.correct, s.predicted, s.true, s.reachable) == (2, 3, 4, 4)
    folders.edit("wall_cabinet_1", parent="wall_2", attachment="none")
    s = folders.report().supports
    assert (s.correct, s.predicted, s.attached_correct, s.attached) == (2, 4, 0, 1)


def test_one_wall_for_another_is_the_same_parent(folders):
    for name in ("cup_1", "cup_2", "table_1", "chair_1"):
        folders.edit(name, parent="wall_1")
    truth = folders.root / "truth"
    entities = [dataclasses.replace(e) for e in folders.entities]
    write_scene(SceneFile(tuple(entities), np.eye(4)), truth / "scene.json")
    for name in ("cup_1", "cup_2", "table_1", "chair_1"):
        folders.edit(name, parent="wall_2")
    assert folders.report().supports.precision == 1.0


def test_boxes_stand_in_where_segments_fail(folders):
    keep = ~((folders.instance == 4) & (folders.points[:, 2] > 0.3))
    drop(folders, keep)
    match = next(m for m in folders.report().matches if m.truth == "table_1")
    assert (match.predicted, match.by) == ("table_1", "boxes")


def test_boxes_before_and_after_refinement(folders):
    lifted = canonical_box(np.array([-1.0, -0.8, 0.68]), -0.3, np.array([0.5, 0.5, 0.44]))
    report = folders.report(unrefined={"chair_1": lifted})
    assert report.boxes.map50 == 1.0
    assert report.unrefined_boxes is not None
    assert report.unrefined_boxes.ap["chair"] == (0.0, 1.0)  # half of the box: IoU just below 0.5


def turned(entity: EntityRecord, degrees: float, **changes) -> CadRecord:
    assert entity.cad is not None
    T = entity.cad.T_world_cad.copy()
    T[:3, :3] = T[:3, :3] @ rotation_z(np.deg2rad(degrees))
    return dataclasses.replace(entity.cad, T_world_cad=T, **changes)


def test_symmetry_of_models_is_known_only_when_given(folders):
    folders.edit("table_1", cad=turned(folders.entities[3], 180))
    assert folders.report().cad.accuracy == pytest.approx(0.8)
    assert folders.report(symmetry={"table/a": 2}).cad.accuracy == 1.0


def test_another_model_is_judged_by_its_size(folders):
    cad = dataclasses.replace(
        folders.entities[6].cad, id="chair/b", scale=np.full(3, 0.5, np.float32)
    )
    folders.edit("chair_1", cad=cad)
    row = next(r for r in folders.report().cad.rows if r.truth == "chair_1")
    assert row.errors.aligned and row.size_source == "boxes of the entities"
    sizes = {"chair/a": (0.5, 0.5, 0.9), "chair/b": (1.0, 1.0, 1.8)}
    report = folders.report(model_size=sizes)
    row = next(r for r in report.cad.rows if r.truth == "chair_1")
    assert row.errors.aligned and row.size_source == "model"
    assert report.cad.same_model == pytest.approx(0.8)
    sizes["chair/b"] = (0.5, 0.5, 0.9)
    row = next(r for r in folders.report(model_size=sizes).cad.rows if r.truth == "chair_1")
    assert not row.errors.aligned and row.errors.size_ratio == pytest.approx(0.5)


def test_what_the_camera_did_not_see_is_not_asked_for(folders):
    truth = folders.root / "truth/observed.npz"
    with np.load(truth) as data:
        keep = data["instance"] != 6
        np.savez(
            folders.root / "seen.npz",
            **{k: data[k][keep] for k in ("points", "normals", "instance")},
        )
    (folders.root / "seen.npz").replace(truth)
    folders.entities = [e for e in folders.entities if e.name != "cup_2"]
    drop(folders, folders.instance != 6)
    report = folders.report()
    assert report.unseen == ("cup_2",)
    assert report.panoptic.pq == pytest.approx(1.0) and report.supports.recall == 1.0


def test_report_prints_and_writes(folders, tmp_path):
    report = folders.report()
    report.write(tmp_path / "evaluation.json")
    data = json.loads((tmp_path / "evaluation.json").read_text())
    assert data["panoptic"]["pq"] == pytest.approx(1.0)
    assert data["supports"]["recall"] == 1.0
    console = Console(file=io.StringIO(), width=140, color_system=None)
    console.print(report.table())
    text = console.file.getvalue()
    for words in ("PQ / SQ / RQ", "100.0 / 100.0 / 100.0", "wall_cabinet", "5 of 5"):
        assert words in text


@pytest.mark.parametrize(
    ("spoil", "words"),
    [
        (lambda d: (d / "result/map/panoptic.ply").unlink(), "panoptic.ply"),
        (lambda d: (d / "result/map/panoptic.ply").write_bytes(b"solid"), "no binary"),
        (lambda d: cut(d / "result/map/panoptic.ply"), "some of its vertices"),
        (lambda d: (d / "truth/observed.npz").write_bytes(b"x"), "observed.npz"),
        (lambda d: (d / "truth/scene.json").unlink(), "scene.json"),
    ],
)
def test_files_that_cannot_be_read_are_named(folders, spoil, words):
    result = folders.write()
    spoil(folders.root)
    with pytest.raises(SceneError, match=words):
        evaluate(result, folders.root / "truth")


def cut(path: Path) -> None:
    path.write_bytes(path.read_bytes()[:2000])
