"""Properties of the map that hold for any frames, through the public interface alone."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import cKDTree

from isr_jax.classes import class_named
from isr_jax.config import MappingSettings
from isr_jax.mapping import PanopticMapper
from isr_jax.types import FrameSegments, PanopticSurface

from .reference.mapping_reference import CAMERA, Solid, orbit, render

FLOOR, TABLE, BOWL = (class_named(n).id for n in ("floor", "table", "bowl"))
SOLIDS = [
    Solid("plane", (0, 0, 1), 0.013, class_id=FLOOR, color=(120, 120, 120)),
    Solid("box", (0, 0, 0.37), (0.4, 0.3, 0.37), yaw=0.35, class_id=TABLE),
    Solid("ball", (0.1, 0.05, 0.86), 0.12, class_id=BOWL, color=(20, 40, 220)),
]
VOXEL_M = 0.05
SETTINGS = MappingSettings(voxel_size_m=VOXEL_M, block_capacity=256, min_votes=5)
COUNT = 8
VIEWS = [
    render(SOLIDS, T, index=i, noise_m=0.002)
    for i, T in enumerate(orbit((0, 0, 0.4), 1.6, 1.1, COUNT))
]
few = settings(max_examples=6, deadline=None)
splits = st.integers(1, COUNT - 1)
orders = st.permutations(range(COUNT))


def map_of(views, mapper=None):
    mapper = mapper or PanopticMapper(CAMERA, SETTINGS)
    for frame, segments in views:
        mapper.integrate(frame, segments)
    return mapper


@pytest.fixture(scope="module")
def surface() -> PanopticSurface:
    return map_of(VIEWS).surface()


def assert_same(one: PanopticSurface, other: PanopticSurface) -> None:
    """Bit for bit, the order of vertices and faces included."""
    for name in ("vertices", "faces", "colors", "normals"):
        assert np.array_equal(getattr(one.mesh, name), getattr(other.mesh, name)), name
    for name in ("instance", "instance_ids", "class_ids"):
        assert np.array_equal(getattr(one, name), getattr(other, name)), name


def assert_near(one: PanopticSurface, vertices: np.ndarray, share: float = 0.999) -> None:
    """The same surface but for rounding: nearly all vertices have one within a fiftieth voxel."""
    assert len(one.mesh.vertices) > 1000
    for a, b in ((one.mesh.vertices, vertices), (vertices, one.mesh.vertices)):
        gap, _ = cKDTree(b).query(a)
        assert np.mean(gap < 0.02 * VOXEL_M) > share


def class_of_vertices(surface: PanopticSurface) -> np.ndarray:
    table = np.concatenate([[0], surface.class_ids])
    return table[np.searchsorted(np.concatenate([[0], surface.instance_ids]), surface.instance)]


def test_two_runs_give_the_same_bits(surface):
    assert_same(map_of(VIEWS).surface(), surface)


@few
@given(orders, orders)
def test_the_order_of_frames_does_not_matter_to_the_surface(first, second):
    """Below the weight cap a mean knows no order, once all blocks are there.

    A block begins with the first frame that comes near it, so both maps see all frames once
    before, in one order.
    """
    one, other = (
        map_of([VIEWS[i] for i in order], map_of(VIEWS)).surface() for order in (first, second)
    )
    assert_near(one, other.mesh.vertices)
    found, expected = class_of_vertices(one), class_of_vertices(other)
    _, nearest = cKDTree(other.mesh.vertices).query(one.mesh.vertices)
    assert np.mean(found == expected[nearest]) > 0.98


@few
@given(splits)
def test_saved_and_continued_is_as_uninterrupted(surface, tmp_path_factory, split):
    path = tmp_path_factory.mktemp("map") / "map.npz"
    half = map_of(VIEWS[:split])
    half.save(path)
    loaded = PanopticMapper.load(path)
    assert loaded.frames == split and loaded.settings == SETTINGS
    assert_same(loaded.surface(), half.surface())
    assert_same(map_of(VIEWS[split:], loaded).surface(), surface)
    assert_same(map_of(VIEWS[split:], half).surface(), surface)


def test_a_map_saved_again_and_again_stays_the_same(surface, tmp_path):
    mapper = PanopticMapper(CAMERA, SETTINGS)
    for view in VIEWS:
        map_of([view], mapper).save(tmp_path / "map.npz")
        mapper = PanopticMapper.load(tmp_path / "map.npz")
    mapper.save(tmp_path / "again.npz")
    assert_same(mapper.surface(), surface)
    with np.load(tmp_path / "map.npz") as a, np.load(tmp_path / "again.npz") as b:
        assert sorted(a.files) == sorted(b.files)
        assert all(np.array_equal(a[name], b[name]) for name in a.files)


@few
@given(st.sets(splits))
def test_asking_for_the_surface_changes_nothing(surface, asked):
    """A map that is watched live ends as one that is not."""
    mapper = PanopticMapper(CAMERA, SETTINGS)
    for i, view in enumerate(VIEWS):
        map_of([view], mapper)
        if i in asked:
            assert_same(mapper.surface(), map_of(VIEWS[: i + 1]).surface())
    assert_same(mapper.surface(), surface)


def test_the_caller_may_use_its_buffers_again(surface):
    """A camera driver fills the same arrays with every frame."""
    mapper = PanopticMapper(CAMERA, SETTINGS)
    frame, segments = VIEWS[0]
    images = frame.color.copy(), frame.depth_m.copy(), segments.segment.copy()
    pose, tables = frame.T_world_camera.copy(), (segments.class_id.copy(), segments.instance.copy())
    for frame, segments in VIEWS:
        buffers = (*images, pose, *tables)
        values = (frame.color, frame.depth_m, segments.segment, frame.T_world_camera)
        for buffer, value in zip(buffers, (*values, segments.class_id, segments.instance)):
            buffer[...] = value
        color, depth_m, segment = images
        mapper.integrate(
            dataclasses.replace(frame, color=color, depth_m=depth_m, T_world_camera=pose),
            FrameSegments(segment, *tables),
        )
        for buffer in buffers:
            buffer[...] = 0
    assert_same(mapper.surface(), surface)


def test_a_frame_integrated_twice_is_the_same_surface():
    once, twice = map_of(VIEWS[:1]).surface(), map_of(VIEWS[:1] * 2).surface()
    assert_near(twice, once.mesh.vertices)


@few
@given(st.tuples(*[st.integers(-200, 200)] * 3), st.integers(0, 3))
def test_the_map_moves_with_the_poses(surface, voxels, quarters):
    """Whole voxels and quarter turns map the lattice onto itself: the same surface, moved."""
    c, s = [(1, 0), (0, 1), (-1, 0), (0, -1)][quarters]
    T = np.array([[c, -s, 0, 0], [s, c, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1.0]])
    T[:3, 3] = np.array(voxels) * VOXEL_M
    moved = []
    for frame, segments in VIEWS:
        pose = (T @ frame.T_world_camera).astype(np.float32)
        moved.append((dataclasses.replace(frame, T_world_camera=pose), segments))
    # float32 projects a voxel onto the other pixel now and then, and blocks begin elsewhere
    assert_near(map_of(moved).surface(), surface.mesh.vertices @ T[:3, :3].T + T[:3, 3], 0.97)


@few
@given(st.randoms(use_true_random=False))
def test_the_numbers_of_segments_do_not_matter(surface, random):
    """The same segments under other numbers: the same instances, up to theirs."""
    renamed = []
    for frame, segments in VIEWS:
        rows = [0, *random.sample(range(1, len(segments.class_id)), len(segments.class_id) - 1)]
        position = np.argsort(rows).astype(np.int32)
        tables = segments.class_id[rows], segments.instance[rows]
        renamed.append((frame, FrameSegments(position[segments.segment], *tables)))
    found = map_of(renamed).surface()
    assert np.array_equal(found.mesh.vertices, surface.mesh.vertices)
    assert np.array_equal(class_of_vertices(found), class_of_vertices(surface))
    pairs = set(zip(found.instance.tolist(), surface.instance.tolist(), strict=True))
    assert len(pairs) == len(set(found.instance)) == len(set(surface.instance))
