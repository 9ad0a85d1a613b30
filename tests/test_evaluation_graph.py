"""Edges of the contact graph and heights of supporting planes, by hand."""

from __future__ import annotations

import dataclasses
import json

import numpy as np
import pytest

from isr_jax.evaluation import evaluate
from isr_jax.evaluation.graphs.support_planes import height_of_plane
from isr_jax.scene_file import NOT_ANNOTATED, PlaneRecord

from .builders import rotation_z
from .evaluation_folders import Folders, make_folders, measure_surfaces_fast


@pytest.fixture
def folders(tmp_path, monkeypatch) -> Folders:
    measure_surfaces_fast(monkeypatch)
    return make_folders(tmp_path)


def test_proximal_pairs_by_hand(folders):
    # True: cups, table-chair. Predicted: chair-table (turned round), chair-cup: 1 of 2, 1 of 2.
    folders.proximal = (("chair_1", "table_1", 0.5), ("chair_1", "cup_1", 0.1))
    p = folders.report().proximal
    assert (p.correct, p.predicted, p.true) == (1, 2, 2)
    assert (p.precision, p.recall) == (0.5, 0.5)


def test_pairs_of_layout_are_left_out(folders):
    folders.proximal = (*folders.proximal, ("wall_cabinet_1", "wall_1", 0.1))
    p = folders.report().proximal
    assert (p.precision, p.recall, p.predicted) == (1.0, 1.0, 2)


def test_pairs_of_things_that_match_nothing_are_wrong_but_not_the_graphs_fault(folders):
    ghost = dataclasses.replace(folders.entities[6], id=30, name="ghost", class_name="sofa")
    folders.entities.append(ghost)
    folders.proximal = (*folders.proximal, ("ghost", "cup_1", 0.1))
    p = folders.report().proximal
    assert (p.precision, p.recall) == (pytest.approx(2 / 3), 1.0)
    assert (p.precision_of_found, p.recall_of_found) == (1.0, 1.0)
    assert (p.predicted, p.predicted_of_found) == (3, 2)


def test_supports_of_found_leave_out_what_is_lost_or_false(folders):
    """The table is lost: its cups cannot stand on it. A ghost stands on the floor."""
    ghost = dataclasses.replace(folders.entities[6], id=30, name="ghost", class_name="sofa")
    folders.entities = [e for e in folders.entities if e.name != "table_1"] + [ghost]
    for cup in ("cup_1", "cup_2"):
        folders.edit(cup, parent="floor_1")
    folders.drop(folders.instance != 4)
    report = folders.report()
    s = report.supports
    # Predicted: two cups, chair and ghost on the floor; chair alone is right. True: 4 edges, of
    # which the table's and both cups' have an end that was lost.
    assert (s.correct, s.predicted, s.true) == (1, 4, 4)
    assert (s.predicted_of_found, s.reachable) == (3, 1)
    assert (s.precision, s.recall) == (0.25, 0.25)
    assert (s.precision_of_found, s.recall_of_found) == (pytest.approx(1 / 3), 1.0)


def test_what_nobody_annotated_is_not_asked(folders):
    """A scan's truth has no supports: no edge of the result is right or wrong."""
    path = folders.write() and folders.truth / "scene.json"
    data = json.loads(path.read_text())
    data["settings"]["supports"] = NOT_ANNOTATED
    path.write_text(json.dumps(data))
    report = evaluate(folders.write(), folders.truth)
    for edges in (report.supports, report.proximal):
        assert (edges.precision, edges.recall, edges.predicted) == (None, None, 0)
    assert (report.attachments.accuracy, report.attachments.count) == (None, 0)


def lifted(plane: PlaneRecord, by_m: float) -> PlaneRecord:
    return dataclasses.replace(plane, offset=plane.offset - by_m)


def test_heights_of_planes_by_hand(folders):
    # The table's top is found 3 cm too high: both cups err by it, table and chair by nothing.
    table = folders.entities[3]
    folders.edit("table_1", planes=(lifted(table.planes[0], 0.03),))
    s = folders.report().support_planes
    errors = {r.truth: r.error_m for r in s.rows}
    expected = {"cup_1": 0.03, "cup_2": 0.03, "table_1": 0.0, "chair_1": 0.0}
    assert errors == pytest.approx(expected, abs=1e-5)
    assert s.median_m == pytest.approx(0.015, abs=1e-5) and s.near_share == 0.5
    # One cup is said to stand on the floor, 72 cm below; of the other no plane is known.
    folders.edit("cup_1", parent="floor_1")
    folders.edit("cup_2", support_plane=None)
    s = folders.report().support_planes
    rows = {r.truth: r for r in s.rows}
    assert rows["cup_1"].error_m == pytest.approx(0.72) and not rows["cup_1"].same_parent
    assert rows["cup_2"].error_m is None
    assert s.median_m == pytest.approx(0.0, abs=1e-5) and s.near_share == 0.5


def test_another_plane_of_the_right_parent_errs_by_its_depth(folders):
    """A shelf 30 cm below the top: the parent is right, the plane is not."""
    table = folders.entities[3]
    folders.edit("table_1", planes=(table.planes[0], lifted(table.planes[0], -0.3)))
    folders.edit("cup_1", support_plane=1)
    report = folders.report()
    row = next(r for r in report.support_planes.rows if r.truth == "cup_1")
    assert row.same_parent and row.error_m == pytest.approx(0.3)
    assert report.supports.precision == 1.0 and report.support_planes.near_share == 0.75


def test_what_was_not_found_has_no_row(folders):
    folders.entities = [e for e in folders.entities if e.name != "cup_2"]
    folders.drop(folders.instance != 6)
    s = folders.report().support_planes
    assert {r.truth for r in s.rows} == {"cup_1", "table_1", "chair_1"} and s.near_share == 1.0


def test_height_of_a_tilted_plane():
    # z = 0.1 x + 0.5 is 0.7 above x = 2; moved by (1, 0, 2) it is z = 0.1 (x - 1) + 2.5 = 2.6.
    length = np.hypot(0.1, 1.0)
    normal = np.array([-0.1, 0.0, 1.0]) / length
    plane = PlaneRecord(normal, -0.5 / length, np.zeros((4, 3)), 1.0)
    at, T = np.array([2.0, 9.0, 0.0]), np.eye(4)
    assert height_of_plane(plane, at, T) == pytest.approx(0.7)
    T[:3, 3] = 1.0, 0.0, 2.0
    assert height_of_plane(plane, at, T) == pytest.approx(2.6)
    # Turned by 90 degrees the slope runs along y: z = 0.1 y + 0.5 is 1.4 at y = 9.
    T = np.eye(4)
    T[:3, :3] = rotation_z(np.pi / 2)
    assert height_of_plane(plane, at, T) == pytest.approx(1.4, abs=1e-6)


def test_a_wall_has_no_height():
    wall = PlaneRecord(np.array([1.0, 0, 0]), -1.0, np.zeros((4, 3)), 1.0)
    assert height_of_plane(wall, np.zeros(3), np.eye(4)) is None
