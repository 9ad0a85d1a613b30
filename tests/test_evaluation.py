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

from .builders import library_of, parts_model, rotation_z
from .evaluation_folders import SPECS, Folders, make_folders, measure_surfaces_fast

THINGS = {"table", "cup", "chair", "wall_cabinet"}
NAMES = {"table_1", "cup_1", "chair_1", "wall_cabinet_1"}
"""A thing of each class."""


@pytest.fixture
def folders(tmp_path, monkeypatch) -> Folders:
    measure_surfaces_fast(monkeypatch)
    return make_folders(tmp_path)


def check_perfect(report) -> None:
    p = report.panoptic
    assert p.pq == p.sq == p.rq == p.pq_matched == pytest.approx(1.0)
    assert p.pq_things == p.pq_stuff == pytest.approx(1.0)
    assert {c.class_name for c in p.classes} == {
        "floor",
        "wall",
        "table",
        "cup",
        "chair",
        "wall_cabinet",
    }
    b, i = report.boxes, report.instances
    assert b.map50 == b.map25 == b.map50_11point == b.map25_11point == pytest.approx(1.0)
    assert i.map == i.map50 == i.map25 == pytest.approx(1.0)
    assert {r.class_name for r in i.rows} == {r.class_name for r in b.rows} == THINGS
    for edges, count in ((report.supports, 4), (report.proximal, 2)):
        assert edges.precision == edges.recall == 1.0
        assert edges.precision_of_found == edges.recall_of_found == 1.0
        assert edges.true == edges.predicted == edges.reachable == count
    assert (report.attachments.correct, report.attachments.count) == (1, 1)
    assert report.support_planes.near_share == 1.0 and report.support_planes.median_m < 1e-5
    assert len(report.support_planes.rows) == 4
    assert all(row.same_parent for row in report.support_planes.rows)
    c = report.cad
    assert c.accuracy == c.class_accuracy == c.placed == c.same_model == 1.0
    assert c.median_center_m < 1e-5 and c.median_rotation_deg < 0.1
    check_perfect_surface(report.surface)
    assert all(m.truth == m.predicted and m.by == "segments" for m in report.matches)
    assert len(report.matches) == 5 and report.unseen == ()


def check_perfect_surface(surface) -> None:
    for error in (
        "accuracy_mean_m",
        "accuracy_median_m",
        "completeness_mean_m",
        "completeness_median_m",
    ):
        assert getattr(surface, error) < 1e-5
    assert [r.limit_m for r in surface.rates] == [0.01, 0.02, 0.05]
    assert all(r.precision == r.recall == r.f_score == 1.0 for r in surface.rates)


def test_the_truth_scores_everything(folders):
    check_perfect(folders.report())


def test_another_world_of_the_same_dataset_changes_nothing(folders):
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = rotation_z(1.1), (0.5, -2.0, 0.03)
    folders.T_world_dataset = T
    folders.points = folders.points @ T[:3, :3].T + T[:3, 3]
    for e in list(folders.entities):
        box = canonical_box(T[:3, :3] @ e.box.center + T[:3, 3], float(e.box.yaw) + 1.1, e.box.size)
        planes = tuple(
            dataclasses.replace(
                p,
                normal=T[:3, :3] @ p.normal,
                offset=p.offset - float(T[:3, :3] @ p.normal @ T[:3, 3]),
            )
            for p in e.planes
        )
        cad = e.cad and dataclasses.replace(
            e.cad, T_world_cad=(T @ e.cad.T_world_cad).astype(np.float32)
        )
        folders.edit(e.name, box=box, planes=planes, cad=cad)
    check_perfect(folders.report())


def test_ids_names_and_order_change_nothing(folders):
    folders.instance = (folders.instance * 7 + 3).astype(np.int32)
    names = {e.name: f"renamed_{e.id}" for e in folders.entities} | {"room": "room", None: None}
    folders.entities = [
        dataclasses.replace(e, id=e.id * 7 + 3, name=names[e.name], parent=names[e.parent])
        for e in reversed(folders.entities)
    ]
    folders.proximal = tuple((names[b], names[a], depth) for a, b, depth in folders.proximal)
    report = folders.report()
    assert {m.truth: m.predicted for m in report.matches} == {
        e[1]: names[e[1]] for e in SPECS if class_named(e[2]).kind == "thing"
    }
    assert report.panoptic.pq == pytest.approx(1.0) and report.boxes.map50 == 1.0
    assert (report.supports.precision, report.cad.accuracy) == (1.0, 1.0)
    assert report.proximal.precision == report.proximal.recall == report.instances.map50 == 1.0


def test_nothing_scores_nothing(folders):
    folders.entities = []
    folders.drop(np.zeros(len(folders.points), bool))
    report = folders.report()
    assert report.panoptic.pq == report.boxes.map50 == report.cad.accuracy == 0.0
    assert report.supports.recall == 0.0 and report.supports.precision is None
    assert report.proximal.recall == 0.0 and report.proximal.precision is None
    assert report.instances.map == report.instances.map25 == 0.0
    assert report.surface.accuracy_mean_m is None and report.surface.completeness_mean_m is None
    assert [(r.precision, r.recall, r.f_score) for r in report.surface.rates] == [
        (None, 0, None)
    ] * 3
    assert report.support_planes.median_m is None and report.support_planes.rows == ()
    assert all(m.predicted is None for m in report.matches)
    json.dumps(report.to_json(), allow_nan=False)


def test_quality_falls_as_a_segment_is_eaten(folders):
    rng = np.random.default_rng(0)
    table, scores = folders.instance == 4, []
    original = folders.instance, folders.class_id
    order = rng.permutation(np.flatnonzero(table))
    for share in (0.0, 0.1, 0.3, 0.45, 0.6):
        folders.instance, folders.class_id = (v.copy() for v in original)
        eaten = np.zeros(len(folders.points), bool)
        eaten[order[: int(share * len(order))]] = True
        folders.assign_to(eaten, "chair_1")
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
        spoiled = dataclasses.replace(folders)
        spoiled.add(ghost, 4, "table")
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
    assert box_ap(report.boxes, "chair") == (0.0, 0.0)
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
    report = folders.report()
    assert (report.supports.correct, report.supports.predicted) == (2, 4)
    assert (report.attachments.correct, report.attachments.count) == (0, 1)


def test_one_wall_for_another_is_the_same_parent(folders):
    for name in ("cup_1", "cup_2", "table_1", "chair_1"):
        folders.edit(name, parent="wall_1")
    write_scene(SceneFile(tuple(folders.entities), np.eye(4)), folders.truth / "scene.json")
    for name in ("cup_1", "cup_2", "table_1", "chair_1"):
        folders.edit(name, parent="wall_2")
    assert folders.report().supports.precision == 1.0


def test_boxes_stand_in_where_segments_fail(folders):
    keep = ~((folders.instance == 4) & (folders.points[:, 2] > 0.3))
    folders.drop(keep)
    match = next(m for m in folders.report().matches if m.truth == "table_1")
    assert (match.predicted, match.by) == ("table_1", "boxes")


def box_ap(boxes, class_name: str) -> tuple[float, float]:
    row = next(r for r in boxes.rows if r.class_name == class_name)
    return row.ap50, row.ap25


def test_boxes_before_and_after_refinement(folders):
    lifted = canonical_box(np.array([-1.0, -0.8, 0.68]), -0.3, np.array([0.5, 0.5, 0.44]))
    assert folders.report().observed_boxes is None
    folders.edit("chair_1", observed_box=lifted)
    report = folders.report()
    assert report.boxes.map50 == 1.0
    assert report.observed_boxes is not None
    assert box_ap(report.observed_boxes, "chair") == (
        0.0,
        1.0,
    )  # half of the box: IoU just below 0.5


def turned(entity: EntityRecord, degrees: float, **changes) -> CadRecord:
    assert entity.cad is not None
    T = entity.cad.T_world_cad.copy()
    T[:3, :3] = T[:3, :3] @ rotation_z(np.deg2rad(degrees))
    return dataclasses.replace(entity.cad, T_world_cad=T, **changes)


def solid(cad_id: str, size):
    return parts_model(cad_id, cad_id.split("/")[0], [(size, (0, 0, 0))])


def models_of_the_truth():
    return [solid(f"{c}/a", size) for _, name, c, _, size, *_ in SPECS if name in NAMES]


def test_symmetry_of_models_is_known_only_when_given(folders):
    folders.edit("table_1", cad=turned(folders.entities[3], 180))
    assert folders.report().cad.accuracy == pytest.approx(0.8)
    symmetric = models_of_the_truth()
    assert folders.report(library=library_of(*symmetric)).cad.accuracy == 1.0
    plain = library_of(*(dataclasses.replace(m, symmetry=1) for m in symmetric))
    assert folders.report(library=plain).cad.accuracy == pytest.approx(0.8)
    # Symmetry is of the true model: the truth's library decides.
    report = folders.report(library=plain, truth_library=library_of(*symmetric))
    assert report.cad.accuracy == 1.0


def test_an_empty_library_of_the_truth_is_not_taken_for_none(folders):
    with pytest.raises(SceneError, match="which has 0 models"):
        folders.report(library=library_of(*models_of_the_truth()), truth_library=library_of())


def test_another_model_is_judged_by_its_size(folders):
    cad = dataclasses.replace(
        folders.entities[6].cad, id="chair/b", scale=np.full(3, 0.5, np.float32)
    )
    folders.edit("chair_1", cad=cad)
    row = next(r for r in folders.report().cad.rows if r.truth == "chair_1")
    assert row.errors.aligned and row.size_source == "boxes of the entities"
    true = models_of_the_truth()
    twice = solid("chair/b", (1.0, 1.0, 1.8))
    report = folders.report(library=library_of(*true, twice))
    row = next(r for r in report.cad.rows if r.truth == "chair_1")
    assert row.errors.aligned and row.size_source == "model"
    assert report.cad.same_model == pytest.approx(0.8)
    as_large = library_of(*true, solid("chair/b", (0.5, 0.5, 0.9)))
    report = folders.report(library=as_large, truth_library=library_of(*true))
    row = next(r for r in report.cad.rows if r.truth == "chair_1")
    assert not row.errors.aligned and row.errors.size_ratio == pytest.approx(0.5)


def test_what_the_camera_did_not_see_is_not_asked_for(folders):
    keep = folders.instance != 6
    folders.write_observed(folders.points[keep], folders.instance[keep])
    folders.entities = [e for e in folders.entities if e.name != "cup_2"]
    folders.drop(keep)
    report = folders.report()
    assert report.unseen == ("cup_2",)
    assert report.panoptic.pq == pytest.approx(1.0) and report.supports.recall == 1.0


def test_report_prints_and_writes(folders, tmp_path):
    report = folders.report()
    report.write(tmp_path / "evaluation.json")
    data = json.loads((tmp_path / "evaluation.json").read_text())
    assert data["panoptic"]["pq"] == pytest.approx(1.0)
    assert data["supports"]["recall"] == data["proximal"]["recall_of_found"] == 1.0
    assert data["surface"]["rates"][0]["f_score"] == 1.0
    console = Console(file=io.StringIO(), width=140, color_system=None)
    console.print(report.table())
    text = console.file.getvalue()
    for words in (
        "PQ / SQ / RQ, all 6 classes",
        "PQ / SQ / RQ, 6 matched classes only",
        "100.0 / 100.0 / 100.0",
        "mean, matched classes only",
        "box mAP_re@0.5 / 0.25, 11-point",
        "wall_cabinet",
        "5 of 5",
    ):
        assert words in text


@pytest.mark.parametrize(
    ("spoil", "words"),
    [
        (lambda d: (d / "result/map/panoptic.ply").unlink(), "panoptic.ply"),
        (lambda d: (d / "result/map/panoptic.ply").write_bytes(b"solid"), "no binary"),
        (lambda d: cut(d / "result/map/panoptic.ply", 2000), "some of its vertices"),
        (lambda d: cut(d / "result/map/panoptic.ply", -5), "some of its faces"),
        (lambda d: cut(d / "truth/meshes/table_1.ply", -5), "some of its faces"),
        (lambda d: edit(d, b"int vertex_indices", b"half vertex_indices"), "another kind"),
        (lambda d: edit(d, b"element vertex", b"element vertex many"), "another kind"),
        (lambda d: edit(d, b"list uchar int vertex", b"list uchar int8 vertex"), "no triangles"),
        (lambda d: edit(d, b"int instance", b"int entity"), "lacks instance"),
        (lambda d: (d / "truth/observed.npz").write_bytes(b"x"), "observed.npz"),
        (lambda d: (d / "truth/scene.json").unlink(), "scene.json"),
    ],
)
def test_files_that_cannot_be_read_are_named(folders, spoil, words):
    result = folders.write()
    spoil(folders.root)
    with pytest.raises(SceneError, match=words):
        evaluate(result, folders.truth)


def edit(root: Path, old: bytes, new: bytes) -> None:
    path = root / "result/map/panoptic.ply"
    path.write_bytes(path.read_bytes().replace(old, new, 1))


def cut(path: Path, end: int) -> None:
    path.write_bytes(path.read_bytes()[:end])


def test_models_and_the_verdict_stand_in_the_report(folders):
    report = folders.report()
    assert report.replacement is None and report.standing is None
    report = folders.report(library=library_of(*models_of_the_truth()))
    assert report.replacement is not None
    assert report.replacement.retrieval.top1_same == 1.0
    assert report.replacement.scan2cad.strict.instances == 1.0
    assert report.replacement.equivalence.relations == 1.0
    assert report.replacement.chamfer.two_way_median_m < 1e-4
    text = str(report)
    assert "functional equivalence" in text and "retrieval" in text
    json.dumps(report.to_json(), allow_nan=False)
