"""Rays against meshes whose depth is known in closed form."""

from __future__ import annotations

import numpy as np
import pytest

from isr_jax.borders.raycast import MISS, RayScene, camera_rays
from isr_jax.types import Camera, Mesh

from .builders import box_mesh, rotation_z

CAMERA = Camera(60.0, 60.0, 40.0, 30.0, 80, 60)
FLOAT32_DEPTH_M = 2e-5
"""A few float32 roundings of coordinates of a few metres."""
LOOK_ALONG_X = np.array([[0, 0, 1, 0], [-1, 0, 0, 0], [0, -1, 0, 0], [0, 0, 0, 1]], float)
"""A camera at the origin, forward +x, up +z."""


def wall_at(x: float, size: float = 40.0) -> Mesh:
    return box_mesh((0.1, size, size), (x + 0.05, 0, 0), spacing_m=100.0)


def test_depth_of_a_facing_plane_is_its_distance_everywhere():
    view = RayScene([wall_at(2.5)], [7]).view(CAMERA, LOOK_ALONG_X)
    np.testing.assert_allclose(view.depth_m, 2.5, atol=FLOAT32_DEPTH_M)
    assert np.all(view.instance == 7)
    np.testing.assert_allclose(view.normal, np.broadcast_to([-1, 0, 0], view.normal.shape))


def test_depth_of_a_slanted_plane():
    """n . (z r) = d, so z = d / (n . r) for the ray r through a pixel."""
    yaw = 0.5
    mesh = box_mesh((0.1, 40, 40), rotation_z(yaw) @ [3.05, 0, 0], yaw, spacing_m=100.0)
    view = RayScene([mesh], [1]).view(CAMERA, LOOK_ALONG_X)
    rays = camera_rays(CAMERA) @ LOOK_ALONG_X[:3, :3].T
    normal = rotation_z(yaw) @ np.array([1.0, 0, 0])
    np.testing.assert_allclose(view.depth_m, 3.0 / (rays @ normal), rtol=1e-5)


def test_a_box_covers_just_the_pixels_that_its_projection_does():
    box = box_mesh((0.4, 1.0, 0.57), (2.0, 0, 0), spacing_m=0.1)
    view = RayScene([box, wall_at(5.0)], [3, 4]).view(CAMERA, LOOK_ALONG_X)
    rays = camera_rays(CAMERA)
    inside = (np.abs(rays[..., 0]) * 1.8 < 0.5) & (np.abs(rays[..., 1]) * 1.8 < 0.285)
    np.testing.assert_array_equal(view.instance == 3, inside)
    np.testing.assert_allclose(view.depth_m, np.where(inside, 1.8, 5.0), atol=FLOAT32_DEPTH_M)


def test_a_miss_is_zero_and_never_infinite():
    view = RayScene([box_mesh((0.1, 0.1, 0.1), (3, 0, 0))], [1]).view(CAMERA, LOOK_ALONG_X)
    missed = view.instance == 0
    assert 0 < missed.sum() < missed.size
    assert np.all(view.depth_m[missed] == 0) and np.all(view.triangle[missed] == MISS)
    assert np.all(view.normal[missed] == 0) and np.isfinite(view.depth_m).all()


def test_triangles_count_over_all_meshes():
    near, far = box_mesh((0.2, 0.2, 0.2), (1, 0, 0), spacing_m=1.0), wall_at(4.0)
    view = RayScene([near, far], [5, 6]).view(CAMERA, LOOK_ALONG_X)
    of_far = view.triangle >= len(near.faces)
    np.testing.assert_array_equal(of_far, view.instance == 6)
    assert view.triangle.max() < len(near.faces) + len(far.faces)


@pytest.mark.parametrize("length", [0.5, 1.0, 3.0])
def test_distance_counts_in_lengths_of_the_direction(length):
    hits = RayScene([wall_at(2.0)], [1]).cast(np.zeros((1, 3)), np.array([[length, 0, 0]]))
    assert hits.distance[0] == pytest.approx(2.0 / length, rel=1e-6)


def test_a_rigid_motion_of_scene_and_camera_changes_nothing():
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = rotation_z(0.7), [1.0, -2.0, 0.3]
    box = box_mesh((0.4, 1.0, 0.6), (2.0, 0.1, 0), 0.3)
    moved = Mesh((box.vertices @ T[:3, :3].T + T[:3, 3]).astype(np.float32), box.faces)
    still = RayScene([box], [1]).view(CAMERA, LOOK_ALONG_X)
    other = RayScene([moved], [1]).view(CAMERA, T @ LOOK_ALONG_X)
    both = (still.instance == 1) & (other.instance == 1)
    assert both.sum() > 0.98 * (still.instance == 1).sum()
    inner = both & (still.triangle == other.triangle)  # edges may flip by a rounding
    np.testing.assert_allclose(still.depth_m[inner], other.depth_m[inner], atol=5e-5)


def test_barycentric_weights_give_the_point_that_was_hit():
    """P = (1 - u - v) A + u B + v C for the corners A, B, C of the triangle."""
    scene = RayScene([wall_at(2.5)], [7])
    rays = camera_rays(CAMERA).reshape(-1, 3) @ LOOK_ALONG_X[:3, :3].T
    hits, weights = scene.cast_into(np.zeros_like(rays), rays)
    corners = scene.vertices[scene.faces[hits.triangle]]
    whole = np.concatenate([1 - weights.sum(1, keepdims=True), weights], 1)
    points = np.einsum("rk,rki->ri", whole, corners)
    np.testing.assert_allclose(points, hits.distance[:, None] * rays, atol=FLOAT32_DEPTH_M)


@pytest.mark.parametrize(("reach", "expected"), [(0.99, False), (1.01, True), (5.0, True)])
def test_a_wall_blocks_what_reaches_it(reach, expected):
    blocked = RayScene([wall_at(2.0)], [1]).blocked(
        np.zeros((1, 3)), np.array([[2.0, 0, 0]]), reach
    )
    assert bool(blocked[0]) is expected
