"""Border: runs an ONNX model as its sidecar says (ONNX Runtime)."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from jaxtyping import UInt8

from ..errors import SegmenterError
from ..runtime.cores import usable_cores
from .model_image import prepare
from .onnx_session import open_session
from .sidecar import Constant, Sidecar, find_sidecar

_MAX_BATCH = 8
"""Images that go in at once where the model leaves the number open; bounds the memory."""


class OnnxModel:
    """One ONNX model with its session, opened once and checked against its sidecar.

    Raises:
        SegmenterError: There is no such model or no sidecar, or the two do not fit each other.
    """

    def __init__(self, path: Path | str, *, provider: str = "auto", threads: int = 0) -> None:
        self.path = Path(path)
        if not self.path.is_file():
            raise SegmenterError(f"{self.path} does not exist", "give the path of an ONNX model")
        self.sidecar: Sidecar = find_sidecar(self.path)
        self.threads = threads or usable_cores()
        self._session = open_session(self.path, provider=provider, threads=threads)
        self.provider: str = self._session.get_providers()[0]
        self._names = {o.name: role for role, o in self.sidecar.outputs.items()}
        self.batch_size = self._check_declared()
        self._constants = {c.name: _array(c) for c in self.sidecar.constants}

    def __call__(self, image: UInt8[np.ndarray, "height width 3"]) -> dict[str, np.ndarray]:
        """The outputs for an RGB image by their roles, without batch axis; see `Sidecar`."""
        return self.batch([image])[0]

    def batch(
        self, images: Sequence[UInt8[np.ndarray, "height width 3"]]
    ) -> list[dict[str, np.ndarray]]:
        """The outputs of each image. They go in together as far as the model takes several.

        Raises:
            SegmenterError: The model failed on them.
        """
        found, size = [], self.batch_size or min(len(images), _MAX_BATCH)
        for start in range(0, len(images), max(size, 1)):
            some = [prepare(image, self.sidecar) for image in images[start : start + size]]
            spare = size - len(some) if self.batch_size else 0
            outputs = self._run(np.stack([*some, *some[-1:] * spare]))
            found += [{r: v[k] for r, v in outputs.items()} for k in range(len(some))]
        return found

    def _run(self, fed: np.ndarray) -> dict[str, np.ndarray]:
        given = {n: _repeated(v, len(fed)) for n, v in self._constants.items()}
        try:
            outputs = self._session.run([*self._names], {self.sidecar.input_name: fed, **given})
        except Exception as error:  # ONNX Runtime's own classes derive from Exception alone
            raise SegmenterError(
                f"{self.path} failed on {len(fed)} images: {str(error).splitlines()[0]}",
                f"compare {self.sidecar.source} with what the model takes",
            ) from None
        arrays = {name: np.asarray(v) for name, v in zip(self._names, outputs, strict=True)}
        for name, array in arrays.items():
            expected = (len(fed), *self.sidecar.outputs[self._names[name]].shape[1:])
            self._check_shape("output", name, array.shape, expected)
        return {self._names[name]: array for name, array in arrays.items()}

    def content_hash(self) -> str:
        """Hex digest of the model's bytes and of its sidecar."""
        digest = hashlib.sha256(self.path.read_bytes())
        digest.update(repr({**vars(self.sidecar), "source": ""}).encode())
        return digest.hexdigest()

    def describe(self) -> str:
        """Model, sidecar, execution provider and threads in one line."""
        where = f"{self.provider}, {self.threads} threads"
        return f"{self.path.name} ({self.sidecar.kind}; {self.sidecar.source}; {where})"

    def _check_declared(self) -> int:
        """Compare names and shapes with the sidecar's; returns the batch size, 0 = any."""
        side = self.sidecar
        inputs = {i.name: i.shape for i in self._session.get_inputs()}
        outputs = {o.name: o.shape for o in self._session.get_outputs()}
        expected = {side.input_name: side.input_shape, **{c.name: c.shape for c in side.constants}}
        results = {o.name: o.shape for o in side.outputs.values()}
        declared = [inputs.get(n) for n in expected] + [outputs.get(n) for n in results]
        batch = next((d[0] for d in declared if d and isinstance(d[0], int)), 0)
        for what, found, shapes in (("input", inputs, expected), ("output", outputs, results)):
            for name, shape in shapes.items():
                self._check_one(what, name, found, (batch or shape[0], *shape[1:]))
        spare = [name for name in inputs if name not in expected]
        if spare:
            raise SegmenterError(
                f"{self.path} also wants the input {spare[0]!r} {inputs[spare[0]]}, which "
                f"{side.source} does not give",
                "add it to the sidecar as [[constants]]",
            )
        return batch

    def _check_one(
        self, what: str, name: str, found: dict[str, list], shape: tuple[int, ...]
    ) -> None:
        if name not in found:
            raise SegmenterError(
                f"{self.path} has no {what} {name!r}, which {self.sidecar.source} names; it has "
                + ", ".join(f"{n!r} {s}" for n, s in found.items()),
                f"correct the {what}'s name in the sidecar",
            )
        self._check_shape(what, name, found[name], shape)

    def _check_shape(
        self, what: str, name: str, found: Sequence, expected: tuple[int, ...]
    ) -> None:
        """A dimension of the model that is no number is free."""
        same = len(found) == len(expected) and all(
            not isinstance(f, int) or f == e for f, e in zip(found, expected, strict=True)
        )
        if not same:
            raise SegmenterError(
                f"{self.path}: {what} {name!r} has shape {list(found)}, {self.sidecar.source} "
                f"says {list(expected)}",
                f"correct the {what}'s shape in the sidecar, or take the model that it describes",
            )


def _array(constant: Constant) -> np.ndarray:
    value = np.array(constant.value, constant.dtype)
    if len(value) == 1:
        return np.full(constant.shape, value[0])
    return value.reshape(constant.shape)


def _repeated(constant: np.ndarray, count: int) -> np.ndarray:
    """The constant for each of so many images."""
    return np.repeat(constant, count // len(constant), 0)
