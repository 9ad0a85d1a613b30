"""What a map holds beside its voxels, and how a frame finds its blocks in it."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable

import numpy as np
from jaxtyping import Float, Int

from ..config import MappingSettings
from ..runtime.batches import bucket
from ..types import Camera
from . import view
from .blocks import BlockIndex
from .labels import MapLabels
from .packing import DEPTH_STEP_M, PackedFrames
from .pool import BLOCK_SIDE
from .renumbering import Renumbering
from .voxel_kernel import MapScale

_ROOM_M2, _LEAST_START, _MOST_START = 200.0, 1 << 14, 1 << 16
"""Surface of a furnished room, whose blocks a map has from the start, within bounds."""
_CROWD = 128
_FORGET_EVERY = 256
"""From so many labels on, those that lead no voxel are forgotten every so many frames."""
_RENUMBER_EVERY = 64
"""Merged labels get their new numbers every so many frames; votes resolve them meanwhile."""


@dataclasses.dataclass(frozen=True, eq=False)
class PosedFrame:
    """A checked and packed frame with its pose and the tables of its segments."""

    packed: PackedFrames
    farthest: int
    """Greatest depth, in `DEPTH_STEP_M`."""
    T_world_camera: Float[np.ndarray, "4 4"]
    class_id: Int[np.ndarray, " segments"]
    instance: Int[np.ndarray, " segments"]


@dataclasses.dataclass(frozen=True, eq=False)
class ReadyFrame:
    """A frame with its blocks in the map, to be integrated."""

    packed: PackedFrames
    T_camera_world: Float[np.ndarray, "4 4"]
    rows: Int[np.ndarray, " active"]
    new_rows: slice
    """Rows that it was the first to need."""
    class_id: Int[np.ndarray, " segments"]
    instance: Int[np.ndarray, " segments"]


class MapState:
    """Blocks, labels and counters of a map; its rows begin at ``first_row`` of a pool."""

    def __init__(self, settings: MappingSettings) -> None:
        self.settings = settings
        capacity = settings.block_capacity or _room_blocks(settings.voxel_size_m)
        self.blocks = BlockIndex(capacity, settings.max_blocks)
        self.labels = MapLabels(settings)
        self.renumbering = Renumbering()
        self.frames = 0
        """Frames integrated so far."""
        self.step = 0
        """Rises with every change of voxels, renumbering included."""
        self.first_row = 0

    def is_crowded(self, frames: int) -> bool:
        """Whether it is time to forget labels, after so many frames."""
        return frames % _FORGET_EVERY == 0 and self.labels.label_count >= _CROWD

    def ready(
        self,
        frame: PosedFrame,
        camera: Camera,
        scale: MapScale,
        reserve: Callable[[int], None],
    ) -> ReadyFrame:
        """The frame with the rows of the blocks that it updates, allocated where they are new.

        Those are the blocks near its returns and, with ``carve``, known ones it sees through.
        Blocks of which it sees nothing but free space are counted as such.

        Raises:
            FrameError: its view spans too many blocks.
            MapError: the map cannot grow (see `BlockIndex.allocate`); the frame leaves no trace.
        """
        T = frame.T_world_camera.astype(np.float64)
        before = self.blocks.used
        rows = self._rows(frame, T, camera, scale, reserve)
        new_rows, tables = slice(before, self.blocks.used), (frame.class_id, frame.instance)
        return ReadyFrame(frame.packed, np.linalg.inv(T), rows, new_rows, *tables)

    def _rows(self, frame: PosedFrame, T_world_camera, camera, scale, reserve):
        if not frame.farthest:
            return np.zeros(0, np.int32)
        far_m = frame.farthest * DEPTH_STEP_M
        window = view.window_of(T_world_camera, camera, scale, far_m)
        pixels = frame.packed.depth_segment
        flags = view.visible_blocks(pixels, T_world_camera, camera, scale, window, far_m)
        self.blocks.cover(window.low, window.low + window.extent - 1)
        part = self.blocks.part(window.low, window.extent)
        near = np.flatnonzero(flags & view.NEAR_SURFACE)
        coords = np.stack(np.unravel_index(near, flags.shape), -1).astype(np.int32) + window.low
        self.blocks.allocate(coords, reserve)
        rows = self.blocks.grid[part].reshape(-1)
        passes = self.blocks.passes[part]
        passes += ((flags & view.SEEN_EMPTY) > 0) & (passes < 255)
        if not self.settings.carve:
            return rows[near]
        through = (flags & view.SEEN_THROUGH).reshape(-1) > 0
        touched = through & (rows >= 0)
        touched[near] = True
        return rows[touched]

    def observe(
        self, label_of: Int[np.ndarray, " segments"], frame: ReadyFrame, frames: int
    ) -> None:
        """Count a frame, and every so many ``frames`` give merged labels their new numbers."""
        self.labels.observe(label_of, frame.class_id, frame.instance)
        if frames % _RENUMBER_EVERY:
            return
        new_label = self.labels.renumber_merged()
        if new_label is not None:
            self.renumbering.add(new_label)


def _room_blocks(voxel_size_m: float) -> int:
    """Blocks of 8^3 voxels that a room needs, as a power of two."""
    blocks = int(_ROOM_M2 / (BLOCK_SIDE * voxel_size_m) ** 2)
    return min(bucket(blocks, _LEAST_START), _MOST_START)
