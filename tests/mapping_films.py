"""Frames of a small analytic room, and what two maps must share to be the same map."""

from __future__ import annotations

import numpy as np

from isr_jax.classes import class_named
from isr_jax.config import MappingSettings
from isr_jax.mapping import PanopticMapper

from .reference.mapping_reference import CAMERA, Solid, orbit, render

FLOOR, TABLE, BOWL = (class_named(n).id for n in ("floor", "table", "bowl"))
SOLIDS = [
    Solid("plane", (0, 0, 1), 0.013, class_id=FLOOR, color=(120, 120, 120)),
    Solid("box", (0, 0, 0.37), (0.4, 0.3, 0.37), yaw=0.35, class_id=TABLE),
    Solid("ball", (0.1, 0.05, 0.86), 0.12, class_id=BOWL, color=(20, 40, 220)),
]
SETTINGS = MappingSettings(voxel_size_m=0.03, block_capacity=1024)


def film(count=10, seed=0, noise_m=0.002, radius=1.6):
    """Frames around a table, and their true segments."""
    poses = orbit((0, 0, 0.4), radius, 1.1, count)
    return [render(SOLIDS, T, index=i, noise_m=noise_m, seed=seed) for i, T in enumerate(poses)]


def map_of(frames, settings=SETTINGS):
    """The map of some frames."""
    mapper = PanopticMapper(CAMERA, settings)
    for frame, segments in frames:
        mapper.integrate(frame, segments)
    return mapper


def assert_same_map(one: PanopticMapper, other: PanopticMapper) -> None:
    """Every voxel, label, count and decision, bit for bit."""
    assert one.frames == other.frames
    assert one.blocks.used == other.blocks.used
    used = one.blocks.used
    np.testing.assert_array_equal(one.blocks.coords[:used], other.blocks.coords[:used])
    a, b = one.pool, other.pool
    for x, y in zip(
        (a.sdf_m, a.weight, a.color, *a.labels), (b.sdf_m, b.weight, b.color, *b.labels)
    ):
        np.testing.assert_array_equal(np.asarray(x)[:used], np.asarray(y)[:used])
    assert one.labels.counts == other.labels.counts
    for x, y in zip(one.map_labels(), other.map_labels()):
        np.testing.assert_array_equal(x, y)
    points = np.random.default_rng(1).uniform((-2, -2, 0), (2, 2, 1.5), (4000, 3))
    np.testing.assert_array_equal(one.observed(points), other.observed(points))
