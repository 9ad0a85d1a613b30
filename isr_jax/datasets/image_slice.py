"""An image that lies within a larger file, as in ScanNet's ``.sens``."""

from __future__ import annotations

import dataclasses
import zlib
from pathlib import Path
from typing import Literal

import numpy as np
from jaxtyping import UInt8, UInt16

from ..errors import FrameError

Coding = Literal["encoded", "raw_rgb", "raw_ushort", "zlib_ushort"]
"""JPEG or PNG; 3 bytes per pixel; 16 bits per pixel, little-endian; the same, deflated."""


@dataclasses.dataclass(frozen=True)
class ImageSlice:
    """Bytes of a file that hold one image."""

    path: Path
    offset: int
    size: int
    """Bytes, as stored."""
    coding: Coding
    width: int
    height: int

    @property
    def name(self) -> str:
        """Unique within the file, for messages and hashes."""
        return f"{self.path.name}@{self.offset}"

    def __str__(self) -> str:
        return f"{self.path} at byte {self.offset}"

    def read_bytes(self) -> bytes:
        """The stored bytes.

        Raises:
            FrameError: the file is gone or has become shorter.
        """
        try:
            with self.path.open("rb") as file:
                file.seek(self.offset)
                data = file.read(self.size)
        except OSError as error:
            raise FrameError(f"{self}: {error.strerror}", "restore the file or skip it") from None
        if len(data) < self.size:
            raise FrameError(
                f"{self}: {len(data)} of {self.size} bytes are left", "copy the file again"
            )
        return data

    def rgb(self) -> UInt8[np.ndarray, "height width 3"]:
        """The pixels of a ``raw_rgb`` image.

        Raises:
            FrameError: as `read_bytes`.
        """
        pixels = _filling(self, self.read_bytes(), 3 * self.width * self.height)
        return np.frombuffer(pixels, np.uint8).reshape(self.height, self.width, 3).copy()

    def depth(self) -> UInt16[np.ndarray, "height width"]:
        """The stored values of a ``raw_ushort`` or ``zlib_ushort`` image.

        Raises:
            FrameError: as `read_bytes`, or the bytes are damaged.
        """
        expected = 2 * self.width * self.height
        data = self.read_bytes()
        if self.coding == "zlib_ushort":
            data = _inflated(self, data, expected)
        values = np.frombuffer(_filling(self, data, expected), "<u2")
        return values.astype(np.uint16).reshape(self.height, self.width)


def _inflated(image: ImageSlice, data: bytes, expected: int) -> bytes:
    """Never more than one byte beyond ``expected``: what is stored may claim to be huge."""
    try:
        return zlib.decompressobj().decompress(data, expected + 1)
    except zlib.error as error:
        raise FrameError(
            f"{image} cannot be inflated: {error}", "copy the file again, or skip the frame"
        ) from None


def _filling(image: ImageSlice, data: bytes, expected: int) -> bytes:
    if len(data) != expected:
        more = "more than " if len(data) > expected else ""
        raise FrameError(
            f"{image} holds {more}{min(len(data), expected)} bytes of pixels, "
            f"{image.width}x{image.height} need {expected}",
            "copy the file again, or skip the frame",
        )
    return data
