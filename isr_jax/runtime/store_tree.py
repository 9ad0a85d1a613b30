"""Trees of this package's types as JSON and named arrays, and their content hash."""

from __future__ import annotations

import dataclasses
import functools
import hashlib
import importlib
from collections.abc import Mapping
from typing import Any

import jax
import numpy as np

_PACKAGE = "isr_jax."
_MODULES = ("types", "library.cad_models", "robot_model.model")
"""Only classes of these modules are ever made from a stored file."""


def content_hash(value: Any) -> str:
    """Hex digest of a tree of this package's types; the same for NumPy and JAX arrays."""
    digest = hashlib.blake2b(digest_size=16)
    _feed(digest, value)
    return digest.hexdigest()


def _feed(digest: Any, value: Any) -> None:
    if isinstance(value, (jax.Array, np.ndarray, np.generic)):
        array = _little_endian(np.asarray(value))
        digest.update(f"array {array.dtype.str} {array.shape};".encode())
        digest.update(np.atleast_1d(array).data.cast("B") if array.size else b"")
    elif is_record(value):
        fields = dataclasses.fields(value)
        digest.update(f"{_class_name(type(value))} {len(fields)};".encode())
        for field in fields:
            digest.update(f"{field.name}=".encode())
            _feed(digest, getattr(value, field.name))
    elif isinstance(value, dict):
        digest.update(f"dict {len(value)};".encode())
        for name, item in value.items():
            _feed(digest, name)
            _feed(digest, item)
    elif isinstance(value, (tuple, list)):
        digest.update(f"{type(value).__name__} {len(value)};".encode())
        for item in value:
            _feed(digest, item)
    elif value is None or isinstance(value, (bool, int, float, str)):
        text = repr(value).encode()
        digest.update(f"{type(value).__name__} {len(text)}:".encode() + text)
    else:
        raise TypeError(f"{type(value).__name__} is no type that the store knows")


def encode(value: Any, arrays: dict[str, np.ndarray]) -> Any:
    """The tree as JSON; arrays move to ``arrays`` and leave their names."""
    if isinstance(value, (jax.Array, np.ndarray, np.generic)):
        name = f"a{len(arrays)}"
        arrays[name] = _little_endian(np.asarray(value))
        return {"$": "scalar" if isinstance(value, np.generic) else "array", "name": name}
    if is_record(value):
        fields = {f.name: getattr(value, f.name) for f in dataclasses.fields(value)}
        encoded = {name: encode(item, arrays) for name, item in fields.items()}
        return {"$": _class_name(type(value)), "fields": encoded}
    if isinstance(value, dict):
        pairs = [[encode(k, arrays), encode(v, arrays)] for k, v in value.items()]
        return {"$": "dict", "items": pairs}
    if isinstance(value, tuple):
        return {"$": "tuple", "items": [encode(item, arrays) for item in value]}
    if isinstance(value, list):
        return [encode(item, arrays) for item in value]
    if isinstance(value, float) and not np.isfinite(value):
        return {"$": "float", "value": repr(value)}
    if value is None or isinstance(value, (bool, int, float, str)):
        return value
    raise TypeError(f"{type(value).__name__} is no type that the store knows")


def decode(node: Any, arrays: Mapping[str, np.ndarray]) -> Any:
    """The inverse of `encode`; only classes of `_MODULES` are ever made."""
    if isinstance(node, list):
        return [decode(item, arrays) for item in node]
    if not isinstance(node, dict):
        return node
    kind = node["$"]
    if kind == "array":
        return arrays[node["name"]]
    if kind == "scalar":
        return arrays[node["name"]][()]
    if kind == "float":
        return float(node["value"])
    if kind == "tuple":
        return tuple(decode(item, arrays) for item in node["items"])
    if kind == "dict":
        return {decode(k, arrays): decode(v, arrays) for k, v in node["items"]}
    cls = _classes()[kind]
    return cls(**{name: decode(item, arrays) for name, item in node["fields"].items()})


@functools.cache
def _classes() -> dict[str, type]:
    """Every dataclass that may be stored, by its name within this package."""
    modules = [importlib.import_module(_PACKAGE + name) for name in _MODULES]
    found = [v for m in modules for v in vars(m).values() if isinstance(v, type)]
    own = [c for c in found if dataclasses.is_dataclass(c) and c.__module__.startswith(_PACKAGE)]
    return {f"{c.__module__.removeprefix(_PACKAGE)}.{c.__name__}": c for c in own}


def _class_name(cls: type) -> str:
    name = f"{cls.__module__.removeprefix(_PACKAGE)}.{cls.__name__}"
    if name not in _classes():
        raise TypeError(f"{name} is no type that the store knows")
    return name


def is_record(value: Any) -> bool:
    """Whether a value is a dataclass (an `eqx.Module` is one)."""
    return dataclasses.is_dataclass(value) and not isinstance(value, type)


def _little_endian(array: np.ndarray) -> np.ndarray:
    if array.dtype.hasobject:
        raise TypeError("an array of Python objects cannot be stored")
    return np.ascontiguousarray(array, array.dtype.newbyteorder("<")).reshape(array.shape)
