"""Long sequences: what is bounded stays bounded, and a frame costs what it did at the start."""

from __future__ import annotations

import dataclasses
import resource
import time

import numpy as np
import pytest

from isr_jax.classes import class_named
from isr_jax.config import MappingSettings
from isr_jax.mapping import PanopticMapper, pool
from isr_jax.types import Camera, Frame, FrameSegments

from .reference.mapping_reference import Solid, look_at, render

FLOOR, WALL, TABLE, CHAIR = (class_named(n).id for n in ("floor", "wall", "table", "chair"))
CAMERA = Camera(52.0, 52.0, 31.5, 23.5, 64, 48)
SETTINGS = MappingSettings(
    voxel_size_m=0.08, block_capacity=256, max_blocks=16384, max_weight=50.0, min_votes=5
)
ROOM = [
    Solid("plane", (0, 0, 1), 0.0, class_id=FLOOR, color=(120, 120, 120)),
    *(
        Solid("plane", (np.cos(a), np.sin(a), 0), 3.0, class_id=WALL)
        for a in np.radians([20, 110, 200, 290])
    ),
    Solid("box", (0, 0, 0.37), (0.6, 0.4, 0.37), yaw=0.35, class_id=TABLE),
    *(
        Solid("box", (1.2 * np.cos(a), 1.2 * np.sin(a), 0.25), (0.2, 0.2, 0.25), class_id=CHAIR)
        for a in (0.0, 2.0, 4.0)
    ),
]
LAP = 100


def lap() -> list[tuple[Frame, FrameSegments]]:
    """Once around the room, looking outwards and down by turns."""
    angles = np.linspace(0, 2 * np.pi, LAP, endpoint=False)
    views = []
    for i, a in enumerate(angles):
        eye = (2.2 * np.cos(a), 2.2 * np.sin(a), 1.4 + 0.3 * np.sin(5 * a))
        target = (0.0, 0.0, 0.4) if i % 3 else (-3 * np.cos(a), -3 * np.sin(a), 1.0)
        views.append(render(ROOM, look_at(eye, target), CAMERA, index=i))
    return views


def cut_at_random(view, rng) -> tuple[Frame, FrameSegments]:
    """The frame with noise, its segments cut anew, some of them under another class."""
    frame, segments = view
    noise = rng.normal(0, 0.004, frame.depth_m.shape).astype(np.float32)
    depth_m = np.where(frame.depth_m > 0, frame.depth_m + noise, np.float32(0))
    columns = np.sort(rng.integers(0, CAMERA.width, 2))
    part = np.searchsorted(columns, np.arange(CAMERA.width), side="right")
    count = len(segments.class_id)
    segment = np.where(segments.segment > 0, segments.segment + part * count, 0).astype(np.int32)
    class_id = np.tile(segments.class_id, 3)
    wrong = rng.random(len(class_id)) < 0.1
    class_id = np.where(wrong, rng.choice([TABLE, CHAIR], len(class_id)), class_id)
    class_id[0] = 0
    instance = np.where(rng.random(len(class_id)) < 0.3, rng.permutation(len(class_id)), 0)
    instance = np.where(instance > 0, instance, np.tile(segments.instance, 3))
    tables = class_id.astype(np.int32), instance.astype(np.int32)
    return dataclasses.replace(frame, depth_m=depth_m), FrameSegments(segment, *tables)


@dataclasses.dataclass(frozen=True)
class Reading:
    """What a map had come to after some frames."""

    blocks: int
    labels: int
    resident_mb: float
    frame_ms: float
    """Median since the reading before."""


def read(mapper: PanopticMapper, seconds: list[float]) -> Reading:
    peak_mb = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    labels = len(mapper.map_labels()[0])
    return Reading(mapper.blocks.used, labels, peak_mb, 1e3 * float(np.median(seconds)))


def driven(frames, every: int) -> tuple[PanopticMapper, list[Reading]]:
    """A map of the frames, and what it had come to after each so many."""
    mapper, readings, seconds = PanopticMapper(CAMERA, SETTINGS), [], []
    for i, (frame, segments) in enumerate(frames, 1):
        start = time.perf_counter()
        mapper.integrate(frame, segments)
        seconds.append(time.perf_counter() - start)
        if i % every == 0:
            readings.append(read(mapper, seconds))
            seconds = []
    return mapper, readings


def around(laps: int):
    """So many laps, no two frames the same."""
    rng, views = np.random.default_rng(0), lap()
    for _ in range(laps):
        for view in views:
            yield cut_at_random(view, rng)


def heaviest(mapper: PanopticMapper) -> tuple[float, int]:
    """Greatest weight of a voxel, and greatest count of a voxel's leading label."""
    rows = np.arange(mapper.blocks.used)
    _, count = pool.leading_label(mapper.pool, rows)
    return float(np.max(pool.weight(mapper.pool, rows))), int(np.max(count))


@pytest.fixture(scope="module")
def three_laps() -> tuple[PanopticMapper, list[Reading]]:
    return driven(around(3), LAP)


def test_blocks_and_weights_stay_bounded(three_laps):
    mapper, (first, _, third) = three_laps
    assert third.blocks < 1.05 * first.blocks
    assert heaviest(mapper)[0] == SETTINGS.max_weight


def test_labels_stay_bounded(three_laps):
    """Segments that are cut anew in every frame leave no label behind for each."""
    _, (_, second, third) = three_laps
    assert third.labels < 1.2 * second.labels + 10


@pytest.mark.slow
def test_20000_frames_around_a_room_cost_no_more_than_the_first():
    mapper, readings = driven(around(200), 20 * LAP)
    start, end = readings[0], readings[-1]
    assert mapper.frames == 20_000
    assert end.blocks < 1.05 * start.blocks
    assert end.labels < 1.5 * start.labels
    assert end.resident_mb < start.resident_mb + 100
    assert end.frame_ms < 1.5 * start.frame_ms
    weight, count = heaviest(mapper)
    assert weight == SETTINGS.max_weight and count == pool.MAX_COUNT
    classes = set(mapper.surface().class_ids.tolist())
    assert {FLOOR, WALL, TABLE, CHAIR} >= classes >= {FLOOR, WALL}


def walk(frames: int, step_m: float = 0.02):
    """Along a corridor with a chair every two metres."""
    floor, *_ = ROOM
    walls = [Solid("plane", (0, s, 0), 1.5, class_id=WALL) for s in (-1, 1)]
    for i in range(frames):
        x = i * step_m
        chairs = [
            Solid("box", (2.0 * k, 0.9, 0.25), (0.2, 0.2, 0.25), class_id=CHAIR)
            for k in range(int(x / 2), int(x / 2) + 4)
        ]
        pose = look_at((x, 0.0, 1.3), (x + 2, 0.3, 0.6))
        frame, segments = render([floor, *walls, *chairs], pose, CAMERA, index=i)
        near = frame.depth_m < 4
        depth_m = np.where(near, frame.depth_m, np.float32(0))
        segment = np.where(near, segments.segment, 0)
        tables = segments.class_id, segments.instance
        yield dataclasses.replace(frame, depth_m=depth_m), FrameSegments(segment, *tables)


@pytest.mark.slow
def test_a_frame_of_a_long_walk_costs_no_more_than_one_of_a_short_walk():
    """100 m of corridor: the map grows, the time per frame does not."""
    mapper, readings = driven(walk(5000), 500)
    start, end = readings[1], readings[-1]
    assert end.blocks > 4 * start.blocks
    assert end.frame_ms < 1.5 * start.frame_ms
    assert mapper.surface().mesh.vertices[:, 0].max() > 95
