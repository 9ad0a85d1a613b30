"""Border: runs an ONNX model as its sidecar says (ONNX Runtime, OpenCV)."""

from __future__ import annotations

import hashlib
import os
from pathlib import Path

import cv2
import numpy as np
import onnxruntime
from jaxtyping import Float, UInt8

from ..errors import SegmenterError
from .sidecar import Sidecar, find_sidecar


class OnnxModel:
    """One ONNX model with its session, opened once and checked against its sidecar."""

    def __init__(self, path: Path | str, *, threads: int = 0) -> None:
        self.path = Path(path)
        if not self.path.is_file():
            raise SegmenterError(f"{self.path} does not exist", "give the path of an ONNX model")
        self.sidecar: Sidecar = find_sidecar(self.path)
        self.threads = threads or os.cpu_count() or 1
        self._session = _open_session(self.path, self.threads)
        self.provider = self._session.get_providers()[0]
        self._check_declared()

    def __call__(self, image: UInt8[np.ndarray, "height width 3"]) -> np.ndarray:
        """The model's output for an RGB image."""
        given = {self.sidecar.input_name: prepare(image, self.sidecar)}
        output = np.asarray(self._session.run([self.sidecar.output_name], given)[0])
        self._check_shape("output", self.sidecar.output_name, output.shape)
        return output

    def content_hash(self) -> str:
        """Hex digest of the model's bytes and of its sidecar."""
        digest = hashlib.sha256(self.path.read_bytes())
        digest.update(repr({**vars(self.sidecar), "source": ""}).encode())
        return digest.hexdigest()

    def describe(self) -> str:
        """Model, sidecar, execution provider and threads in one line."""
        where = f"{self.provider}, {self.threads} threads"
        return f"{self.path.name} ({self.sidecar.kind}; {self.sidecar.source}; {where})"

    def _check_declared(self) -> None:
        side = self.sidecar
        inputs = {i.name: i.shape for i in self._session.get_inputs()}
        outputs = {o.name: o.shape for o in self._session.get_outputs()}
        for what, name, found in (
            ("input", side.input_name, inputs),
            ("output", side.output_name, outputs),
        ):
            if name not in found:
                raise SegmenterError(
                    f"{self.path} has no {what} {name!r}, which {side.source} names; "
                    f"it has {', '.join(map(repr, found))}",
                    f"correct {what}.name in the sidecar",
                )
            self._check_shape(what, name, found[name])

    def _check_shape(self, what: str, name: str, found) -> None:
        """A dimension of the model that is no number is free."""
        expected = getattr(self.sidecar, f"{what}_shape")
        same = len(found) == len(expected) and all(
            not isinstance(f, int) or f == e for f, e in zip(found, expected, strict=True)
        )
        if not same:
            raise SegmenterError(
                f"{self.path}: {what} {name!r} has shape {list(found)}, {self.sidecar.source} "
                f"says {list(expected)}",
                f"correct {what}.shape in the sidecar, or take the model that it describes",
            )


def _open_session(path: Path, threads: int) -> onnxruntime.InferenceSession:
    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = threads
    options.log_severity_level = 3
    available = onnxruntime.get_available_providers()
    wanted = ("CUDAExecutionProvider", "CPUExecutionProvider")
    providers = [p for p in wanted if p in available]
    try:
        return onnxruntime.InferenceSession(str(path), options, providers=providers)
    except Exception as error:  # ONNX Runtime's own classes derive from Exception alone
        raise SegmenterError(
            f"{path} is not a model that ONNX Runtime can load: {str(error).splitlines()[0]}",
            "export it to ONNX again, or give another file",
        ) from None


def prepare(image: UInt8[np.ndarray, "height width 3"], sidecar: Sidecar) -> np.ndarray:
    """The image as the model wants it: size, channel order, numbers, layout."""
    height, width = sidecar.input_size
    if sidecar.resize == "letterbox":
        ratio = letterbox_ratio(image.shape[:2], sidecar)
        inner = (round(image.shape[1] * ratio), round(image.shape[0] * ratio))
        fitted = np.full((height, width, 3), sidecar.pad, np.uint8)
        fitted[: inner[1], : inner[0]] = cv2.resize(image, inner, interpolation=cv2.INTER_LINEAR)
    else:
        fitted = cv2.resize(image, (width, height), interpolation=cv2.INTER_LINEAR)
    if sidecar.color == "BGR":
        fitted = fitted[..., ::-1]
    if sidecar.dtype == "float32":
        fitted = (fitted - np.array(sidecar.mean, np.float32)) * np.array(sidecar.scale, np.float32)
    if sidecar.layout == "NCHW":
        fitted = fitted.transpose(2, 0, 1)
    return np.ascontiguousarray(fitted[None])


def letterbox_ratio(shape: tuple[int, ...], sidecar: Sidecar) -> float:
    """Pixels of the model's input per pixel of an image of ``shape`` (height, width)."""
    height, width = sidecar.input_size
    return min(height / shape[0], width / shape[1])


def class_maps(
    output: np.ndarray, sidecar: Sidecar, shape: tuple[int, int]
) -> tuple[np.ndarray, Float[np.ndarray, "height width"]]:
    """Our class a pixel of an image of ``shape``, and the confidence in it.

    ``labels`` outputs know no confidence: it is 0.75 everywhere.
    """
    table = np.array(sidecar.class_of, np.int32)
    size = (shape[1], shape[0])
    if sidecar.decoder == "labels":
        label = cv2.resize(output[0].astype(np.uint8), size, interpolation=cv2.INTER_NEAREST)
        return table[label], np.full(shape, 0.75, np.float32)
    label = output[0].argmax(0)
    top = np.take_along_axis(output[0], label[None], 0)
    confidence = (1.0 / np.exp(output[0] - top).sum(0)).astype(np.float32)
    # Edges come from depth: classes are enlarged without smoothing.
    label = cv2.resize(label.astype(np.uint8), size, interpolation=cv2.INTER_NEAREST)
    return table[label], cv2.resize(confidence, size, interpolation=cv2.INTER_LINEAR)
