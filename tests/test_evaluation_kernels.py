"""Panoptic quality, average precision and rotation errors against twins and by hand."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from isr_jax.evaluation import (
    AlignmentLimits,
    CadPose,
    ClassQuality,
    PanopticScores,
    average_precision,
    box_iou_matrix,
    contingency,
    panoptic_quality,
    precision_recall,
    rotation_error_rad,
    score_cads,
)
from isr_jax.geometry.boxes import canonical_box

from .builders import rotation_z
from .reference import evaluation_reference as reference

FLOAT32 = 1e-6
seeds = st.integers(0, 2**31)


def quality(shared, truth_size, predicted_size, truth_class, predicted_class, class_count=4):
    arrays = (shared, truth_size, predicted_size, truth_class, predicted_class)
    return panoptic_quality(*(np.asarray(a, np.int32) for a in arrays), class_count=class_count)


@settings(max_examples=20, deadline=None)
@given(seeds)
def test_contingency_as_its_twin(seed):
    rng = np.random.default_rng(seed)
    truth, predicted = rng.integers(-1, 8, 64), rng.integers(-1, 8, 64)
    found = contingency(
        truth.astype(np.int32), predicted.astype(np.int32), truth_count=8, predicted_count=8
    )
    np.testing.assert_array_equal(found, reference.contingency(truth, predicted, 8, 8))


@settings(max_examples=20, deadline=None)
@given(seeds)
def test_quality_as_its_twin(seed):
    rng = np.random.default_rng(seed)
    truth = rng.integers(0, 8, 400)
    predicted = np.where(rng.random(400) < 0.7, truth, rng.integers(-1, 8, 400))
    shared = reference.contingency(truth, predicted, 8, 8)
    sizes = np.bincount(truth, minlength=8), np.bincount(predicted[predicted >= 0], minlength=8)
    classes = rng.integers(0, 3, 8), rng.integers(0, 3, 8)
    classes = classes[0], np.where(rng.random(8) < 0.8, classes[0], classes[1])
    found = quality(shared, *sizes, *classes)
    expected = reference.panoptic_quality(shared, *sizes, *classes, 4)
    np.testing.assert_allclose([found.pq, found.sq, found.rq], expected, atol=FLOAT32)


def test_quality_by_hand():
    # Class 1: truth 0 (10 points) shares 8 of predicted 0 (10) -> IoU 8/12; truth 1 (6) is missed,
    # predicted 1 (5) is false. Class 2: truth 2 (4) and predicted 2 (6) share 4, IoU 4/6.
    shared = np.zeros((8, 8), int)
    shared[0, 0], shared[2, 2] = 8, 4
    q = quality(
        shared,
        [10, 6, 4, 0, 0, 0, 0, 0],
        [10, 5, 6, 0, 0, 0, 0, 0],
        [1, 1, 2, 0, 0, 0, 0, 0],
        [1, 1, 2, 0, 0, 0, 0, 0],
    )
    np.testing.assert_allclose(q.sq, [0, 2 / 3, 2 / 3, 0], atol=FLOAT32)
    np.testing.assert_allclose(q.rq, [0, 0.5, 1, 0], atol=FLOAT32)
    np.testing.assert_allclose(q.pq, [0, 1 / 3, 2 / 3, 0], atol=FLOAT32)
    assert q.true_positives.tolist() == [0, 1, 1, 0]
    assert q.false_positives.tolist() == q.false_negatives.tolist() == [0, 1, 0, 0]
    assert q.partner[:3].tolist() == [0, -1, 2]


def test_exactly_one_half_is_no_match():
    q = quality([[5]], [5], [10], [1], [1])
    assert q.true_positives.sum() == 0
    assert (q.false_positives.sum(), q.false_negatives.sum()) == (1, 1)


def test_another_class_is_no_match():
    q = quality([[5]], [5], [5], [1], [2])
    np.testing.assert_array_equal(q.pq, 0)
    assert q.false_positives.tolist() == [0, 0, 1, 0]
    assert q.false_negatives.tolist() == [0, 1, 0, 0]


@pytest.mark.parametrize(
    ("iou", "score", "expected"),
    [
        ([[1, 0], [0, 1]], [2, 1], 1.0),
        ([[0.9, 0], [0.4, 0], [0, 0.8]], [3, 2, 1], 0.5 + 0.5 * 2 / 3),
        ([[0.4, 0], [0.9, 0]], [2, 1], 0.25),
        ([[0.9, 0.8], [0.7, 0]], [2, 1], 0.5),  # the second finds its box taken
        ([[0.6] + [0] * 9], [1], 0.1),  # one of ten: recall that is never reached counts 0
        ([], [], 0.0),
    ],
)
def test_average_precision_by_hand(iou, score, expected):
    table = np.asarray(iou, float).reshape(len(score), -1 if len(iou) else 1)
    assert average_precision(table, np.asarray(score, float), 0.5) == pytest.approx(expected)


@settings(max_examples=50, deadline=None)
@given(seeds, st.integers(0, 6), st.integers(1, 5))
def test_average_precision_as_its_twin(seed, predictions, truths):
    rng = np.random.default_rng(seed)
    iou, score = rng.random((predictions, truths)), rng.random(predictions)
    expected = reference.average_precision(iou, score, 0.5)
    assert average_precision(iou, score, 0.5) == pytest.approx(expected)


@settings(max_examples=50, deadline=None)
@given(seeds, st.integers(0, 6), st.integers(1, 10))
def test_eleven_point_precision_as_its_twin(seed, predictions, truths):
    rng = np.random.default_rng(seed)
    iou, score = rng.random((predictions, truths)), rng.random(predictions)
    found = precision_recall(iou, score, 0.5).eleven_point
    assert found == pytest.approx(reference.eleven_point(iou, score, 0.5))


def test_eleven_point_precision_by_hand():
    # Hit, miss, hit of 2: precision 1, 1/2, 2/3 at recall 1/2, 1/2, 1. The levels 0, ..., 0.5 see
    # 1, the levels 0.6, ..., 1.0 see 2/3: (6 + 5 * 2/3) / 11 = 28/33. All points: 5/6.
    curve = precision_recall(
        np.array([[0.9, 0], [0.4, 0], [0, 0.8]]), np.array([3.0, 2.0, 1.0]), 0.5
    )
    np.testing.assert_allclose(curve.precision, [1, 1 / 2, 2 / 3])
    np.testing.assert_allclose(curve.recall, [1 / 2, 1 / 2, 1])
    assert curve.eleven_point == pytest.approx(28 / 33)
    assert curve.all_point == pytest.approx(5 / 6)


@pytest.mark.parametrize(("found", "levels"), [(0, 0), (1, 2), (3, 4), (10, 11)])
def test_recall_that_is_never_reached_counts_nothing(found, levels):
    """``found`` of 10 and no false alarm: the levels 0, ..., found/10 see 1, the others 0."""
    curve = precision_recall(np.eye(10)[:found], np.ones(found), 0.5)
    assert curve.eleven_point == pytest.approx(levels / 11)
    assert curve.all_point == pytest.approx(found / 10)


def test_ignored_predictions_are_left_out_unless_they_hit():
    iou, score = np.array([[0.1], [0.9]]), np.array([2.0, 1.0])
    assert average_precision(iou, score, 0.5) == pytest.approx(0.5)
    ignored = precision_recall(iou, score, 0.5, np.array([True, True]))
    np.testing.assert_array_equal(ignored.precision, [1.0])
    assert ignored.all_point == ignored.eleven_point == 1.0


def test_both_averages_by_hand():
    # chair: 0.6 * 0.5 = 0.3; cup: nothing found; floor: 0.8 * 1.
    rows = (
        ClassQuality("chair", "thing", 0.3, 0.6, 0.5, 1, 1, 1),
        ClassQuality("cup", "thing", 0.0, 0.0, 0.0, 0, 1, 2),
        ClassQuality("floor", "stuff", 0.8, 0.8, 1.0, 1, 0, 0),
    )
    s = PanopticScores.over(rows)
    np.testing.assert_allclose([s.pq, s.sq, s.rq], [1.1 / 3, 1.4 / 3, 1.5 / 3])
    np.testing.assert_allclose([s.pq_things, s.pq_stuff], [0.15, 0.8])
    np.testing.assert_allclose([s.pq_matched, s.sq_matched, s.rq_matched], [0.55, 0.7, 0.75])
    lines = dict(s.headline())
    assert lines["PQ / SQ / RQ, all 3 classes"] == "36.7 / 46.7 / 50.0"
    assert lines["PQ / SQ / RQ, 2 matched classes only"] == "55.0 / 70.0 / 75.0"


def test_averages_of_nothing_are_none_or_zero():
    s = PanopticScores.over(())
    assert (s.pq, s.sq, s.rq) == (0.0, 0.0, 0.0)
    assert s.pq_things is s.pq_stuff is s.pq_matched is s.sq_matched is s.rq_matched is None


def test_box_iou_matrix_needs_no_power_of_two():
    boxes = [canonical_box(np.array([x, 0, 0]), 0.3, np.ones(3)) for x in (0.0, 5.0, 9.0)]
    np.testing.assert_allclose(box_iou_matrix(boxes, boxes[:2]), np.eye(3)[:, :2], atol=1e-5)
    assert box_iou_matrix([], boxes).shape == (0, 3)


@pytest.mark.parametrize(
    ("symmetry", "degrees", "expected"),
    [
        (1, 30, 30),
        (1, 180, 180),
        (2, 180, 0),
        (2, 170, 10),
        (2, 90, 90),
        (4, 90, 0),
        (4, 50, 40),
        (0, 77, 0),
    ],
)
def test_rotation_error_about_z(symmetry, degrees, expected):
    truth = rotation_z(0.7).astype(float)
    turned = rotation_z(0.7 + np.deg2rad(degrees)).astype(float)
    error = np.rad2deg(rotation_error_rad(truth, turned, symmetry))
    assert error == pytest.approx(expected, abs=0.05)  # arccos near 1 in float32 rotations


@pytest.mark.parametrize("symmetry", [0, 1, 2, 4])
def test_tilt_is_an_error_under_every_symmetry(symmetry):
    c, s = np.cos(0.5), np.sin(0.5)
    tilted = np.array([[1, 0, 0], [0, c, -s], [0, s, c]])
    assert rotation_error_rad(np.eye(3), tilted, symmetry) == pytest.approx(0.5)


@pytest.mark.parametrize(
    ("move", "turn", "grow", "aligned"),
    [
        (0.19, 0, 1, True),
        (0.21, 0, 1, False),
        (0, 19, 1, True),
        (0, 21, 1, False),
        (0, 0, 1.19, True),
        (0, 0, 1.21, False),
        (0, 0, 0.79, False),
    ],
)
def test_alignment_limits(move, turn, grow, aligned):
    truth = CadPose("a", np.eye(3), np.zeros(3), np.array([1.0, 2.0, 3.0]))
    other = CadPose(
        "b",
        rotation_z(np.deg2rad(turn)).astype(float),
        np.array([0.0, 0.0, move]),
        truth.size * grow,
    )
    assert score_cads(truth, other, 1, AlignmentLimits()).aligned is aligned


def test_opposite_size_errors_do_not_cancel():
    truth = CadPose("a", np.eye(3), np.zeros(3), np.ones(3))
    stretched = CadPose("a", np.eye(3), np.zeros(3), np.array([1.5, 0.5, 1.0]))
    assert not score_cads(truth, stretched, 1, AlignmentLimits()).aligned
