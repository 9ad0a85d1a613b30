"""Border: opens an ONNX model on the hardware that was asked for (ONNX Runtime)."""

from __future__ import annotations

from pathlib import Path

import onnxruntime

from ..errors import SegmenterError
from ..runtime.cores import usable_cores

PROVIDERS = {
    "cpu": "CPUExecutionProvider",
    "cuda": "CUDAExecutionProvider",
    "tensorrt": "TensorrtExecutionProvider",
    "migraphx": "MIGraphXExecutionProvider",
    "openvino": "OpenVINOExecutionProvider",
    "directml": "DmlExecutionProvider",
    "coreml": "CoreMLExecutionProvider",
}
"""ONNX Runtime's name of each choice; ``auto`` is CUDA where it works, else the CPU."""


def open_session(
    path: Path, *, provider: str = "auto", threads: int = 0
) -> onnxruntime.InferenceSession:
    """A session for the model at ``path``.

    Args:
        path: An ONNX file.
        provider: One of `PROVIDERS` or ``auto``. One that was asked for by name runs the model or
            is an error; operators it has no kernel for run on the CPU, as always in ONNX Runtime.
        threads: Of the CPU; 0 = all cores.

    Raises:
        SegmenterError: The file is no model, or the provider is not there or does not start.
    """
    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = threads or usable_cores()
    options.log_severity_level = 3
    wanted = _wanted(provider)
    try:
        session = onnxruntime.InferenceSession(str(path), options, providers=wanted)
    except Exception as error:  # ONNX Runtime's own classes derive from Exception alone
        raise SegmenterError(
            f"{path} is not a model that ONNX Runtime can load: {str(error).splitlines()[0]}",
            "export it to ONNX again, or give another file",
        ) from None
    found = session.get_providers()[0]
    if provider != "auto" and found != wanted[0]:
        raise SegmenterError(
            f"{wanted[0]} did not start for {path.name}: ONNX Runtime fell back to {found}",
            "install the driver and libraries that it needs, or set "
            "segmentation.onnx_provider=auto",
        )
    return session


def _wanted(provider: str) -> list[str]:
    cpu, available = PROVIDERS["cpu"], onnxruntime.get_available_providers()
    if provider == "auto":
        return [p for p in (PROVIDERS["cuda"], cpu) if p in available]
    if provider not in PROVIDERS:
        raise SegmenterError(
            f"unknown execution provider {provider!r}",
            f"use one of: auto, {', '.join(PROVIDERS)}",
        )
    name = PROVIDERS[provider]
    if name not in available:
        raise SegmenterError(
            f"ONNX Runtime {onnxruntime.__version__} has no {name} here; it has "
            f"{', '.join(available)}",
            "install the build of ONNX Runtime that has it, or set segmentation.onnx_provider=auto",
        )
    return [name] if name == cpu else [name, cpu]
