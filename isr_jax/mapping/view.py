"""Which blocks a frame touches, in a window of blocks around what the camera sees.

The window is the box around the viewing pyramid as far as the frame's farthest return, so the work
depends on the frame and the voxel size, never on the size of the map.
"""

from __future__ import annotations

import dataclasses
import functools

import jax
import jax.numpy as jnp
import numpy as np
from jax import lax
from jaxtyping import Float, Int, UInt8, UInt32

from ..errors import FrameError
from ..runtime.batches import bucket
from ..types import Array, Camera
from .packing import DEPTH_STEP_M, SEGMENT_BITS
from .pool import BLOCK_SIDE
from .voxel_kernel import MapScale, pixel_of

NEAR_SURFACE = 1
"""Flag of a block within the truncation distance of a return."""
SEEN_THROUGH = 2
"""Flag of a block whose centre lies in front of a return: what stood there is gone."""
SEEN_EMPTY = 4
"""Flag of a block that lies, as a whole, in front of the returns of all pixels that see it."""

_MAX_WINDOW = 1 << 25
"""Blocks of a window: 20 m of depth at 1 cm voxels."""
_EXACT_QUOTIENT = 1 << 22
"""Below this, float32 divides positions in the window exactly, and vectorised."""
_CHUNK_CELLS = 1 << 14
_TILE = 4
"""Side of a tile of pixels, of which the least depth is kept."""
_REACHES = (1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48)
"""Tiles to each side, of which the least depth is kept; each at most twice the one before."""


@dataclasses.dataclass(frozen=True, eq=False)
class Window:
    """A box of blocks."""

    low: Int[np.ndarray, "3"]
    extent: Int[np.ndarray, "3"]

    @property
    def size(self) -> int:
        return int(np.prod(self.extent.astype(np.int64)))


def window_of(
    T_world_camera: Float[np.ndarray, "4 4"], camera: Camera, scale: MapScale, far_m: float
) -> Window:
    """The blocks around the viewing pyramid down to ``far_m`` and the truncation distance.

    Raises:
        FrameError: they are more than a frame may look through.
    """
    far_m = far_m + scale.truncation_m
    u = (np.array([-0.5, camera.width - 0.5]) - camera.cx) / camera.fx * far_m
    v = (np.array([-0.5, camera.height - 0.5]) - camera.cy) / camera.fy * far_m
    corners = np.array([[0, 0, 0], *([a, b, far_m] for a in u for b in v)])
    corners = corners @ T_world_camera[:3, :3].T + T_world_camera[:3, 3]
    block_m = scale.voxel_m * BLOCK_SIDE
    low = np.floor((corners.min(0) - scale.truncation_m) / block_m).astype(np.int64)
    high = np.floor((corners.max(0) + scale.truncation_m) / block_m).astype(np.int64)
    window = Window(low.astype(np.int32), (high - low + 1).astype(np.int32))
    if window.size > _MAX_WINDOW:
        raise FrameError(
            f"a view {far_m:.1f} m deep spans {window.extent.tolist()} blocks of 8^3 voxels",
            "lower input.depth_max_m, or raise MappingSettings.voxel_size_m",
        )
    return window


def visible_blocks(
    depth_segment: UInt32[Array, "1 pixels"],
    T_world_camera: Float[np.ndarray, "4 4"],
    camera: Camera,
    scale: MapScale,
    window: Window,
    far_m: float,
) -> UInt8[np.ndarray, "x y z"]:
    """Flags of the blocks of the window: `NEAR_SURFACE`, `SEEN_THROUGH`, `SEEN_EMPTY`."""
    block_m = BLOCK_SIDE * scale.voxel_m
    stride = int(np.clip(block_m / 3 * camera.fx / max(far_m, 0.5), 1, 4))
    corner_m = window.low * block_m
    R, t = T_world_camera[:3, :3], T_world_camera[:3, 3] - corner_m
    flags = _visible_blocks(
        depth_segment,
        np.concatenate([R, t[:, None]], 1).astype(np.float32),
        camera,
        scale,
        window.extent,
        stride=1 << (stride.bit_length() - 1),
        samples=int(np.ceil(4 * scale.truncation_m / block_m)) + 1,
        size=bucket(window.size, 4 * _CHUNK_CELLS),
    )
    return np.asarray(flags)[: window.size].reshape(window.extent)


@functools.partial(jax.jit, static_argnames=("stride", "samples", "size"))
def _visible_blocks(
    depth_segment, T_window_camera, camera, scale, extent, *, stride, samples, size
):
    steps = (depth_segment >> SEGMENT_BITS).astype(jnp.int32).astype(jnp.float32)
    depth_m = (steps * DEPTH_STEP_M).reshape(camera.height, camera.width)
    flags = _free_blocks(depth_m, T_window_camera, camera, scale, extent, size)
    near = _near_surface(depth_m, T_window_camera, camera, scale, extent, stride, samples, size)
    return flags | near


def _near_surface(depth_m, T, camera, scale, extent, stride, samples, size):
    """Blocks at points from -truncation to +truncation around the return of every few pixels."""
    x = ((jnp.arange(0, depth_m.shape[1], stride) - camera.cx) / camera.fx)[None, :]
    y = ((jnp.arange(0, depth_m.shape[0], stride) - camera.cy) / camera.fy)[:, None]
    depth_m = depth_m[::stride, ::stride]
    spread = jnp.linspace(-1.0, 1.0, samples)[:, None, None] * scale.truncation_m
    z = depth_m + spread / jnp.sqrt(1.0 + x * x + y * y)
    per_m = 1.0 / (scale.voxel_m * BLOCK_SIDE)
    flat, inside = 0, jnp.broadcast_to(depth_m > 0, z.shape)
    for k in range(3):  # an axis at a time: [..., 3] arrays do not vectorise
        along = T[k, 0] * x + T[k, 1] * y + T[k, 2]
        block = jnp.floor((z * along + T[k, 3]) * per_m).astype(jnp.int32)
        inside = inside & (block >= 0) & (block < extent[k])
        flat = flat * extent[k] + block
    flat = lax.optimization_barrier(jnp.where(inside, flat, size)).reshape(-1)
    return jnp.zeros(size, jnp.uint8).at[flat].set(NEAR_SURFACE, mode="drop")


def _free_blocks(depth_m, T, camera, scale, extent, size):
    """Flags of all blocks of the window by their centre's pixel and the tile around it."""
    block_m = scale.voxel_m * BLOCK_SIDE
    R = T[:, :3]
    step = R * block_m  # row k: a block along window axis k, in camera axes
    first = (0.5 * block_m - T[:, 3]) @ R
    half = 0.5 * np.sqrt(3.0) * block_m
    tiles, layout = _least_depth(depth_m)
    depth = depth_m.reshape(-1)

    def chunk(i, flags):
        cells = i * _CHUNK_CELLS + lax.iota(jnp.int32, _CHUNK_CELLS)
        column, iz = _divided(cells, extent[2], size)
        ix, iy = _divided(column, extent[1], size)
        at = [c.astype(jnp.float32) for c in (ix, iy, iz)]
        x, y, z = (first[k] + sum(at[j] * step[j, k] for j in range(3)) for k in range(3))
        index, z, _, ray = lax.optimization_barrier(pixel_of(x, y, z, camera))
        reach = camera.fx * half * ray / jnp.maximum(z - half, 1e-3)
        tile = lax.optimization_barrier(_tile_of(index, reach, camera, layout))
        behind, least = lax.optimization_barrier((depth[index], tiles[tile]))
        through = jnp.where(z < behind, SEEN_THROUGH, 0)
        empty = jnp.where((z + half < least) & (z > half), SEEN_EMPTY, 0)
        found = (through | empty).astype(jnp.uint8)
        return lax.dynamic_update_slice(flags, found, (i * _CHUNK_CELLS,))

    used = jnp.prod(extent)
    trips = (used + _CHUNK_CELLS - 1) // _CHUNK_CELLS
    return lax.fori_loop(0, trips, chunk, jnp.zeros(size, jnp.uint8))


def _divided(value, divisor, size):
    """Quotient and remainder of positions in the window."""
    if size > _EXACT_QUOTIENT:
        return value // divisor, value % divisor
    quotient = jnp.floor((value.astype(jnp.float32) + 0.5) * (1.0 / divisor)).astype(jnp.int32)
    return quotient, value - quotient * divisor


def _least_depth(depth_m):
    """Least depth of the tiles within each of `_REACHES` of each tile, and their layout.

    It is 0 where the tiles reach out of the image or one of them lacks returns (a lone pixel
    without one is a speckle). The last entry is 0.
    """
    known = depth_m > 0
    nearest = _of_tiles(jnp.where(known, depth_m, np.inf), jnp.minimum)
    number = _of_tiles(known.astype(jnp.uint8), jnp.add)
    least = jnp.where(number > _TILE * _TILE // 2, nearest, 0.0)
    height, width = least.shape
    parts, reached = [], 0
    for reach in _REACHES:
        for axis in (0, 1):
            least = lax.optimization_barrier(_nearer_within(least, reach - reached, reached, axis))
        parts.append(least.reshape(-1))
        reached = reach
    return jnp.concatenate([*parts, jnp.zeros(1)]), (height, width)


def _of_tiles(image, combine):
    """Pixels of each whole tile combined; as slices, since XLA reduces slowly along memory."""
    height, width = (side // _TILE * _TILE for side in image.shape)
    rows = functools.reduce(combine, [image[i:height:_TILE, :width] for i in range(_TILE)])
    rows = lax.optimization_barrier(rows)
    return functools.reduce(combine, [rows[:, i::_TILE] for i in range(_TILE)])


def _nearer_within(least, step: int, reached: int, axis: int):
    """Minimum of both neighbours ``step`` away, and of the middle where they leave a gap."""
    before, after = (
        jnp.pad(
            least,
            [(step * (axis == k and first), step * (axis == k and not first)) for k in (0, 1)],
        )
        for first in (True, False)
    )
    size = least.shape[axis]
    before = lax.slice_in_dim(before, 0, size, axis=axis)
    after = lax.slice_in_dim(after, step, size + step, axis=axis)
    both = jnp.minimum(before, after)
    return jnp.minimum(both, least) if step > reached else both


def _tile_of(index, reach_px, camera: Camera, layout):
    """Index of a pixel's tile among those with a reach that suffices; the last where none does."""
    height, width = layout
    quotient = jnp.floor((index.astype(jnp.float32) + 0.5) * (1.0 / camera.width))
    row = quotient.astype(jnp.int32)
    column = index - row * camera.width
    tile = (row // _TILE) * width + column // _TILE
    nothing = len(_REACHES) * height * width
    place = jnp.full_like(index, nothing)
    for level in reversed(range(len(_REACHES))):
        suffices = reach_px + _TILE - 1 <= _REACHES[level] * _TILE
        place = jnp.where(suffices, tile + level * height * width, place)
    whole = (row < height * _TILE) & (column < width * _TILE)
    return jnp.where(whole, place, nothing)
