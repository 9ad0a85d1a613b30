"""Border: colours of visuals at points of their faces: plain, or from a texture (PIL)."""

from __future__ import annotations

import io
from collections.abc import Sequence

import numpy as np
from jaxtyping import Float, Int
from PIL import Image, UnidentifiedImageError

from ...robot_model import Texture, Visual

_MAX_SIDE = 1024
"""Pixels of a decoded texture; finer ones are scaled down."""


class Paint:
    """Colour and opacity of each visual of a model."""

    def __init__(self, visuals: Sequence[Visual]) -> None:
        self._rgba = np.array([v.rgba for v in visuals], np.float64).reshape(-1, 4)
        self._images: dict[int, np.ndarray] = {}
        self._uv: dict[int, np.ndarray] = {}
        for i, visual in enumerate(visuals):
            if visual.texture is None or visual.mesh.uv is None:
                continue
            image = decoded(visual.texture)
            if image is not None:
                self._images[i], self._uv[i] = image, visual.mesh.uv

    def at(
        self,
        visual: Int[np.ndarray, " points"],
        face: Int[np.ndarray, " points"],
        corners: Float[np.ndarray, "points 3 3"],
        points: Float[np.ndarray, "points 3"],
    ) -> tuple[Float[np.ndarray, "points 3"], Float[np.ndarray, " points"]]:
        """Colour (RGB, 0..255) and opacity (0..1).

        Args:
            visual: Whose surface it is.
            face: Of that visual's mesh.
            corners: Of that face, in the frame of the points.
            points: On the faces.
        """
        color, alpha = 255 * self._rgba[visual, :3], self._rgba[visual, 3].copy()
        for i, image in self._images.items():
            mine = visual == i
            if not mine.any():
                continue
            weight = barycentric(corners[mine], points[mine])
            uv = np.einsum("pk,pkc->pc", weight, self._uv[i][face[mine]])
            texel = _sampled(image, uv)
            color[mine], alpha[mine] = texel[:, :3], alpha[mine] * texel[:, 3] / 255
        return color, alpha


def decoded(texture: Texture) -> np.ndarray | None:
    """RGBA image [height, width, 4], float; None where the file is no image PIL can read."""
    try:
        with Image.open(io.BytesIO(texture.content)) as image:
            image.thumbnail((_MAX_SIDE, _MAX_SIDE))
            return np.asarray(image.convert("RGBA"), np.float64)
    except (UnidentifiedImageError, OSError, ValueError, Image.DecompressionBombError):
        return None  # the visual keeps its mean colour


def barycentric(
    corners: Float[np.ndarray, "points 3 3"], points: Float[np.ndarray, "points 3"]
) -> Float[np.ndarray, "points 3"]:
    """Weights of the three corners of a triangle at a point of its plane."""
    a, b, c = corners[:, 0].astype(np.float64), corners[:, 1], corners[:, 2]
    u, v, w = b - a, c - a, points - a
    uu, uv, vv = (np.sum(p * q, -1) for p, q in ((u, u), (u, v), (v, v)))
    wu, wv = np.sum(w * u, -1), np.sum(w * v, -1)
    area = np.maximum(uu * vv - uv * uv, 1e-30)
    s, t = (vv * wu - uv * wv) / area, (uu * wv - uv * wu) / area
    return np.clip(np.stack([1 - s - t, s, t], -1), 0, 1)


def _sampled(image: np.ndarray, uv: np.ndarray) -> np.ndarray:
    """Nearest texels; coordinates repeat, v points up."""
    height, width = image.shape[:2]
    column = np.floor(uv[:, 0] * width).astype(np.int64) % width
    row = np.floor((1 - uv[:, 1]) * height).astype(np.int64) % height
    return image[row, column]
