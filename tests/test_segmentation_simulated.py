"""The simulated segmenter: its errors have the stated rates, and fall where they should."""

from __future__ import annotations

import functools
import json

import numpy as np
import pytest

from isr_jax.classes import class_named, classes
from isr_jax.errors import SegmenterError
from isr_jax.segmentation import (
    LEVELS,
    SimulatedSegmenter,
    TrueViews,
    measured_rates,
    open_segmenter,
    read_true_views,
)
from isr_jax.types import PanopticFrame

from .crowded_masks import INDEPENDENT, SHAPE, CrowdedTruth, frame

LAYOUT = [class_named("floor").id, class_named("wall").id]
NOISY = [level for level, rates in LEVELS.items() if rates]


def masks_of(*things, size=SHAPE) -> PanopticFrame:
    """A wall, and before it things given as (class, y, x, height, width); row k + 1 is thing k."""
    mask = np.zeros(size, np.int32)
    for row, (_, y, x, height, width) in enumerate(things, 1):
        mask[y : y + height, x : x + width] = row
    names = ["none", *(thing[0] for thing in things)]
    ids = np.array([class_named(name).id for name in names], np.int32)
    return PanopticFrame(mask, ids, np.ones(len(ids), np.float32))


class Fixed:
    """One true image in every frame, and other masks that a segmenter gives for it."""

    def __init__(self, true: PanopticFrame, found: PanopticFrame | None = None):
        self.true, self.found = true, found

    def read(self, frame):
        return self.true, np.arange(len(self.true.class_id)) * 7

    def __call__(self, frame):
        return self.found

    def content_hash(self) -> str:
        return "fixed"

    name = "fixed"

    def describe(self) -> str:
        return "fixed"


@functools.cache
def crowd(level: str):
    truth = CrowdedTruth()
    frames = [frame(INDEPENDENT * k) for k in range(100)]
    return measured_rates(SimulatedSegmenter(truth, level), truth, frames)


@pytest.mark.parametrize("level", NOISY)
def test_the_stated_rates_come_out(level):
    stated, found = SimulatedSegmenter(CrowdedTruth(), level).rates(), crowd(level)
    # 1350 independent things: two standard deviations are 0.03 of the things and up to 0.06 of the
    # hits; of 0.4 false masks a frame in 100 frames, 0.13.
    assert found.things > 1300
    assert found.recall == pytest.approx(stated.recall, abs=0.03)
    assert found.right_class == pytest.approx(stated.right_class, abs=0.06)
    assert found.mean_iou == pytest.approx(stated.mean_iou, abs=0.015)
    assert found.false_masks == pytest.approx(stated.false_masks, abs=0.13)
    if not stated.class_recall:
        assert found.layout_recall == pytest.approx(stated.layout_recall, abs=0.02)


def test_single_classes_have_their_own_recall_of_pixels():
    stated = dict(LEVELS["weak"].class_recall)
    found = dict(crowd("weak").class_recall)
    assert found["wall"] == pytest.approx(stated["wall"], abs=0.01)
    assert found["floor"] == pytest.approx(stated["floor"], abs=0.01)
    # About 130 tables and 260 chairs, of which a few large ones count most.
    assert found["chair"] == pytest.approx(stated["chair"], abs=0.1)
    assert found["table"] == pytest.approx(stated["table"], abs=0.1)


@pytest.mark.parametrize("level", NOISY)
def test_some_touching_things_share_a_mask_and_some_masks_fall_in_two(level):
    assert 0.05 < crowd(level).merges < 0.6
    assert 0.02 < crowd(level).splits < 0.4
    perfect = crowd("perfect")
    assert perfect.merges == perfect.splits == 0


def test_a_perfect_segmenter_measures_as_perfect():
    found = crowd("perfect")
    assert (found.recall, found.right_class, found.mean_iou, found.false_masks) == (1, 1, 1, 0)
    assert found.layout_recall == 1 and set(dict(found.class_recall).values()) == {1.0}


def test_rates_by_hand():
    # A chair of 20x20 gets a mask shifted by 4: shared 16*20 = 320, union 480, IoU 2/3, a hit with
    # the wrong class. Two boxes of 20x20 side by side get one mask of 800: IoU 1/2 with each, both
    # missed, a merge and a false mask. A table of 20x40 falls in 20x30 (IoU 3/4, a hit, right) and
    # 20x10 (false). The cup of 9x11 < 100 pixels is not asked for.
    true = masks_of(
        ("chair", 0, 0, 20, 20),
        ("box", 40, 0, 20, 20),
        ("box", 40, 20, 20, 20),
        ("table", 80, 0, 20, 40),
        ("cup", 120, 0, 9, 11),
    )
    found = masks_of(
        ("stool", 0, 4, 20, 20),
        ("box", 40, 0, 20, 40),
        ("table", 80, 0, 20, 30),
        ("table", 80, 30, 20, 10),
    )
    rates = measured_rates(Fixed(true, found), Fixed(true), [frame(0), frame(1)])
    assert (rates.frames, rates.things, rates.hits) == (2, 8, 4)
    assert (rates.recall, rates.right_class) == (0.5, 0.5)
    assert rates.mean_iou == pytest.approx((2 / 3 + 3 / 4) / 2)
    assert (rates.false_masks, rates.merges, rates.splits) == (2.0, 1.0, 1.0)
    assert rates.layout_recall is None
    assert dict(rates.class_recall) == {"chair": 0, "box": 1, "table": 1, "cup": 0}


def test_rates_of_nothing_are_none():
    empty = masks_of()
    rates = measured_rates(Fixed(empty, empty), Fixed(empty), [frame(0)])
    assert rates.recall is rates.right_class is rates.mean_iou is None
    assert rates.false_masks == 0
    assert measured_rates(Fixed(empty, empty), Fixed(empty), []).false_masks is None


def hit_shares(truth, level="medium", frames=120, **options) -> np.ndarray:
    """Share of independent frames in which each thing is found."""
    segmenter = SimulatedSegmenter(truth, level, **options)
    true, _ = truth.read(frame(0))
    hits = np.zeros(len(true.class_id) - 1)
    for k in range(frames):
        found = segmenter(frame(INDEPENDENT * k))
        pairs = np.zeros((len(true.class_id), len(found.class_id)))
        np.add.at(pairs, (true.mask.ravel(), found.mask.ravel()), 1)
        union = pairs.sum(1, keepdims=True) + pairs.sum(0, keepdims=True) - pairs
        hits += (pairs / np.maximum(union, 1))[1:, 1:].max(1, initial=0) > 0.5
    return hits / frames


def test_misses_fall_on_small_and_cut_things_first():
    # A large thing, a like one cut by the border, a small one: all apart from each other.
    room = Fixed(
        masks_of(("plant", 60, 60, 60, 60), ("cup", 60, 260, 60, 60), ("book", 180, 120, 20, 20))
    )
    large, cut, small = hit_shares(room)
    # By rank 5/6, 3/6, 1/6: 0.5 + 0.45 * (2 rank - 1) = 0.8, 0.5, 0.2; two deviations are 0.09.
    assert (large, cut, small) == pytest.approx((0.8, 0.5, 0.2), abs=0.1)


def test_misses_fall_on_occluded_things_where_views_tell():
    room = Fixed(masks_of(("plant", 60, 30, 50, 50), ("cup", 60, 200, 50, 50)))
    name = {f"{INDEPENDENT * k:06d}": {7: 0.3, 14: 1.0} for k in range(120)}
    occluded, whole = hit_shares(room, views=TrueViews(name, "views"))
    # By rank 1/4 and 3/4: 0.5 -+ 0.225.
    assert (occluded, whole) == pytest.approx((0.275, 0.725), abs=0.1)


def seen_ids(panoptic: PanopticFrame, k: int) -> set[int]:
    """True things that a mask of IoU > 0.5 covers."""
    true, ids = CrowdedTruth().read(frame(k))
    found = set()
    for row in range(1, len(ids)):
        pixels = true.mask == row
        for other in np.unique(panoptic.mask[pixels]):
            both = np.count_nonzero(pixels & (panoptic.mask == other))
            union = np.count_nonzero(pixels | (panoptic.mask == other))
            if other and both > 0.5 * union and true.class_id[row] not in LAYOUT:
                found.add(int(ids[row]))
    return found


def test_misses_last_over_neighbouring_frames():
    segmenter = SimulatedSegmenter(CrowdedTruth(), "medium", seed=2)
    # The true image stays for 4 frames. Independent ones at recall 0.5 would change 0.5 of it.
    pairs = [(k, k + 1) for k in range(0, 80, 4)]
    seen = [[seen_ids(segmenter(frame(k)), k) for k in pair] for pair in pairs]
    changes = np.sum([len(a ^ b) for a, b in seen])
    things = sum(np.count_nonzero(~np.isin(truth_classes(k), LAYOUT)) for k, _ in pairs)
    assert 0 < changes / things < 0.12


def truth_classes(k: int) -> np.ndarray:
    return CrowdedTruth().read(frame(k))[0].class_id[1:]


def test_masks_are_disjoint_repeatable_and_change_rows():
    a, b = (SimulatedSegmenter(CrowdedTruth(), "strong", seed=5)(frame(3)) for _ in range(2))
    assert np.array_equal(a.mask, b.mask) and np.array_equal(a.class_id, b.class_id)
    other = SimulatedSegmenter(CrowdedTruth(), "strong", seed=6)
    assert not np.array_equal(a.mask, other(frame(3)).mask)
    perfect = SimulatedSegmenter(CrowdedTruth(), "perfect")
    rows = {int(np.flatnonzero(perfect(frame(k)).class_id == LAYOUT[0])[0]) for k in range(8)}
    assert len(rows) > 1 and perfect.rates() is None


def test_a_merged_mask_has_one_class_and_a_split_one_too():
    kinds = {info.id for info in classes() if info.kind == "thing"}
    truth, merged, split = CrowdedTruth(), 0, 0
    for k in range(60):
        true, _ = truth.read(frame(INDEPENDENT * k))
        found = SimulatedSegmenter(truth, "medium")(frame(INDEPENDENT * k))
        for row in np.flatnonzero(np.isin(found.class_id, list(kinds))):
            under = np.unique(true.mask[found.mask == row], return_counts=True)
            under = [int(r) for r, n in zip(*under) if n > 0.8 * np.count_nonzero(true.mask == r)]
            under = [r for r in under if true.class_id[r] not in LAYOUT]
            merged += len(under) > 1
            assert len({int(true.class_id[r]) for r in under}) <= 1, "unlike things are not merged"
        for row in range(1, len(true.class_id)):
            inside, count = np.unique(found.mask[true.mask == row], return_counts=True)
            pieces = [i for i, n in zip(inside, count) if i and n > 0.1 * count.sum()]
            pieces = [i for i in pieces if found.class_id[i] not in LAYOUT]
            whole = [np.count_nonzero(found.mask == i) for i in pieces]
            if len(pieces) == 2 and sum(whole) < 1.2 * count.sum():
                split += len({int(found.class_id[i]) for i in pieces}) == 1
    assert merged > 0 and split > 0


def test_perfect_masks_are_the_truth():
    true, _ = CrowdedTruth().read(frame(9))
    found = SimulatedSegmenter(CrowdedTruth(), "perfect")(frame(9))
    assert np.array_equal(found.class_id[found.mask], true.class_id[true.mask])
    pairs = np.unique(np.stack([true.mask.ravel(), found.mask.ravel()]), axis=1)
    assert pairs.shape[1] == len(np.unique(true.mask)), "one to one"


def test_the_hash_names_level_seed_and_views():
    truth = CrowdedTruth()
    hashes = {SimulatedSegmenter(truth, level).content_hash() for level in LEVELS}
    hashes.add(SimulatedSegmenter(truth, "weak", seed=1).content_hash())
    hashes.add(SimulatedSegmenter(truth, "weak", views=TrueViews({}, "a")).content_hash())
    hashes.add(SimulatedSegmenter(truth, "weak", views=TrueViews({}, "b")).content_hash())
    assert len(hashes) == len(LEVELS) + 3


def test_the_description_says_the_rates_and_what_is_not_known():
    text = SimulatedSegmenter(CrowdedTruth(), "weak").describe()
    for part in ("20%", "50%", "0.78", "0.4 false", "wall 83%", "occlusion is not known"):
        assert part in text
    known = SimulatedSegmenter(CrowdedTruth(), "weak", views=TrueViews({}, "v")).describe()
    assert "occluded" in known and "not known" not in known


@pytest.mark.parametrize("level", LEVELS)
@pytest.mark.parametrize(
    "things",
    [
        (),
        (("chair", 0, 0, 9, 9),),
        (("chair", 0, 0, *SHAPE),),
        (("floor", 5, 5, 1, 1),),  # one pixel of layout, of which 0.9 is none
    ],
)
def test_empty_and_full_images_are_images_too(level, things):
    for k in range(10):
        found = SimulatedSegmenter(Fixed(masks_of(*things)), level)(frame(INDEPENDENT * k))
        assert found.mask.shape == SHAPE and found.mask.max() < len(found.class_id)
        assert len(found.class_id) == len(found.score)


def test_an_unknown_level_lists_the_levels():
    with pytest.raises(SegmenterError, match="perfect, strong, medium, weak"):
        SimulatedSegmenter(CrowdedTruth(), "superb")


def views_file(folder, text):
    (folder / "truth").mkdir()
    (folder / "truth/views.json").write_text(text)
    return folder / "truth/views.json"


def test_views_of_a_film_are_read(tmp_path):
    assert read_true_views(tmp_path / "views.json") is None
    entities = {"3": {"visible_px": 30, "unoccluded_px": 120, "cut": False}}
    path = views_file(tmp_path, json.dumps({"frames": {"000001": entities}}))
    views = read_true_views(path)
    assert views.visible_shares("000001") == {3: 0.25}
    assert views.visible_shares("000002") == {}
    (tmp_path / "panoptic.json").write_text('{"annotations": [], "categories": []}')
    segmenter = open_segmenter("simulated:weak", tmp_path)
    assert "cut and occluded" in segmenter.describe()
    before = segmenter.content_hash()
    path.write_text(json.dumps({"frames": {}}))
    assert open_segmenter("simulated:weak", tmp_path).content_hash() != before


@pytest.mark.parametrize(
    "text",
    ["", "[]", "{}", '{"frames": 3}', '{"frames": {"a": {"x": {}}}}', '{"frames": {"a": []}}'],
)
def test_a_file_of_views_that_is_none_is_refused(tmp_path, text):
    path = views_file(tmp_path, text)
    with pytest.raises(SegmenterError, match=r"views\.json is not of the format"):
        read_true_views(path)
