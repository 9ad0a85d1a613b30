"""Border: a frame's images packed, so that one gather serves depth and segment, one colour."""

from __future__ import annotations

import dataclasses

import cv2
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Float, Int, UInt8, UInt32

from ..types import Array

SEGMENT_BITS = 12
"""A packed pixel holds ``depth << SEGMENT_BITS | segment``."""
SEGMENT_MASK = (1 << SEGMENT_BITS) - 1
"""The segment in a packed pixel."""
MAX_SEGMENTS = SEGMENT_MASK
"""Segments of a frame, 0 for none aside."""
DEPTH_STEP_M = 1e-4
"""Depth is packed in tenths of a millimetre: 20 bits reach 104 m."""


@jax.tree_util.register_dataclass
@dataclasses.dataclass(frozen=True, eq=False)
class PackedFrames:
    """Frames as flat images."""

    depth_segment: UInt32[Array, "frames pixels"]
    """Depth in `DEPTH_STEP_M` and segment of each pixel."""
    color: UInt32[Array, "frames pixels"]
    """See `packed_color`."""


def pack_frame(
    depth_m: Float[np.ndarray, "height width"],
    segment: Int[np.ndarray, "height width"],
    color: UInt8[np.ndarray, "height width 3"],
) -> PackedFrames:
    """One frame: depth (metres) and segment in one integer, red, green and blue in another."""
    return PackedFrames(_packed_depth_segment(depth_m, segment), packed_color(color))


@jax.jit
def _packed_depth_segment(depth_m, segment):
    steps = jnp.round(depth_m / DEPTH_STEP_M).astype(jnp.int32).astype(jnp.uint32)
    packed = (steps << SEGMENT_BITS) | segment.astype(jnp.uint32)
    return packed.reshape(1, -1)


def packed_color(color: UInt8[np.ndarray, "height width 3"]) -> UInt32[Array, "1 pixels"]:
    """Red, green and blue in the bytes of an integer, the lowest first."""
    rgba = cv2.cvtColor(np.ascontiguousarray(color), cv2.COLOR_RGB2RGBA)
    return jnp.asarray(rgba.view("<u4").reshape(1, -1))


@jax.jit
def join_frames(frames: list[PackedFrames]) -> PackedFrames:
    """Several packed frames as one."""
    return jax.tree.map(lambda *images: jnp.concatenate(images), *frames)
