"""Border: the TOML file beside an ONNX model that says what goes in and what comes out."""

from __future__ import annotations

import dataclasses
import math
import tomllib
from importlib import resources
from pathlib import Path
from typing import Any, Literal, get_args

from ..errors import SegmenterError
from .sidecar_checks import check_channels, known_keys, one_of
from .sidecar_labels import read_labels

ModelKind = Literal["boxes", "semantics", "instances", "panoptic"]
"""What a model finds; ``instances`` are boxes with masks."""
Decoder = Literal["yolox", "logits", "labels", "yolo_seg", "queries"]
"""How a model's outputs are read:

- ``yolox``: [1, cells, 5 + classes], raw.
- ``logits``: [1, classes, h, w]. ``labels``: [1, h, w].
- ``yolo_seg``: cells [1, 4 + classes + p, cells], prototypes [1, p, h, w].
- ``queries``: class logits [1, queries, classes + 1], the last for "no object", and mask logits
  [1, queries, h, w].
"""
ImageLayout = Literal["NCHW", "NHWC"]
"""Where the channels of an image or an image-like output are."""
InputType = Literal["float32", "float16", "uint8"]
ConstantType = Literal["float32", "int64", "int32", "bool"]
ColorOrder = Literal["RGB", "BGR"]
Resize = Literal["letterbox", "stretch"]
"""How an image comes to the input's size: top left and padded, or stretched."""
BoxUnit = Literal["pixels", "share"]
"""Of the boxes of ``yolo_seg``: pixels of the model's input, or shares of its size."""

ROLES: dict[Decoder, tuple[str, ...]] = {
    "yolox": ("output",),
    "logits": ("output",),
    "labels": ("output",),
    "yolo_seg": ("cells", "prototypes"),
    "queries": ("classes", "masks"),
}
"""The outputs that each decoder reads: ``[output]``, or a table ``[outputs.ROLE]`` for each."""
DECODERS: dict[ModelKind, tuple[Decoder, ...]] = {
    "boxes": ("yolox",),
    "semantics": ("logits", "labels"),
    "instances": ("yolo_seg",),
    "panoptic": ("queries",),
}
"""The decoders of each kind of model."""


@dataclasses.dataclass(frozen=True)
class Output:
    """One output that is read."""

    name: str
    shape: tuple[int, ...]
    layout: ImageLayout = "NCHW"
    strides: tuple[int, ...] = ()
    """Of the grids of a ``yolox`` output."""
    box_unit: BoxUnit = "pixels"


@dataclasses.dataclass(frozen=True)
class Constant:
    """An input that is the same for every image: an attention mask, the tokens of a task."""

    name: str
    shape: tuple[int, ...]
    dtype: ConstantType
    value: tuple[float, ...]
    """All elements, or one number for all of them."""


@dataclasses.dataclass(frozen=True)
class Sidecar:
    """How one ONNX model is fed and read."""

    source: str
    """Where it was found."""
    kind: ModelKind
    decoder: Decoder
    class_of: tuple[int, ...]
    """Our class for each of the model's labels; 0 = none."""
    is_thing: tuple[bool, ...]
    """Whether the model tells instances of that label apart."""
    input_name: str
    input_shape: tuple[int, ...]
    layout: ImageLayout
    dtype: InputType
    color: ColorOrder
    resize: Resize
    pad: int
    mean: tuple[float, ...]
    scale: tuple[float, ...]
    """Input = (pixel - mean) * scale, per channel; pixels are 0 to 255."""
    outputs: dict[str, Output]
    """By role; see `ROLES`."""
    constants: tuple[Constant, ...] = ()

    @property
    def input_size(self) -> tuple[int, int]:
        """Height and width that the model wants."""
        at = 2 if self.layout == "NCHW" else 1
        return self.input_shape[at], self.input_shape[at + 1]


def find_sidecar(model: Path) -> Sidecar:
    """The TOML file beside ``model``, or the shipped one of the same name.

    Raises:
        SegmenterError: There is none, or what it says is wrong.
    """
    beside = model.with_suffix(".toml")
    if beside.is_file():
        return parse_sidecar(beside.read_text("utf-8"), str(beside))
    shipped = resources.files("isr_jax.segmentation").joinpath("sidecars", f"{model.stem}.toml")
    if shipped.is_file():
        return parse_sidecar(shipped.read_text("utf-8"), f"shipped sidecars/{model.stem}.toml")
    raise SegmenterError(
        f"{model} has no sidecar: neither {beside} exists nor a shipped one",
        f"write {beside.name}: kind, decoder, label_set or labels, [input], [output] "
        f"(docs/segmenters.md; shipped examples: {', '.join(shipped_sidecars())})",
    )


def shipped_sidecars() -> list[str]:
    """File names of the sidecars that come with the package."""
    folder = resources.files("isr_jax.segmentation").joinpath("sidecars")
    return sorted(f.name for f in folder.iterdir() if f.name.endswith(".toml"))


def parse_sidecar(text: str, source: str) -> Sidecar:
    """Read and check a sidecar.

    Args:
        text: TOML.
        source: Names it in errors.

    Raises:
        SegmenterError: It is not TOML, lacks a key, or holds an unknown key or value.
    """
    try:
        content = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise SegmenterError(f"{source} is not TOML: {error}", "correct the file") from None
    try:
        return _from_toml(content, source)
    except KeyError as error:
        raise SegmenterError(f"{source} has no {error}", "add it") from None


def _from_toml(content: dict[str, Any], source: str) -> Sidecar:
    known_keys(source, content)
    kind: ModelKind = one_of(source, "kind", content["kind"], tuple(DECODERS))
    decoder: Decoder = one_of(source, "decoder", content["decoder"], DECODERS[kind])
    class_of, is_thing = read_labels(content, source)
    given = content["input"]
    sidecar = Sidecar(
        source=source,
        kind=kind,
        decoder=decoder,
        class_of=class_of,
        is_thing=is_thing,
        input_name=given["name"],
        input_shape=tuple(given["shape"]),
        layout=one_of(source, "input.layout", given["layout"], get_args(ImageLayout)),
        dtype=one_of(source, "input.dtype", given["dtype"], get_args(InputType)),
        color=one_of(source, "input.color", given["color"], get_args(ColorOrder)),
        resize=one_of(source, "input.resize", given["resize"], get_args(Resize)),
        pad=given.get("pad", 0),
        mean=_floats(given.get("mean", [0.0, 0.0, 0.0])),
        scale=_floats(given.get("scale", [1.0, 1.0, 1.0])),
        outputs=_outputs(content, ROLES[decoder], source),
        constants=tuple(_constant(c, source) for c in content.get("constants", ())),
    )
    shapes = {role: _channels_first(output) for role, output in sidecar.outputs.items()}
    check_channels(source, decoder, len(class_of), shapes)
    return sidecar


def _outputs(content: dict[str, Any], roles: tuple[str, ...], source: str) -> dict[str, Output]:
    if roles == ("output",):
        return {"output": _output(content["output"], source, "output")}
    tables = content["outputs"]
    missing = [r for r in roles if r not in tables]
    if missing:
        raise SegmenterError(
            f"{source} has no [outputs.{missing[0]}]",
            f"add it; this decoder reads {' and '.join(f'[outputs.{r}]' for r in roles)}",
        )
    return {role: _output(tables[role], source, f"outputs.{role}") for role in roles}


def _output(table: dict[str, Any], source: str, where: str) -> Output:
    return Output(
        name=table["name"],
        shape=tuple(table["shape"]),
        layout=one_of(
            source, f"{where}.layout", table.get("layout", "NCHW"), get_args(ImageLayout)
        ),
        strides=tuple(table.get("strides", ())),
        box_unit=one_of(
            source, f"{where}.box_unit", table.get("box_unit", "pixels"), get_args(BoxUnit)
        ),
    )


def _channels_first(output: Output) -> tuple[int, ...]:
    if output.layout == "NHWC" and len(output.shape) == 4:
        batch, height, width, channels = output.shape
        return batch, channels, height, width
    return output.shape


def _floats(values: list[float | int]) -> tuple[float, ...]:
    return tuple(float(v) for v in values)


def _constant(table: dict[str, Any], source: str) -> Constant:
    shape, value = tuple(table["shape"]), table["value"]
    if not shape:
        raise SegmenterError(
            f"{source}: constant {table['name']!r} has no axis", "its first axis is the batch, 1"
        )
    value = _floats(value if isinstance(value, list) else [value])
    size = math.prod(shape)
    if len(value) not in (1, size):
        raise SegmenterError(
            f"{source}: constant {table['name']!r} of shape {list(shape)} has {len(value)} values",
            f"give one number for all, or {size}",
        )
    dtypes = get_args(ConstantType)
    return Constant(
        table["name"],
        shape,
        one_of(source, "constants.dtype", table.get("dtype", "float32"), dtypes),
        value,
    )
