"""glTF 2.0 in one binary file (GLB): nodes, triangles, materials and images from plain arrays.

Colours of the scene are sRGB; glTF wants factors and vertex colours linear, and images as they
are. Equal arrays, materials and images are stored once.
"""

from __future__ import annotations

import json
import struct
from typing import Any

import numpy as np

from ..robot_model import Texture
from ..types import Mesh

_FLOAT, _UINT16, _UINT32 = 5126, 5123, 5125
_VERTICES, _INDICES = 34962, 34963
_REPEAT, _LINEAR, _MIPMAPPED = 10497, 9729, 9987
Rgba = tuple[float, float, float, float]


def linear_of_srgb(values: np.ndarray) -> np.ndarray:
    """Linear intensities of sRGB values, both in [0, 1] (IEC 61966-2-1)."""
    values = np.asarray(values, np.float64)
    return np.where(values <= 0.04045, values / 12.92, ((values + 0.055) / 1.055) ** 2.4)


class GlbFile:
    """Collects a tree of nodes; `content` is the file."""

    def __init__(self) -> None:
        self._tree: dict[str, list] = {
            key: []
            for key in (
                *("nodes", "meshes", "materials", "textures", "images", "samplers"),
                *("accessors", "bufferViews"),
            )
        }
        self._roots: list[int] = []
        self._binary = bytearray()
        self._known: dict[Any, int] = {}

    def add_node(self, name: str, parent: int | None, T: np.ndarray) -> int:
        """A node at ``T`` in its parent's frame; None stands for the scene."""
        node: dict[str, Any] = {"name": name}
        if not np.array_equal(T, np.eye(4)):
            node["matrix"] = np.asarray(T, np.float64).T.ravel().tolist()
        row = self._append("nodes", node)
        siblings = self._roots
        if parent is not None:
            siblings = self._tree["nodes"][parent].setdefault("children", [])
        siblings.append(row)
        return row

    def set_mesh(
        self, node: int, mesh: Mesh, rgba: Rgba, texture: Texture | None, roughness: float
    ) -> None:
        """Show triangles at a node, each vertex in its own colour where the mesh has colours.

        Args:
            node: From `add_node`.
            mesh: In the node's frame; vertices are split where the uv of its corners differ.
            rgba: sRGB, and opacity; multiplies vertex colours and texture.
            texture: For the mesh's uv.
            roughness: 0 = mirror, 1 = matt.
        """
        uv, faces = None, np.asarray(mesh.faces)
        rows = np.arange(len(mesh.vertices))
        if texture is not None and mesh.uv is not None:
            corners = np.column_stack([faces.reshape(-1, 1), mesh.uv.reshape(-1, 2)])
            split, index = np.unique(corners, axis=0, return_inverse=True)
            rows, faces = split[:, 0].astype(np.int64), index.reshape(faces.shape)
            uv = (split[:, 1:] * [1, -1] + [0, 1]).astype(np.float32)  # glTF's v points down
        attributes = {"POSITION": self._positions(np.asarray(mesh.vertices, np.float32)[rows])}
        if mesh.normals is not None:
            attributes["NORMAL"] = self._floats(np.asarray(mesh.normals, np.float32)[rows])
        if uv is not None:
            attributes["TEXCOORD_0"] = self._floats(uv)
        elif mesh.colors is not None:
            attributes["COLOR_0"] = self._colors(mesh.colors[rows])
        primitive = {
            "attributes": attributes,
            "indices": self._accessor(faces.astype(np.uint32).ravel(), _UINT32, _INDICES),
            "material": self._material(rgba, texture if uv is not None else None, roughness),
        }
        name = self._tree["nodes"][node]["name"]
        mesh_row = self._append("meshes", {"name": name, "primitives": [primitive]})
        self._tree["nodes"][node]["mesh"] = mesh_row

    def content(self) -> bytes:
        """The bytes of the file."""
        tree: dict[str, Any] = {
            "asset": {"version": "2.0", "generator": "isr_jax"},
            "scene": 0,
            "scenes": [{"nodes": self._roots}],
            **{key: rows for key, rows in self._tree.items() if rows},
        }
        chunks = []
        if self._binary:
            tree["buffers"] = [{"byteLength": len(self._binary)}]
            chunks = [(b"BIN\0", bytes(self._binary))]
        text = json.dumps(tree, separators=(",", ":")).encode()
        chunks.insert(0, (b"JSON", text + b" " * (-len(text) % 4)))
        body = b"".join(struct.pack("<I", len(data)) + kind + data for kind, data in chunks)
        return struct.pack("<4sII", b"glTF", 2, 12 + len(body)) + body

    def _append(self, key: str, entry: dict[str, Any]) -> int:
        self._tree[key].append(entry)
        return len(self._tree[key]) - 1

    def _once(self, key: str, mark: Any, entry: dict[str, Any]) -> int:
        """Row of an entry that is added unless one of the same mark is there."""
        if (key, mark) not in self._known:
            self._known[key, mark] = self._append(key, entry)
        return self._known[key, mark]

    def _view(self, data: bytes, target: int | None) -> int:
        if ("view", target, data) not in self._known:
            view = {"buffer": 0, "byteOffset": len(self._binary), "byteLength": len(data)}
            if target is not None:
                view["target"] = target
            self._binary += data + b"\0" * (-len(data) % 4)
            self._known["view", target, data] = self._append("bufferViews", view)
        return self._known["view", target, data]

    def _accessor(self, values: np.ndarray, component: int, target: int, **more: Any) -> int:
        view = self._view(np.ascontiguousarray(values).tobytes(), target)
        kind = "SCALAR" if values.ndim == 1 else f"VEC{values.shape[1]}"
        entry = {"bufferView": view, "componentType": component, "count": len(values), "type": kind}
        return self._once("accessors", (view, kind, component), entry | more)

    def _positions(self, values: np.ndarray) -> int:
        low, high = values.min(0).tolist(), values.max(0).tolist()
        return self._accessor(values, _FLOAT, _VERTICES, min=low, max=high)

    def _floats(self, values: np.ndarray) -> int:
        return self._accessor(values, _FLOAT, _VERTICES)

    def _colors(self, srgb: np.ndarray) -> int:
        # 8 bits are too few for dark colours once they are linear.
        linear = np.ones((len(srgb), 4))
        linear[:, :3] = linear_of_srgb(srgb / 255)
        values = np.rint(65535 * linear).astype(np.uint16)
        return self._accessor(values, _UINT16, _VERTICES, normalized=True)

    def _material(self, rgba: Rgba, texture: Texture | None, roughness: float) -> int:
        factor = [*linear_of_srgb(np.clip(rgba[:3], 0, 1)).round(6).tolist(), float(rgba[3])]
        surface: dict[str, Any] = {"baseColorFactor": factor}
        if texture is not None:
            surface["baseColorTexture"] = {"index": self._texture(texture)}
        # glTF's default is metal, which viewers without surroundings show black.
        surface |= {"metallicFactor": 0.0, "roughnessFactor": roughness}
        entry: dict[str, Any] = {"pbrMetallicRoughness": surface}
        if rgba[3] < 1:
            entry["alphaMode"] = "BLEND"
        return self._once("materials", json.dumps(entry), entry)

    def _texture(self, texture: Texture) -> int:
        kind = "image/png" if texture.name.lower().endswith(".png") else "image/jpeg"
        view = self._view(texture.content, None)
        entry = {"name": texture.name, "mimeType": kind, "bufferView": view}
        image = self._once("images", view, entry)
        repeated = {
            "magFilter": _LINEAR,
            "minFilter": _MIPMAPPED,
            "wrapS": _REPEAT,
            "wrapT": _REPEAT,
        }
        sampler = self._once("samplers", "repeat", repeated)
        return self._once("textures", image, {"source": image, "sampler": sampler})
