"""The integrator: frames into one or more maps, the kernels in turn, and their lists of blocks.

Geometry and colour of all frames of the step come first, in one call. Labels follow frame by
frame, since a frame's segments are named by the labels that the frames before it left.
"""

from __future__ import annotations

import collections
import dataclasses
from concurrent.futures import Future, ThreadPoolExecutor, wait

import numpy as np
from jaxtyping import UInt16

from ..errors import MapError
from ..runtime.batches import bucket
from ..types import Array, Camera
from . import ballots, label_slots, voxel_kernel
from .ballots import CHUNK_VOXELS
from .chunks import Chunks, chunked
from .packing import join_frames
from .pool import BLOCK_VOXELS, OutOfMemory, VoxelPool, grown_pool, with_labels
from .state import MapState, ReadyFrame
from .votes import count_votes
from .voxel_kernel import ChunkedBlocks, MapScale

_MAX_VOXELS = (1 << 31) - 1
"""Voxels of a step: int32 counts them."""
_STEPS_AHEAD = 2
"""Steps that may be under way when another begins: one in the voxels, one in the labels."""


@dataclasses.dataclass(frozen=True, eq=False)
class _Step:
    """Frames of a step, and the blocks that they update."""

    states: list[MapState]
    frames: list[list[ReadyFrame]]
    first: list[int]
    """Frames that each map had before."""
    chunks: Chunks


@dataclasses.dataclass(frozen=True, eq=False)
class _Observed:
    """What the voxels of a step saw (see `voxel_kernel.integrate_into_blocks`)."""

    observations: UInt16[Array, "frames blocks 512"]
    flags: UInt16[np.ndarray, "frames blocks"]


class Integrator:
    """Owns the voxels of one or more maps, and integrates ready frames into them.

    Two threads work behind `integrate`, and the map is the same as without them: geometry does not
    ask for labels, so the voxels of one step are updated while the labels of the one before are
    counted and the caller prepares the next.

    Args:
        pool: Voxels of the maps, one map's rows after the other's.
        parts: Number of maps.
    """

    def __init__(self, camera: Camera, scale: MapScale, pool: VoxelPool, parts: int = 1) -> None:
        self.camera, self.scale, self.parts = camera, scale, parts
        self._voxels, self._labels = _without_labels(pool), pool.labels
        self._chunk_blocks = voxel_kernel.chunk_blocks(pool)
        self._spare: list[UInt16[Array, "frames blocks 512"]] = []
        self._voxel_thread = ThreadPoolExecutor(1, thread_name_prefix="voxels")
        self._label_thread = ThreadPoolExecutor(1, thread_name_prefix="labels")
        self._under_way: collections.deque[tuple[Future[_Observed], Future[None]]]
        self._under_way = collections.deque()

    @property
    def pool(self) -> VoxelPool:
        """The voxels, once all steps are integrated and their labels counted."""
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
        """Room for ``capacity`` rows per map.

        Raises:
            OutOfMemory: there is none; the maps are as they were.
        """
        if capacity <= self.capacity:
            return
        try:
            self.pool = grown_pool(self.pool, capacity, self.parts)
        except OutOfMemory as error:
            self.pool = error.kept
            raise

    def integrate(self, states: list[MapState], frames: list[list[ReadyFrame]]) -> None:
        """Integrate the frames of each map, equally many, in the background.

        What goes wrong there is raised by the next call that waits for it: `integrate`, `join`,
        `pool`. Whatever `integrate` raises, these frames are not in the maps.

        Raises:
            MapError: too many voxels in one step, or what a step before this one ran into.
        """
        step, images, blocks, local_m = self._step(states, frames)
        self._wait(_STEPS_AHEAD)
        spare = self._spare.pop() if self._spare else None
        voxels = self._voxel_thread.submit(self._update_voxels, spare, images, blocks, local_m)
        labels = self._label_thread.submit(self._label_step, step, voxels)
        self._under_way.append((voxels, labels))
        for state in states:
            state.frames += len(frames[0])

    def join(self) -> None:
        """Wait until all steps are integrated and their labels counted."""
        self._wait(0)

    def _wait(self, steps: int) -> None:
        """Until so many steps are under way; the first error ends them all."""
        while len(self._under_way) > steps:
            voxels, labels = self._under_way.popleft()
            if (error := labels.exception()) is not None:
                wait([later for _, later in self._under_way])
                self._under_way.clear()
                raise error
            self._spare.append(voxels.result().observations)

    def renumber(self, state: MapState) -> None:
        """Write today's label numbers into all voxels of a map."""
        self.join()
        self._renumber(state)

    def _renumber(self, state: MapState) -> None:
        if state.renumbering.pending:
            state.step += 1
            self._labels = state.renumbering.renumber_all(
                self._labels, state.blocks, state.first_row
            )

    def _forget_labels(self, state: MapState) -> None:
        """Free the numbers of labels that no voxel bears first."""
        self._renumber(state)
        rows = np.array([state.first_row, state.blocks.used], np.int32)
        size = bucket(state.labels.label_count)
        leads = np.asarray(label_slots.leading_somewhere(self._labels[0], rows, size))
        new_label = state.labels.forget(leads[: state.labels.label_count])
        if new_label is not None:
            state.renumbering.add(new_label)

    def _step(self, states: list[MapState], frames: list[list[ReadyFrame]]):
        """A step, and what updates its voxels: the union of the blocks of its frames."""
        count = len(frames[0])
        unions = [_union([frame.rows for frame in of_map]) for of_map in frames]
        parts = [rows + state.first_row for (rows, _), state in zip(unions, states, strict=True)]
        chunks = chunked(parts, self._voxels.capacity, self._chunk_blocks)
        voxels = count * len(chunks.rows) * BLOCK_VOXELS
        if voxels > _MAX_VOXELS:
            raise MapError(
                f"one step would update {voxels} voxels, at most {_MAX_VOXELS}",
                "integrate into fewer maps per batch, or lower MappingSettings.frames_per_step",
            )
        base_m = np.zeros((count, 3, len(chunks.rows)), np.float32)
        active = np.zeros((count, len(chunks.rows)), bool)
        local_m = np.zeros((len(states), count, 3, BLOCK_VOXELS), np.float32)
        for i, (state, of_map, span) in enumerate(zip(states, frames, chunks.spans, strict=True)):
            rows, touched = unions[i]
            active[:, span] = touched
            for k, frame in enumerate(of_map):
                T, voxel_m = frame.T_camera_world, self.scale.voxel_m
                coords = state.blocks.coords[rows]
                base_m[k, :, span] = voxel_kernel.block_corners_in_camera(T, coords, voxel_m)
                local_m[i, k] = voxel_kernel.voxel_centers_in_camera(T, voxel_m)
        images = [frame.packed for of_map in frames for frame in of_map]
        blocks = ChunkedBlocks(chunks.rows, base_m, active, chunks.owner, chunks.chunks)
        first = [state.frames for state in states]
        return _Step(states, frames, first, chunks), images, blocks, local_m

    def _update_voxels(self, spare, images, blocks: ChunkedBlocks, local_m) -> _Observed:
        """Geometry of all frames of a step; ``spare`` is storage, if it is of the right size."""
        packed = images[0] if len(images) == 1 else join_frames(images)
        if spare is None or spare.shape[:2] != blocks.active.shape:
            spare = voxel_kernel.empty_observations(*blocks.active.shape)
        self._voxels, observations, flags = voxel_kernel.integrate_into_blocks(
            self._voxels, spare, packed, blocks, local_m, self.camera, self.scale
        )
        return _Observed(observations, np.asarray(flags))

    def _label_step(self, step: _Step, voxels: Future[_Observed]) -> None:
        """Labels of all frames of a step, once its voxels are up to date."""
        observed = voxels.result()
        for k in range(len(step.frames[0])):
            self._label(step, observed, k)
        for state in step.states:
            if state.renumbering.is_long:
                self._renumber(state)

    def _label(self, step: _Step, observed: _Observed, k: int) -> None:
        """Votes of frame ``k`` of each map, names of its segments, counts of its voxels."""
        chunks, flags = step.chunks, observed.flags[k]
        frames = [of_map[k] for of_map in step.frames]
        for state, frame, span in zip(step.states, frames, chunks.spans, strict=True):
            rows = chunks.rows[span] - state.first_row
            state.step += 1
            state.blocks.generation[frame.new_rows] = state.renumbering.generation
            state.blocks.stamp[rows[(flags[span] & voxel_kernel.CHANGED) > 0]] = state.step
            to_label = rows[flags[span] >= voxel_kernel.LABELLED]
            self._labels = state.renumbering.renumber_rows(
                self._labels, state.blocks, state.first_row, to_label
            )
        voxels, labelled, votes = self._votes(step, observed.observations, k)
        label_of = [
            state.labels.name_segments(found, frame.class_id, frame.instance)
            for state, frame, found in zip(step.states, frames, votes, strict=True)
        ]
        self._count(voxels, labelled, label_of)
        for i, (state, frame, names) in enumerate(zip(step.states, frames, label_of, strict=True)):
            number = step.first[i] + k + 1
            state.observe(names, frame, number)
            if state.is_crowded(number):
                self._forget_labels(state)

    def _votes(self, step: _Step, observations: UInt16[Array, "frames blocks 512"], k: int):
        """The voxels of each map that frame ``k`` labels, what they saw, and their votes."""
        of_frame, blocks = np.asarray(observations)[k], step.chunks
        parts = [
            ballots.labelled_voxels(of_frame[s]) + s.start * BLOCK_VOXELS for s in blocks.spans
        ]
        voxels = chunked(parts, of_frame.size, CHUNK_VOXELS)
        canonical = [state.labels.canonical for state in step.states]
        labels = np.array([len(known) for known in canonical], np.uint32)[voxels.owner]
        frame, chunks = np.array(k, np.int32), voxels.chunks
        labelled, cast = ballots.cast_votes(
            self._labels[0], observations, frame, blocks.rows, voxels.rows, labels, chunks
        )
        cast = np.asarray(cast)
        votes = [
            count_votes(cast[span], known, len(of_map[k].class_id))
            for of_map, known, span in zip(step.frames, canonical, voxels.spans, strict=True)
        ]
        return voxels, labelled, votes

    def _count(
        self, voxels: Chunks, labelled: ballots.LabelledVoxels, label_of: list[np.ndarray]
    ) -> None:
        """Voxels that need their first slots alone, then the others."""
        total = sum(len(names) for names in label_of)
        table = np.zeros(bucket(total, 64), np.uint32)
        table[:total] = np.concatenate(label_of)
        first = np.cumsum([0, *(len(names) for names in label_of[:-1])]).astype(np.int32)
        leading, *others = self._labels
        leading, left = label_slots.count_leading_labels(
            leading, labelled, first[voxels.owner], table, voxels.chunks
        )
        self._labels = (leading, *others)
        left = np.asarray(left)
        parts = [np.flatnonzero(left[span]) + span.start for span in voxels.spans]
        rest = chunked(parts, len(left), CHUNK_VOXELS)
        self._labels = label_slots.count_labels(
            self._labels, labelled, rest.rows, first[rest.owner], table, rest.chunks
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
