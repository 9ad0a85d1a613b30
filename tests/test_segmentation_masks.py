"""Masks from files, and what a user writes to get a source of masks."""

from __future__ import annotations

import json

import cv2
import numpy as np
import pytest

from isr_jax.classes import class_named, classes
from isr_jax.errors import FrameError, SegmenterError
from isr_jax.segmentation import FileMasks, Segmenter, open_segmenter

from .crowded_masks import SHAPE, frame


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


NAMES = {
    1: "floor",
    2: "wall",
    70000: "table",
    300: "cup",
    301: "book",
    302: "cup",
    303: "bottle",
    304: "chair",
}
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


def official(folder, ids: np.ndarray, segments: list[dict], categories: list[dict]):
    """As the COCO API writes it: the PNG folder has the JSON's name, images are listed."""
    (folder / "panoptic_val2017").mkdir()
    rgb = np.stack([ids % 256, ids // 256 % 256, ids // 65536], -1).astype(np.uint8)
    cv2.imwrite(str(folder / "panoptic_val2017" / "0139.png"), rgb[..., ::-1])
    full = [{"area": 1, "bbox": [0, 0, 1, 1], "iscrowd": 0, **s} for s in segments]
    content = {
        "info": {},
        "licenses": [],
        "images": [{"id": 139, "file_name": "000000.jpg", "height": SHAPE[0], "width": SHAPE[1]}],
        "annotations": [{"image_id": 139, "file_name": "0139.png", "segments_info": full}],
        "categories": categories,
    }
    path = folder / "panoptic_val2017.json"
    path.write_text(json.dumps(content))
    return path


COCO = [
    {"id": 62, "name": "chair", "isthing": 1, "supercategory": "furniture"},
    {"id": 188, "name": "cabinet-merged", "isthing": 0, "supercategory": "furniture-stuff"},
    {"id": 190, "name": "floor-other-merged", "isthing": 0, "supercategory": "floor"},
]


def test_the_official_format(tmp_path):
    """Cabinets are stuff to COCO: two in one segment are two; a crowd of chairs is no chair."""
    ids = np.full(SHAPE, 3226756)
    ids[:40, :60] = ids[:40, 100:160] = 8921
    ids[60:100, :40] = 1_000_000
    ids[60:100, 60:100] = 17
    ids[-1] = 0
    segments = [
        {"id": 3226756, "category_id": 190},
        {"id": 8921, "category_id": 188},
        {"id": 1_000_000, "category_id": 62},
        {"id": 17, "category_id": 62, "iscrowd": 1},
    ]
    path = official(tmp_path, ids, segments, COCO)
    for spec in (f"masks:{path}", f"masks:{tmp_path}"):
        panoptic, source = open_segmenter(spec, tmp_path).read(frame())
        names = np.array([classes()[c].name for c in panoptic.class_id])[panoptic.mask]
        assert [names[y, x] for y, x in ((200, 5), (5, 5), (5, 120), (80, 5), (80, 80))] == [
            "floor",
            "cabinet",
            "cabinet",
            "chair",
            "none",
        ]
        assert panoptic.mask[5, 5] != panoptic.mask[5, 120], "two cabinets"
        assert source[panoptic.mask[5, 5]] == source[panoptic.mask[5, 120]] == 8921
        assert not panoptic.mask[-1].any(), "0 is nothing"


def test_a_mask_and_its_annotation_belong_together(tmp_path):
    ids = np.full(SHAPE, 7)
    ids[0, 0] = 300
    path = official(tmp_path, ids, [{"id": 7, "category_id": 62}], COCO)
    with pytest.raises(FrameError, match=r"0139\.png has a segment 300"):
        FileMasks(path)(frame())
    cv2.imwrite(str(tmp_path / "panoptic_val2017" / "0139.png"), ids.astype(np.uint8))
    with pytest.raises(FrameError, match="no RGB image"):
        FileMasks(path)(frame())


def test_two_annotations_of_an_image_and_two_files(tmp_path):
    path = official(tmp_path, np.full(SHAPE, 7), [{"id": 7, "category_id": 62}], COCO)
    content = json.loads(path.read_text())
    (tmp_path / "panoptic_train2017.json").write_text(json.dumps(content))
    with pytest.raises(SegmenterError, match=r"2 files of masks(.|\n)*panoptic_train2017"):
        FileMasks(tmp_path)
    content["annotations"] *= 2
    path.write_text(json.dumps(content))
    with pytest.raises(SegmenterError, match="two annotations for image '000000'"):
        FileMasks(path)


def test_coco_and_our_own_names_mix(tmp_path):
    """An id alone says nothing: 62 is a chair only under COCO's name."""
    ids = np.full(SHAPE, 1)
    ids[:100] = 2
    categories = [{"id": 62, "name": "kettle"}, {"id": 67, "name": "dining table"}]
    write_masks(tmp_path, {"000000": ids}, {1: 62, 2: 67}, categories)
    panoptic = FileMasks(tmp_path)(frame())
    names = [classes()[c].name for c in panoptic.class_id]
    assert sorted(names) == ["kettle", "none", "table"]


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
