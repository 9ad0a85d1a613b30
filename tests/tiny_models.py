"""Tiny ONNX models with known outputs, and their sidecars."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import onnx
from onnx import TensorProto, helper

from isr_jax.types import Camera, Frame

HEIGHT, WIDTH = 48, 64
CAMERA = Camera(60.0, 60.0, 32.0, 24.0, WIDTH, HEIGHT)

INPUT = """
[input]
name = "image"
shape = [1, 3, {height}, {width}]
layout = "NCHW"
dtype = "float32"
color = "RGB"
resize = "{resize}"
"""
"""Of a sidecar; to be formatted."""


def write_graph(path: Path, nodes, inputs, outputs, constants=()) -> Path:
    """An ONNX file; inputs and outputs are name -> shape, constants name -> array."""
    graph = helper.make_graph(
        nodes,
        "tiny",
        [helper.make_tensor_value_info(n, TensorProto.FLOAT, s) for n, s in inputs.items()],
        [helper.make_tensor_value_info(n, TensorProto.FLOAT, s) for n, s in outputs.items()],
        [onnx.numpy_helper.from_array(v, n) for n, v in dict(constants).items()],
    )
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 17)])
    model.ir_version = 8
    onnx.save(model, str(path))
    return path


def blind_model(
    path: Path, sidecar: str, outputs: dict[str, np.ndarray], input_shape, batch: int | str = 1
) -> Path:
    """A model that ignores the image and always gives ``outputs`` (without batch axis)."""
    nodes = [
        helper.make_node("ReduceSum", ["image", "axes"], ["sum"], keepdims=1),
        helper.make_node("Mul", ["sum", "zero"], ["nothing"]),
    ]
    constants = {"axes": np.array([1, 2, 3], np.int64), "zero": np.zeros(1, np.float32)}
    for name, value in outputs.items():
        shape = np.array([-1] + [1] * value.ndim, np.int64)
        constants |= {f"{name}_value": value[None].astype(np.float32), f"{name}_shape": shape}
        nodes += [
            helper.make_node("Reshape", ["nothing", f"{name}_shape"], [f"{name}_nothing"]),
            helper.make_node("Add", [f"{name}_value", f"{name}_nothing"], [name]),
        ]
    path.with_suffix(".toml").write_text(sidecar)
    shapes = {n: [batch, *v.shape] for n, v in outputs.items()}
    return write_graph(path, nodes, {"image": [batch, *input_shape]}, shapes, constants)


def frame(color=None, depth=None, T=None) -> Frame:
    """A frame of `CAMERA`, black and 1.5 m away by default."""
    color = np.zeros((HEIGHT, WIDTH, 3), np.uint8) if color is None else color
    depth = np.full((HEIGHT, WIDTH), 1.5, np.float32) if depth is None else depth
    return Frame(0, "0", color, depth, np.eye(4) if T is None else T, CAMERA)
