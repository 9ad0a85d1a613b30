"""ONNX models and their sidecars: tiny models written here, and the shipped sidecars."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from onnx import helper

from isr_jax.classes import class_named, classes
from isr_jax.config import SegmentationSettings
from isr_jax.errors import SegmenterError
from isr_jax.segmentation import BoxesAndSemantics, OnnxModel, find_sidecar, open_segmenter
from isr_jax.segmentation.box_shapes import plausible_layout, shape_in_box
from isr_jax.segmentation.boxes import decode_yolox
from isr_jax.segmentation.class_maps import class_maps
from isr_jax.segmentation.model_image import pixels_per_pixel, prepare, reach, to_image
from isr_jax.segmentation.sidecar import shipped_sidecars

from .reference import segmenter_reference
from .tiny_models import HEIGHT, WIDTH, blind_model, frame, write_graph

SETTINGS = dataclasses.replace(SegmentationSettings(), normal_window=5, onnx_threads=1)

SEMANTICS = """
kind = "semantics"
decoder = "logits"
labels = ["", "floor", "table"]
[input]
name = "image"
shape = [1, 3, 16, 16]
layout = "NCHW"
dtype = "float32"
color = "RGB"
resize = "stretch"
mean = [0.0, 0.0, 0.0]
scale = [0.1, 0.1, 0.1]
[output]
name = "scores"
shape = [1, 3, 16, 16]
"""

BOXES = """
kind = "boxes"
decoder = "yolox"
labels = ["chair", "cup"]
[input]
name = "image"
shape = [1, 3, 32, 32]
layout = "NCHW"
dtype = "float32"
color = "BGR"
resize = "letterbox"
pad = 114
[output]
name = "raw"
shape = [1, 21, 7]
strides = [8, 16, 32]
"""


def semantics_model(folder, sidecar: str | None = SEMANTICS):
    """Its scores are the image: red = nothing, green = floor, blue = table."""
    node = helper.make_node("Identity", ["image"], ["scores"])
    shape = [1, 3, 16, 16]
    if sidecar is not None:
        (folder / "semantics.toml").write_text(sidecar)
    return write_graph(folder / "semantics.onnx", [node], {"image": shape}, {"scores": shape})


def raw_boxes(*rows: tuple[int, tuple[float, ...]]) -> np.ndarray:
    raw = np.zeros((21, 7), np.float32)
    for cell, values in rows:
        raw[cell] = values
    return raw


ONE_CHAIR = raw_boxes((5, (0.5, 0.5, np.log(2), np.log(1), 0.9, 0.9, 0.1)))
"""Cell (1, 1) of stride 8: centre (12, 12), size 16 x 8, in the model's 32 pixels."""


def boxes_model(folder, raw: np.ndarray = ONE_CHAIR, sidecar: str = BOXES):
    """It ignores the image and always sees ``raw``."""
    return blind_model(folder / "boxes.onnx", sidecar, {"raw": raw}, [3, 32, 32])


def test_prepare_orders_pads_and_scales(tmp_path):
    image = np.zeros((24, 32, 3), np.uint8)
    image[:] = (10, 20, 30)
    boxes = OnnxModel(boxes_model(tmp_path))
    fed = prepare(image, boxes.sidecar)
    assert fed.shape == (3, 32, 32) and fed.dtype == np.float32
    assert fed[:, 0, 0].tolist() == [30, 20, 10], "BGR"
    assert np.all(fed[:, 24:] == 114), "padded below"
    semantics = OnnxModel(semantics_model(tmp_path))
    fed = prepare(image, semantics.sidecar)
    assert fed.shape == (3, 16, 16)
    np.testing.assert_allclose(fed[:, 5, 5], [1, 2, 3], rtol=1e-6)


@pytest.mark.parametrize("resize", ["stretch", "letterbox"])
@pytest.mark.parametrize("shape", [(48, 64), (45, 77), (80, 33)])
def test_maps_come_back_to_the_pixels_of_the_image(tmp_path, resize, shape):
    """Whole, in part, and one pixel at a time: the same values."""
    text = SEMANTICS.replace('"stretch"', f'"{resize}"')
    sidecar = OnnxModel(semantics_model(tmp_path, text)).sidecar
    model_map = np.random.default_rng(0).normal(size=(24, 32)).astype(np.float32)
    whole = to_image(model_map, sidecar, shape, smooth=True)
    assert whole.shape == shape
    x_ratio, y_ratio = pixels_per_pixel(shape, sidecar)
    step = x_ratio * 32 / 16, y_ratio * 24 / 16
    last = (int(shape[1] * step[0]) - 1, int(shape[0] * step[1]) - 1)  # cells without padding
    for y in range(0, shape[0], 7):
        for x in range(0, shape[1], 5):
            if (x + 0.5) * step[0] - 0.5 < last[0] and (y + 0.5) * step[1] - 0.5 < last[1]:
                expected = segmenter_reference.sample(model_map, x, y, step)
                # OpenCV's warp interpolates at 1/32 of a cell.
                assert whole[y, x] == pytest.approx(expected, abs=0.15)
    part = to_image(model_map, sidecar, shape, smooth=True, window=(3, 5, 20, 30))
    assert np.abs(part[:-5, :-5] - whole[5:25, 3:15]).max() < 0.15
    for least in (0.5, 1.5, 2.0):
        x0, y0, x1, y1 = reach(model_map, least, sidecar, shape)
        outside = np.ones(shape, bool)
        outside[y0:y1, x0:x1] = False
        assert whole[outside].max(initial=-9) < least
    assert reach(model_map, 99.0, sidecar, shape) is None


def test_semantics_classes_and_confidence(tmp_path):
    model = OnnxModel(semantics_model(tmp_path))
    image = np.zeros((HEIGHT, WIDTH, 3), np.uint8)
    image[:24, :, 1], image[24:, :, 2] = 30, 10  # scores 3 for floor, 1 for table
    class_map, confidence = class_maps(model(image)["output"], model.sidecar, (HEIGHT, WIDTH))
    assert np.all(class_map[:22] == class_named("floor").id)
    assert np.all(class_map[26:] == class_named("table").id)
    assert confidence[5, 5] == pytest.approx(np.exp(3) / (np.exp(3) + 2), rel=1e-4)
    assert confidence[40, 5] == pytest.approx(np.e / (np.e + 2), rel=1e-4)


def test_boxes_decode_and_suppress(tmp_path):
    raw = raw_boxes(
        (5, (0.5, 0.5, np.log(2), np.log(1), 0.9, 0.9, 0.1)),
        (6, (-0.45, 0.5, np.log(2), np.log(1), 0.8, 0.8, 0.1)),  # nearly the same box
        (18, (0.5, 0.5, 0.0, 0.0, 0.9, 0.0, 0.7)),  # stride 16, cell (0, 1): centre (8, 24)
        (0, (0.5, 0.5, 0.0, 0.0, 0.3, 0.9, 0.1)),  # low objectness
    )
    model = OnnxModel(boxes_model(tmp_path, raw))
    image = np.zeros((HEIGHT, WIDTH, 3), np.uint8)
    output = model(image)["output"]
    boxes = decode_yolox(output, model.sidecar, (HEIGHT, WIDTH), min_score=0.5)
    assert [classes()[c].name for c in boxes.class_id] == ["chair", "cup"]
    np.testing.assert_allclose(boxes.score, [0.81, 0.63], rtol=1e-5)
    # The letterbox maps 64 pixels to 32: twice the model's pixels.
    np.testing.assert_allclose(boxes.xyxy[0], [8, 16, 40, 32], atol=1e-4)
    np.testing.assert_allclose(boxes.xyxy[1], [0, 32, 32, 48], atol=1e-4), "clipped to the image"


def test_a_box_alone_takes_the_depth_cluster_of_its_middle():
    depth = np.full((HEIGHT, WIDTH), 2.0, np.float32)
    depth[10:30, 20:40] = 1.0
    depth[12, 22] = 0
    none = np.zeros(depth.shape, bool)
    box = np.array([15, 8, 45, 34], np.float32)
    mask = shape_in_box(box, depth, none, by_semantics=False)
    assert np.array_equal(mask, depth == 1.0)
    agrees = np.zeros(depth.shape, bool)
    agrees[8:34, 15:20] = True  # semantics point at the surface behind
    mask = shape_in_box(box, depth, agrees, by_semantics=False)
    assert mask[9, 16] and not mask[20, 30]
    assert np.array_equal(shape_in_box(box, depth, agrees, by_semantics=True), agrees)
    assert shape_in_box(box, 0 * depth, none, by_semantics=False).sum() == 30 * 26


def test_a_slope_is_one_cluster():
    depth = np.tile(np.linspace(1.0, 1.6, HEIGHT)[:, None], (1, WIDTH)).astype(np.float32)
    depth[:, 40:] += 0.8
    box = np.array([10, 0, 50, HEIGHT], np.float32)
    mask = shape_in_box(box, depth, np.zeros(depth.shape, bool), by_semantics=False)
    assert np.array_equal(mask[:, 10:50], depth[:, 10:50] < 1.61)


def test_layout_where_it_cannot_be():
    floor, ceiling, wall = (class_named(n).id for n in ("floor", "ceiling", "wall"))
    class_map = np.array([[floor, floor, ceiling, ceiling, wall, floor]])
    height = np.array([[0.02, 0.75, 2.4, 0.75, 0.75, 0.75]])
    seen = np.array([[True] * 5 + [False]])
    result = plausible_layout(class_map, height, seen, floor=floor, ceiling=ceiling)
    assert result.tolist() == [[floor, 0, ceiling, 0, wall, floor]]


def downward_camera() -> np.ndarray:
    """A camera that looks at the floor from 1.5 m."""
    T = np.diag([1.0, -1.0, -1.0, 1.0])
    T[2, 3] = 1.5
    return T


def test_boxes_and_semantics_together(tmp_path):
    spec = f"{boxes_model(tmp_path)}+{semantics_model(tmp_path)}"
    segmenter = open_segmenter(spec, tmp_path, settings=SETTINGS)
    color = np.zeros((HEIGHT, WIDTH, 3), np.uint8)
    color[..., 1] = 60
    depth = np.full((HEIGHT, WIDTH), 1.5, np.float32)
    depth[16:32, 8:40] = 1.0  # what stands in the chair's box
    panoptic = segmenter(frame(color, depth, downward_camera()))
    names = [classes()[c].name for c in panoptic.class_id]
    assert names == ["none", "floor", "chair"]
    assert np.array_equal(panoptic.mask == 2, depth == 1.0)
    assert np.all(panoptic.mask[40:] == 1)
    raised = downward_camera()
    raised[2, 3] = 2.5
    names = [classes()[c].name for c in segmenter(frame(color, depth, raised)).class_id]
    assert names == ["none", "chair"], "no floor a metre above the floor"
    assert "1 threads" in segmenter.describe() and "boxes.toml" in segmenter.describe()


def test_things_that_only_semantics_see(tmp_path):
    semantics = OnnxModel(semantics_model(tmp_path))
    segmenter = BoxesAndSemantics(None, semantics, SETTINGS)
    color = np.zeros((HEIGHT, WIDTH, 3), np.uint8)
    color[:, :28, 2] = color[:, 36:, 2] = 60
    depth = np.full((HEIGHT, WIDTH), 1.5, np.float32)
    depth[:, 28:36] = 2.5
    panoptic = segmenter(frame(color, depth))
    assert [classes()[c].name for c in panoptic.class_id] == ["none", "table", "table"]
    assert panoptic.mask[24, 5] != panoptic.mask[24, 60]
    assert panoptic.mask[24, 32] == 0


def test_boxes_alone(tmp_path):
    segmenter = open_segmenter(str(boxes_model(tmp_path)), tmp_path, settings=SETTINGS)
    panoptic = segmenter(frame())
    assert [classes()[c].name for c in panoptic.class_id] == ["none", "chair"]


def test_the_hash_follows_model_and_sidecar(tmp_path):
    before = OnnxModel(semantics_model(tmp_path)).content_hash()
    assert before == OnnxModel(semantics_model(tmp_path)).content_hash()
    changed = OnnxModel(semantics_model(tmp_path, SEMANTICS.replace("0.1, 0.1]", "0.1, 0.2]")))
    assert changed.content_hash() != before


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ('name = "scores"', 'name = "logits"', r"no output 'logits'(.|\n)*'scores'"),
        ("[1, 3, 16, 16]\n", "[1, 3, 16, 32]\n", r"\[1, 3, 16, 16\].*\[1, 3, 16, 32\]"),
        ('name = "scores"\nshape = [1, 3', 'name = "scores"\nshape = [1, 4', "3 labels has"),
        ('name = "scores"\nshape = [1, 3, 16, 16]', 'name = "scores"', "has no 'shape'"),
        ('kind = "semantics"', 'kind = "masks"', "boxes, semantics, instances, panoptic"),
        ('decoder = "logits"', 'decoder = "yolox"', "logits, labels"),
        ('resize = "stretch"', 'resize = "stretch"\nmeans = [0, 0, 0]', r"input\.means(.|\n)*mean"),
        ('"table"]', '"tabel"]', "tabel"),
        ('resize = "stretch"', 'resize = "crop"', "letterbox, stretch"),
        ("[input]", "[input", "is not TOML"),
        ('layout = "NCHW"\n', "", "layout"),
    ],
)
def test_bad_sidecars_say_what_is_wrong(tmp_path, old, new, says):
    path = semantics_model(tmp_path, SEMANTICS.replace(old, new))
    with pytest.raises(SegmenterError, match=says) as error:
        OnnxModel(path)
    assert error.value.hint


def test_files_that_are_no_models(tmp_path):
    path = tmp_path / "semantics.onnx"
    with pytest.raises(SegmenterError, match="does not exist"):
        OnnxModel(path)
    path.write_bytes(b"this is not ONNX")
    with pytest.raises(SegmenterError, match="no sidecar"):
        OnnxModel(path)
    (tmp_path / "semantics.toml").write_text(SEMANTICS)
    with pytest.raises(SegmenterError, match="not a model that ONNX Runtime can load"):
        OnnxModel(path)


def test_outputs_that_differ_at_run_time(tmp_path):
    """A model that declares no shape is found out when it runs."""
    (tmp_path / "semantics.toml").write_text(SEMANTICS)
    node = helper.make_node("Concat", ["image", "image"], ["scores"], axis=1)
    shapes = {"image": [1, 3, 16, 16]}, {"scores": ["n", "c", "h", "w"]}
    path = write_graph(tmp_path / "semantics.onnx", [node], *shapes)
    # ONNX infers the shape of Concat where it can; the batch axis hides it here.
    with pytest.raises(SegmenterError, match=r"\[1, 6, 16, 16\].*\[1, 3, 16, 16\]"):
        OnnxModel(path)(np.zeros((HEIGHT, WIDTH, 3), np.uint8))


def test_two_models_of_a_kind(tmp_path):
    path = semantics_model(tmp_path)
    with pytest.raises(SegmenterError, match="two models of semantics"):
        open_segmenter(f"{path}+{path}", tmp_path)


@pytest.mark.parametrize(
    "stem",
    [
        "yolox_nano_coco80",
        "deeplabv3_mnv2_ade20k32_logits",
        "deeplabv3_mnv2_ade20k32_int8qdq",
        "yolov8n-seg",
        "yolo11n-seg",
        "detr-resnet-50-panoptic",
        "mask2former-swin-tiny-coco-panoptic",
        "oneformer-ade20k-swin-tiny",
    ],
)
def test_shipped_sidecars(tmp_path, stem):
    sidecar = find_sidecar(tmp_path / f"{stem}.onnx")
    assert sidecar.source == f"shipped sidecars/{stem}.toml"
    names = [classes()[c].name for c in sidecar.class_of]
    if sidecar.kind in ("boxes", "instances"):
        assert names[56] == "chair" and names[0] == "person" and len(names) == 80
    elif sidecar.kind == "semantics":
        assert names[:5] == ["none", "wall", "none", "none", "floor"] and len(names) == 32
    else:
        label, count = {
            "detr-resnet-50-panoptic": (62, 250),
            "mask2former-swin-tiny-coco-panoptic": (56, 133),
            "oneformer-ade20k-swin-tiny": (19, 150),
        }[stem]
        assert names[label] == "chair" and sidecar.is_thing[label] and len(names) == count
        assert not sidecar.is_thing[names.index("floor")]


def test_every_shipped_sidecar_is_tested():
    tested = test_shipped_sidecars.pytestmark[0].args[1]
    assert {f"{stem}.toml" for stem in tested} == set(shipped_sidecars())
