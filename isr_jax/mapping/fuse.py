"""Per-frame voxel kernels: mark blocks, fuse depth and colour.

Three measured rules shape this module: an optimisation barrier between index computation and
gather (fused, XLA does not vectorise them: 1.8 times slower), a loop over chunks of blocks
whose trip count follows the real number (temporaries stay in cache, padding costs nothing), and
donated pools (a fresh pool a frame costs more than the fusion).
"""

from __future__ import annotations

import functools

import equinox as eqx
import jax
import jax.numpy as jnp
from jax import lax
from jaxtyping import Bool, Float, Int, UInt8, UInt32

from ..types import Array, Camera
from .pool import (
    BLOCK_SIDE,
    DEPTH_STEP_M,
    LABEL_BITS,
    LABEL_MASK,
    SEGMENT_BITS,
    VOXEL_OFFSETS,
    VoxelPool,
)

CHUNK_BLOCKS = 512
"""Blocks a step: 0.25 M voxels, best at 2 cm and near the best at 1 cm."""
NEAR_M = 0.05
"""Voxels nearer to the camera plane are not updated."""
_FAR = 1 << 30
"""Farther than any block."""
NO_VOTE = LABEL_MASK
"""Label of a hit outside the voting band."""


class FusionScale(eqx.Module):
    """Lengths and caps that only scale things; changing them compiles nothing."""

    voxel_m: float
    truncation_m: float
    label_band_m: float
    max_weight: float


class PackedFrame(eqx.Module):
    """A frame as two flat images with one sentinel pixel (nothing) at the end."""

    words: UInt32[Array, " pixels_and_one"]
    """Depth in `DEPTH_STEP_M` and segment."""
    color: UInt32[Array, " pixels_and_one"]


@jax.jit
def pack_frame(
    depth_m: Float[Array, "height width"],
    segment: Int[Array, "height width"],
    color: UInt8[Array, "height width 3"],
) -> PackedFrame:
    """Depth and segment in one word, so that one gather serves both."""
    steps = jnp.round(depth_m / DEPTH_STEP_M).astype(jnp.uint32)
    words = (steps << SEGMENT_BITS) | segment.astype(jnp.uint32)
    rgb = color.astype(jnp.uint32) << 2
    packed = (rgb[..., 0] << 20) | (rgb[..., 1] << 10) | rgb[..., 2] | 1  # 0 means no colour
    nothing = jnp.zeros(1, jnp.uint32)
    return PackedFrame(
        jnp.concatenate([words.ravel(), nothing]), jnp.concatenate([packed.ravel(), nothing])
    )


@functools.partial(jax.jit, static_argnames=("stride", "samples", "size"))
def mark_blocks(
    depth_m: Float[Array, "height width"],
    T_world_camera: Float[Array, "4 4"],
    camera: Camera,
    scale: FusionScale,
    origin: Int[Array, "3"],
    extent: Int[Array, "3"],
    *,
    stride: int,
    samples: int,
    size: int,
) -> tuple[Bool[Array, " size"], Int[Array, "3"], Int[Array, "3"]]:
    """Blocks within the truncation distance of the surface, in a window of blocks.

    Args:
        origin: First block of the window.
        extent: Blocks of the window along x, y and z; their product is at most ``size``.
        stride: Every how many pixels a ray is taken.
        samples: Points a ray, spread from -truncation to +truncation around its return.

    Returns:
        The marks (z fastest), and the least and greatest block touched, which tells whether the
        window held them all.
    """
    depth = depth_m[::stride, ::stride]
    x = ((jnp.arange(0, depth_m.shape[1], stride) - camera.cx) / camera.fx)[None, :]
    y = ((jnp.arange(0, depth_m.shape[0], stride) - camera.cy) / camera.fy)[:, None]
    spread = jnp.linspace(-1.0, 1.0, samples)[:, None, None] * scale.truncation_m
    z = depth + spread / jnp.sqrt(1.0 + x * x + y * y)
    seen = jnp.broadcast_to(depth > 0, z.shape)
    per_m = 1.0 / (scale.voxel_m * BLOCK_SIDE)
    R, t = T_world_camera[:3, :3], T_world_camera[:3, 3]
    flat, inside, low, high = 0, seen, [], []
    for k in range(3):  # an axis at a time: [..., 3] arrays do not vectorise
        along = R[k, 0] * x + R[k, 1] * y + R[k, 2]
        block = jnp.floor((z * along + t[k]) * per_m).astype(jnp.int32)
        low.append(jnp.min(jnp.where(seen, block, _FAR)))
        high.append(jnp.max(jnp.where(seen, block, -_FAR)))
        local = block - origin[k]
        inside = inside & (local >= 0) & (local < extent[k])
        flat = flat * extent[k] + local
    flat = lax.optimization_barrier(jnp.where(inside, flat, size)).reshape(-1)
    marks = jnp.zeros(size, bool).at[flat].set(True, mode="drop")
    return marks, jnp.stack(low), jnp.stack(high)


@jax.jit
def seen_through(
    depth_m: Float[Array, "height width"],
    T_camera_world: Float[Array, "4 4"],
    camera: Camera,
    scale: FusionScale,
    coords: Int[Array, "capacity 3"],
) -> Bool[Array, " capacity"]:
    """Blocks whose centre lies in front of a return: a later frame frees what stood there."""
    center = (coords.astype(jnp.float32) + 0.5) * (scale.voxel_m * BLOCK_SIDE)
    p = center @ T_camera_world[:3, :3].T + T_camera_world[:3, 3]
    index, z, _ = _pixel_of(p[:, 0], p[:, 1], p[:, 2], camera)
    depth = jnp.append(depth_m.ravel(), 0.0)[index]
    return z < depth


def _pixel_of(x, y, z, camera: Camera):
    """Flat pixel of camera points (the sentinel where there is none), z, and |ray| / z."""
    inverse = 1.0 / jnp.maximum(z, NEAR_M)
    xn, yn = x * inverse, y * inverse
    u = jnp.floor(xn * camera.fx + (camera.cx + 0.5))
    v = jnp.floor(yn * camera.fy + (camera.cy + 0.5))
    inside = (z > NEAR_M) & (u >= 0) & (u < camera.width) & (v >= 0) & (v < camera.height)
    flat = (v * camera.width + u).astype(jnp.int32)
    index = jnp.where(inside, flat, camera.width * camera.height)
    return lax.optimization_barrier((index, z, jnp.sqrt(1.0 + xn * xn + yn * yn)))


def observation_weight(z, sdf_m, scale: FusionScale):
    """1 / z^2, falling linearly to 0 from one voxel behind the surface to the truncation."""
    fade = (scale.truncation_m + sdf_m) / (scale.truncation_m - scale.voxel_m)
    return jnp.clip(fade, 0.0, 1.0) / (z * z)


def _blend_color(old, new, share, update):
    """Running mean of each 10-bit channel; a voxel without a colour (0) takes the first whole."""
    share = jnp.where(old == 0, 1.0, share)
    out = jnp.zeros_like(old)
    for shift in (20, 10, 0):
        a = ((old >> shift) & 1023).astype(jnp.float32)
        b = ((new >> shift) & 1023).astype(jnp.float32)
        out = out | (jnp.round(a + (b - a) * share).astype(jnp.uint32) << shift)
    return jnp.where(update, out, old)


def _fuse_chunk(fields, packed: PackedFrame, base, camera: Camera, scale: FusionScale, local):
    """New fields of some blocks, and the segment and old label that each voxel saw."""
    sdf_old, weight_old, color_old, leader = fields
    x, y, z = (base[:, k, None] + local[None, :, k] for k in range(3))
    index, z, ray = _pixel_of(x, y, z, camera)
    word, color = lax.optimization_barrier((packed.words[index], packed.color[index]))
    depth = (word >> SEGMENT_BITS).astype(jnp.float32) * DEPTH_STEP_M
    sdf = (depth - z) * ray
    near = (depth > 0) & (sdf > -scale.truncation_m)
    clipped = jnp.minimum(sdf, scale.truncation_m)
    weight = jnp.where(near, observation_weight(z, sdf, scale), 0.0)
    total = weight_old + weight
    share = weight / jnp.maximum(total, 1e-12)
    sdf_new = sdf_old + (clipped - sdf_old) * share
    weight_new = jnp.minimum(total, scale.max_weight)
    on_surface = near & (sdf < scale.truncation_m)
    color_new = _blend_color(color_old, color, share, on_surface)
    segment = word & ((1 << SEGMENT_BITS) - 1)
    labelled = near & (jnp.abs(sdf) < scale.label_band_m)
    votes = near & (jnp.abs(sdf) < scale.voxel_m) & (segment > 0)
    label = jnp.where(votes, leader & LABEL_MASK, NO_VOTE)
    hits = (jnp.where(labelled, segment, 0) << LABEL_BITS) | label
    return lax.optimization_barrier((sdf_new, weight_new, color_new, hits))


def fuse_blocks(
    pool: VoxelPool,
    hits: UInt32[Array, "blocks 512"],
    packed: PackedFrame,
    T_camera_world: Float[Array, "4 4"],
    camera: Camera,
    scale: FusionScale,
    slots: Int[Array, " blocks"],
    coords: Int[Array, "blocks 3"],
    count: Int[Array, ""],
) -> tuple[VoxelPool, UInt32[Array, "blocks 512"]]:
    """Fuse one frame into the active blocks (Curless and Levoy's running mean).

    D <- (W D + w d) / (W + w),  W <- min(W + w, max_weight),  w = `observation_weight`

    Args:
        hits: Storage for the second result.
        slots: Rows of the pool, the first ``count`` true ones, then out-of-range padding.
        coords: Block coordinates of the slots.

    Returns:
        The pool, and for each voxel ``segment << LABEL_BITS | leading label``: the segment where
        the voxel is to be labelled, the label where it votes (|sdf| < 1 voxel), else `NO_VOTE`.
    """
    R, t = T_camera_world[:3, :3], T_camera_world[:3, 3]
    local = (jnp.asarray(VOXEL_OFFSETS, jnp.float32) + 0.5) * scale.voxel_m @ R.T
    base = coords.astype(jnp.float32) * (scale.voxel_m * BLOCK_SIDE) @ R.T + t

    def step(i, carry):
        (sdf_m, weight, color), hits = carry
        start = i * CHUNK_BLOCKS
        rows = lax.dynamic_slice(slots, (start,), (CHUNK_BLOCKS,))
        fields = tuple(
            jnp.take(f, rows, axis=0, mode="clip") for f in (sdf_m, weight, color, pool.labels[0])
        )
        here = lax.dynamic_slice(base, (start, 0), (CHUNK_BLOCKS, 3))
        *new, seen = _fuse_chunk(fields, packed, here, camera, scale, local)
        put = [
            f.at[rows].set(n, mode="drop", unique_indices=True)
            for f, n in zip((sdf_m, weight, color), new, strict=True)
        ]
        return tuple(put), lax.dynamic_update_slice(hits, seen, (start, 0))

    trips = (count + CHUNK_BLOCKS - 1) // CHUNK_BLOCKS
    fields, hits = lax.fori_loop(0, trips, step, ((pool.sdf_m, pool.weight, pool.color), hits))
    sdf_m, weight, color = fields
    return VoxelPool(sdf_m, weight, color, pool.labels), hits


fuse_frame = jax.jit(fuse_blocks, donate_argnames=("pool", "hits"))
"""`fuse_blocks`, compiled; it takes the storage of ``pool`` and ``hits`` for its result."""
