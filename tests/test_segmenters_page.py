"""docs/segmenters.md: its example works, and its tables are what the package knows."""

from __future__ import annotations

import re

import numpy as np
import pytest
from onnx import helper

from isr_jax.classes import classes
from isr_jax.classes.label_lists import LABEL_SETS
from isr_jax.config import SegmentationSettings
from isr_jax.segmentation import open_segmenter
from isr_jax.segmentation.sidecar import DECODERS, ROLES, parse_sidecar

from .conftest import REPOSITORY
from .tiny_models import frame, write_graph

PAGE = (REPOSITORY / "docs" / "segmenters.md").read_text("utf-8")
BLOCKS = re.findall(r"```toml\n(.*?)```", PAGE, re.S)


def test_the_example_runs(tmp_path):
    """A model that gives back its input: red is none, green is floor, blue is table."""
    (tmp_path / "seg.toml").write_text(BLOCKS[0])
    shape = [1, 3, 120, 160]
    node = helper.make_node("Identity", ["image"], ["scores"])
    path = write_graph(tmp_path / "seg.onnx", [node], {"image": shape}, {"scores": shape})
    segmenter = open_segmenter(str(path), tmp_path, settings=SegmentationSettings(normal_window=5))
    color = np.zeros((48, 64, 3), np.uint8)
    color[..., 2] = 255
    panoptic = segmenter(frame(color))
    assert [classes()[c].name for c in panoptic.class_id] == ["none", "table"]


def test_the_other_pieces_fit_into_it():
    labels = BLOCKS[0].splitlines()[2] + "\n"
    head, output = BLOCKS[0].replace(labels, BLOCKS[1]).split("[output]")
    listed = f"{head}[output]{output.replace('[1, 3,', '[1, 133,')}"
    assert len(parse_sidecar(listed, "page").class_of) == 133
    constant = parse_sidecar(BLOCKS[0] + BLOCKS[2], "page").constants[0]
    assert constant.shape == (1, 64, 64) and constant.value == (1.0,)


@pytest.mark.parametrize("kind", DECODERS)
def test_every_decoder_is_in_the_table(kind):
    for decoder in DECODERS[kind]:
        row = next(r for r in PAGE.splitlines() if r.startswith(f"| `{kind}` | `{decoder}` |"))
        for role in ROLES[decoder]:
            assert ("[output]" if role == "output" else f"[outputs.{role}]") in row


def test_every_label_set_and_setting_is_named():
    assert all(f"`{name}`" in PAGE for name in LABEL_SETS)
    named = re.findall(r"segmentation\.(\w+)", PAGE)
    assert named and all(hasattr(SegmentationSettings(), name) for name in named)
