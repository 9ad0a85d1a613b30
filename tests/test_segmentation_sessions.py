"""Where and how ONNX models run: hardware, threads, several images at once, extra inputs."""

from __future__ import annotations

import dataclasses

import numpy as np
import onnxruntime
import pytest
from onnx import helper

from isr_jax.config import SegmentationSettings
from isr_jax.errors import SegmenterError
from isr_jax.runtime.cores import usable_cores
from isr_jax.segmentation import BatchSegmenter, OnnxModel, onnx_session, open_segmenter
from isr_jax.segmentation.onnx_session import PROVIDERS

from .test_segmentation_onnx import SEMANTICS, semantics_model
from .tiny_models import HEIGHT, WIDTH, frame, write_graph

CUDA = PROVIDERS["cuda"]


def pretend(monkeypatch, *, available: tuple[str, ...], starts: str) -> list:
    """An ONNX Runtime with other hardware; returns what sessions are asked to run on."""
    asked = []

    class Session(onnxruntime.InferenceSession):
        def __init__(self, path, options, providers):
            asked.append((providers, options.intra_op_num_threads))
            super().__init__(path, options, providers=["CPUExecutionProvider"])

        def get_providers(self):
            return [starts]

    monkeypatch.setattr(onnx_session.onnxruntime, "get_available_providers", lambda: [*available])
    monkeypatch.setattr(onnx_session.onnxruntime, "InferenceSession", Session)
    return asked


def test_the_processor_is_the_default_and_is_said(tmp_path):
    model = OnnxModel(semantics_model(tmp_path), provider="cpu")
    assert model.provider == "CPUExecutionProvider"
    assert f"CPUExecutionProvider, {usable_cores()} threads" in model.describe()
    assert "1 threads" in OnnxModel(semantics_model(tmp_path), threads=1).describe()


def test_auto_takes_cuda_where_it_is(tmp_path, monkeypatch):
    cpu = PROVIDERS["cpu"]
    asked = pretend(monkeypatch, available=("TensorrtExecutionProvider", CUDA, cpu), starts=CUDA)
    model = OnnxModel(semantics_model(tmp_path), threads=3)
    assert asked == [([CUDA, cpu], 3)]
    assert CUDA in model.describe()


def test_a_provider_that_is_missing_is_an_error(tmp_path, monkeypatch):
    pretend(monkeypatch, available=("CPUExecutionProvider",), starts="CPUExecutionProvider")
    path = semantics_model(tmp_path)
    with pytest.raises(SegmenterError, match=f"no {CUDA} here; it has CPUExecution") as error:
        OnnxModel(path, provider="cuda")
    assert "onnx_provider=auto" in error.value.hint
    settings = dataclasses.replace(SegmentationSettings(), onnx_provider="cuda")
    with pytest.raises(SegmenterError, match=CUDA):
        open_segmenter(str(path), tmp_path, settings=settings)
    with pytest.raises(SegmenterError, match=r"'npu'(.|\n)*auto, cpu, cuda"):
        OnnxModel(path, provider="npu")
    assert OnnxModel(path).provider == "CPUExecutionProvider", "auto did not ask for one"


def test_a_provider_that_does_not_start_is_an_error(tmp_path, monkeypatch):
    """ONNX Runtime itself would go on with the CPU and say so in a log alone."""
    cpu = PROVIDERS["cpu"]
    pretend(monkeypatch, available=(CUDA, cpu), starts=cpu)
    with pytest.raises(SegmenterError, match=f"{CUDA} did not start"):
        OnnxModel(semantics_model(tmp_path), provider="cuda")
    assert OnnxModel(semantics_model(tmp_path)).provider == cpu


def images(count: int) -> list[np.ndarray]:
    rng = np.random.default_rng(0)
    return [rng.integers(0, 255, (HEIGHT, WIDTH, 3), np.uint8) for _ in range(count)]


@pytest.mark.parametrize(("batch", "runs"), [("n", [8, 3]), (1, [1] * 11), (4, [4, 4, 4])])
def test_images_go_in_together_as_far_as_the_model_takes_them(tmp_path, batch, runs):
    (tmp_path / "semantics.toml").write_text(SEMANTICS)
    shape = [batch, 3, 16, 16]
    node = helper.make_node("Identity", ["image"], ["scores"])
    path = tmp_path / "semantics.onnx"
    model = OnnxModel(write_graph(path, [node], {"image": shape}, {"scores": shape}))
    sizes, run = [], model._session.run
    model._session = type(
        "Counting", (), {"run": lambda _, o, i: sizes.append(len(i["image"])) or run(o, i)}
    )()
    some = images(11)
    together = model.batch(some)
    assert sizes == runs and len(together) == 11
    for image, found in zip(some, together, strict=True):
        assert np.array_equal(found["output"], model(image)["output"])


def test_segmenters_of_models_take_several_frames(tmp_path):
    settings = dataclasses.replace(SegmentationSettings(), normal_window=5)
    segmenter = open_segmenter(str(semantics_model(tmp_path)), tmp_path, settings=settings)
    assert isinstance(segmenter, BatchSegmenter)
    assert "things are connected components" in segmenter.describe()
    frames = [frame(color) for color in images(3)]
    for one, panoptic in zip(frames, segmenter.batch(frames), strict=True):
        assert np.array_equal(panoptic.mask, segmenter(one).mask)


CONSTANT = """
[[constants]]
name = "bias"
shape = [1, 3, 1, 1]
value = [1, 2, 3]
"""


def biased_model(folder, sidecar: str):
    """Its scores are the image plus a second input."""
    (folder / "semantics.toml").write_text(sidecar)
    inputs = {"image": ["n", 3, 16, 16], "bias": ["n", 3, 1, 1]}
    node = helper.make_node("Add", ["image", "bias"], ["scores"])
    path = folder / "semantics.onnx"
    return write_graph(path, [node], inputs, {"scores": ["n", 3, 16, 16]})


def test_constants_are_fed_with_every_image(tmp_path):
    model = OnnxModel(biased_model(tmp_path, SEMANTICS + CONSTANT))
    for found in model.batch([np.zeros((HEIGHT, WIDTH, 3), np.uint8)] * 2):
        assert found["output"][:, 3, 3].tolist() == [1, 2, 3]
    one = CONSTANT.replace("[1, 2, 3]", "4")
    model = OnnxModel(biased_model(tmp_path, SEMANTICS + one))
    assert np.all(model(np.zeros((HEIGHT, WIDTH, 3), np.uint8))["output"] == 4)


@pytest.mark.parametrize(
    ("constant", "says"),
    [
        ("", r"also wants the input 'bias'(.|\n)*constants"),
        (CONSTANT.replace("bias", "mask"), r"no input 'mask'(.|\n)*'bias'"),
        (CONSTANT.replace("[1, 3, 1, 1]", "[1, 4, 1, 1]"), "has 3 values(.|\n)*or 4"),
        (CONSTANT.replace("[1, 3, 1, 1]", "[1, 3, 3, 1]").replace("[1, 2, 3]", "1"), "bias"),
        (CONSTANT.replace("shape", "size"), r"unknown key constants\.size"),
        (CONSTANT + 'dtype = "complex64"', "float32, int64"),
        (CONSTANT + 'dtype = "int64"', "failed on 1 images"),
    ],
)
def test_wrong_constants_say_what_is_wrong(tmp_path, constant, says):
    path = biased_model(tmp_path, SEMANTICS + constant)
    with pytest.raises(SegmenterError, match=says):
        OnnxModel(path)(np.zeros((HEIGHT, WIDTH, 3), np.uint8))
