"""Border: textures as PNG, the one image format that MuJoCo reads (PIL)."""

from __future__ import annotations

import io

from PIL import Image

from ..errors import OutputError
from .model import Texture


def as_png(texture: Texture) -> Texture:
    """The same image as PNG of three channels; a PNG stays as it is, byte for byte.

    Raises:
        OutputError: the content is no image.
    """
    if texture.name.lower().endswith(".png"):
        return texture
    written = io.BytesIO()
    try:
        with Image.open(io.BytesIO(texture.content)) as image:
            image.convert("RGB").save(written, "PNG")
    except OSError:
        problem = f"texture {texture.name} is no image that can be read"
        raise OutputError(problem, "import that model again") from None
    return Texture(texture.name.rpartition(".")[0] + ".png", written.getvalue())
