"""Border: the frames of a map, kept without loss as PNG images, to be integrated again."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator

import cv2
import jax.numpy as jnp
import numpy as np
from jaxtyping import Float, Int, Shaped

from ..errors import MapError
from ..types import Camera
from .packing import SEGMENT_BITS, SEGMENT_MASK, PackedFrames, packed_color
from .state import PosedFrame

_FAST = [cv2.IMWRITE_PNG_COMPRESSION, 1]
_MILLIMETRE = 10
"""Steps of depth; most sensors give whole millimetres, and those fit 16 bits."""


@dataclasses.dataclass(frozen=True, eq=False)
class KeptFrame:
    """A frame as PNG images and tables."""

    images: tuple[bytes, ...]
    """Segments, colour, depth (16 bits), and the higher bits of depth where there are any."""
    depth_unit: int
    """Steps of depth that the depth image counts in."""
    farthest: int
    class_id: Int[np.ndarray, " segments"]
    instance: Int[np.ndarray, " segments"]


class KeptFrames:
    """The integrated frames of a map, in order, without their poses."""

    def __init__(self, camera: Camera) -> None:
        self.shape = (camera.height, camera.width)
        self.frames: list[KeptFrame] = []

    def __len__(self) -> int:
        return len(self.frames)

    @property
    def nbytes(self) -> int:
        """Bytes of all images."""
        return sum(len(image) for frame in self.frames for image in frame.images)

    def append(self, frame: PosedFrame) -> None:
        """Keep one more frame.

        Raises:
            MapError: OpenCV cannot write it as PNG.
        """
        depth_segment = np.asarray(frame.packed.depth_segment)[0].reshape(self.shape)
        rgba = np.asarray(frame.packed.color).view(np.uint8).reshape(*self.shape, 4)
        depth = depth_segment >> SEGMENT_BITS
        unit = 1 if np.any(depth % _MILLIMETRE) else _MILLIMETRE
        depth = depth // unit
        images = [
            (depth_segment & SEGMENT_MASK).astype(np.uint16),
            rgba[..., :3],
            (depth & 0xFFFF).astype(np.uint16),
        ]
        if depth.max() > 0xFFFF:
            images.append((depth >> 16).astype(np.uint8))
        png = tuple(_png(image) for image in images)
        self.frames.append(KeptFrame(png, unit, frame.farthest, frame.class_id, frame.instance))

    def replay(self, poses: Float[np.ndarray, "frames 4 4"]) -> Iterator[PosedFrame]:
        """The frames, as they were packed, with these poses.

        Raises:
            MapError: an image of a frame is broken.
        """
        for frame, T_world_camera in zip(self.frames, poses, strict=True):
            yield PosedFrame(
                _packed(frame), frame.farthest, T_world_camera, frame.class_id, frame.instance
            )


def _png(image: Shaped[np.ndarray, "height width *channels"]) -> bytes:
    done, png = cv2.imencode(".png", image, _FAST)
    if not done:
        raise MapError("a frame cannot be kept as PNG", "set MappingSettings.keep_frames = false")
    return png.tobytes()


def _image(png: bytes) -> Shaped[np.ndarray, "height width *channels"]:
    image = cv2.imdecode(np.frombuffer(png, np.uint8), cv2.IMREAD_UNCHANGED)
    if image is None:
        raise MapError("a kept frame is broken", "map the sequence anew")
    return image


def _packed(frame: KeptFrame) -> PackedFrames:
    """What `packing.pack_frame` gave, bit for bit."""
    segment, color, *steps = (_image(png) for png in frame.images)
    depth = sum(image.astype(np.uint32) << (16 * i) for i, image in enumerate(steps))
    depth_segment = (depth * np.uint32(frame.depth_unit) << SEGMENT_BITS) | segment
    return PackedFrames(jnp.asarray(depth_segment.reshape(1, -1)), packed_color(color))
