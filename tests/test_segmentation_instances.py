"""Boxes with masks from YOLO segmentation heads."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from isr_jax.classes import class_named, classes
from isr_jax.config import SegmentationSettings
from isr_jax.errors import SegmenterError
from isr_jax.segmentation import OnnxModel, open_segmenter
from isr_jax.segmentation.instance_masks import decode_yolo_seg

from .reference import segmenter_reference
from .test_segmentation_onnx import boxes_model, downward_camera, semantics_model
from .tiny_models import HEIGHT, INPUT, WIDTH, blind_model, frame

SETTINGS = dataclasses.replace(SegmentationSettings(), normal_window=5, onnx_threads=1)
SIDE = 64
"""Of the model's input: the image of 64 x 48 fills its upper three quarters."""
LABELS = ("chair", "", "cup")
PROTOTYPES = 4

SIDECAR = f"""
kind = "instances"
decoder = "yolo_seg"
labels = {list(LABELS)}
{INPUT.format(height=SIDE, width=SIDE, resize="letterbox")}
[outputs.cells]
name = "cells"
shape = [1, {4 + len(LABELS) + PROTOTYPES}, CELLS]
[outputs.prototypes]
name = "prototypes"
shape = [1, {PROTOTYPES}, 16, 16]
"""


def cell(box, scores, coefficients) -> np.ndarray:
    """One column: centre, size, one score per class, coefficients."""
    return np.array([*box, *scores, *coefficients], np.float32)


def halves() -> np.ndarray:
    """Prototypes positive in the left half, the upper half, everywhere and nowhere."""
    maps = -np.ones((PROTOTYPES, 16, 16), np.float32)
    maps[0, :, :8] = maps[1, :6] = maps[2] = 1
    return maps


def model(folder, columns, prototypes=None, sidecar=SIDECAR, **options):
    cells = np.stack(columns, 1)
    outputs = {"cells": cells, "prototypes": halves() if prototypes is None else prototypes}
    text = sidecar.replace("CELLS", str(cells.shape[1]))
    return blind_model(folder / "seg.onnx", text, outputs, [3, SIDE, SIDE], **options)


CHAIR = cell((32, 24, 32, 24), (0.9, 0, 0.1), (1, 0, 0, 0))
"""x 16 to 48, y 12 to 36; its mask is the left half of the image."""


def decode(path, min_score=0.4):
    found = OnnxModel(path)
    image = np.zeros((HEIGHT, WIDTH, 3), np.uint8)
    return decode_yolo_seg(found(image), found.sidecar, (HEIGHT, WIDTH), min_score=min_score)


def test_a_mask_is_its_prototypes_within_its_box(tmp_path):
    boxes = decode(model(tmp_path, [CHAIR]))
    assert [classes()[c].name for c in boxes.class_id] == ["chair"]
    np.testing.assert_allclose(boxes.xyxy, [[16, 12, 48, 36]], atol=1e-5)
    expected = np.zeros((1, HEIGHT, WIDTH), bool)
    expected[0, 12:36, 16:32] = True
    assert np.array_equal(boxes.masks, expected)


def test_weak_unknown_and_doubled_boxes_go(tmp_path):
    columns = [
        CHAIR,
        cell((33, 24, 32, 24), (0.8, 0, 0.7), (1, 0, 0, 0)),  # the same again
        cell((10, 10, 8, 8), (0.3, 0, 0.2), (0, 0, 1, 0)),  # weak
        cell((50, 40, 8, 8), (0.1, 0.9, 0.2), (0, 0, 1, 0)),  # a label that is none of ours
        cell((60, 44, 16, 16), (0.0, 0.1, 0.6), (0, 0, 1, 0)),  # over the edge
    ]
    boxes = decode(model(tmp_path, columns))
    assert [classes()[c].name for c in boxes.class_id] == ["chair", "cup"]
    np.testing.assert_allclose(boxes.xyxy[1], [52, 36, 64, 48], atol=1e-5)
    assert boxes.masks[1].sum() == 12 * 12


def test_nothing_seen_is_no_error(tmp_path):
    path = model(tmp_path, [cell((10, 10, 8, 8), (0.1, 0, 0), (0, 0, 1, 0))])
    assert decode(path).masks.shape == (0, HEIGHT, WIDTH)
    panoptic = open_segmenter(str(path), tmp_path, settings=SETTINGS)(frame())
    assert not panoptic.mask.any() and len(panoptic.score) == 1


@pytest.mark.parametrize("seed", range(3))
def test_parity_with_the_slow_twin(tmp_path, seed):
    rng = np.random.default_rng(seed)
    count = 12
    cells = np.zeros((4 + len(LABELS) + PROTOTYPES, count), np.float32)
    cells[:2] = rng.uniform(0, (SIDE, HEIGHT), (count, 2)).T
    cells[2:4] = rng.uniform(4, 30, (2, count))
    cells[4] = rng.uniform(0, 1, count)
    cells[6] = rng.uniform(0, 1, count)
    cells[7:] = rng.normal(size=(PROTOTYPES, count))
    prototypes = rng.normal(size=(PROTOTYPES, 16, 16)).astype(np.float32)
    found = decode(model(tmp_path, list(cells.T), prototypes), min_score=0.5)
    expected = segmenter_reference.yolo_seg(
        cells, prototypes, len(LABELS), (SIDE, SIDE), (HEIGHT, WIDTH), min_score=0.5
    )
    assert len(found.score) == len(expected) > 2
    for k, (label, score, box, pixels) in enumerate(expected):
        assert classes()[found.class_id[k]].name == LABELS[label]
        assert found.score[k] == pytest.approx(score)
        np.testing.assert_allclose(found.xyxy[k], box, atol=1e-4)
        # OpenCV interpolates at 1/32 of a cell: pixels on the outline may differ.
        assert np.count_nonzero(found.masks[k] != pixels) <= 0.02 * pixels.size


def test_prototypes_last_and_boxes_in_shares(tmp_path):
    """As TFLite exports have them."""
    shares = CHAIR.copy()
    shares[:4] /= SIDE
    sidecar = SIDECAR.replace("16, 16]", f'16, {PROTOTYPES}]\nlayout = "NHWC"')
    sidecar = sidecar.replace(f"[1, {PROTOTYPES}, 16", "[1, 16, 16").replace("16, 16, 16", "16, 16")
    sidecar = sidecar.replace('name = "cells"', 'name = "cells"\nbox_unit = "share"')
    (tmp_path / "a").mkdir()
    plain = decode(model(tmp_path / "a", [CHAIR]))
    other = decode(model(tmp_path, [shares], halves().transpose(1, 2, 0), sidecar))
    np.testing.assert_allclose(plain.xyxy, other.xyxy, atol=1e-5)
    assert np.array_equal(plain.masks, other.masks)


def test_with_semantics_the_masks_stay_as_the_model_gave_them(tmp_path):
    spec = f"{model(tmp_path, [CHAIR])}+{semantics_model(tmp_path)}"
    segmenter = open_segmenter(spec, tmp_path, settings=SETTINGS)
    color = np.zeros((HEIGHT, WIDTH, 3), np.uint8)
    color[..., 1] = 60  # all floor
    panoptic = segmenter(frame(color, T=downward_camera()))
    assert [classes()[c].name for c in panoptic.class_id] == ["none", "floor", "chair"]
    chair = np.zeros((HEIGHT, WIDTH), bool)
    chair[12:36, 16:32] = True
    assert np.array_equal(panoptic.mask == 2, chair)
    assert np.array_equal(panoptic.mask == 1, ~chair)
    assert panoptic.class_id[2] == class_named("chair").id
    assert "connected components" not in segmenter.describe()


def test_boxes_and_instances_are_one_too_many(tmp_path):
    spec = f"{model(tmp_path, [CHAIR])}+{boxes_model(tmp_path)}"
    with pytest.raises(SegmenterError, match="instances and boxes"):
        open_segmenter(spec, tmp_path)


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("shape = [1, 11, CELLS]", "shape = [1, 12, CELLS]", r"3 labels has \[\*, 11, \*\]"),
        ("shape = [1, 11, CELLS]", "shape = [1, 11, 9]", r"\[1, 11, 1\].*\[1, 11, 9\]"),
        ('name = "cells"', 'name = "boxes"', r"'boxes'(.|\n)*'cells' \[1, 11, 1\]"),
        ("[outputs.prototypes]", "[outputs.masks]", r"no \[outputs.prototypes\]"),
        ("[outputs.cells]", "[outputs.boxes]", r"unknown key outputs\.boxes"),
        ("[outputs.prototypes]", '[outputs.prototypes]\nlayout = "HWC"', "NCHW, NHWC"),
        ('kind = "instances"', 'kind = "boxes"', "yolox"),
    ],
)
def test_bad_sidecars_say_what_is_wrong(tmp_path, old, new, says):
    path = model(tmp_path, [CHAIR], sidecar=SIDECAR.replace(old, new))
    with pytest.raises(SegmenterError, match=says) as error:
        OnnxModel(path)
    assert error.value.hint
