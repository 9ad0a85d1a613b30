"""Border: images of foreign models as textures that every viewer reads (Pillow)."""

from __future__ import annotations

import dataclasses
import io
import posixpath
import warnings

import numpy as np
from PIL import Image

from ....errors import LibraryError
from ....robot_model import Texture
from ..names import fit_name, shown
from .files import Files, locate
from .limits import ReadLimits

_ENDINGS = {"PNG": ".png", "JPEG": ".jpg"}
_JPEG_QUALITY = 90

Rgb = tuple[float, float, float]


@dataclasses.dataclass(frozen=True, eq=False)
class FoundImage:
    """A texture and its mean colour."""

    texture: Texture
    mean_rgb: Rgb
    note: str | None = None


@dataclasses.dataclass(eq=False)
class Images:
    """Images of one model; each is read once."""

    files: Files
    limits: ReadLimits
    notes: list[str] = dataclasses.field(default_factory=list)
    _seen: dict[str, FoundImage | None] = dataclasses.field(default_factory=dict)

    def find(self, folder: str, reference: str) -> FoundImage | None:
        """The image that a file in ``folder`` names; None, and a note, where there is none.

        Raises:
            LibraryError: The reference leads out of the files that were given.
        """
        name = locate(self.files, folder, reference)
        key = name or f"?{reference}"
        if key not in self._seen:
            self._seen[key] = self._read(name, reference)
        return self._seen[key]

    def _read(self, name: str | None, reference: str) -> FoundImage | None:
        if name is None:
            image = shown(reference).replace("\\", "/").rsplit("/", 1)[-1]
            self.notes.append(f"texture {image} is missing: the material's colour")
            return None
        try:
            found = texture_of(self.files.read(name), name, self.limits)
        except LibraryError as error:
            self.notes.append(f"{error.problem}: the material's colour")
            return None
        if found.note:
            self.notes.append(found.note)
        return found


def texture_of(content: bytes, name: str, limits: ReadLimits) -> FoundImage:
    """Decode an image, make it smaller where it is too large, and keep it as PNG or JPEG.

    Raises:
        LibraryError: No image, a damaged one, or one with too many pixels.
    """
    hint = "replace the image"
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            image = Image.open(io.BytesIO(content))
            if image.width * image.height > limits.max_image_px:
                problem = f"texture {shown(name)} has {image.width} x {image.height} pixels"
                raise LibraryError(problem, hint)
            kind = image.format or ""
            image.load()
            return _kept(image, kind, content, name, limits)
    except (OSError, ValueError, SyntaxError, EOFError, Image.DecompressionBombError) as error:
        said = " ".join(str(error).split())[:80]
        raise LibraryError(f"texture {shown(name)} cannot be decoded ({said})", hint) from None


def _kept(image, kind: str, content: bytes, name: str, limits: ReadLimits) -> FoundImage:
    stem = fit_name(posixpath.splitext(posixpath.basename(name))[0], "texture")
    small, note = image, None
    factor = limits.max_texture_px / max(image.size)
    if factor < 1:
        size = tuple(max(1, round(factor * side)) for side in image.size)
        small = _plain(image).resize(size, Image.Resampling.BOX)
        note = f"texture {shown(name)} made smaller: {image.width} x {image.height} pixels"
    if kind not in _ENDINGS or factor < 1 or image.mode == "CMYK":
        kind = "JPEG" if kind == "JPEG" else "PNG"
        small, buffer = _plain(small), io.BytesIO()
        if kind == "JPEG":
            small.convert("RGB").save(buffer, kind, quality=_JPEG_QUALITY)
        else:
            small.save(buffer, kind)
        content = buffer.getvalue()
    return FoundImage(Texture(stem + _ENDINGS[kind], content), _mean(small), note)


def _plain(image):
    """RGB, or RGBA where some of it is transparent."""
    transparent = "A" in image.getbands() or "transparency" in image.info
    return image.convert("RGBA" if transparent else "RGB")


def _mean(image) -> Rgb:
    """Mean colour of what is not transparent."""
    thumb = _plain(image).convert("RGBA").resize((32, 32), Image.Resampling.BOX)
    pixels = np.asarray(thumb, np.float64).reshape(-1, 4) / 255.0
    weight = pixels[:, 3:] + 1e-6
    red, green, blue = np.round((pixels[:, :3] * weight).sum(0) / weight.sum(), 4)
    return float(red), float(green), float(blue)


def encoded(image) -> bytes:
    """A decoded image that came inside a model file, as a file of its own."""
    buffer = io.BytesIO()
    kind = "JPEG" if image.format == "JPEG" else "PNG"
    image = image if image.mode in ("L", "RGB", "RGBA", "P") else _plain(image)
    image.convert("RGB").save(buffer, kind, quality=_JPEG_QUALITY) if kind == "JPEG" else (
        image.save(buffer, kind)
    )
    return buffer.getvalue()
