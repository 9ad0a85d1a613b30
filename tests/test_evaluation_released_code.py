"""The released code's counting, trap by trap, by hand."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from isr_jax.evaluation.maps.released_code import (
    ReleasedCodeScores,
    count_as_released_code,
    pooled,
    released_ap,
    released_class,
    released_true_class,
    triangle_soup,
)
from isr_jax.geometry.boxes import canonical_box

from .builders import box_mesh

FLOAT32 = 1e-6


def rows(*counts: tuple[int, int, int]):
    """Points in a row, 1 cm apart: (number, predicted instance, true label) one after another."""
    instance = np.concatenate([np.full(n, i) for n, i, _ in counts])
    label = np.concatenate([np.full(n, k) for n, _, k in counts])
    at = np.arange(len(instance))
    # Three heights, so that boxes have a volume.
    points = np.stack([at * 0.01, (at % 2) * 0.3, (at % 3) * 0.2], 1)
    return points, instance, points, label


def score(counts, predicted, true, **options):
    points, instance, truth_points, label = rows(*counts)
    options = {"min_vertices": 10} | options
    found = count_as_released_code(
        points, instance, predicted, truth_points, label, true, **options
    )
    return ReleasedCodeScores.over(found), found


def test_a_perfect_map_scores_one():
    counts = [(60, 1, 5), (40, 2, 6), (80, 3, 7)]
    scores, _ = score(
        counts, {1: "chair", 2: "table", 3: "floor"}, {5: "chair", 6: "table", 7: "floor"}
    )
    assert dataclasses.astuple(scores)[:5] == (1.0,) * 5
    assert {c.class_name for c in scores.classes} == {"chair", "table", "floor"}


def test_quality_by_hand():
    # Chair 1 has 50 vertices, 40 on the true chair 5, which has 40 + 10 of nothing predicted as a
    # chair: IoU 40 / (50 + 50 - 40) = 2/3. True chair 6 is missed: RQ = 1 / (1 + 0 + 1/2) = 2/3,
    # PQ = 4/9. The table is predicted where there is none: all 0, and it counts in the means.
    counts = [(40, 1, 5), (10, 1, 0), (10, 9, 5), (30, 9, 6), (20, 2, 0)]
    scores, _ = score(counts, {1: "chair", 2: "table"}, {5: "chair", 6: "chair"})
    assert scores.sq == pytest.approx((2 / 3 + 0) / 2)
    assert scores.rq == pytest.approx((2 / 3 + 0) / 2)
    assert scores.pq == pytest.approx((4 / 9 + 0) / 2)
    assert scores.instance_map == pytest.approx((1.0 + 0) / 2), "one of two: AP 1, see below"


def test_classes_that_are_not_predicted_cost_nothing():
    counts = [(40, 1, 5), (40, 9, 6)]
    scores, _ = score(counts, {1: "chair"}, {5: "chair", 6: "sofa"})
    assert (scores.pq, scores.instance_map) == (1.0, 1.0)


def test_true_surface_that_the_map_lacks_costs_nothing():
    points, instance, truth_points, label = rows((40, 1, 5))
    more = np.concatenate([truth_points, truth_points + np.array([0, 9, 0])])
    found = count_as_released_code(
        points, instance, {1: "chair"}, more, np.tile(label, 2), {5: "chair"}, min_vertices=10
    )
    assert ReleasedCodeScores.over(found).pq == 1.0


def test_labels_come_from_any_distance():
    points, instance, truth_points, label = rows((40, 1, 5))
    far = points + np.array([0, 0, 7.0])
    found = count_as_released_code(
        far, instance, {1: "chair"}, truth_points, label, {5: "chair"}, min_vertices=10
    )
    assert ReleasedCodeScores.over(found).pq == 1.0


def test_small_predictions_are_dropped_but_stay_in_the_map():
    # The small chair is dropped; its vertices still count for the true chair 5: IoU 60/69.
    counts = [(60, 1, 5), (9, 2, 5)]
    scores, found = score(counts, {1: "chair", 2: "chair"}, {5: "chair"})
    assert found["chair"].predicted == 1
    assert scores.sq == pytest.approx(60 / 69)
    points, instance, truth_points, label = rows((1000, 1, 5), (999, 2, 6))
    by_default = count_as_released_code(
        points, instance, {1: "chair", 2: "bed"}, truth_points, label, {5: "chair", 6: "bed"}
    )
    assert list(by_default) == ["chair"], "1000 vertices stay, 999 do not"


def test_of_two_true_walls_the_second_never_matches():
    # One predicted wall of 100 covers true walls 5 (60) and 6 (40) exactly. Merged as meant, its
    # IoU would be 1. The 40 join the union and are not shared: 60 / (100 + 100 - 60) < 1/2.
    counts = [(60, 1, 5), (40, 1, 6)]
    scores, found = score(counts, {1: "wall"}, {5: "wall", 6: "wall"})
    assert (found["wall"].predicted, found["wall"].true) == (1, 1)
    assert scores.pq == 0.0 and scores.instance_map is None
    # 90 and 10: 90 / (100 + 100 - 90) = 0.818 matches, and is not 1.
    scores, _ = score([(90, 1, 5), (10, 1, 6)], {1: "wall"}, {5: "wall", 6: "wall"})
    assert scores.sq == pytest.approx(90 / 110)
    # In the other order of the annotation the small one is the first: 10 / 190.
    scores, _ = score([(90, 1, 5), (10, 1, 6)], {1: "wall"}, {6: "wall", 5: "wall"})
    assert scores.pq == 0.0


@pytest.mark.parametrize(
    ("predictions", "true", "expected"),
    [
        ([(9, True)], 10, 1.0),  # one of ten: recalls beyond 0.1 get the last precision, 1
        ([(9, True)], 1, 1.0),
        ([(9, False)], 3, 0.0),
        ([(9, True)], 0, 0.0),
        ([], 4, 0.0),
        # Hit, miss of 2: precisions 1, 1/2; recall reached 1/2. Levels 0 to 0.4 (5 of them) have 1,
        # 0.5 to 1 (6) have the last precision, 1/2.
        ([(9, True), (8, False)], 2, (5 * 1 + 6 * 0.5) / 11),
        # Miss, hit: precisions 0, 1/2. Level 0 is reached by the first, the best after it is 1/2.
        ([(8, True), (9, False)], 2, 0.5),
        # Hit, miss, hit of 2: precisions 1, 1/2, 2/3. Levels to 0.5 (6) have 1; to 0.9 (4) have
        # 2/3; level 1 is the recall of all: the last precision, 2/3.
        ([(9, True), (8, False), (7, True)], 2, (6 * 1 + 5 * 2 / 3) / 11),
        # Three of ten, then a miss: recall 0.3. Levels 0, 0.1, 0.2 have 1, 0.3 and on 3/4.
        ([(9, True), (8, True), (7, True), (6, False)], 10, (3 * 1 + 8 * 0.75) / 11),
    ],
)
def test_ap_by_hand(predictions, true, expected):
    assert released_ap(predictions, true) == pytest.approx(expected, abs=FLOAT32)


def test_true_boxes_are_fitted_to_the_map():
    # The map holds the left half of a true box, and labels it right: the fitted true box is the
    # same half, so that the box matches, though half of the true box is missing.
    whole = box_mesh((1.0, 0.6, 0.5), spacing_m=0.05).vertices
    half = whole[whole[:, 0] < 0]
    found = count_as_released_code(
        half,
        np.ones(len(half), int),
        {1: "table"},
        whole,
        np.full(len(whole), 5),
        {5: "table"},
        min_vertices=10,
    )
    assert ReleasedCodeScores.over(found).box_map == 1.0


def test_given_boxes_take_the_place_of_fitted_ones():
    points = box_mesh((1.0, 0.6, 0.5), spacing_m=0.05).vertices
    arrays = points, np.ones(len(points), int), {1: "table"}, points, np.full(len(points), 5)
    # Moved by 0.3 along x: IoU 0.7 / 1.3 > 1/2; by 0.4: 0.6 / 1.4 < 1/2.
    for shift, expected in ((0.3, 1.0), (0.4, 0.0)):
        boxes = {1: canonical_box(np.array([shift, 0, 0]), 0.0, np.array([1.0, 0.6, 0.5]))}
        found = count_as_released_code(*arrays, {5: "table"}, boxes=boxes, min_vertices=10)
        assert ReleasedCodeScores.over(found).box_map == expected
        assert ReleasedCodeScores.over(found).instance_map == 1.0


def test_pooled_counts_are_not_means():
    # Sequence A: one chair matched at IoU 1. Sequence B: a chair predicted for none of 3 true ones.
    a, b = (
        score([(40, 1, 5)], {1: "chair"}, {5: "chair"})[1],
        score([(40, 1, 0), (9, 9, 6)], {1: "chair"}, {6: "chair", 7: "chair", 8: "chair"})[1],
    )
    together = ReleasedCodeScores.over(pooled([a, b]))
    assert together.sq == 1.0, "B has no match and so no say"
    assert together.rq == pytest.approx(2 * 1 / (2 + 4))
    means = [ReleasedCodeScores.over(c) for c in (a, b)]
    assert np.mean([s.sq for s in means]) == 0.5


def test_nothing_predicted_gives_none():
    scores, found = score([(40, 9, 5)], {}, {5: "chair"})
    assert found == {}
    assert (scores.pq, scores.sq, scores.rq, scores.instance_map, scores.box_map) == (None,) * 5


def test_classes_and_the_words_that_annotations_are_searched_for():
    assert released_class("desk") == "table" and released_class("sofa") == "sofa"
    assert released_class("wall_cabinet") == "cabinet" and released_class("plant") is None
    assert released_true_class("computer desk") == "table"
    assert released_true_class("wall") == "wall" and released_true_class("wall clock") == "wall"
    assert released_true_class("garbage bin") == "bag", "gar-bag-e"
    assert released_true_class("tv") is None and released_true_class("") is None


def test_soup_has_three_vertices_a_triangle_and_none_between_instances():
    vertices = np.arange(12.0).reshape(4, 3)
    faces = np.array([[0, 1, 2], [1, 2, 3]])
    corners, instance = triangle_soup(vertices, faces, np.array([1, 1, 1, 2]))
    np.testing.assert_array_equal(corners, vertices[[0, 1, 2, 1, 2, 3]])
    assert instance.tolist() == [1, 1, 1, 0, 0, 0]
