"""MTL files of textured meshes, and the names under which images lie beside them.

An image lies beside its meshes as ``<stem>_<hash of its content><ending>``: equal images share
one file, and what reads the file gets the name without the hash back.
"""

from __future__ import annotations

import hashlib
import re

from .model import Texture

IMAGE_ENDINGS = (".png", ".jpg", ".jpeg")
_NAME = re.compile(r"([A-Za-z0-9_.\-]+)(\.[A-Za-z]+)")


def image_name(texture: Texture) -> str:
    """File name of a texture; raises ValueError for a name that does not fit every reader."""
    found = _NAME.fullmatch(texture.name)
    if found is None or found[2].lower() not in IMAGE_ENDINGS:
        allowed = f"letters, digits and _ . -, and ends with {', '.join(IMAGE_ENDINGS)}"
        raise ValueError(f"texture {texture.name!r}: its name has {allowed}")
    return f"{found[1]}_{_digest(texture.content)}{found[2]}"


def texture_of(file_name: str, content: bytes) -> Texture:
    """The texture that `image_name` has given this file name."""
    stem, dot, ending = file_name.rpartition(".")
    return Texture(stem.removesuffix("_" + _digest(content)) + dot + ending, content)


def mtl_text(material: str, image: str) -> str:
    """One white material with an image: readers multiply the two."""
    return f"newmtl {material}\nKd 1 1 1\nmap_Kd {image}\n"


def image_of_mtl(text: str) -> str:
    """File name of the image that an MTL of one material names, beside it; else ValueError."""
    names = [
        line.removeprefix("map_Kd ").strip()
        for line in text.splitlines()
        if line.startswith("map_Kd ")
    ]
    if len(names) != 1 or not _NAME.fullmatch(names[0]):
        raise ValueError("it names not one image that lies beside it")
    return names[0]


def _digest(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()[:10]
