"""Pieces of an instance that lie apart: against the slow twin, and on scenes that can be seen."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st

from isr_jax.segmentation.outliers import largest_clusters
from isr_jax.types import Camera

from .reference import segmentation_reference as reference

CAMERA = Camera(100.0, 100.0, 50.0, 40.0, 100, 80)
"""Its samples are single pixels, 1 cm apart at 1 m."""
SHAPE = (80, 100)
DISTANCE_M = 0.05


@hypothesis_settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 10_000))
def test_clusters_equal_the_twin(seed):
    """Small blobs, few a place, so that instances fall into clusters, near and far in depth."""
    rng = np.random.default_rng(seed)
    piece, depth_m = np.zeros(SHAPE, np.int32), np.ones(SHAPE, np.float32)
    for k in range(1, 25):
        y, x = rng.integers(0, 76), rng.integers(0, 96)
        h, w = rng.integers(2, 9, 2)
        piece[y : y + h, x : x + w] = k
        depth_m[y : y + h, x : x + w] = 1 + 0.04 * rng.integers(0, 4)
    instance = np.append(0, rng.integers(0, 4, 24))
    found = largest_clusters(depth_m, CAMERA, piece, instance, DISTANCE_M)
    several = (instance > 0) & (np.bincount(instance)[instance] > 1)
    points, owner = cell_means(depth_m, np.where(several[piece], piece, 0))
    pixels = np.bincount(piece.ravel(), minlength=25)
    wanted = reference.largest_clusters(points, owner, pixels, instance, DISTANCE_M)
    assert np.array_equal(found, wanted)


def cell_means(depth_m, piece):
    """Mean point of every cell of half the distance that a piece occupies, and the piece."""
    points = reference.back_project(depth_m.astype(np.float64), CAMERA)[piece > 0]
    cells = np.floor(points / (DISTANCE_M / 2)).astype(int)
    keys = [(k, *cell) for k, cell in zip(piece[piece > 0].tolist(), cells.tolist(), strict=True)]
    members: dict[tuple, list[np.ndarray]] = {}
    for key, point in zip(keys, points, strict=True):
        members.setdefault(key, []).append(point)
    return np.array([np.mean(m, 0) for m in members.values()]), np.array([k[0] for k in members])


@pytest.mark.parametrize(("gap_px", "whole"), [(3, True), (12, False)])
def test_pieces_side_by_side_are_one_and_pieces_apart_are_not(gap_px, whole):
    piece = np.zeros(SHAPE, np.int32)
    piece[20:40, 10:40], piece[20:30, 40 + gap_px : 60 + gap_px] = 1, 2
    instance = np.array([0, 1, 1])
    kept = largest_clusters(np.ones(SHAPE, np.float32), CAMERA, piece, instance, DISTANCE_M)
    assert kept.tolist() == [True, True, whole]


def test_a_gap_that_another_piece_bridges_is_none():
    """The third piece is behind the other two in the image's order, and joins them."""
    piece = np.zeros(SHAPE, np.int32)
    piece[20:40, 10:30], piece[20:40, 60:70], piece[50:55, 10:70] = 1, 2, 3
    piece[40:50, 12:16], piece[40:50, 62:66] = 3, 3
    kept = largest_clusters(
        np.ones(SHAPE, np.float32), CAMERA, piece, np.array([0, 1, 1, 1]), DISTANCE_M
    )
    assert kept.all()


@pytest.mark.parametrize("instance", [[0, 0, 0], [0, 1, 2], [0, 1, 1]])
def test_pieces_that_are_not_seen_are_kept(instance):
    nothing = np.zeros(SHAPE, np.int32)
    kept = largest_clusters(
        nothing.astype(np.float32), CAMERA, nothing, np.array(instance), DISTANCE_M
    )
    assert kept.all()
