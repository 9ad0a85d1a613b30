"""What a sidecar must hold: known keys, known values, and shapes that fit its labels."""

from __future__ import annotations

from typing import Any, TypeVar

from ..errors import SegmenterError

Choice = TypeVar("Choice", bound=str)

_OUTPUT_KEYS = ("name", "shape", "layout", "strides", "box_unit")
_KEYS: dict[str, tuple[str, ...]] = {
    "": (
        *("kind", "decoder", "label_set", "label_order", "label_count", "labels"),
        *("input", "output", "outputs", "constants"),
    ),
    "input": ("name", "shape", "layout", "dtype", "color", "resize", "pad", "mean", "scale"),
    "constants": ("name", "shape", "dtype", "value"),
    "outputs": ("cells", "prototypes", "classes", "masks"),
}


def one_of(source: str, key: str, value: Any, choices: tuple[Choice, ...]) -> Choice:
    """``value``, if it is one of ``choices``.

    Raises:
        SegmenterError: It is none of them.
    """
    if value not in choices:
        raise SegmenterError(f"{source}: {key} = {value!r}", f"use one of: {', '.join(choices)}")
    return value


def known_keys(source: str, content: dict[str, Any]) -> None:
    """Refuse a misspelt key, which would else be a default that nobody chose.

    Raises:
        SegmenterError: A key is unknown.
    """
    tables = [("", content, _KEYS[""]), ("input.", content.get("input", {}), _KEYS["input"])]
    tables += [("constants.", c, _KEYS["constants"]) for c in content.get("constants", ())]
    tables += [("output.", content.get("output", {}), _OUTPUT_KEYS)]
    outputs = content.get("outputs", {})
    tables += [("outputs.", outputs, _KEYS["outputs"])]
    tables += [(f"outputs.{role}.", table, _OUTPUT_KEYS) for role, table in outputs.items()]
    for where, table, keys in tables:
        unknown = [key for key in table if key not in keys]
        if unknown:
            raise SegmenterError(
                f"{source}: unknown key {where}{unknown[0]}", f"use one of: {', '.join(keys)}"
            )


def check_channels(
    source: str, decoder: str, labels: int, shapes: dict[str, tuple[int, ...]]
) -> None:
    """Refuse outputs (by role, channels first) that cannot be of that many labels.

    Raises:
        SegmenterError: A shape does not fit the decoder and the labels.
    """
    if decoder == "yolox":
        expected = {"output": (None, None, 5 + labels)}
    elif decoder == "logits":
        expected = {"output": (None, labels, None, None)}
    elif decoder == "labels":
        expected = {"output": (None, None, None)}
    elif decoder == "yolo_seg":
        parts = shapes["prototypes"][1] if len(shapes["prototypes"]) == 4 else None
        channels = None if parts is None else 4 + labels + parts
        expected = {"cells": (None, channels, None), "prototypes": (None, parts, None, None)}
    else:
        queries = shapes["classes"][1] if len(shapes["classes"]) == 3 else None
        expected = {
            "classes": (None, queries, labels + 1),
            "masks": (None, queries, None, None),
        }
    for role, wanted in expected.items():
        found = shapes[role]
        if len(found) != len(wanted) or any(
            w not in (None, f) for w, f in zip(wanted, found, strict=True)
        ):
            text = ", ".join("*" if w is None else str(w) for w in wanted)
            raise SegmenterError(
                f"{source}: {role}.shape is {list(found)} (channels first), "
                f"{decoder} with {labels} labels has [{text}]",
                "correct the shape, the layout or the number of labels",
            )
