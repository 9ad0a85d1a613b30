"""Whether the time per frame grows with the map: a film again and again, each in a further room."""

from __future__ import annotations

import dataclasses
import time

import jax
import numpy as np

from isr_jax.config import MappingSettings
from isr_jax.mapping import PanopticMapper
from isr_jax.types import Frame

from .figures import Figure
from .filmed import Filmed, integrated
from .map_memory import map_bytes

_PITCH_M = 10.0
"""From room to room: no furnished room is as long."""
_ROW = 10
"""Rooms of a row."""
_MAX_BLOCKS = 1 << 22
_GROWTH = 1.1
"""The promise that time does not grow, with what a clock gives away."""


def growth_figures(film: Filmed, settings: MappingSettings, count: int) -> list[Figure]:
    """Time per frame in the second tenth of a long way (all is compiled then) and in the last."""
    settings = dataclasses.replace(settings, max_blocks=_MAX_BLOCKS)
    mapper, seconds, used = PanopticMapper(film.sequence.camera, settings), [], []
    for index in range(count):
        room, place = divmod(index, len(film.frames))
        frame, segments = film.frames[place]
        frame = _further(frame, room)
        start = time.perf_counter()
        jax.block_until_ready(integrated(mapper, [(frame, segments)]))
        seconds.append(time.perf_counter() - start)
        used.append(mapper.blocks.used)
    tenth = max(1, count // 10)
    early, late = (
        1000 * float(np.median(part)) for part in (seconds[tenth : 2 * tenth], seconds[-tenth:])
    )
    return [
        Figure("early frames", early, "ms per frame", "lower"),
        Figure("late frames", late, "ms per frame", "lower"),
        Figure("late / early", late / early, "x", "lower", _GROWTH),
        Figure("slowest late frame", 1000 * max(seconds[-tenth:]), "ms", "lower"),
        Figure("blocks of the map early", used[min(tenth, count - 1)], "blocks", "lower"),
        Figure("blocks of the map at the end", used[-1], "blocks", "lower"),
        Figure("map at the end", map_bytes(mapper) / 1e6, "MB", "lower"),
    ]


def _further(frame: Frame, room: int) -> Frame:
    """The frame as taken in the n-th room."""
    T = frame.T_world_camera.copy()
    T[:2, 3] += np.array([room % _ROW, room // _ROW]) * _PITCH_M
    return dataclasses.replace(frame, T_world_camera=T)
