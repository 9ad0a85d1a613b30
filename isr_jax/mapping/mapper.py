"""The panoptic mapper: one call a frame, a surface at any time."""

from __future__ import annotations

import functools
from pathlib import Path

import jax.numpy as jnp
import numpy as np
from jaxtyping import Int

from ..classes import classes
from ..config import MappingSettings
from ..errors import MapError
from ..geometry import invert_T
from ..types import Camera, Frame, FrameSegments, PanopticSurface
from . import checkpoint, fuse, label_slots, surface
from .blocks import BlockIndex
from .labels import LabelFusion
from .pool import BLOCK_SIDE, BLOCK_VOXELS, MAX_SEGMENTS, empty_pool, grown_pool
from .votes import count_votes

_RELABEL_EVERY = 16
"""Merged labels are rewritten in the voxels at most every so many frames."""


class PanopticMapper:
    """Fuses posed frames and their segments into one sparse panoptic voxel map (paper, sec. IV).

    Args:
        camera: The camera of every frame to come.
        settings: `MappingSettings`.
    """

    def __init__(self, camera: Camera, settings: MappingSettings | None = None) -> None:
        self.camera = camera
        self.settings = settings or MappingSettings()
        self.blocks = BlockIndex(self.settings.block_capacity, self.settings.max_blocks)
        self.pool = empty_pool(self.blocks.capacity, self.settings.label_slots)
        self.labels = LabelFusion(self.settings)
        self.frames = 0
        """Frames fused so far."""
        self._hits = jnp.zeros((0, BLOCK_VOXELS), jnp.uint32)
        self._rewritten = 0

    @property
    def scale(self) -> fuse.FusionScale:
        """The lengths of this map, for the kernels."""
        s = self.settings
        return fuse.FusionScale(
            voxel_m=s.voxel_size_m,
            truncation_m=s.truncation_voxels * s.voxel_size_m,
            label_band_m=min(s.label_band_voxels, s.truncation_voxels) * s.voxel_size_m,
            max_weight=s.max_weight,
        )

    def integrate(self, frame: Frame, segments: FrameSegments) -> None:
        """Fuse one frame: geometry and colour, then labels, classes and instances.

        Raises `MapError` when the map outgrows ``max_blocks``; the frame is then not fused.
        """
        self._check(frame, segments)
        depth_m, segment = _without_dynamic(frame.depth_m, segments)
        T_camera_world = np.asarray(invert_T(frame.T_world_camera.astype(np.float64)), np.float32)
        rows = self._activate(depth_m, frame.T_world_camera.astype(np.float32), T_camera_world)
        slots, coords = self._padded(rows)
        packed = fuse.pack_frame(depth_m, segment, frame.color)
        hits = self._hits if len(self._hits) == len(slots) else _fresh_hits(len(slots))
        count = np.int32(len(rows))
        self.pool, self._hits = fuse.fuse_frame(
            self.pool, hits, packed, T_camera_world, self.camera, self.scale, slots, coords, count
        )
        label_of = self._name(segments, len(rows))
        table = jnp.asarray(_padded_table(label_of))
        slot_labels = label_slots.count_labels(self.pool.labels, self._hits, table, slots, count)
        self.pool = self._with_labels(slot_labels)
        self.labels.observe(label_of, segments.class_id, segments.instance)
        self.frames += 1
        self._rewrite_merged()

    def _check(self, frame: Frame, segments: FrameSegments) -> None:
        shape = (self.camera.height, self.camera.width)
        for name, image in (("depth", frame.depth_m), ("segments", segments.segment)):
            if image.shape != shape:
                raise MapError(
                    f"frame {frame.name}: {name} of {image.shape} pixels, the camera has {shape}",
                    "make all frames of a sequence one size",
                )
        if len(segments.class_id) > MAX_SEGMENTS:
            raise MapError(
                f"frame {frame.name} has {len(segments.class_id)} segments, at most {MAX_SEGMENTS}",
                "raise SegmentationSettings.min_segment_px",
            )

    def _activate(self, depth_m, T_world_camera, T_camera_world) -> Int[np.ndarray, " active"]:
        """Rows of the blocks that this frame updates, allocated where they are new."""
        mark = functools.partial(self._mark, depth_m, T_world_camera)
        marks, low, high = mark()
        if np.all(low <= high) and not self.blocks.covers(low, high):
            self.blocks.cover(low, high)
            marks, _, _ = mark()
        rows = self.blocks.allocate(self.blocks.marked(marks))
        self._grow_pool()
        if not self.settings.carve:
            return rows
        through = np.asarray(
            fuse.seen_through(depth_m, T_camera_world, self.camera, self.scale, self.blocks.coords)
        )
        active = np.zeros(self.blocks.capacity, bool)
        active[: self.blocks.used] = through[: self.blocks.used]
        active[rows] = True
        return np.flatnonzero(active).astype(np.int32)

    def _mark(self, depth_m, T_world_camera):
        block_m = BLOCK_SIDE * self.settings.voxel_size_m
        far = max(float(depth_m.max()), 0.5)
        stride = int(np.clip(block_m / 3 * self.camera.fx / far, 1, 4))
        samples = int(np.ceil(4 * self.scale.truncation_m / block_m)) + 1
        marks, low, high = fuse.mark_blocks(
            depth_m,
            T_world_camera,
            self.camera,
            self.scale,
            self.blocks.origin,
            self.blocks.extent,
            stride=1 << (stride.bit_length() - 1),
            samples=samples,
            size=_bucket(self.blocks.grid.size),
        )
        return np.asarray(marks), np.asarray(low), np.asarray(high)

    def _grow_pool(self) -> None:
        if self.blocks.capacity > self.pool.capacity:
            self.pool = grown_pool(self.pool, self.blocks.capacity)

    def _padded(self, rows):
        """Rows and block coordinates in a power-of-two bucket; padding lies out of range."""
        size = max(_bucket(len(rows)), fuse.CHUNK_BLOCKS)
        slots = self.blocks.capacity + np.arange(size, dtype=np.int32)
        slots[: len(rows)] = rows
        coords = np.zeros((size, 3), np.int32)
        coords[: len(rows)] = self.blocks.coords[rows]
        return slots, coords

    def _name(self, segments: FrameSegments, active: int) -> Int[np.ndarray, " segments"]:
        hits = np.asarray(self._hits)[:active]
        votes = count_votes(hits, self.labels.canonical, len(segments.class_id))
        return self.labels.name_segments(votes, segments.class_id, segments.instance)

    def _with_labels(self, slot_labels):
        return type(self.pool)(self.pool.sdf_m, self.pool.weight, self.pool.color, slot_labels)

    def _rewrite_merged(self) -> None:
        """Write merged labels into the voxels, now and then; votes resolve them meanwhile."""
        merged = int(np.sum(self.labels.canonical != np.arange(self.labels.label_count)))
        if self.frames % _RELABEL_EVERY or merged == self._rewritten:
            return
        size = _bucket(self.labels.label_count)
        table = np.zeros(size, np.uint32)
        table[: self.labels.label_count] = self.labels.canonical
        self.pool = self._with_labels(
            label_slots.relabel(self.pool.labels, table, np.int32(self.blocks.used))
        )
        self._rewritten = merged

    def map_labels(self) -> tuple[Int[np.ndarray, " labels"], Int[np.ndarray, " labels"]]:
        """Class and instance of every map label, as decided so far; 0 = undecided."""
        return self.labels.decisions()

    def surface(self) -> PanopticSurface:
        """The map's surface: a mesh with an instance a vertex, and a class an instance."""
        class_of, instance_of = self.map_labels()
        return surface.extract_surface(
            self.pool,
            self.blocks,
            self.settings,
            class_of,
            instance_of,
        )

    def save(self, path: Path) -> None:
        """Write a checkpoint (npz). A map loaded from it goes on bit for bit."""
        checkpoint.save(self, Path(path))

    @classmethod
    def load(cls, path: Path) -> PanopticMapper:
        """The map of a checkpoint, with its camera and settings."""
        return checkpoint.load(cls, Path(path))


def _without_dynamic(depth_m, segments: FrameSegments):
    """Depth and segments without people and animals: they would leave ghosts in the map."""
    dynamic = np.array([info.kind == "dynamic" for info in classes()])[segments.class_id]
    segment = segments.segment.astype(np.int32)
    depth_m = depth_m.astype(np.float32)
    if dynamic.any():
        hidden = dynamic[segment]
        depth_m = np.where(hidden, np.float32(0), depth_m)
        segment = np.where(hidden, 0, segment)
    return depth_m, segment


def _padded_table(label_of):
    table = np.zeros(_bucket(len(label_of)), np.uint32)
    table[: len(label_of)] = label_of
    return table


def _fresh_hits(blocks: int):
    return jnp.zeros((blocks, BLOCK_VOXELS), jnp.uint32)


def _bucket(count: int) -> int:
    """The power of two that holds ``count``, at least 64."""
    return max(64, 1 << max(count - 1, 0).bit_length())
