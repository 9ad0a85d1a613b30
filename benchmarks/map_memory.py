"""What a map takes in memory, and what a frame must move through it at least."""

from __future__ import annotations

import jax
import numpy as np

from isr_jax.mapping import PanopticMapper
from isr_jax.mapping.pool import BLOCK_VOXELS

from .figures import Figure
from .filmed import SegmentedFrames
from .open3d_peer import Open3dMap

_BYTES_PER_VOXEL = 32.0
"""The promise."""
_BYTES_PER_PIXEL = 4 + 3 + 4
"""Depth, colour and segment."""


def bytes_per_voxel(mapper: PanopticMapper) -> float:
    """Of all fields of the pool, colours and labels among them."""
    fields = jax.tree.leaves(mapper.pool)
    return sum(field.nbytes for field in fields) / (mapper.pool.capacity * BLOCK_VOXELS)


def map_bytes(mapper: PanopticMapper) -> float:
    """Of the blocks in use and of the grid that finds them."""
    voxels = mapper.blocks.used * BLOCK_VOXELS
    return voxels * bytes_per_voxel(mapper) + mapper.blocks.grid.nbytes


def changed_blocks(frames: SegmentedFrames, mapper: PanopticMapper) -> list[int]:
    """Integrate the frames; how many blocks each of them changed."""
    changed = []
    for frame, segments in frames:
        mapper.integrate(frame, segments)
        stamps = mapper.blocks.stamp[: mapper.blocks.used]
        changed.append(int(np.count_nonzero(stamps == mapper.step)))
    jax.block_until_ready(mapper.pool)
    return changed


def memory_figures(mapper: PanopticMapper, peers: dict[str, Open3dMap]) -> list[Figure]:
    """Bytes per voxel, and the size of the map and of the peers'."""
    sizes = {"ours": map_bytes(mapper)} | {name: peer.nbytes for name, peer in peers.items()}
    return [
        Figure("ours", bytes_per_voxel(mapper), "bytes per voxel", "lower", _BYTES_PER_VOXEL),
        *(Figure(f"map, {name}", size / 1e6, "MB", "lower") for name, size in sizes.items()),
    ]


def traffic_figures(
    mapper: PanopticMapper, blocks: float, bytes_per_s: float, ms: float
) -> list[Figure]:
    """The bound: each byte of the changed blocks read and written once, each pixel read once.

    Args:
        mapper: Ours.
        blocks: That a frame changes.
        bytes_per_s: Read and written by a copy on this machine.
        ms: Time per frame.
    """
    pixels = mapper.camera.width * mapper.camera.height
    moved = 2 * blocks * BLOCK_VOXELS * bytes_per_voxel(mapper) + pixels * _BYTES_PER_PIXEL
    least_ms = 1000 * moved / bytes_per_s
    return [
        Figure("blocks changed", blocks, "per frame", "lower"),
        Figure("bytes moved at least", moved / 1e6, "MB per frame", "lower"),
        Figure("copy bandwidth, read and written", bytes_per_s / 1e9, "GB/s", "higher"),
        Figure("bound of that bandwidth", least_ms, "ms per frame", "lower"),
        Figure("ours / bound", ms / least_ms, "x", "lower"),
    ]
