"""Sources of masks: files, the simulated segmenter, and what a user writes to get them."""

from __future__ import annotations

import itertools
import json

import cv2
import numpy as np
import pytest

from isr_jax.classes import class_named
from isr_jax.errors import FrameError, SegmenterError
from isr_jax.segmentation import (
    LEVELS,
    FileMasks,
    Segmenter,
    SimulatedSegmenter,
    open_segmenter,
)
from isr_jax.types import Camera, Frame, PanopticFrame

SHAPE = (240, 320)
CAMERA = Camera(290.0, 290.0, 160.0, 120.0, SHAPE[1], SHAPE[0])


def frame(number: int = 0, shape=SHAPE) -> Frame:
    color, depth = np.zeros((*shape, 3), np.uint8), np.ones(shape, np.float32)
    return Frame(number, f"{number:06d}", color, depth, np.eye(4), CAMERA)


def write_masks(folder, frames: dict[str, np.ndarray], classes_of: dict[int, int], categories):
    """Write id images as COCO panoptic PNG and JSON."""
    (folder / "panoptic").mkdir(parents=True, exist_ok=True)
    annotations = []
    for name, ids in frames.items():
        rgb = np.stack([ids % 256, ids // 256 % 256, ids // 65536], -1).astype(np.uint8)
        cv2.imwrite(str(folder / "panoptic" / f"{name}.png"), rgb[..., ::-1])
        present = [int(i) for i in np.unique(ids) if i in classes_of]
        infos = [{"id": i, "category_id": classes_of[i]} for i in present]
        annotations.append({"file_name": f"{name}.png", "image_id": name, "segments_info": infos})
    content = {"annotations": annotations, "categories": categories}
    (folder / "panoptic.json").write_text(json.dumps(content))


def room_ids(shift: int = 0) -> np.ndarray:
    """Floor, wall, a table and things of several sizes, one id with all three bytes."""
    ids = np.full(SHAPE, 1)
    ids[:120] = 2
    ids[110:200, 60 + shift : 200 + shift] = 70000
    boxes = [(20, 70, 30), (90, 90, 24), (130, 150, 18), (150, 100, 14), (60, 250, 60)]
    for k, (y, x, size) in enumerate(boxes):
        ids[y : y + size, x + shift : x + shift + size] = 300 + k
    return ids


NAMES = {1: "floor", 2: "wall", 70000: "table", 300: "cup", 301: "book", 302: "cup", 303: "bottle",
         304: "chair"}  # fmt: skip
OURS = [{"id": k, "name": n} for k, n in enumerate(sorted(set(NAMES.values())))]
CLASSES_OF = {i: next(c["id"] for c in OURS if c["name"] == n) for i, n in NAMES.items()}


@pytest.fixture
def masks_dir(tmp_path):
    write_masks(tmp_path, {"000000": room_ids()}, CLASSES_OF, OURS)
    return tmp_path


def test_files_round_trip(masks_dir):
    masks = FileMasks(masks_dir)
    assert isinstance(masks, Segmenter)
    panoptic, ids = masks.read(frame())
    assert np.array_equal(ids[panoptic.mask], room_ids())
    for row in range(1, len(ids)):
        assert panoptic.class_id[row] == class_named(NAMES[int(ids[row])]).id
    assert panoptic.score[0] == 0 and np.all(panoptic.score[1:] == 1)
    assert "1 frames" in masks.describe()


def test_coco_panoptic_ids(tmp_path):
    categories = [
        {"id": 62, "name": "chair"},
        {"id": 67, "name": "dining table"},
        {"id": 190, "name": "floor-other-merged"},
        {"id": 192, "name": "mountain-merged"},
    ]
    ids = np.zeros(SHAPE, int)
    ids[:50], ids[50:100], ids[100:150], ids[150:200] = 5, 6, 7, 8
    write_masks(tmp_path, {"000000": ids}, {5: 62, 6: 67, 7: 190, 8: 192}, categories)
    panoptic = FileMasks(tmp_path)(frame())
    seen = panoptic.class_id[panoptic.mask]
    expected = [class_named(n).id for n in ("chair", "table", "floor")] + [0, 0]
    assert [int(seen[y, 0]) for y in (20, 70, 120, 170, 220)] == expected
    assert panoptic.mask[170, 0] == 0, "a class that we do not have is no mask"


def test_the_hash_follows_the_contents(masks_dir):
    before = FileMasks(masks_dir).content_hash()
    assert before == FileMasks(masks_dir).content_hash()
    write_masks(masks_dir, {"000000": room_ids(1)}, CLASSES_OF, OURS)
    assert before != FileMasks(masks_dir).content_hash()


def test_frames_without_masks_are_frame_errors(masks_dir):
    masks = FileMasks(masks_dir)
    with pytest.raises(FrameError, match="000007"):
        masks(frame(7))
    with pytest.raises(FrameError, match="320x240"):
        masks(frame(0, (24, 32)))
    path = masks_dir / "panoptic" / "000000.png"
    path.write_bytes(path.read_bytes()[:40])
    with pytest.raises(FrameError, match=r"000000\.png"):
        masks(frame())


def test_bad_mask_files_say_what_is_wrong(tmp_path):
    with pytest.raises(SegmenterError, match="does not exist"):
        FileMasks(tmp_path)
    (tmp_path / "panoptic.json").write_text("{")
    with pytest.raises(SegmenterError, match="is not JSON"):
        FileMasks(tmp_path)
    (tmp_path / "panoptic.json").write_text("{}")
    with pytest.raises(SegmenterError, match="annotations and no categories"):
        FileMasks(tmp_path)
    write_masks(tmp_path, {}, {}, [{"id": 1, "name": "tabel"}])
    with pytest.raises(SegmenterError, match=r"tabel(.|\n)*table"):
        FileMasks(tmp_path)


class Truth:
    """True masks of a room that moves by a pixel in four frames; things pass the image's edge."""

    def read(self, frame: Frame) -> tuple[PanopticFrame, np.ndarray]:
        ids = np.roll(room_ids(), frame.index // 4, axis=1)
        values = np.array([0, *NAMES])
        mask = np.searchsorted(np.sort(values), ids)
        order = np.sort(values)
        class_id = [class_named(NAMES[int(i)]).id if i else 0 for i in order]
        score = np.ones(len(order), np.float32)
        return PanopticFrame(mask.astype(np.int32), np.array(class_id, np.int32), score), order

    def content_hash(self) -> str:
        return "truth"


LAYOUT = [class_named("floor").id, class_named("wall").id]


def measure(level: str, frames: int) -> dict[str, float]:
    """The rates that masks of ``level`` have against the truth."""
    segmenter, truth = SimulatedSegmenter(Truth(), level), Truth()
    hits = right = things = false = 0
    ious, kept, layout = [], 0, 0
    for k in range(frames):
        true, _ = truth.read(frame(k))
        found = segmenter(frame(k))
        pairs = np.zeros((len(true.class_id), len(found.class_id)))
        np.add.at(pairs, (true.mask.ravel(), found.mask.ravel()), 1)
        union = pairs.sum(1, keepdims=True) + pairs.sum(0, keepdims=True) - pairs
        iou = pairs / np.maximum(union, 1)
        rows = [r for r in range(1, len(true.class_id)) if true.class_id[r] not in LAYOUT]
        columns = [c for c in range(1, len(found.class_id)) if found.class_id[c] not in LAYOUT]
        iou = iou[np.ix_(rows, columns)]
        things += len(rows)
        for i, row in enumerate(rows):
            if iou.shape[1] and iou[i].max() > 0.5:
                hits += 1
                ious.append(iou[i].max())
                right += found.class_id[columns[int(iou[i].argmax())]] == true.class_id[row]
        false += np.count_nonzero(iou.max(0, initial=0) <= 0.5)
        is_layout = np.isin(true.class_id[true.mask], LAYOUT)
        layout += np.count_nonzero(is_layout)
        same = found.class_id[found.mask] == true.class_id[true.mask]
        kept += np.count_nonzero(is_layout & same)
    return {
        "recall": hits / things,
        "right_class": right / hits,
        "mean_iou": float(np.mean(ious)),
        "false_masks": false / frames,
        "layout_recall": kept / layout,
    }


@pytest.mark.parametrize("level", ["strong", "medium", "weak"])
def test_simulated_masks_have_the_stated_rates(level):
    stated = SimulatedSegmenter(Truth(), level).rates()
    found = measure(level, 90)
    # 540 things in 90 frames, of which about 540 / 10 are independent in time.
    assert found["recall"] == pytest.approx(stated.recall, abs=0.08)
    assert found["right_class"] == pytest.approx(stated.right_class, abs=0.12)
    assert found["mean_iou"] == pytest.approx(stated.mean_iou, abs=0.03)
    assert found["false_masks"] == pytest.approx(stated.false_masks, abs=0.2)
    assert found["layout_recall"] == pytest.approx(stated.layout_recall, abs=0.03)


def seen_ids(panoptic: PanopticFrame, k: int) -> set[int]:
    """True things that a mask of IoU > 0.5 covers."""
    true, ids = Truth().read(frame(k))
    found = set()
    for row in range(1, len(ids)):
        pixels = true.mask == row
        for other in np.unique(panoptic.mask[pixels]):
            both = np.count_nonzero(pixels & (panoptic.mask == other))
            union = np.count_nonzero(pixels | (panoptic.mask == other))
            if other and both > 0.5 * union and true.class_id[row] not in LAYOUT:
                found.add(int(ids[row]))
    return found


def test_misses_last_and_small_things_fall_first():
    segmenter = SimulatedSegmenter(Truth(), "medium", seed=2)
    seen = [seen_ids(segmenter(frame(k)), k) for k in range(80)]
    changes = np.mean([len(a ^ b) / 6 for a, b in itertools.pairwise(seen)])
    assert changes < 0.15  # independent frames at recall 0.5 would give up to 0.5
    assert changes > 0
    share = {i: np.mean([i in s for s in seen]) for i in (70000, 303)}
    assert share[70000] > share[303] + 0.2


def test_simulated_masks_are_repeatable_and_rows_change():
    a, b = (SimulatedSegmenter(Truth(), "strong", seed=5)(frame(3)) for _ in range(2))
    assert np.array_equal(a.mask, b.mask) and np.array_equal(a.class_id, b.class_id)
    other = SimulatedSegmenter(Truth(), "strong", seed=6)
    assert not np.array_equal(a.mask, other(frame(3)).mask)
    perfect = SimulatedSegmenter(Truth(), "perfect")
    rows = {int(np.flatnonzero(perfect(frame(k)).class_id == LAYOUT[0])[0]) for k in range(8)}
    assert len(rows) > 1
    assert perfect.rates() is None


def test_perfect_masks_are_the_truth():
    true, _ = Truth().read(frame(9))
    found = SimulatedSegmenter(Truth(), "perfect")(frame(9))
    assert np.array_equal(found.class_id[found.mask], true.class_id[true.mask])
    pairs = np.unique(np.stack([true.mask.ravel(), found.mask.ravel()]), axis=1)
    assert pairs.shape[1] == len(np.unique(true.mask)), "one to one"


def test_simulated_hash_names_level_and_seed():
    hashes = {SimulatedSegmenter(Truth(), level).content_hash() for level in LEVELS}
    hashes.add(SimulatedSegmenter(Truth(), "weak", seed=1).content_hash())
    assert len(hashes) == len(LEVELS) + 1
    assert "75%" in SimulatedSegmenter(Truth(), "strong").describe()


def test_open_segmenter(masks_dir, tmp_path_factory):
    empty = tmp_path_factory.mktemp("empty")
    assert open_segmenter("", masks_dir).name.startswith("masks:")
    assert open_segmenter(f"masks:{masks_dir}", empty).name == f"masks:{masks_dir.name}"
    assert open_segmenter(str(masks_dir), empty).name == f"masks:{masks_dir.name}"
    assert open_segmenter("simulated", masks_dir).name == "simulated:strong"
    assert open_segmenter("simulated:weak", masks_dir).name == "simulated:weak"
    assert open_segmenter("simulated:perfect", masks_dir)(frame()).mask.any()


@pytest.mark.parametrize(
    ("spec", "says"),
    [
        ("", "no masks of its own"),
        ("detectron", "unknown segmenter"),
        ("simulated", r"panoptic\.json"),
        ("nothing/here.onnx", "does not exist"),
    ],
)
def test_what_cannot_be_opened_names_the_way_out(tmp_path, spec, says):
    with pytest.raises(SegmenterError, match=says) as error:
        open_segmenter(spec, tmp_path)
    assert error.value.hint


def test_an_unknown_level_lists_the_levels(masks_dir):
    with pytest.raises(SegmenterError, match="perfect, strong, medium, weak"):
        open_segmenter("simulated:superb", masks_dir)
