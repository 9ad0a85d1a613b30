"""The voxel kernel: depth and colour of some frames, integrated into the blocks that they touch.

Measured rules shape this module:

- Intermediate values are written into scratch arrays that the loop carries. That keeps XLA from
  fusing index computation with gathers (not vectorised then: 1.8 times slower), and from splitting
  each of a chunk's small kernels over all cores: on two cores that took half as much core time
  again, and little less time. The other cores count labels, decode and segment.
- A loop over chunks of blocks, as many as there are: temporaries stay in a core's cache, and
  padding costs nothing.
- Donated pools: a fresh pool per frame costs more than the integration.
- The frames of a step in the inner loop, so that a block is read and written once for all of them.

A chunk belongs to one map: one call integrates into several maps, as chunks of one stacked pool.

The limit: a voxel of an active block moves 26 bytes (distance, weight and colour read and written,
its observation written), 1.7 ns of the 4.5 ns that it takes on one core.
"""

from __future__ import annotations

import dataclasses
import functools

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jax import lax
from jaxtyping import Bool, Float, Int, UInt16

from ..runtime.wide_vectors import jit_wide_vectors, platform_of
from ..types import Array, Camera
from .packing import DEPTH_STEP_M, SEGMENT_BITS, SEGMENT_MASK, PackedFrames
from .pool import BLOCK_SIDE, BLOCK_VOXELS, VOXEL_OFFSETS, VoxelPool

_CHUNK_CPU = 32
"""Blocks per chunk: 64 KB per temporary. A quarter as many are as fast, twice as many slower."""
_CHUNK_ELSEWHERE = 512
"""More where each call of a kernel costs time; not measured."""
NEAR_M = 0.05
"""Voxels nearer to the camera plane are not updated."""
_OUT_OF_VIEW_M = 1e6
"""Behind any return."""

CHANGED = 1
"""Bit of an observation: distance or colour changed (more weight on free space is no change)."""
VOTES = 2
"""Bit of an observation: the voxel lies within a voxel of the surface; its label votes."""
SEGMENT_SHIFT = 2
"""Above these bits: the segment where the voxel is to be labelled, else 0."""
LABELLED = 1 << SEGMENT_SHIFT
"""The least observation of a voxel that is to be labelled."""


class MapScale(eqx.Module):
    """Lengths and caps that only scale things; changing them compiles nothing."""

    voxel_m: float
    truncation_m: float
    label_band_m: float
    max_weight: float


@jax.tree_util.register_dataclass
@dataclasses.dataclass(frozen=True, eq=False)
class ChunkedBlocks:
    """Blocks to update, in chunks of equal size: ``chunks`` true ones, the rest is padding."""

    rows: Int[Array, " blocks"]
    """Rows of the pool; padding lies out of range."""
    base_m: Float[Array, "frames 3 blocks"]
    """Lower corner of each block in the camera of each frame."""
    active: Bool[Array, "frames blocks"]
    """Which frames touch the block."""
    owner: Int[Array, " chunks"]
    """Map of each chunk."""
    chunks: Int[Array, ""]


def block_corners_in_camera(
    T_camera_world: Float[np.ndarray, "4 4"], coords: Int[np.ndarray, "blocks 3"], voxel_m: float
) -> Float[np.ndarray, "3 blocks"]:
    """Lower corners of blocks in the camera frame, metres; in float64, so far maps stay exact."""
    side = voxel_m * BLOCK_SIDE
    R, t = T_camera_world[:3, :3], T_camera_world[:3, 3]
    return ((coords * side) @ R.T + t).T.astype(np.float32)


def voxel_centers_in_camera(
    T_camera_world: Float[np.ndarray, "4 4"], voxel_m: float
) -> Float[np.ndarray, "3 512"]:
    """Voxel centres from the lower corner of their block, along the camera's axes, metres."""
    return (((VOXEL_OFFSETS + 0.5) * voxel_m) @ T_camera_world[:3, :3].T).T.astype(np.float32)


def pixel_of(x, y, z, camera: Camera):
    """Flat pixel of camera points, z, 1 / z, and |ray| / z; out of view the first pixel, z far.

    Write the pixels out before gathering with them, by `lax.optimization_barrier` at least.
    """
    inverse = 1.0 / jnp.maximum(z, NEAR_M)
    xn, yn = x * inverse, y * inverse
    u = jnp.floor(xn * camera.fx + (camera.cx + 0.5))
    v = jnp.floor(yn * camera.fy + (camera.cy + 0.5))
    inside = (z > NEAR_M) & (u >= 0) & (u < camera.width) & (v >= 0) & (v < camera.height)
    flat = (v * camera.width + u).astype(jnp.int32)
    index, z = jnp.where(inside, flat, 0), jnp.where(inside, z, _OUT_OF_VIEW_M)
    return index, z, inverse, jnp.sqrt(1.0 + xn * xn + yn * yn)


def observation_weight(inverse_z, sdf_m, scale: MapScale):
    """1 / z^2, falling linearly to 0 from one voxel behind the surface to the truncation."""
    fade = (scale.truncation_m + sdf_m) / (scale.truncation_m - scale.voxel_m)
    return jnp.clip(fade, 0.0, 1.0) * (inverse_z * inverse_z)


def _blend_color(old, new, share, update):
    """Running mean of each 10-bit channel; a voxel without a colour (0) takes the first whole."""
    share = jnp.where(old == 0, 1.0, share)
    out = jnp.zeros_like(old)
    for shift, byte in ((20, 0), (10, 8), (0, 16)):
        quarters = ((new >> byte) & 255) << 2
        if not shift:
            quarters = quarters | 1  # black is a colour too
        a = ((old >> shift) & 1023).astype(jnp.int32).astype(jnp.float32)
        b = quarters.astype(jnp.int32).astype(jnp.float32)
        out = out | (jnp.round(a + (b - a) * share).astype(jnp.int32).astype(jnp.uint32) << shift)
    return jnp.where(update, out, old)


def chunk_blocks(pool: VoxelPool) -> int:
    """Blocks of a chunk that is fast where the pool lies."""
    return _CHUNK_CPU if platform_of(pool) == "cpu" else _CHUNK_ELSEWHERE


def _scratch(size):
    """Arrays for a chunk's intermediate values; see `_kept`."""

    def arrays(*dtypes):
        return tuple(jnp.zeros((size + 1, BLOCK_VOXELS), dtype) for dtype in dtypes)

    number, index, packed = jnp.float32, jnp.int32, jnp.uint32
    return {
        "old": arrays(number, number, packed),
        "projected": arrays(index, number, number, number),
        "returns": arrays(packed, packed),
        "new": arrays(number, number, packed, jnp.uint16),
    }


def _kept(scratch, name, values):
    """Values of a chunk, written to scratch arrays.

    These hold a row more than they need, or XLA would write to fresh arrays.
    """
    kept = [
        lax.dynamic_update_slice(array, value, (0, 0))
        for array, value in zip(scratch[name], values, strict=True)
    ]
    scratch[name] = tuple(lax.optimization_barrier(kept))
    return tuple(array[: len(values[0])] for array in scratch[name])


def _integrate_chunk(scratch, fields, images, base, local, active, camera: Camera, scale: MapScale):
    """New fields of some blocks after one frame, and the observation of each voxel."""
    depth_segment, colors, first_pixel = images
    sdf_old, weight_old, color_old = fields
    x, y, z = (base[k][:, None] + local[k][None, :] for k in range(3))
    index, *rest = pixel_of(x, y, z, camera)
    index, z, inverse_z, ray = _kept(scratch, "projected", (index + first_pixel, *rest))
    packed, color = _kept(scratch, "returns", (depth_segment[index], colors[index]))
    depth = (packed >> SEGMENT_BITS).astype(jnp.int32).astype(jnp.float32) * DEPTH_STEP_M
    sdf = (depth - z) * ray
    near = (depth > 0) & (sdf > -scale.truncation_m) & active[:, None]
    clipped = jnp.minimum(sdf, scale.truncation_m)
    weight = jnp.where(near, observation_weight(inverse_z, sdf, scale), 0.0)
    total = weight_old + weight
    share = weight / jnp.maximum(total, 1e-12)
    sdf_new = sdf_old + (clipped - sdf_old) * share
    weight_new = jnp.minimum(total, scale.max_weight)
    on_surface = near & (sdf < scale.truncation_m)
    color_new = _blend_color(color_old, color, share, on_surface)
    segment = jnp.where(near & (jnp.abs(sdf) < scale.label_band_m), packed & SEGMENT_MASK, 0)
    votes = near & (jnp.abs(sdf) < scale.voxel_m) & ((packed & SEGMENT_MASK) > 0)
    freed = near & ((weight_old == 0) | (sdf_old < scale.truncation_m))
    observation = (segment << SEGMENT_SHIFT) | jnp.where(votes, jnp.uint32(VOTES), 0)
    observation = observation | jnp.where(on_surface | freed, jnp.uint32(CHANGED), 0)
    return sdf_new, weight_new, color_new, observation.astype(jnp.uint16)


@functools.partial(jit_wide_vectors, donate_argnames=("pool", "observations"))
def integrate_into_blocks(
    pool: VoxelPool,
    observations: UInt16[Array, "frames blocks 512"],
    packed: PackedFrames,
    blocks: ChunkedBlocks,
    local_m: Float[Array, "maps frames 3 512"],
    camera: Camera,
    scale: MapScale,
) -> tuple[VoxelPool, UInt16[Array, "frames blocks 512"], UInt16[Array, "frames blocks"]]:
    """Integrate frames, one after the other, into their blocks (Curless and Levoy's running mean).

    D <- (W D + w d) / (W + w),  W <- min(W + w, max_weight),  w = `observation_weight`

    It takes the storage of ``pool`` and ``observations`` for its result.

    Args:
        observations: Storage for the second result.
        packed: All frames of the first map, then those of the next.
        local_m: `voxel_centers_in_camera` for each map's frames.

    Returns:
        The pool; for each frame and voxel its segment, `CHANGED` and `VOTES`; and the same, joined
        by "or", for each block.
    """
    frames = observations.shape[0]
    pixels = packed.depth_segment.shape[1]
    size = len(blocks.rows) // len(blocks.owner)
    depth_segment, colors = packed.depth_segment.reshape(-1), packed.color.reshape(-1)

    def step(i, carry):
        fields, observations, flags, scratch = carry
        start = i * size
        rows = lax.dynamic_slice(blocks.rows, (start,), (size,))
        chunk = [jnp.take(f, rows, axis=0, mode="clip") for f in fields]
        chunk = _kept(scratch, "old", chunk)
        for k in range(frames):
            first = (blocks.owner[i] * frames + k) * pixels
            base = lax.dynamic_slice(blocks.base_m[k], (0, start), (3, size))
            active = lax.dynamic_slice(blocks.active[k], (start,), (size,))
            local = local_m[blocks.owner[i], k]
            images = (depth_segment, colors, first)
            new = _integrate_chunk(scratch, chunk, images, base, local, active, camera, scale)
            *chunk, observed = _kept(scratch, "new", new)
            observations = lax.dynamic_update_slice(observations, observed[None], (k, start, 0))
            any_of = lax.reduce(observed, np.uint16(0), lax.bitwise_or, (1,))
            flags = lax.dynamic_update_slice(flags, any_of[None], (k, start))
        put = [
            f.at[rows].set(n, mode="drop", unique_indices=True)
            for f, n in zip(fields, chunk, strict=True)
        ]
        return tuple(put), observations, flags, scratch

    flags = jnp.zeros(observations.shape[:2], jnp.uint16)
    fields = (pool.sdf_m, pool.weight, pool.color)
    carry = lax.fori_loop(0, blocks.chunks, step, (fields, observations, flags, _scratch(size)))
    (sdf_m, weight, color), observations, flags, _ = carry
    return VoxelPool(sdf_m, weight, color, pool.labels), observations, flags


def empty_observations(frames: int, blocks: int) -> UInt16[Array, "frames blocks 512"]:
    """Storage for the observations of a step: nothing seen yet."""
    return jnp.zeros((frames, blocks, BLOCK_VOXELS), jnp.uint16)
