"""One step of one or more maps: the kernels in turn, and the lists of blocks they work on.

Geometry and colour of all frames of the step come first, in one call. Labels follow frame by
frame, since a frame's segments are named by the labels that the frames before it left.
"""

from __future__ import annotations

import dataclasses
from concurrent.futures import Future, ThreadPoolExecutor

import jax.numpy as jnp
import numpy as np
from jaxtyping import Int, UInt16

from ..types import Array, Camera
from . import ballots, fuse, label_slots
from .fuse import CHUNK_BLOCKS
from .label_slots import CHUNK_LAYERS
from .pool import BLOCK_SIDE, BLOCK_VOXELS, OutOfMemory, VoxelPool, grown_pool, with_labels
from .state import MapState, ReadyFrame
from .votes import Votes, count_votes


@dataclasses.dataclass(frozen=True, eq=False)
class _Chunks:
    """Rows of several maps, each map's filled up to whole chunks."""

    rows: Int[np.ndarray, " blocks"]
    """Padding lies out of range, each entry once."""
    owner: Int[np.ndarray, " chunks"]
    spans: list[slice]
    """Where each map's own rows stand."""
    chunks: Int[np.ndarray, ""]


def _chunked(parts: list[np.ndarray], out_of_range: int, chunk: int = CHUNK_BLOCKS) -> _Chunks:
    """Lists of rows, one a map, in a power of two of chunks."""
    counts = [-(-len(part) // chunk) for part in parts]
    total = sum(counts)
    size = 1 << max(total - 1, 0).bit_length()
    rows = out_of_range + np.arange(size * chunk, dtype=np.int32)
    owner = np.zeros(size, np.int32)
    owner[:total] = np.repeat(np.arange(len(parts)), counts)
    starts = (np.cumsum([0, *counts[:-1]]) * chunk).tolist()
    spans = [slice(s, s + len(part)) for s, part in zip(starts, parts, strict=True)]
    for span, part in zip(spans, parts, strict=True):
        rows[span] = part
    return _Chunks(rows, owner, spans, np.array(total, np.int32))


@dataclasses.dataclass(frozen=True, eq=False)
class _Step:
    """Frames whose geometry is fused, and what their voxels saw."""

    states: list[MapState]
    frames: list[list[ReadyFrame]]
    first: list[int]
    """Frames that each map had before."""
    chunks: _Chunks
    hits: UInt16[Array, "frames blocks 512"]
    flags: UInt16[np.ndarray, "frames blocks"]


class Fusion:
    """Owns the voxels of one or more maps, and fuses ready frames into them.

    Geometry does not ask for labels, so those of a step are counted in a thread of their own while
    the next step's frames are prepared and fused: two cores are busy, and the map is the same.

    Args:
        pool: Voxels of the maps, one map's rows after the other's.
        parts: Number of maps.
    """

    def __init__(
        self, camera: Camera, scale: fuse.FusionScale, pool: VoxelPool, parts: int = 1
    ) -> None:
        self.camera, self.scale, self.parts = camera, scale, parts
        self._voxels, self._labels = _without_labels(pool), pool.labels
        self._spare_hits: UInt16[Array, "frames blocks 512"] | None = None
        self._ballots = jnp.zeros((0, BLOCK_VOXELS), jnp.uint32)
        self._helper = ThreadPoolExecutor(1, thread_name_prefix="labels")
        self._labelling: Future[UInt16[Array, "frames blocks 512"]] | None = None

    @property
    def pool(self) -> VoxelPool:
        """The voxels, once the labels of all steps are counted."""
        self.join()
        return with_labels(self._voxels, self._labels)

    @pool.setter
    def pool(self, pool: VoxelPool) -> None:
        self.join()
        self._voxels, self._labels = _without_labels(pool), pool.labels

    @property
    def capacity(self) -> int:
        """Rows of a map."""
        return self._voxels.capacity // self.parts

    def reserve(self, capacity: int) -> None:
        """Room for ``capacity`` rows a map; raises `OutOfMemory`, the maps as they were."""
        if capacity <= self.capacity:
            return
        try:
            self.pool = grown_pool(self.pool, capacity, self.parts)
        except OutOfMemory as error:
            self.pool = error.kept
            raise

    def fuse(self, states: list[MapState], frames: list[list[ReadyFrame]]) -> None:
        """Fuse the frames of each map, equally many; their segments are named in the background.

        What goes wrong there is raised by the next call that waits for it: `fuse`, `join`, `pool`.
        """
        chunks, hits, flags = self._geometry(states, frames)
        self.join()
        first = [state.frames for state in states]
        for state in states:
            state.frames += len(frames[0])
        step = _Step(states, frames, first, chunks, hits, flags)
        self._labelling = self._helper.submit(self._label_step, step)

    def join(self) -> None:
        """Wait until the labels of all steps are counted."""
        labelling, self._labelling = self._labelling, None
        if labelling is not None:
            self._spare_hits = labelling.result()

    def settle(self, state: MapState) -> None:
        """Write today's label numbers into all voxels of a map."""
        self.join()
        self._settle(state)

    def _settle(self, state: MapState) -> None:
        if state.renaming.pending:
            state.step += 1
            self._labels = state.renaming.settle(self._labels, state)

    def _forget_labels(self, state: MapState) -> None:
        """Free the numbers of labels that no voxel bears first."""
        self._settle(state)
        rows = np.array([state.first_row, state.blocks.used], np.int32)
        size = 1 << (state.labels.label_count - 1).bit_length()
        leads = np.asarray(label_slots.leading_somewhere(self._labels[0], rows, size))
        new_label = state.labels.forget(leads[: state.labels.label_count])
        if new_label is not None:
            state.renaming.rename(new_label)

    def _geometry(self, states: list[MapState], frames: list[list[ReadyFrame]]):
        """All frames into the union of their blocks; flags a frame and block of the union."""
        count = len(frames[0])
        unions = [_union([frame.rows for frame in of_map]) for of_map in frames]
        parts = [rows + state.first_row for (rows, _), state in zip(unions, states, strict=True)]
        chunks = _chunked(parts, self._voxels.capacity)
        base_m = np.zeros((count, 3, len(chunks.rows)), np.float32)
        active = np.zeros((count, len(chunks.rows)), bool)
        local_m = np.zeros((len(states), count, 3, BLOCK_VOXELS), np.float32)
        for i, (state, of_map, span) in enumerate(zip(states, frames, chunks.spans, strict=True)):
            rows, touched = unions[i]
            active[:, span] = touched
            for k, frame in enumerate(of_map):
                T, voxel_m = frame.T_camera_world, self.scale.voxel_m
                base_m[k, :, span] = fuse.voxel_corners(T, state.blocks.coords[rows], voxel_m)
                local_m[i, k] = fuse.voxel_places(T, voxel_m)
        images = [frame.packed for of_map in frames for frame in of_map]
        packed = images[0] if len(images) == 1 else fuse.join_frames(images)
        work = fuse.ChunkedBlocks(chunks.rows, base_m, active, chunks.owner, chunks.chunks)
        hits, self._spare_hits = self._spare_hits, None
        if hits is None or hits.shape[:2] != active.shape:
            hits = fuse.fresh_hits(*active.shape)
        self._voxels, hits, flags = fuse.fuse_frames(
            self._voxels, hits, packed, work, local_m, self.camera, self.scale
        )
        return chunks, hits, np.asarray(flags)

    def _label_step(self, step: _Step) -> UInt16[Array, "frames blocks 512"]:
        """Labels of all frames of a step; gives the storage of its hits back."""
        for k in range(len(step.frames[0])):
            self._label(step, k)
        for state in step.states:
            if state.renaming.is_long:
                self._settle(state)
        return step.hits

    def _label(self, step: _Step, k: int) -> None:
        """Votes of frame ``k`` of each map, names of its segments, counts of its voxels."""
        chunks, flags = step.chunks, step.flags[k]
        frames = [of_map[k] for of_map in step.frames]
        labelled = (flags & (fuse.VOTES | fuse.SEGMENT_MASK)) > 0
        for state, frame, span in zip(step.states, frames, chunks.spans, strict=True):
            rows = chunks.rows[span] - state.first_row
            state.step += 1
            state.blocks.generation[frame.new_rows] = state.renaming.generation
            state.blocks.stamp[rows[(flags[span] & fuse.CHANGED) > 0]] = state.step
            self._labels = state.renaming.freshen(self._labels, state, rows[labelled[span]])
        votes = self._votes(step, frames, k, (flags & fuse.VOTES) > 0)
        label_of = [
            state.labels.name_segments(found, frame.class_id, frame.instance)
            for state, frame, found in zip(step.states, frames, votes, strict=True)
        ]
        self._count(step, k, (flags & fuse.SEGMENT_MASK) > 0, label_of)
        for i, (state, frame, names) in enumerate(zip(step.states, frames, label_of, strict=True)):
            number = step.first[i] + k + 1
            state.observe(names, frame, number)
            if state.is_crowded(number):
                self._forget_labels(state)

    def _votes(self, step: _Step, frames, k: int, votes) -> list[Votes]:
        places, some = _some_of(step.chunks, votes, self._voxels.capacity)
        if len(self._ballots) != len(some.rows):
            self._ballots = jnp.zeros((len(some.rows), BLOCK_VOXELS), jnp.uint32)
        self._ballots, *layers = ballots.cast_votes(
            self._labels[0],
            step.hits,
            np.array(k, np.int32),
            some.rows,
            places,
            some.chunks,
            self._ballots,
        )
        cast = [np.asarray(table) for table in (self._ballots, *layers)]
        found = []
        for state, frame, span in zip(step.states, frames, some.spans, strict=True):
            ballot, often = ballots.counted(*(table[span] for table in cast))
            segments = len(frame.class_id)
            found.append(count_votes(ballot, state.labels.canonical, segments, often))
        return found

    def _count(self, step: _Step, k: int, labelled, label_of) -> None:
        """Layers that need the first slots alone, then the others."""
        total = sum(len(names) for names in label_of)
        table = np.zeros(max(64, 1 << max(total - 1, 0).bit_length()), np.uint32)
        table[:total] = np.concatenate(label_of)
        first = np.cumsum([0, *(len(names) for names in label_of[:-1])]).astype(np.int32)
        frame, capacity = np.array(k, np.int32), self._voxels.capacity
        places, some = _some_of(step.chunks, labelled, capacity)
        leading, *others = self._labels
        leading, left = label_slots.count_leading_labels(
            leading, step.hits, frame, some.rows, places, first[some.owner], table, some.chunks
        )
        self._labels = (leading, *others)
        among, rest = _some_of(some, np.asarray(left), capacity)
        places = places[among // BLOCK_SIDE] * BLOCK_SIDE + among % BLOCK_SIDE
        self._labels = label_slots.count_labels(
            self._labels, step.hits, frame, rest.rows, places, first[rest.owner], table, rest.chunks
        )


def _without_labels(pool: VoxelPool) -> VoxelPool:
    return with_labels(pool, ())


def _union(rows: list[np.ndarray]):
    """Rows that any frame touches, and which frame touches which."""
    if len(rows) == 1:
        return rows[0], np.ones((1, len(rows[0])), bool)
    union, inverse = np.unique(np.concatenate(rows), return_inverse=True)
    touched = np.zeros((len(rows), len(union)), bool)
    touched[np.repeat(np.arange(len(rows)), [len(r) for r in rows]), inverse] = True
    return union, touched


def _some_of(chunks: _Chunks, keep, capacity: int) -> tuple[np.ndarray, _Chunks]:
    """The entries that are kept, in chunks of their own, and their places among all.

    Args:
        keep: A value a row; or one a part of a row, then the rows found are numbers of parts.
    """
    parts = keep[0].size
    places = [span.start * parts + np.flatnonzero(keep[span]) for span in chunks.spans]
    rows = [chunks.rows[p // parts] * parts + p % parts for p in places]
    some = _chunked(rows, capacity * parts, CHUNK_BLOCKS if parts == 1 else CHUNK_LAYERS)
    padded = np.zeros(len(some.rows), np.int32)
    for span, place in zip(some.spans, places, strict=True):
        padded[span] = place
    return padded, some
