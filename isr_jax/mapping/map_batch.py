"""Several maps that grow in one call: one stacked pool, one frame per map and step."""

from __future__ import annotations

from collections.abc import Sequence

import jax
import jax.numpy as jnp

from ..errors import MapError
from ..types import Frame, FrameSegments
from .integrator import Integrator
from .mapper import PanopticMapper
from .pool import VoxelPool, grown_pool


class MapBatch:
    """Integrates one frame into each of several maps, as one compiled call per kernel.

    Each map becomes what it would become by itself, bit for bit. The batch owns the voxels of its
    maps until `close`; meanwhile the maps themselves are not to be used. With a ``with`` statement
    they are given back at its end.

    Args:
        maps: Maps of one camera and equal settings. All get the capacity of the largest.

    Raises:
        MapError: there are none, they differ in camera or settings, or there is no memory.
    """

    def __init__(self, maps: Sequence[PanopticMapper]) -> None:
        self.maps = list(maps)
        first = _alike(self.maps)
        capacity = max(m.blocks.capacity for m in self.maps)
        pools = []
        for i, one in enumerate(self.maps):
            one.finish()
            one.state.blocks.resize(capacity)
            one.state.first_row = i * capacity
            pools.append(_lent(one, capacity))
        stacked = jax.tree.map(lambda *fields: jnp.concatenate(fields), *pools)
        self.integrator = Integrator(first.camera, first.scale, stacked, len(self.maps))

    def integrate(self, frames: Sequence[Frame], segments: Sequence[FrameSegments]) -> None:
        """Integrate one frame into each map.

        Args:
            frames: One per map, in the order of the maps.
            segments: Of these frames.

        Raises:
            FrameError: a frame that cannot be used (see `PanopticMapper.integrate`).
            MapError: they are not as many as the maps, or a map cannot grow. In both cases no map
                has taken in a frame.
        """
        if not len(frames) == len(segments) == len(self.maps):
            raise MapError(
                f"{len(frames)} frames and {len(segments)} segments for {len(self.maps)} maps",
                "give one of each per map, in the order of the maps",
            )
        posed = [m.posed(f, s) for m, f, s in zip(self.maps, frames, segments, strict=True)]
        ready = []
        for one, frame in zip(self.maps, posed, strict=True):
            ready.append(one.state.ready(frame, one.camera, one.scale, self._reserve))
        self.integrator.integrate([m.state for m in self.maps], [[frame] for frame in ready])
        for one, frame in zip(self.maps, posed, strict=True):
            one.keep(frame)

    def _reserve(self, capacity: int) -> None:
        self.integrator.reserve(capacity)
        for i, one in enumerate(self.maps):
            one.state.blocks.resize(self.integrator.capacity)
            one.state.first_row = i * self.integrator.capacity

    def close(self) -> list[PanopticMapper]:
        """Give each map its voxels back."""
        capacity = self.integrator.capacity
        for i, one in enumerate(self.maps):
            rows = slice(i * capacity, (i + 1) * capacity)
            one.integrator.pool = jax.tree.map(
                lambda field, rows=rows: field[rows], self.integrator.pool
            )
            one.state.first_row = 0
        maps, self.maps = self.maps, []
        return maps

    def __enter__(self) -> MapBatch:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


def _alike(maps: list[PanopticMapper]) -> PanopticMapper:
    if not maps:
        raise MapError("a batch of no maps", "give at least one map")
    for one in maps[1:]:
        if one.settings != maps[0].settings or one.camera != maps[0].camera:
            raise MapError(
                "maps of different settings or cameras in one batch",
                "make all maps of a batch with the same camera and settings",
            )
    return maps[0]


def _lent(one: PanopticMapper, capacity: int) -> VoxelPool:
    """The map's voxels, which it has no longer."""
    pool = grown_pool(one.integrator.pool, capacity) if one.integrator.capacity < capacity else None
    pool = pool or one.integrator.pool
    one.integrator.pool = jax.tree.map(lambda field: field[:0], pool)
    return pool
