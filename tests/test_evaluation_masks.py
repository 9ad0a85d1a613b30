"""Segments, instance masks and boxes under damage: what must change does, nothing else does."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from isr_jax.classes import class_named
from isr_jax.evaluation.maps.instances import STRICT_IOUS, score_instances
from isr_jax.evaluation.maps.labels import Transfer
from isr_jax.evaluation.maps.segments import MIN_POINTS, compare_segments
from isr_jax.evaluation.result_files import Result, Truth
from isr_jax.geometry.boxes import canonical_box
from isr_jax.scene_file import SceneFile

from .builders import box_mesh
from .evaluation_folders import Folders, make_folders, measure_surfaces_fast, record
from .reference import evaluation_reference as reference

CHAIR, CUP = class_named("chair").id, class_named("cup").id


@pytest.fixture
def folders(tmp_path, monkeypatch) -> Folders:
    measure_surfaces_fast(monkeypatch)
    return make_folders(tmp_path)


def masks(report, class_name: str):
    return next(r for r in report.instances.rows if r.class_name == class_name)


def boxes(report, class_name: str):
    return next(r for r in report.boxes.rows if r.class_name == class_name)


def quality(report, class_name: str):
    return next(c for c in report.panoptic.classes if c.class_name == class_name)


def some_of(folders: Folders, instance: int, count: int) -> np.ndarray:
    """The first ``count`` vertices of an instance."""
    chosen = np.zeros(len(folders.points), bool)
    chosen[np.flatnonzero(folders.instance == instance)[:count]] = True
    return chosen


def test_a_mask_with_two_fifths_of_its_points_by_hand(folders):
    # cup_1 is whole; cup_2 keeps 0.4 of its points, IoU 0.4: a hit at 0.25, a miss at 0.5.
    # At 0.5: hit, miss of 2, so AP = 1/2 * 1; so at every stricter threshold.
    whole = int((folders.instance == 6).sum())
    folders.instance[some_of(folders, 6, whole - round(0.4 * whole))] = 0
    report = folders.report()
    row = masks(report, "cup")
    assert (row.true, row.predicted) == (2, 2)
    assert (row.ap50, row.ap25, row.ap) == pytest.approx((0.5, 1.0, 0.5))
    assert report.instances.map50 == pytest.approx((3 + 0.5) / 4)
    assert report.instances.map25 == pytest.approx(1.0)
    assert masks(report, "chair").ap == 1.0


def test_a_false_mask_costs_by_its_rank(folders):
    # Before both cups: miss, hit, hit gives precision 0, 1/2, 2/3, and AP = 2/3. Behind: 1.
    ghost = box_mesh((0.1, 0.1, 0.12), (0, 0, 3.0), spacing_m=0.02).vertices
    for copies, ap in ((3, 2 / 3), (0.5, 1.0)):
        spoiled = dataclasses.replace(folders)
        count = int(copies * len(ghost))
        spoiled.add(np.tile(ghost, (3, 1))[:count], 9, "cup")
        report = spoiled.report()
        assert masks(report, "cup").predicted == 3
        assert masks(report, "cup").ap50 == pytest.approx(ap)
        assert quality(report, "cup").false_positives == 1


def test_swapping_two_ids_of_one_class_swaps_only_who_is_whom(folders):
    plain = folders.report()
    five, six = folders.instance == 5, folders.instance == 6
    folders.instance[five], folders.instance[six] = 6, 5
    report = folders.report()
    assert report.panoptic == plain.panoptic and report.instances == plain.instances
    assert report.surface == plain.surface and report.supports == plain.supports
    named = {m.truth: m.predicted for m in report.matches}
    assert (named["cup_1"], named["cup_2"]) == ("cup_2", "cup_1")
    assert report.cad.accuracy == pytest.approx(3 / 5)  # the models of the cups are 50 cm apart


def test_swapping_two_classes_costs_these_two_alone(folders):
    plain = folders.report()
    table, chair = folders.instance == 4, folders.instance == 7
    folders.class_id[table], folders.class_id[chair] = CHAIR, class_named("table").id
    report = folders.report()
    for name in ("table", "chair"):
        row = quality(report, name)
        assert (row.true_positives, row.false_positives, row.false_negatives) == (0, 1, 1)
        assert masks(report, name).ap25 == 0.0
    assert report.panoptic.pq == pytest.approx(4 / 6)
    assert report.panoptic.pq_matched == pytest.approx(1.0)
    assert report.instances.map50 == pytest.approx(2 / 4)
    for name in ("cup", "wall_cabinet", "floor", "wall"):
        assert quality(report, name) == quality(plain, name)
    assert report.boxes == plain.boxes and report.surface == plain.surface


def test_a_box_shifted_by_half_its_side_costs_boxes_alone(folders):
    # The overlap of two equal boxes half a side apart is 1/2, their union 3/2: IoU 1/3.
    plain = folders.report()
    along = 0.25 * np.array([np.cos(0.3), -np.sin(0.3), 0.0])
    shifted = np.array([-1.0, -0.8, 0.45]) + along
    folders.edit("chair_1", box=canonical_box(shifted, -0.3, np.array([0.5, 0.5, 0.9])))
    report = folders.report()
    row = boxes(report, "chair")
    assert (row.ap50, row.ap25, row.ap50_11point, row.ap25_11point) == (0.0, 1.0, 0.0, 1.0)
    assert report.boxes.map50 == pytest.approx(3 / 4)
    assert report.panoptic == plain.panoptic and report.instances == plain.instances
    assert report.supports == plain.supports and report.surface == plain.surface


def test_dropping_an_instance_costs_its_own_rows(folders):
    plain = folders.report()
    folders.entities = [e for e in folders.entities if e.name != "chair_1"]
    chair = folders.instance == 7
    gone = float(np.mean(chair))
    folders.drop(~chair)
    report = folders.report()
    assert quality(report, "chair").false_negatives == 1
    assert masks(report, "chair").ap == boxes(report, "chair").ap25 == 0.0
    assert quality(report, "table") == quality(plain, "table")
    assert (report.supports.correct, report.supports.true) == (3, 4)
    assert report.supports.precision == report.supports.recall_of_found == 1.0
    assert (report.proximal.correct, report.proximal.true, report.proximal.reachable) == (1, 2, 1)
    assert report.surface.rate(0.02).precision == 1.0
    sampling = 4 * np.sqrt(gone / 1000)  # standard errors of a share of 1000 points
    assert report.surface.rate(0.02).recall == pytest.approx(1 - gone, abs=sampling)


def test_what_hits_only_a_hardly_seen_thing_is_no_false_alarm(folders):
    few = (folders.instance != 6) | some_of(folders, 6, MIN_POINTS - 1)
    folders.write_observed(folders.points[few], folders.instance[few])
    report = folders.report()
    assert report.unseen == ("cup_2",)
    row = boxes(report, "cup")
    assert (row.true, row.predicted, row.ap50) == (1, 2, 1.0)


def with_picture(folders: Folders, **columns) -> np.ndarray:
    """Part of a wall is a picture in the truth, which is no entity; True where."""
    p = folders.points
    picture = (folders.instance == 2) & (np.abs(p[:, 0]) < 0.5) & (np.abs(p[:, 2] - 1) < 0.5)
    instance = np.where(picture, 20, folders.instance)
    class_of = {k: np.where(picture, v, folders.class_id) for k, v in columns.items()}
    folders.write_observed(folders.points, instance, **class_of)
    return picture


def test_stuff_that_is_no_entity_is_asked_for(folders):
    stuff = class_named("picture").id
    picture = with_picture(folders, class_id=stuff)
    report = folders.report()
    assert quality(report, "picture").false_negatives == 1
    wall = np.isin(folders.instance, (2, 3))
    assert quality(report, "wall").sq == pytest.approx((wall & ~picture).sum() / wall.sum())
    folders.class_id[picture] = stuff
    folders.instance[picture] = 30
    report = folders.report()
    assert report.panoptic.pq == pytest.approx(1.0) and report.panoptic.pq_stuff == 1.0
    assert quality(report, "picture").kind == "stuff"
    assert {r.class_name for r in report.instances.rows} == {
        *("table", "cup", "chair", "wall_cabinet")
    }


def test_what_has_no_entity_and_no_class_is_ignored(folders):
    """Files that do not say the class, and things that are no entity: nobody is asked."""
    for columns in ({}, {"class_id": CHAIR}):
        with_picture(folders, **columns)
        report = folders.report()
        assert report.panoptic.pq == pytest.approx(1.0)
        assert {c.class_name for c in report.panoptic.classes} == {
            *("floor", "wall", "table", "cup", "chair", "wall_cabinet")
        }


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 2**31))
def test_instance_precision_as_its_twin(seed):
    rng = np.random.default_rng(seed)
    true = rng.integers(0, 6, 240)
    predicted = np.where(rng.random(240) < rng.uniform(0.5, 1), true, rng.integers(0, 6, 240))
    class_of = np.append(0, rng.choice([CHAIR, CUP], 5))
    guess_of = np.append(0, np.where(rng.random(5) < 0.8, class_of[1:], CHAIR))
    names = {CHAIR: "chair", CUP: "cup"}
    entities = tuple(
        record(i, f"e_{i}", names[class_of[i]], (0, 0, 0), (1, 1, 1), 0.0, None)
        for i in range(1, 6)
    )
    points = rng.random((240, 3))
    scene, empty = SceneFile(entities, np.eye(4)), np.zeros((0, 3), np.int32)
    truth = Truth(scene, points, true, None, None)
    result = Result(scene, points, empty, predicted, guess_of[predicted], np.eye(4))
    near = Transfer(np.arange(240), np.zeros(240))
    scores = score_instances(compare_segments(truth, result, near))
    assert pytest.approx(np.linspace(0.5, 0.95, 10)) == STRICT_IOUS
    for class_id, name in names.items():
        expected = [
            reference.mask_average_precision(
                true, predicted, class_of, guess_of, class_id, threshold, MIN_POINTS
            )
            for threshold in (0.5, 0.25, *STRICT_IOUS)
        ]
        rows = [r for r in scores.rows if r.class_name == name]
        assert len(rows) == (expected[0] is not None)
        for row in rows:
            assert (row.ap50, row.ap25) == pytest.approx(tuple(expected[:2]))
            assert row.ap == pytest.approx(np.mean(expected[2:]))


def test_the_released_counting_of_a_perfect_result(folders):
    """Its trap of several walls: of two as large, the second only enlarges the union, IoU 1/2."""
    assert folders.report().released_counting is None
    report = folders.report(released_counting=True)
    counted = report.released_counting
    assert counted is not None
    rows = {r.class_name: r for r in counted.fitted.classes}
    assert set(rows) == {"floor", "wall", "table", "chair", "cabinet"}  # of cups it knows nothing
    assert rows["wall"].pq == 0.0
    assert all(row.pq == pytest.approx(1.0) for name, row in rows.items() if name != "wall")
    assert counted.fitted.pq == pytest.approx(4 / 5)
    assert counted.fitted.box_map == counted.refined.box_map == counted.fitted.instance_map == 1.0
    assert report.panoptic.pq == pytest.approx(1.0)
    assert any("released code" in name for name, _ in report.headline())


def test_the_released_counting_forgives_what_is_not_predicted(folders):
    folders.drop(folders.instance != 7)
    report = folders.report(released_counting=True)
    assert report.released_counting.fitted.pq == pytest.approx(3 / 4)  # one row less, no worse
    # The chair scores 0; what of it is within 5 cm of the floor now counts as floor, and is wrong.
    assert 0.7 < report.panoptic.pq < 5 / 6


def test_the_released_counting_of_refined_boxes(folders):
    folders.edit("chair_1", box=canonical_box(np.array([5.0, 5, 1]), 0.0, np.ones(3)))
    counted = folders.report(released_counting=True).released_counting
    assert counted.fitted.box_map == 1.0
    assert counted.refined.box_map == pytest.approx(2 / 3)  # of table, chair, cabinet


def test_folders_are_as_the_tests_say(tmp_path: Path):
    """The truth of these tests: 6 entities' worth of classes, cups of as many vertices."""
    made = make_folders(tmp_path)
    counts = np.bincount(made.instance)
    assert counts[5] == counts[6] > 20 * MIN_POINTS and made.faces.max() < len(made.points)
