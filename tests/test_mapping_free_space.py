"""What the map says of points: never seen, seen empty, surface; against the analytic room."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from isr_jax.mapping import PanopticMapper, free_space

from .mapping_films import SETTINGS, SOLIDS, film, map_of
from .reference.mapping_reference import CAMERA, Solid, look_at, render

FINE = dataclasses.replace(SETTINGS, voxel_size_m=0.015, block_capacity=8192)
BLOCK_M = 8 * FINE.voxel_size_m


@pytest.fixture(scope="module")
def mapped():
    return map_of(film(12, noise_m=0.0), FINE)


def seen_in(points, frame):
    """Whether a point lies in front of a frame's return, at its own pixel."""
    T = np.linalg.inv(frame.T_world_camera.astype(float))
    x, y, z = (points @ T[:3, :3].T + T[:3, 3]).T
    front = z > 0.05
    safe = np.where(front, z, 1.0)
    u = np.floor(x / safe * CAMERA.fx + CAMERA.cx + 0.5).astype(int)
    v = np.floor(y / safe * CAMERA.fy + CAMERA.cy + 0.5).astype(int)
    inside = front & (u >= 0) & (u < CAMERA.width) & (v >= 0) & (v < CAMERA.height)
    depth = np.zeros(len(points))
    depth[inside] = frame.depth_m[v[inside], u[inside]]
    return inside & (z < depth)


def block_seen_in(points, frame):
    """Whether all corners of a box four times the point's block are in front of returns."""
    center = (np.floor(points / BLOCK_M) + 0.5) * BLOCK_M
    corners = [(i & 1, i >> 1 & 1, i >> 2) for i in range(8)]
    return np.all([seen_in(center + (np.array(c) * 4 - 2) * BLOCK_M, frame) for c in corners], 0)


def inside_solids(points):
    """Within the table or the bowl, or under the floor."""
    cube = SOLIDS[1]
    c, s = np.cos(cube.yaw), np.sin(cube.yaw)
    local = (points - np.array(cube.a)) @ np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    within = np.all(np.abs(local) < np.array(cube.b), 1)
    within |= np.linalg.norm(points - np.array(SOLIDS[2].a), axis=1) < SOLIDS[2].b
    return within | (points[:, 2] < SOLIDS[0].b)


def test_what_is_called_empty_was_seen_and_is_empty(mapped):
    points = np.random.default_rng(2).uniform((-1.5, -1.5, -0.3), (1.5, 1.5, 1.8), (20000, 3))
    said = mapped.observed(points)
    empty = said == free_space.EMPTY
    np.testing.assert_array_equal(mapped.seen_empty(points), empty)
    deep = inside_solids(points)
    clearance = np.min([s.distance(points) for s in SOLIDS], 0)
    assert np.count_nonzero(empty & deep & (clearance > FINE.voxel_size_m)) == 0
    frames = film(12, noise_m=0.0)
    seen = np.any([seen_in(points[empty], frame) for frame, _ in frames], 0)
    assert seen.mean() > 0.995
    clear = np.any([block_seen_in(points, frame) for frame, _ in frames], 0)
    assert np.count_nonzero(clear) > 500
    assert np.mean(empty[clear]) > 0.85


def test_surface_is_where_the_solids_are(mapped):
    mesh = mapped.surface().mesh
    near = np.linalg.norm(mesh.vertices[:, :2], axis=1) < 1.0  # beyond, rays graze the floor
    on = mapped.observed(mesh.vertices[near].astype(np.float64)) == free_space.SURFACE
    assert on.mean() > 0.98


def test_where_nobody_looked_nothing_is_known(mapped):
    behind = np.array([[0.0, 0.0, -1.0], [50.0, 0.0, 0.0], [0.0, 0.0, 0.3]])
    np.testing.assert_array_equal(mapped.observed(behind), free_space.UNKNOWN)
    assert not PanopticMapper(CAMERA, SETTINGS).seen_empty(behind).any()


def test_a_hole_in_the_depth_image_frees_nothing():
    wall = [Solid("plane", (1, 0, 0), 3.0)]
    frame, segments = render(wall, look_at((0, 0, 1), (3, 0, 1)))
    depth_m = frame.depth_m.copy()
    depth_m[:, CAMERA.width // 2 :] = 0  # nothing came back on the right, where y < 0
    mapper = PanopticMapper(CAMERA, FINE)
    mapper.integrate(dataclasses.replace(frame, depth_m=depth_m), segments)
    line = np.linspace(0.8, 2.2, 15)
    left, right = (np.stack([line, y * line, np.ones(15)], 1) for y in (0.25, -0.25))
    assert mapper.seen_empty(left).all()
    assert not mapper.seen_empty(right).any()


def test_passes_are_counted_up_to_a_byte():
    wall = [Solid("plane", (1, 0, 0), 2.0)]
    pair = render(wall, look_at((0, 0, 1), (2, 0, 1)))
    mapper = PanopticMapper(CAMERA, dataclasses.replace(SETTINGS, voxel_size_m=0.04))
    mapper.integrate(*pair)
    passes = mapper.blocks.passes
    assert passes.max() == 1
    passes[passes > 0] = 254
    for _ in range(3):
        mapper.integrate(*pair)
    assert mapper.blocks.passes.max() == 255


def test_of_points_that_are_none_nothing_is_known(mapped):
    points = np.array([[np.nan, 0, 0], [np.inf, 0, 0], [0, 0, -1e30]])
    assert not mapped.seen_empty(points).any()
    assert (mapped.observed(points) == free_space.UNKNOWN).all()
