"""Panoptic masks from class and mask logits of queries (DETR, Mask2Former, OneFormer)."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from isr_jax.classes import classes
from isr_jax.classes.label_lists import label_list
from isr_jax.config import SegmentationSettings
from isr_jax.errors import SegmenterError
from isr_jax.segmentation import BatchSegmenter, OnnxModel, PanopticModel, open_segmenter
from isr_jax.segmentation.mask_queries import decode_queries

from .reference import segmenter_reference
from .test_segmentation_onnx import semantics_model
from .tiny_models import HEIGHT, INPUT, WIDTH, blind_model, frame

SETTINGS = dataclasses.replace(SegmentationSettings(), onnx_threads=1)
SIDECAR = f"""
kind = "panoptic"
decoder = "queries"
label_set = "coco_panoptic"
label_order = "listed"
{INPUT.format(height=24, width=32, resize="stretch")}
[outputs.classes]
name = "class_queries_logits"
shape = [1, QUERIES, 134]
[outputs.masks]
name = "masks_queries_logits"
shape = [1, QUERIES, 12, 16]
"""
NO_OBJECT = 133
LABEL = {label.name: k for k, label in enumerate(label_list("coco_panoptic"))}
LABEL["no object"] = NO_OBJECT


def query(name: str, rows: slice, columns: slice, *, sure: float = 8.0, deep: float = 9.0):
    """Logits of a query that sees ``name`` in a rectangle of the 12 x 16 map."""
    label = np.zeros(134, np.float32)
    label[LABEL[name]] = sure
    mask = np.full((12, 16), -deep, np.float32)
    mask[rows, columns] = deep
    return label, mask


def model(folder, *found, sidecar=SIDECAR, batch=1):
    outputs = {
        "class_queries_logits": np.stack([f[0] for f in found]),
        "masks_queries_logits": np.stack([f[1] for f in found]),
    }
    text = sidecar.replace("QUERIES", str(len(found)))
    return blind_model(folder / "query.onnx", text, outputs, [3, 24, 32], batch=batch)


def segment(path, folder):
    panoptic = open_segmenter(str(path), folder, settings=SETTINGS)(frame())
    return panoptic, [classes()[c].name for c in panoptic.class_id]


ALL, LEFT, RIGHT = slice(None), slice(0, 8), slice(8, 16)


def test_things_are_one_by_one_and_stuff_is_one(tmp_path):
    path = model(
        tmp_path,
        query("floor-wood", slice(6, 12), LEFT),
        query("floor-other-merged", slice(6, 12), RIGHT),
        query("chair", slice(0, 6), slice(0, 4)),
        query("chair", slice(0, 6), slice(4, 8)),
        query("wall-other-merged", slice(0, 6), RIGHT),
        query("no object", ALL, ALL, sure=20),
    )
    panoptic, names = segment(path, tmp_path)
    assert sorted(names) == ["chair", "chair", "floor", "none", "wall"]
    assert np.mean(panoptic.mask > 0) > 0.99, "but for the corners, where nobody is sure"
    floor = names.index("floor")
    assert np.all(panoptic.mask[26:] == floor), "two kinds of floor are one mask"
    left, right = panoptic.mask[10, 5], panoptic.mask[10, 25]
    assert left != right and names[left] == names[right] == "chair"
    assert np.all(panoptic.score[1:] > 0.9) and panoptic.score[0] == 0
    assert isinstance(open_segmenter(str(path), tmp_path, settings=SETTINGS), PanopticModel)


def test_stuff_that_we_call_a_thing_falls_into_pieces(tmp_path):
    """COCO has all cabinets of an image in one segment."""
    label, mask = query("cabinet-merged", slice(0, 6), slice(0, 4))
    mask[0:6, 10:16] = 9
    panoptic, names = segment(model(tmp_path, (label, mask)), tmp_path)
    assert names == ["none", "cabinet", "cabinet"]
    assert panoptic.mask[10, 5] != panoptic.mask[10, 60] > 0


def test_hidden_weak_and_unknown_queries_go(tmp_path):
    path = model(
        tmp_path,
        query("couch", ALL, LEFT),
        query("bed", ALL, slice(0, 7), sure=6),  # behind the couch nearly everywhere
        query("chair", ALL, slice(12, 16), sure=3),  # 13 % sure
        query("mountain-merged", ALL, slice(8, 12)),  # none of ours, yet it keeps its pixels
        query("table-merged", ALL, slice(8, 11), sure=6),
    )
    panoptic, names = segment(path, tmp_path)
    assert names == ["none", "sofa"]
    assert not panoptic.mask[:, 34:].any()


def test_no_query_is_no_error(tmp_path):
    panoptic, names = segment(model(tmp_path, query("no object", ALL, ALL)), tmp_path)
    assert names == ["none"] and not panoptic.mask.any()


@pytest.mark.parametrize("seed", range(3))
def test_parity_with_the_slow_twin(tmp_path, seed):
    rng = np.random.default_rng(seed)
    things = [LABEL[n] for n in ("chair", "couch", "bed", "laptop", "cup")]
    found = []
    for k in range(6):
        label = rng.normal(size=134).astype(np.float32)
        label[rng.choice(things) if k else NO_OBJECT] += 9
        y, x = np.mgrid[:12, :16]
        far = np.hypot(y - rng.uniform(0, 12), x - rng.uniform(0, 16))
        found.append((label, (rng.uniform(2, 4) - far).astype(np.float32)))
    side = OnnxModel(model(tmp_path, *found)).sidecar
    outputs = {"classes": np.stack([f[0] for f in found]), "masks": np.stack([f[1] for f in found])}
    masks = decode_queries(outputs, side, (HEIGHT, WIDTH), min_score=0.4)
    expected = segmenter_reference.queries(
        outputs["classes"], outputs["masks"], (HEIGHT, WIDTH), min_score=0.4
    )
    assert len(masks) == len(expected) > 1
    for mask, (label, score, pixels) in zip(masks, expected.values(), strict=True):
        assert mask.class_id == side.class_of[label]
        assert mask.score == pytest.approx(score, rel=1e-5)
        assert np.count_nonzero(mask.pixels != pixels) <= 2, "but for rounding on the outline"


def test_several_frames_at_once_are_as_one_by_one(tmp_path):
    path = model(tmp_path, query("chair", ALL, LEFT), query("bed", ALL, RIGHT), batch="batch")
    segmenter = open_segmenter(str(path), tmp_path, settings=SETTINGS)
    assert isinstance(segmenter, BatchSegmenter)
    alone = segmenter(frame())
    for panoptic in segmenter.batch([frame()] * 3):
        assert np.array_equal(panoptic.mask, alone.mask)
        assert np.array_equal(panoptic.class_id, alone.class_id)
    assert segmenter.batch([]) == []


def test_the_hash_follows_the_least_score(tmp_path):
    path = model(tmp_path, query("chair", ALL, LEFT))
    hashes = {
        open_segmenter(
            str(path), tmp_path, settings=dataclasses.replace(SETTINGS, min_score=score)
        ).content_hash()
        for score in (0.4, 0.4, 0.5)
    }
    assert len(hashes) == 2


def test_a_panoptic_model_stands_alone(tmp_path):
    path = model(tmp_path, query("chair", ALL, LEFT))
    with pytest.raises(SegmenterError, match="is panoptic"):
        open_segmenter(f"{path}+{semantics_model(tmp_path)}", tmp_path)


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("134]", "133]", r"133 labels has \[\*, 1, 134\]"),
        ("shape = [1, QUERIES, 12, 16]", "shape = [1, 7, 12, 16]", r"has \[\*, 1, \*, \*\]"),
        ('label_order = "listed"', "label_count = 133", r"ids up to 200(.|\n)*listed"),
        ('label_order = "listed"', "label_count = 201", r"201 labels has \[\*, 1, 202\]"),
        ('label_order = "listed"', 'label_order = "alphabet"', "ids, listed"),
        ('"masks_queries_logits"', '"pred_masks"', r"'masks_queries_logits' \[1, 1, 12, 16\]"),
        ("[outputs.masks]", "[outputs.prototypes]", r"\[outputs.classes\] and \[outputs.masks\]"),
    ],
)
def test_bad_sidecars_say_what_is_wrong(tmp_path, old, new, says):
    path = model(tmp_path, query("chair", ALL, LEFT), sidecar=SIDECAR.replace(old, new))
    with pytest.raises(SegmenterError, match=says) as error:
        OnnxModel(path)
    assert error.value.hint
