"""Results of stages on disk, keyed by what made them.

The key of a result is a hash of the stage's version, its settings and the contents it read. A
result is a tree of this package's own types, written as ``<stage>.json`` (the tree) and
``<stage>.npz`` (its arrays). Files appear whole or not at all; arrays come back as NumPy's.
"""

from __future__ import annotations

import contextlib
import dataclasses
import functools
import hashlib
import json
import os
import tempfile
import zipfile
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import IO, Any, TypeVar

import numpy as np

from ..errors import OutputError
from .store_tree import content_hash, decode, encode, is_record

__all__ = ["StageKey", "StageStore", "content_hash"]

_T = TypeVar("_T")
_FORMAT = 1
_KEY_MEMBER = "key"


@dataclasses.dataclass(frozen=True)
class StageKey:
    """What made a result."""

    stage: str
    version: int
    settings: tuple[tuple[str, str], ...]
    """(dotted name, value as JSON), sorted."""
    inputs: tuple[tuple[str, str], ...]
    """(name, content hash), sorted."""

    @functools.cached_property
    def digest(self) -> str:
        """Hex digest of everything above."""
        text = json.dumps([_FORMAT, *dataclasses.astuple(self)])
        return hashlib.blake2b(text.encode(), digest_size=16).hexdigest()


class StageStore:
    """One folder of results, the latest of each stage.

    Args:
        root: The folder; made when missing.

    Raises:
        OutputError: it cannot be made.
    """

    def __init__(self, root: Path) -> None:
        self.root = Path(root)
        with _writing(self.root):
            self.root.mkdir(parents=True, exist_ok=True)

    def key(self, stage: str, version: int, settings: Any, inputs: Mapping[str, str]) -> StageKey:
        """The key of a result of ``stage``.

        Args:
            stage: Name, also of the files.
            version: The stage package's ``VERSION``.
            settings: A settings dataclass or a (nested) dict of plain values.
            inputs: Content hash of everything that the stage reads, by name.
        """
        plain = dataclasses.asdict(settings) if is_record(settings) else dict(settings)
        flat = tuple(sorted((name, json.dumps(value)) for name, value in _flatten(plain)))
        return StageKey(stage, version, flat, tuple(sorted(inputs.items())))

    def save(self, stage: str, key: StageKey, value: Any) -> str:
        """Write a result; returns its `content_hash`, which goes into the next stage's key.

        Raises:
            OutputError: the folder cannot be written.
        """
        arrays: dict[str, np.ndarray] = {}
        tree = encode(value, arrays)
        digest = content_hash(value)
        head = {
            "format": _FORMAT,
            "key": {**dataclasses.asdict(key), "digest": key.digest},
            "content_hash": digest,
            "value": tree,
        }
        arrays_path, tree_path = self._paths(stage)
        with _writing(arrays_path), _whole_file(arrays_path) as file:
            _write_arrays(file, {_KEY_MEMBER: np.array(key.digest), **arrays})
        with _writing(tree_path), _whole_file(tree_path) as file:
            file.write(json.dumps(head, separators=(",", ":"), allow_nan=False).encode())
        return digest

    def load(self, stage: str, key: StageKey, type: type[_T]) -> _T | None:
        """The stored result, or None where there is none of this key.

        Raises `OutputError` where the files are damaged.
        """
        head = self._head(stage)
        if head is None or head["key"]["digest"] != key.digest:
            return None
        arrays_path, tree_path = self._paths(stage)
        with (
            _reading(arrays_path),
            arrays_path.open("rb") as file,  # np.load leaves its own open when it fails
            np.load(file, allow_pickle=False) as arrays,
        ):
            if str(arrays[_KEY_MEMBER]) != key.digest:
                return None  # a save that was killed between its two files
            value = decode(head["value"], arrays)
        if not isinstance(value, type) or content_hash(value) != head["content_hash"]:
            raise _damaged(tree_path, "its contents do not have the hash that it states")
        return value

    def stored_hash(self, stage: str, key: StageKey) -> str | None:
        """`content_hash` of the stored result without reading its arrays; None as in `load`.

        Raises:
            OutputError: the files are damaged.
        """
        head = self._head(stage)
        same = head is not None and head["key"]["digest"] == key.digest
        return head["content_hash"] if head is not None and same else None

    def explain(self, stage: str, key: StageKey) -> str:
        """What differs between ``key`` and that of the stored result, in words.

        Raises:
            OutputError: the files are damaged.
        """
        head = self._head(stage)
        if head is None:
            return f"{stage}: nothing is stored in {self.root}"
        stored = head["key"]
        if stored["digest"] == key.digest:
            return f"{stage}: the stored result matches"
        lines = []
        if stored["version"] != key.version:
            lines.append(f"version: stored {stored['version']}, now {key.version}")
        lines += _differences("setting", dict(stored["settings"]), dict(key.settings))
        lines += _differences("input", dict(stored["inputs"]), dict(key.inputs))
        return f"{stage}: " + "; ".join(lines)

    def _paths(self, stage: str) -> tuple[Path, Path]:
        return self.root / f"{stage}.npz", self.root / f"{stage}.json"

    def _head(self, stage: str) -> dict[str, Any] | None:
        arrays_path, tree_path = self._paths(stage)
        if not (tree_path.exists() and arrays_path.exists()):
            return None
        with _reading(tree_path):
            head = json.loads(tree_path.read_bytes())
            if head["format"] != _FORMAT:
                return None
            _ = head["key"]["digest"], head["content_hash"], head["value"]
            return head


def _flatten(tree: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    for name, value in tree.items():
        if isinstance(value, Mapping):
            yield from _flatten(value, f"{prefix}{name}.")
        else:
            yield f"{prefix}{name}", value


def _differences(kind: str, stored: dict[str, str], now: dict[str, str]) -> list[str]:
    names = sorted({n for n in stored | now if stored.get(n) != now.get(n)})
    return [
        f"{kind} {n}: stored {stored.get(n, 'nothing')}, now {now.get(n, 'nothing')}" for n in names
    ]


def _write_arrays(file: IO[bytes], arrays: Mapping[str, np.ndarray]) -> None:
    # np.savez stamps the time of day; equal results should be equal files.
    with zipfile.ZipFile(file, "w", zipfile.ZIP_STORED) as archive:
        for name, array in arrays.items():
            info = zipfile.ZipInfo(f"{name}.npy")
            with archive.open(info, "w", force_zip64=True) as member:
                np.lib.format.write_array(member, array, allow_pickle=False)


@contextlib.contextmanager
def _whole_file(path: Path) -> Iterator[IO[bytes]]:
    """A file that takes ``path``'s place only once it is complete."""
    with tempfile.NamedTemporaryFile(
        dir=path.parent, prefix=f".{path.name}.", delete=False
    ) as file:
        try:
            yield file
            file.flush()
            os.fsync(file.fileno())
        except BaseException:
            os.unlink(file.name)
            raise
    os.replace(file.name, path)


@contextlib.contextmanager
def _writing(path: Path) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        raise OutputError(
            f"{path} cannot be written: {error.strerror or error}",
            "choose an output folder that you may write to and that has space",
        ) from None


@contextlib.contextmanager
def _reading(path: Path) -> Iterator[None]:
    try:
        yield
    except (OSError, ValueError, KeyError, TypeError, EOFError, zipfile.BadZipFile) as error:
        raise _damaged(path, f"{type(error).__name__}: {error}") from error


def _damaged(path: Path, why: str) -> OutputError:
    return OutputError(
        f"the stored result {path} is damaged ({why})",
        "delete it, or compute it anew with --from and the name of its stage",
    )
