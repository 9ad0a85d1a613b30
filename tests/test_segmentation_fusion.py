"""Fusion of masks and depth segments."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from hypothesis import given
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st

from isr_jax.classes import class_named, classes
from isr_jax.config import SegmentationSettings
from isr_jax.segmentation import label_segments, segment_frame
from isr_jax.types import Camera, Frame, PanopticFrame

from .reference import segmentation_reference as reference

CAMERA = Camera(100.0, 100.0, 50.0, 40.0, 100, 80)
SETTINGS = dataclasses.replace(SegmentationSettings(), min_segment_px=100, min_piece_px=20)
KIND = {info.id: info.kind for info in classes()}


def frame_of(depth_m: np.ndarray, camera: Camera = CAMERA) -> Frame:
    color = np.zeros((*depth_m.shape, 3), np.uint8)
    return Frame(0, "000000", color, depth_m.astype(np.float32), np.eye(4), camera)


def ids(*names: str) -> np.ndarray:
    return np.array([0, *(class_named(n).id for n in names)], np.int32)


def blank() -> np.ndarray:
    return np.zeros((80, 100), np.int32)


FLAT = np.full((80, 100), 1.0)


def at(result, y: int, x: int) -> tuple[str, int]:
    row = result.segment[y, x]
    return classes()[result.class_id[row]].name, int(result.instance[row])


def test_a_ragged_mask_takes_the_shape_of_its_segment():
    segment, mask = blank() + 1, blank()
    segment[20:60, 30:70] = 2
    mask[22:58, 34:75] = 1  # misses a part, spills over another
    result = label_segments(frame_of(FLAT), segment, mask, ids("chair"), SETTINGS)
    assert np.array_equal(result.segment == result.segment[40, 50], segment == 2)
    assert at(result, 40, 50) == ("chair", 1)
    assert at(result, 5, 5) == ("none", 0)


def test_a_cup_flush_with_the_table_is_cut_out():
    segment, mask = blank() + 1, blank() + 1
    mask[30:40, 40:50] = 2
    result = label_segments(frame_of(FLAT), segment, mask, ids("table", "cup"), SETTINGS)
    assert at(result, 35, 45) == ("cup", 2)
    assert at(result, 10, 10) == ("table", 1)


def test_a_window_flush_with_the_wall_is_cut_out():
    """A tenth of the wall's segment: too little to split it, but the window lies there whole."""
    segment, mask = blank() + 1, blank() + 1
    mask[30:50, 40:70] = 2
    result = label_segments(frame_of(FLAT), segment, mask, ids("wall", "window"), SETTINGS)
    assert at(result, 40, 50) == ("window", 2)
    assert at(result, 10, 10) == ("wall", 1)
    papers = dataclasses.replace(SETTINGS, cut_out_stuff=False)
    result = label_segments(frame_of(FLAT), segment, mask, ids("wall", "window"), papers)
    assert at(result, 40, 50) == ("wall", 1), "the paper cuts out instances of things alone"


def test_one_segment_over_two_monitors_is_divided():
    segment, mask = blank(), blank()
    segment[20:60, 10:90] = 1
    mask[22:60, 12:50], mask[22:60, 52:90] = 1, 2
    result = label_segments(frame_of(FLAT), segment, mask, ids("monitor", "monitor"), SETTINGS)
    assert at(result, 40, 30) == ("monitor", 1)
    assert at(result, 40, 70) == ("monitor", 2)


def test_the_baseline_only_labels_segments():
    segment, mask = blank() + 1, blank() + 1
    mask[30:40, 40:50] = 2
    settings = dataclasses.replace(SETTINGS, bilateral=False, remove_outliers=False)
    result = label_segments(frame_of(FLAT), segment, mask, ids("table", "cup"), settings)
    assert len(result.class_id) == 2
    assert at(result, 35, 45) == ("table", 1)


def test_a_mask_that_spills_over_the_floor_leaves_it_alone():
    segment, mask = blank() + 1, blank()
    segment[10:50, 30:60] = 2
    mask[10:70, 25:65] = 1  # the chair, and 1500 px of the floor's 6800
    result = label_segments(frame_of(FLAT), segment, mask, ids("chair"), SETTINGS)
    assert at(result, 30, 45) == ("chair", 1)
    assert at(result, 65, 30) == ("none", 0)


def test_a_far_piece_of_a_thing_goes_to_the_background():
    depth = FLAT.copy()
    depth[:, 60:] = 2.0
    segment = blank() + 1
    segment[:, 60:] = 2
    mask = blank() + 1
    result = label_segments(frame_of(depth), segment, mask, ids("chair"), SETTINGS)
    assert at(result, 40, 30) == ("chair", 1)
    assert at(result, 40, 80) == ("none", 0)
    assert result.segment[40, 80] > 0, "the surface is still a segment"


def test_layout_may_lie_apart():
    depth = FLAT.copy()
    depth[:, 60:] = 2.0
    segment = blank() + 1
    segment[:, 60:] = 2
    result = label_segments(frame_of(depth), segment, blank() + 1, ids("wall"), SETTINGS)
    assert at(result, 40, 30) == at(result, 40, 80) == ("wall", 1)
    assert result.segment[40, 30] != result.segment[40, 80]


def test_near_pieces_stay_together():
    depth = FLAT.copy()
    depth[:, 60:] = 1.03
    segment = blank() + 1
    segment[:, 60:] = 2
    result = label_segments(frame_of(depth), segment, blank() + 1, ids("chair"), SETTINGS)
    assert at(result, 40, 30) == at(result, 40, 80) == ("chair", 1)


def test_people_keep_all_their_pixels_and_their_class():
    segment, mask = blank() + 1, blank()
    mask[30:34, 40:44] = 1
    result = label_segments(frame_of(FLAT), segment, mask, ids("person"), SETTINGS)
    assert at(result, 32, 42) == ("person", 1)
    assert np.count_nonzero(result.segment == result.segment[32, 42]) == 16


def test_specks_are_dropped_unless_a_mask_holds_them():
    segment, mask = blank(), blank()
    segment[10:14, 10:20], segment[30:34, 30:40], segment[50:54, 30:40] = 1, 2, 3
    mask[28:60, 28:42] = 1
    result = label_segments(frame_of(FLAT), segment, mask, ids("plant"), SETTINGS)
    assert result.segment[12, 15] == 0
    assert at(result, 32, 35) == ("plant", 1)
    assert result.segment[32, 35] == result.segment[52, 35] or at(result, 52, 35)[0] == "none"


def test_what_no_segment_holds_follows_its_mask():
    """The rim of a table, lost at the edge of depth."""
    segment, mask = blank() + 1, blank() + 1
    segment[:, 80:] = 0
    mask[:40, 90:] = 0
    result = label_segments(frame_of(FLAT), segment, mask, ids("table"), SETTINGS)
    assert at(result, 10, 85) == at(result, 60, 95) == at(result, 40, 30) == ("table", 1)
    assert result.segment[10, 95] == 0, "no mask, no segment"
    bare = dataclasses.replace(SETTINGS, fill_from_masks=False)
    result = label_segments(frame_of(FLAT), segment, mask, ids("table"), bare)
    assert result.segment[10, 85] == 0 and at(result, 40, 30) == ("table", 1)


def test_low_scores_are_ignored():
    mask = blank() + 1
    panoptic = PanopticFrame(mask, ids("table"), np.array([0.0, 0.3], np.float32))
    result = segment_frame(frame_of(FLAT), panoptic, SETTINGS)
    assert at(result, 40, 50) == ("none", 0)
    panoptic = dataclasses.replace(panoptic, score=np.array([0.0, 0.9], np.float32))
    assert at(segment_frame(frame_of(FLAT), panoptic, SETTINGS), 40, 50) == ("table", 1)


def test_no_mask_and_no_depth():
    panoptic = PanopticFrame(blank(), np.zeros(1, np.int32), np.zeros(1, np.float32))
    result = segment_frame(frame_of(FLAT), panoptic, SETTINGS)
    assert result.class_id.tolist() == [0, 0]
    result = segment_frame(frame_of(0 * FLAT), panoptic, SETTINGS)
    assert not result.segment.any()
    assert result.instance.tolist() == [0]


NAMES = ("table", "chair", "cup", "wall", "floor", "person")


@hypothesis_settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 10_000))
def test_fusion_equals_the_twin(seed):
    """Random blobs: every pixel takes the class and instance that the slow rules give it."""
    rng = np.random.default_rng(seed)
    segment, mask = blank(), blank()
    for image, count in ((segment, 8), (mask, 6)):
        for k in range(1, count + 1):
            y, x = rng.integers(0, 70), rng.integers(0, 90)
            h, w = rng.integers(5, 50, 2)
            image[y : y + h, x : x + w] = k
    segment = np.unique(segment, return_inverse=True)[1].reshape(segment.shape).astype(np.int32)
    class_id = ids(*rng.choice(NAMES, 6))
    kinds = np.array([KIND[int(c)] for c in class_id])
    loose = dataclasses.replace(SETTINGS, cluster_distance_m=10.0)
    result = label_segments(frame_of(FLAT), segment, mask, class_id, loose)
    wanted = reference.piece_labels(segment, mask, kinds, 100, loose)
    assert np.array_equal(result.segment > 0, wanted >= 0)
    assert np.array_equal(result.instance[result.segment], np.maximum(wanted, 0))
    assert np.array_equal(result.class_id[result.segment], class_id[np.maximum(wanted, 0)])
    rows = np.unique(result.segment)
    assert set(rows) | {0} == set(range(len(result.class_id))), "no empty segment"


def test_order_of_masks_does_not_matter():
    rng = np.random.default_rng(3)
    segment = np.kron(rng.integers(0, 6, (8, 10)), np.ones((10, 10), int)).astype(np.int32)
    mask = np.kron(rng.integers(0, 4, (10, 10)), np.ones((8, 10), int)).astype(np.int32)
    class_id = ids("table", "chair", "wall")
    order = np.array([0, 3, 1, 2])
    permuted_class = np.zeros(4, np.int32)
    permuted_class[order] = class_id
    a = label_segments(frame_of(FLAT), segment, mask, class_id, SETTINGS)
    b = label_segments(
        frame_of(FLAT), segment, order[mask].astype(np.int32), permuted_class, SETTINGS
    )
    assert np.array_equal(a.class_id[a.segment], b.class_id[b.segment])
    assert np.array_equal(order[a.instance[a.segment]], b.instance[b.segment])


@pytest.mark.parametrize("bilateral", [True, False])
def test_types(bilateral):
    segment, mask = blank() + 1, blank() + 1
    settings = dataclasses.replace(SETTINGS, bilateral=bilateral)
    result = label_segments(frame_of(FLAT), segment, mask, ids("table"), settings)
    assert result.segment.dtype == result.class_id.dtype == result.instance.dtype == np.int32
    assert result.class_id[0] == result.instance[0] == 0
