"""The voxel kernel and the surface: parity, analytic rooms, order, growth, checkpoints."""

from __future__ import annotations

import dataclasses

import jax.numpy as jnp
import numpy as np
import pytest

from isr_jax.classes import class_named
from isr_jax.config import MappingSettings
from isr_jax.errors import FrameError, MapError
from isr_jax.mapping import PanopticMapper, label_slots
from isr_jax.mapping.integrator import Integrator
from isr_jax.mapping.pool import (
    BLOCK_SIDE,
    LABEL_BITS,
    LABEL_MASK,
    VOXEL_OFFSETS,
    empty_pool,
    leading_labels,
)
from isr_jax.mapping.state import MapState, ReadyFrame
from isr_jax.types import Camera, FrameSegments

from .reference.mapping_reference import CAMERA, Solid, count_slots, integrate_voxel, orbit, render

FLOOR, TABLE, BOWL = (class_named(n).id for n in ("floor", "table", "bowl"))
SOLIDS = [
    Solid("plane", (0, 0, 1), 0.013, class_id=FLOOR, color=(120, 120, 120)),
    Solid("box", (0, 0, 0.37), (0.4, 0.3, 0.37), yaw=0.35, class_id=TABLE),
    Solid("ball", (0.1, 0.05, 0.86), 0.12, class_id=BOWL, color=(20, 40, 220)),
]
SETTINGS = MappingSettings(voxel_size_m=0.03, block_capacity=1024)
VOXEL_MM = 30.0
FLOAT_MM = 0.08
"""Half the step in which depth is packed, along an oblique ray, and float32 arithmetic."""
FADE = 5e-3
"""The same error of distance in a weight that fades over 9 cm, three frames, z > 0.9 m."""


def frames_of_room(count=10, noise_m=0.0):
    poses = orbit((0, 0, 0.4), 1.6, 1.1, count)
    return [render(SOLIDS, T, index=i, noise_m=noise_m) for i, T in enumerate(poses)]


@pytest.fixture(scope="module")
def frames():
    return frames_of_room()


@pytest.fixture(scope="module")
def mapped(frames):
    return map_of(frames)


def map_of(frames, settings=SETTINGS):
    mapper = PanopticMapper(CAMERA, settings)
    for frame, segments in frames:
        mapper.integrate(frame, segments)
    return mapper


def voxel_centers(mapper):
    corner = mapper.blocks.coords[: mapper.blocks.used, None] * BLOCK_SIDE + VOXEL_OFFSETS
    return (corner + 0.5) * mapper.settings.voxel_size_m


def volume(mapper, field):
    """A field of the pool in the order of block coordinates, so that two maps compare."""
    coords = mapper.blocks.coords[: mapper.blocks.used]
    return np.asarray(field)[: len(coords)][np.lexsort(coords.T)]


def distance_mm(vertices):
    return 1e3 * np.min([s.distance(vertices.astype(float)) for s in SOLIDS], 0)


def test_integration_equals_the_slow_twin(frames):
    """Every voxel of every block; one frame three times, so that all blocks are always active."""
    first, _ = frames[0]
    mapper = PanopticMapper(CAMERA, dataclasses.replace(SETTINGS, carve=False))
    for _ in range(3):
        mapper.integrate(*frames[0])
    centers = voxel_centers(mapper).reshape(-1, 3)
    sdf, weight = integrate_voxel(centers, [first] * 3, SETTINGS)
    used = mapper.blocks.used
    got_sdf = np.asarray(mapper.pool.sdf_m)[:used].ravel()
    got_weight = np.asarray(mapper.pool.weight)[:used].ravel()
    # float32 rounds a projection onto the other pixel now and then, at a depth edge by any depth
    same = np.abs(got_weight - weight) < FADE
    same &= np.abs(got_sdf - sdf) * 1e3 < FLOAT_MM
    assert same.mean() > 0.9995
    assert np.count_nonzero(weight) > 50_000


def test_mesh_lies_on_the_analytic_surface(mapped):
    surface = mapped.surface()
    error = distance_mm(surface.mesh.vertices)
    assert np.median(error) < 0.1 * VOXEL_MM
    assert np.percentile(error, 95) < 0.5 * VOXEL_MM
    assert np.percentile(error, 99.5) < VOXEL_MM


def test_mesh_covers_what_was_seen(frames, mapped):
    """Points of the last frame have a vertex within a voxel, borders of the view aside."""
    from scipy.spatial import cKDTree

    frame, _ = frames[-1]
    v, u = np.nonzero(frame.depth_m)
    ray = np.stack([(u - CAMERA.cx) / CAMERA.fx, (v - CAMERA.cy) / CAMERA.fy, np.ones_like(u)], 1)
    points = ray * frame.depth_m[v, u, None] @ frame.T_world_camera[:3, :3].T
    points = points + frame.T_world_camera[:3, 3]
    middle = np.linalg.norm(points[:, :2], axis=1) < 1.0
    gap, _ = cKDTree(mapped.surface().mesh.vertices).query(points[middle])
    assert np.mean(gap * 1e3 < VOXEL_MM) > 0.995


def test_normals_point_to_the_camera_side(mapped):
    mesh = mapped.surface().mesh
    ball = SOLIDS[2]
    on_ball = ball.distance(mesh.vertices) < 0.005
    away = mesh.vertices[on_ball] - np.array(ball.a)
    cosine = np.sum(mesh.normals[on_ball] * away / np.linalg.norm(away, axis=1)[:, None], 1)
    assert np.median(cosine) > 0.97
    p = mesh.vertices[mesh.faces]
    wound = np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])
    near = np.all(np.abs(p[..., :2]) < 1.0, axis=(1, 2))  # beyond, rays graze the floor
    agree = np.sum(wound * mesh.normals[mesh.faces].mean(1), 1)[near] > 0
    assert agree.mean() > 0.99
    assert np.allclose(np.linalg.norm(mesh.normals, axis=1), 1, atol=1e-5)


def test_every_solid_is_one_instance_of_its_class(mapped):
    surface = mapped.surface()
    assert sorted(surface.class_ids.tolist()) == sorted([FLOOR, TABLE, BOWL])
    truth = np.argmin([s.distance(surface.mesh.vertices) for s in SOLIDS], 0)
    said = np.array([0, *surface.class_ids])[
        np.searchsorted([0, *surface.instance_ids], surface.instance)
    ]
    assert np.mean(said == np.array([FLOOR, TABLE, BOWL])[truth]) > 0.97


def test_colour_is_that_of_the_solid(mapped):
    surface = mapped.surface()
    clear = SOLIDS[2].distance(surface.mesh.vertices) < 0.01
    clear &= surface.mesh.vertices[:, 2] > 0.9  # away from the table's colour
    assert np.abs(surface.mesh.colors[clear].astype(int) - SOLIDS[2].color).mean() < 6


def test_order_of_frames_does_not_matter_to_geometry(frames):
    """Below the cap a running mean is a sum: only float32 rounding depends on the order."""
    settings = dataclasses.replace(SETTINGS, carve=False)
    mapper = PanopticMapper(CAMERA, settings)
    for frame, segments in frames:  # so that both maps own all blocks from the start
        mapper.integrate(frame, segments)
    forward = integrated_again(mapper, frames)
    backward = integrated_again(mapper, frames[::-1])
    assert np.allclose(forward[1], backward[1], rtol=1e-5)
    assert np.abs(forward[0] - backward[0]).max() < 1e-5


def integrated_again(mapper, frames):
    """Distances and weights of the frames integrated into all blocks of a map, labels aside."""
    used = mapper.blocks.used
    pool = empty_pool(mapper.blocks.capacity, SETTINGS.label_slots)
    integrator = Integrator(CAMERA, mapper.scale, pool)
    rows = np.arange(used, dtype=np.int32)
    state = MapState(SETTINGS)
    state.blocks = mapper.blocks
    for frame, segments in frames:
        posed = mapper.posed(frame, segments)
        T = np.linalg.inv(frame.T_world_camera.astype(float))
        tables = segments.class_id, segments.instance
        integrator.integrate([state], [[ReadyFrame(posed.packed, T, rows, slice(0, 0), *tables)]])
    return np.asarray(integrator.pool.sdf_m)[:used], np.asarray(integrator.pool.weight)[:used]


def test_two_runs_give_the_same_bits(frames, mapped):
    again = map_of(frames)
    assert mapped.blocks.used == again.blocks.used
    for name in ("sdf_m", "weight", "color"):
        assert np.array_equal(getattr(mapped.pool, name), getattr(again.pool, name))
    assert all(np.array_equal(a, b) for a, b in zip(mapped.pool.labels, again.pool.labels))


def test_the_size_of_a_chunk_changes_nothing(frames, mapped, monkeypatch):
    monkeypatch.setattr("isr_jax.mapping.voxel_kernel._CHUNK_CPU", 96)
    other = map_of(frames)
    for name in ("sdf_m", "weight", "color"):
        assert np.array_equal(getattr(mapped.pool, name), getattr(other.pool, name))


def test_pool_grows_without_changing_the_map(frames, mapped):
    small = map_of(frames, dataclasses.replace(SETTINGS, block_capacity=64))
    assert small.blocks.capacity > 64
    assert np.array_equal(volume(small, small.pool.sdf_m), volume(mapped, mapped.pool.sdf_m))


def test_overflow_names_the_setting_and_keeps_the_map(frames):
    settings = dataclasses.replace(SETTINGS, block_capacity=64, max_blocks=128)
    mapper = PanopticMapper(CAMERA, settings)
    with pytest.raises(MapError, match=r"max_blocks = 128"):
        mapper.integrate(*frames[0])
    assert mapper.frames == 0
    assert len(mapper.surface().mesh.faces) == 0


def test_a_frame_of_another_size_is_refused(frames):
    half = (n / 2 for n in (CAMERA.fx, CAMERA.fy, CAMERA.cx, CAMERA.cy))
    other = Camera(*half, CAMERA.width // 2, CAMERA.height // 2)
    with pytest.raises(FrameError, match="the camera has"):
        PanopticMapper(other, SETTINGS).integrate(*frames[0])


def test_saved_and_continued_equals_uninterrupted(frames, mapped, tmp_path):
    half = map_of(frames[:5])
    half.save(tmp_path / "map.npz")
    resumed = PanopticMapper.load(tmp_path / "map.npz")
    for frame, segments in frames[5:]:
        resumed.integrate(frame, segments)
    assert resumed.frames == mapped.frames
    a, b = resumed.surface(), mapped.surface()
    assert np.array_equal(a.mesh.vertices, b.mesh.vertices)
    assert np.array_equal(a.mesh.faces, b.mesh.faces)
    assert np.array_equal(a.mesh.colors, b.mesh.colors)
    assert np.array_equal(a.instance, b.instance)
    assert resumed.labels.counts == mapped.labels.counts
    assert resumed.labels.instances.frames_apart == mapped.labels.instances.frames_apart
    assert all(np.array_equal(x, y) for x, y in zip(resumed.pool.labels, mapped.pool.labels))


def test_a_broken_checkpoint_is_refused(tmp_path):
    path = tmp_path / "map.npz"
    path.write_bytes(b"PK\x03\x04 cut off")
    with pytest.raises(MapError, match=r"map\.npz cannot be read"):
        PanopticMapper.load(path)


def test_people_leave_no_trace(frames):
    person = class_named("person").id
    mapper = PanopticMapper(CAMERA, SETTINGS)
    for frame, segments in frames:
        class_id = np.where(segments.class_id == BOWL, person, segments.class_id)
        mapper.integrate(frame, FrameSegments(segments.segment, class_id, segments.instance))
    surface = mapper.surface()
    assert person not in surface.class_ids
    assert np.count_nonzero(SOLIDS[2].distance(surface.mesh.vertices) < 0.01) < 30


def test_what_is_seen_through_is_freed():
    """A box that is taken away leaves the map; without carving its blocks would keep it."""
    poses = orbit((0, 0, 0.4), 1.6, 1.1, 4)
    before = [render(SOLIDS, T, index=i) for i, T in enumerate(poses)]
    after = [render(SOLIDS[:1], T, index=i) for i, T in enumerate(poses)] * 8
    left = {}
    for carve in (True, False):
        mapper = map_of(before + after, dataclasses.replace(SETTINGS, carve=carve))
        vertices = mapper.surface().mesh.vertices
        left[carve] = np.count_nonzero(vertices[:, 2] > 0.2)
    assert left[True] < 0.02 * left[False]


def test_an_empty_map_has_an_empty_surface():
    surface = PanopticMapper(CAMERA, SETTINGS).surface()
    assert len(surface.mesh.vertices) == 0 and len(surface.instance_ids) == 0


def test_a_frame_without_returns_changes_nothing(frames):
    mapper = map_of(frames[:2])
    before = np.asarray(mapper.pool.sdf_m).copy()
    frame, segments = frames[2]
    nothing = FrameSegments(np.zeros_like(segments.segment), segments.class_id, segments.instance)
    mapper.integrate(dataclasses.replace(frame, depth_m=0 * frame.depth_m), nothing)
    assert np.array_equal(before, mapper.pool.sdf_m)


def test_label_slots_follow_the_stated_policy():
    """Against the twin in words, one voxel per column, random labels from few to many."""
    rng = np.random.default_rng(5)
    voxels, rounds = 64, 60
    kinds = np.repeat([2, 3, 5, 9], voxels // 4)
    slots = tuple(jnp.zeros(voxels, jnp.uint32) for _ in range(3))
    twin = [[(0, 0)] * 3 for _ in range(voxels)]
    for _ in range(rounds):
        label = rng.integers(1, kinds + 1)
        slots = label_slots.count_label(slots, jnp.asarray(label, jnp.uint32))
        twin = [count_slots(t, int(one), 4095) for t, one in zip(twin, label, strict=True)]
    counts = np.stack([np.asarray(s) >> LABEL_BITS for s in slots], 1)
    names = np.stack([np.asarray(leading_labels(s)) for s in slots], 1)
    assert counts.tolist() == [[c for c, _ in t] for t in twin]
    for row, (got, expected) in enumerate(zip(names.tolist(), twin, strict=True)):
        assert set(zip(counts[row].tolist(), got)) == set(expected)


def test_renumbering_adds_up_slots_that_become_one():
    def slot(label, count):
        return jnp.full((64, 512), (count << LABEL_BITS) | label, jnp.uint32)

    table = np.array([0, 1, 1, 3], np.uint32)
    rows, first = np.arange(64, dtype=np.int32), np.zeros(64, np.int32)
    labels = slot(3, 9), slot(1, 6), slot(2, 5)
    out = label_slots.renumber_slots(labels, table[None], rows, first, np.int32(64))
    assert int(out[0][0, 0]) == (11 << LABEL_BITS) | 1
    assert int(out[1][0, 0]) == (9 << LABEL_BITS) | 3
    assert int(out[2][0, 0]) & ~LABEL_MASK == 0


def test_slots_of_forgotten_labels_are_empty():
    """Three voxels whose labels are 1, 2 and both; label 1 is forgotten, 2 becomes 1."""
    one, two = np.uint32(1 << LABEL_BITS | 1), np.uint32(3 << LABEL_BITS | 2)
    first = np.zeros((64, 512), np.uint32)
    second = np.zeros((64, 512), np.uint32)
    first[0, :3], second[0, 2] = [one, two, two], one
    slots = (jnp.asarray(first), jnp.asarray(second))
    found = label_slots.leading_somewhere(slots[0], np.array([0, 1], np.int32), 4)
    assert np.asarray(found).tolist() == [False, True, True, False]
    table = np.array([[0, 0, 1, 0]], np.uint32)
    rows = np.arange(64, dtype=np.int32)
    first, second = label_slots.renumber_slots(
        slots, table, rows, np.zeros(64, np.int32), np.int32(64)
    )
    renumbered = np.uint32(3 << LABEL_BITS | 1)
    assert np.asarray(first)[0, :4].tolist() == [0, renumbered, renumbered, 0]
    assert not np.asarray(second).any()
