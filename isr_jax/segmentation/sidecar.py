"""Border: the TOML file beside an ONNX model that says what goes in and what comes out."""

from __future__ import annotations

import dataclasses
import tomllib
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np

from ..classes import LABEL_SETS, class_named, label_table
from ..errors import ClassError, SegmenterError

KINDS = ("boxes", "semantics")
DECODERS = {"boxes": ("yolox",), "semantics": ("logits", "labels")}


@dataclasses.dataclass(frozen=True)
class Sidecar:
    """How one ONNX model is fed and read."""

    source: str
    """Where it was found."""
    kind: str
    """``boxes`` or ``semantics``."""
    decoder: str
    """``yolox``: [1, cells, 5 + classes] raw. ``logits``: [1, classes, h, w]. ``labels``: [1, h, w]."""  # noqa: E501
    class_of: tuple[int, ...]
    """Our class for each of the model's labels; 0 = none."""
    input_name: str
    input_shape: tuple[int, ...]
    layout: str
    """``NCHW`` or ``NHWC``."""
    dtype: str
    color: str
    """``RGB`` or ``BGR``."""
    resize: str
    """``letterbox`` (top left, padded) or ``stretch``."""
    pad: int
    mean: tuple[float, ...]
    scale: tuple[float, ...]
    """Input = (pixel - mean) * scale, a channel."""
    output_name: str
    output_shape: tuple[int, ...]
    strides: tuple[int, ...]
    """Of the grids of a ``yolox`` output."""

    @property
    def input_size(self) -> tuple[int, int]:
        """Height and width that the model wants."""
        at = 2 if self.layout == "NCHW" else 1
        return self.input_shape[at], self.input_shape[at + 1]


def find_sidecar(model: Path) -> Sidecar:
    """The TOML file beside ``model``, or the shipped one of the same name."""
    beside = model.with_suffix(".toml")
    if beside.is_file():
        return parse_sidecar(beside.read_text("utf-8"), str(beside))
    shipped = resources.files("isr_jax.segmentation").joinpath("sidecars", f"{model.stem}.toml")
    if shipped.is_file():
        return parse_sidecar(shipped.read_text("utf-8"), f"shipped sidecars/{model.stem}.toml")
    raise SegmenterError(
        f"{model} has no sidecar: neither {beside} exists nor a shipped one",
        f"write {beside.name}: kind, decoder, label_set or labels, [input], [output] "
        f"(shipped examples: {', '.join(_shipped())})",
    )


def _shipped() -> list[str]:
    folder = resources.files("isr_jax.segmentation").joinpath("sidecars")
    return sorted(f.name for f in folder.iterdir() if f.name.endswith(".toml"))


def parse_sidecar(text: str, source: str) -> Sidecar:
    """Read and check a sidecar; ``source`` names it in errors."""
    try:
        content = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise SegmenterError(f"{source} is not TOML: {error}", "correct the file") from None
    try:
        return _from_toml(content, source)
    except KeyError as error:
        raise SegmenterError(f"{source} has no {error}", "add it") from None


def _from_toml(content: dict[str, Any], source: str) -> Sidecar:
    given, result = content["input"], content["output"]
    kind = _one_of(source, "kind", content["kind"], KINDS)
    return Sidecar(
        source=source,
        kind=kind,
        decoder=_one_of(source, "decoder", content["decoder"], DECODERS[kind]),
        class_of=_classes(content, source),
        input_name=given["name"],
        input_shape=tuple(given["shape"]),
        layout=_one_of(source, "input.layout", given["layout"], ("NCHW", "NHWC")),
        dtype=_one_of(source, "input.dtype", given["dtype"], ("float32", "uint8")),
        color=_one_of(source, "input.color", given["color"], ("RGB", "BGR")),
        resize=_one_of(source, "input.resize", given["resize"], ("letterbox", "stretch")),
        pad=given.get("pad", 0),
        mean=tuple(given.get("mean", (0.0, 0.0, 0.0))),
        scale=tuple(given.get("scale", (1.0, 1.0, 1.0))),
        output_name=result["name"],
        output_shape=tuple(result["shape"]),
        strides=tuple(result.get("strides", ())),
    )


def _one_of(source: str, key: str, value: Any, choices: tuple[str, ...]) -> str:
    if value not in choices:
        raise SegmenterError(f"{source}: {key} = {value!r}", f"use one of: {', '.join(choices)}")
    return value


def _classes(content: dict[str, Any], source: str) -> tuple[int, ...]:
    """From ``labels`` (our names, "" = none) or ``label_set`` with ``label_count``."""
    try:
        if "labels" in content:
            return tuple(class_named(name).id if name else 0 for name in content["labels"])
        table = label_table(_one_of(source, "label_set", content["label_set"], LABEL_SETS))
    except ClassError as error:
        raise SegmenterError(f"{source}: {error.problem}", error.hint) from None
    count = content["label_count"]
    padded = np.zeros(max(count, len(table)), np.int64)
    padded[: len(table)] = table
    return tuple(int(c) for c in padded[:count])
