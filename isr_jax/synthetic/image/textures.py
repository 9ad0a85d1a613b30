"""Border: PIL. The image textures of a room in one array, so that one lookup finds any texel."""

from __future__ import annotations

import dataclasses
import io
from collections.abc import Sequence

import numpy as np
from jaxtyping import Float, Int, UInt8
from PIL import Image

from ...errors import LibraryError
from ...robot_model import Texture
from ..surface import Surface

_MAX_SIDE_PX = 512
"""Finer images are scaled down: at 2 m a pixel of a camera is 3 mm wide."""
_LEAST_MEAN = 0.05
_PAPER = np.full((1, 1, 3), 255, np.uint8)
"""The texture of what has none."""


@dataclasses.dataclass(frozen=True, eq=False)
class Atlas:
    """Every texture of a room, and which one each face wears."""

    texels: UInt8[np.ndarray, "texels 3"]
    """RGB, texture after texture, rows from the top."""
    face_image: Int[np.ndarray, "faces 3"]
    """First texel, height and width of the texture of each face."""
    face_uv: Float[np.ndarray, "faces 3 2"]
    """Of each corner; v upwards from the image's lower edge. 0 where there is none."""
    face_gain: Float[np.ndarray, "faces 3"]
    """Times the texel, in [0, 1], is the albedo: the colour of what has no texture, the tint of
    what has one."""


def atlas(surfaces: Sequence[Surface]) -> Atlas:
    """The textures of surfaces whose faces are counted one surface after the other.

    Raises:
        LibraryError: a texture is no image that can be read.
    """
    images = [_PAPER]
    places = {b"": (0, 1, 1)}
    columns: list[tuple[np.ndarray, np.ndarray, np.ndarray]] = []
    for surface in surfaces:
        image = np.tile(np.array(places[b""]), (len(surface.face_rgb), 1))
        uv = np.zeros((len(image), 3, 2), np.float32)
        gain = surface.face_rgb.astype(np.float32)
        if surface.uv is not None and surface.face_texture is not None:
            uv = surface.uv
            for row, texture in enumerate(surface.textures):
                if texture.content not in places:
                    start = sum(i.shape[0] * i.shape[1] for i in images)
                    images.append(_decoded(texture))
                    places[texture.content] = (start, *images[-1].shape[:2])
                start, height, width = places[texture.content]
                own = surface.face_texture == row
                image[own] = (start, height, width)
                flat = next(
                    i for i, p in zip(images, places.values(), strict=True) if p[0] == start
                )
                mean = flat.reshape(-1, 3).mean(0) / 255
                gain[own] /= np.maximum(mean, _LEAST_MEAN)
        columns.append((image.astype(np.int32), uv, gain))
    face_image, face_uv, face_gain = (np.concatenate(c) for c in zip(*columns, strict=True))
    texels = np.concatenate([i.reshape(-1, 3) for i in images])
    return Atlas(texels, face_image, face_uv, face_gain)


def _decoded(texture: Texture) -> UInt8[np.ndarray, "height width 3"]:
    try:
        with Image.open(io.BytesIO(texture.content)) as image:
            rgb = image.convert("RGB")
            rgb.thumbnail((_MAX_SIDE_PX, _MAX_SIDE_PX))
            return np.array(rgb, np.uint8)
    except OSError:
        problem = f"texture {texture.name} is no image that can be read"
        raise LibraryError(problem, "import that model again") from None
