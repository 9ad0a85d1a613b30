"""Real models on real frames of a kitchen: boxes, semantics, instance masks."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from isr_jax.classes import classes
from isr_jax.config import SegmentationSettings
from isr_jax.segmentation import OnnxModel, open_segmenter, segment_frame
from isr_jax.segmentation.instance_masks import decode_yolo_seg
from isr_jax.types import Camera, Frame

pytestmark = pytest.mark.data
CAMERA = Camera(585.0, 585.0, 320.0, 240.0, 640, 480)
FLOOR_HEIGHT_M = -1.495
"""Of the kitchen's floor after turning gravity to -z (peak of the heights of four frames)."""


def read_frame(folder: Path, number: int) -> Frame:
    gravity = np.loadtxt(folder / "gravity-direction.txt")
    up = -gravity / np.linalg.norm(gravity)
    across = np.cross(up, [0, 0, 1])
    turn = across / np.linalg.norm(across) * np.arccos(up[2])
    T = np.eye(4)
    T[:3, :3] = Rotation.from_rotvec(turn).as_matrix()
    T[2, 3] = -FLOOR_HEIGHT_M
    stem = folder / f"frame-{number:06d}"
    depth = cv2.imread(f"{stem}.depth.png", cv2.IMREAD_UNCHANGED).astype(np.float32)
    depth[depth == 65535] = 0
    depth = np.where(depth < 4000, depth / 1000, 0).astype(np.float32)
    color = cv2.imread(f"{stem}.color.jpg")[..., ::-1]
    pose = T @ np.loadtxt(f"{stem}.pose.txt")
    return Frame(number, stem.name, np.ascontiguousarray(color), depth, pose, CAMERA)


INSTANCES = """
kind = "instances"
decoder = "yolo_seg"
label_set = "coco80"
label_count = 80
[input]
name = "serving_default_images:0"
shape = [1, 640, 640, 3]
layout = "NHWC"
dtype = "float32"
color = "RGB"
resize = "letterbox"
pad = 114
scale = [0.00392156862745098, 0.00392156862745098, 0.00392156862745098]
[outputs.cells]
name = "PartitionedCall:0"
shape = [1, 116, 8400]
box_unit = "share"
[outputs.prototypes]
name = "PartitionedCall:1"
shape = [1, 160, 160, 32]
layout = "NHWC"
"""
"""Of a TFLite export of YOLOv8n-seg that was turned into ONNX."""


@pytest.fixture(scope="module")
def instances(shared_data, tmp_path_factory) -> Path:
    """The model of instance masks with a sidecar beside it."""
    model = shared_data / "models" / "agpl-reference" / "yolov8n_seg_coco80_int8qdq.onnx"
    if not model.is_file():
        pytest.skip(f"no {model}")
    folder = tmp_path_factory.mktemp("instances")
    (folder / "seg.toml").write_text(INSTANCES)
    (folder / "seg.onnx").symlink_to(model)
    return folder / "seg.onnx"


@pytest.fixture(scope="module")
def segmenter(shared_data):
    models = shared_data / "models"
    spec = f"{models / 'yolox_nano_coco80.onnx'}+{models / 'deeplabv3_mnv2_ade20k32_logits.onnx'}"
    return open_segmenter(spec, shared_data)


def names_by_size(segments) -> dict[str, int]:
    pixels = np.bincount(segments.segment.ravel(), minlength=len(segments.class_id))
    found: dict[str, int] = {}
    for class_id, count in zip(segments.class_id, pixels, strict=True):
        name = classes()[class_id].name
        found[name] = found.get(name, 0) + int(count)
    return found


@pytest.mark.parametrize(
    ("number", "expected"),
    [(0, ("floor", "table", "chair", "cup", "cabinet")), (520, ("table", "chair", "cup"))],
)
def test_kitchen_frames(shared_data, segmenter, number, expected):
    frame = read_frame(shared_data / "redkitchen", number)
    segments = segment_frame(frame, segmenter(frame), SegmentationSettings())
    found = names_by_size(segments)
    for name in expected:
        assert found.get(name, 0) > 300, found
    assert found["table"] > 40_000, "the table top is one of the largest surfaces"
    instances = segments.instance[segments.class_id == classes()[0].id]
    assert not instances.any(), "background has no instance"


def test_the_quantised_model_agrees_on_large_surfaces(shared_data, segmenter):
    spec = str(shared_data / "models" / "deeplabv3_mnv2_ade20k32_int8qdq.onnx")
    frame = read_frame(shared_data / "redkitchen", 0)
    quantised, full = open_segmenter(spec, shared_data)(frame), segmenter(frame)
    floor = [i.id for i in classes() if i.name == "floor"]
    a, b = (np.isin(p.class_id[p.mask], floor) for p in (quantised, full))
    assert np.count_nonzero(a & b) > 0.7 * np.count_nonzero(a | b) > 7000


def test_masks_of_instances_lie_on_the_things(shared_data, instances):
    """Chairs and cups at known places; a chair is cut out at less than its box."""
    frame = read_frame(shared_data / "redkitchen", 520)
    model = OnnxModel(instances)
    boxes = decode_yolo_seg(model(frame.color), model.sidecar, (480, 640), min_score=0.4)
    names = [classes()[c].name for c in boxes.class_id]
    assert names.count("chair") == 3 and names.count("cup") == 2
    for at, name in (((290, 610), "chair"), ((290, 30), "chair"), ((268, 137), "cup")):
        hit = [n for n, mask in zip(names, boxes.masks, strict=True) if mask[at]]
        assert hit == [name], at
    for (x0, y0, x1, y1), mask in zip(boxes.xyxy, boxes.masks, strict=True):
        assert 0.3 * (x1 - x0) * (y1 - y0) < np.count_nonzero(mask) < (x1 - x0 + 1) * (y1 - y0 + 1)


def test_masks_of_instances_with_semantics(shared_data, instances):
    semantics = shared_data / "models" / "deeplabv3_mnv2_ade20k32_logits.onnx"
    frame = read_frame(shared_data / "redkitchen", 520)
    panoptic = open_segmenter(f"{instances}+{semantics}", shared_data)(frame)
    names = [classes()[c].name for c in panoptic.class_id]
    assert names.count("chair") == 3 and names.count("cup") == 2
    for name in ("table", "cabinet", "wall"):
        pixels = np.isin(panoptic.mask, [k for k, n in enumerate(names) if n == name])
        assert np.count_nonzero(pixels) > 10_000, name
