"""Frames are decoded, segmented and integrated at once: in order, and as one thread would."""

from __future__ import annotations

import threading
import time

import jax
import numpy as np
import pytest

from isr_jax.datasets import open_sequence
from isr_jax.errors import FrameError
from isr_jax.map_runs.frames import integrate_sequence, segmented_frames
from isr_jax.mapping import PanopticMapper
from isr_jax.runtime.prefetch import prefetch_results
from isr_jax.runtime.reporter import LogReporter
from isr_jax.runtime.stage_runner import StageRunner
from isr_jax.segmentation import open_segmenter, segment_frame

from .films import FRAMES, Recorder, coarse, film  # noqa: F401 (a fixture)

BAD = (3, 11)
"""Frames whose masks cannot be read."""


class Faulty:
    """A segmenter that fails on some frames, and remembers where it was called from."""

    def __init__(self, folder):
        self._segmenter = open_segmenter("simulated:perfect", folder)
        self.name, self.threads = "faulty", set()

    def __call__(self, frame):
        self.threads.add(threading.get_ident())
        if frame.index in BAD:
            raise FrameError(f"frame {frame.index} has no masks")
        return self._segmenter(frame)

    def content_hash(self):
        return self._segmenter.content_hash()

    def describe(self):
        return self.name


def test_the_map_is_bit_for_bit_that_of_one_thread(film):  # noqa: F811
    sequence, segmenter, settings = open_sequence(film), Faulty(film), coarse()
    result = integrate_sequence(sequence, segmenter, settings, StageRunner(reporter=LogReporter()))
    mapper = PanopticMapper(sequence.camera, settings.mapping)
    for index in range(len(sequence)):
        if index not in BAD:
            frame = sequence[index]
            mapper.integrate(frame, segment_frame(frame, segmenter(frame), settings.segmentation))
    alone = mapper.surface()
    for name in ("instance", "instance_ids", "class_ids"):
        np.testing.assert_array_equal(getattr(result.surface, name), getattr(alone, name))
    for name in ("vertices", "faces", "colors"):
        np.testing.assert_array_equal(getattr(result.surface.mesh, name), getattr(alone.mesh, name))
    assert result.skipped == tuple(f"frame {i} has no masks" for i in BAD)
    assert result.frames_used == FRAMES - len(BAD)


def test_the_segmenter_is_called_in_one_thread_at_a_time(film):  # noqa: F811
    sequence, segmenter = open_sequence(film), Faulty(film)
    indices = list(range(len(sequence)))
    ready = list(segmented_frames(sequence, indices, segmenter, coarse()))
    assert len(segmenter.threads) == 1
    assert [i for i, item in enumerate(ready) if isinstance(item, FrameError)] == list(BAD)
    assert [item[0].index for item in ready if not isinstance(item, FrameError)] == [
        i for i in indices if i not in BAD
    ]


def test_an_interrupted_run_leaves_no_thread_behind(film):  # noqa: F811
    before = set(threading.enumerate())
    sequence, runner = open_sequence(film), StageRunner(reporter=Recorder(die_after=5))
    with pytest.raises(KeyboardInterrupt):
        integrate_sequence(sequence, Faulty(film), coarse(), runner)

    def left():  # the mapper's own threads wait for its next frame, and end with it
        new = set(threading.enumerate()) - before
        return [t.name for t in new if t.name.startswith(("prefetch", "segment"))]

    deadline = time.monotonic() + 30
    while left() and time.monotonic() < deadline:
        time.sleep(0.01)
    assert not left()


def test_results_come_in_order_and_errors_in_their_turn():
    def work(item):
        time.sleep(0.002 * (5 - item))  # the later, the faster
        if item == 4:
            raise FrameError("four")
        return item

    results = prefetch_results(work, range(6), workers=3, ahead=3, name="test")
    assert [next(results) for _ in range(4)] == [0, 1, 2, 3]
    with pytest.raises(FrameError, match="four"):
        next(results)


def test_no_more_is_made_than_asked_for():
    taken = []
    items = (taken.append(i) or i for i in range(100))
    results = prefetch_results(lambda x: x, items, workers=2, ahead=3, name="test")
    next(results), next(results)
    assert taken == [0, 1, 2, 3, 4]


def test_kernels_of_two_threads_give_what_one_gives():
    """XLA runs the programs of several threads at a time; none disturbs another."""
    square = jax.jit(lambda x: (x @ x.T).sum(0))
    items = [np.random.default_rng(i).normal(size=(64, 64)).astype(np.float32) for i in range(20)]
    alone = [np.asarray(square(x)) for x in items]
    ahead = prefetch_results(
        lambda x: np.asarray(square(x)), items, workers=4, ahead=8, name="test"
    )
    for one, other in zip(alone, ahead, strict=True):
        np.testing.assert_array_equal(one, other)
