"""Geometry kernels against slow twins, group laws and analytic cases."""

from __future__ import annotations

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from isr_jax import geometry
from isr_jax.geometry.tight_box import tight_box
from isr_jax.types import Box, PlaneSet

from .builders import box_mesh, box_planes, rotation_z
from .reference import geometry_reference as slow

METRES = 2e-5
"""float32 holds a room's coordinates (10 m) to 1e-6; a few operations lose a digit more."""

_overlap = jax.jit(geometry.convex_overlap_area)
_iou = jax.jit(geometry.box_iou)
_depth = jax.jit(geometry.box_overlap_depth)


def random_box(rng: np.random.Generator, spread: float = 0.6) -> Box:
    center = np.array([3.0, -2.0, 1.0]) + rng.uniform(-spread, spread, 3)
    size = rng.uniform(0.1, 1.5, 3)
    return geometry.canonical_box(center, rng.uniform(-np.pi, np.pi), size)


@pytest.mark.parametrize("seed", range(40))
def test_boxes_agree_with_twin(seed):
    rng = np.random.default_rng(seed)
    a, b = random_box(rng), random_box(rng)
    footprints = geometry.footprint_corners(a), geometry.footprint_corners(b)
    common = slow.convex_overlap(slow.footprint_of(a), slow.footprint_of(b))
    np.testing.assert_allclose(_overlap(*footprints), common, atol=METRES)
    np.testing.assert_allclose(_overlap(*footprints[::-1]), common, atol=METRES)
    np.testing.assert_allclose(_iou(a, b), slow.iou(a, b), atol=1e-4)
    np.testing.assert_allclose(_depth(a, b), slow.overlap_depth(a, b), atol=METRES)
    same = np.sort(geometry.box_corners(a), axis=0), np.sort(slow.corners_of(a), axis=0)
    np.testing.assert_allclose(*same, atol=METRES)


def test_overlap_depth_is_positive_exactly_where_boxes_meet():
    rng = np.random.default_rng(7)
    outcomes = set()
    for _ in range(60):
        a, b = random_box(rng, 1.0), random_box(rng, 1.0)
        depth = float(_depth(a, b))
        if abs(depth) > 1e-4:
            assert (depth > 0) == slow.boxes_meet(a, b)
            outcomes.add(depth > 0)
    assert outcomes == {True, False}


def test_overlap_depth_is_the_move_that_separates():
    a = geometry.canonical_box(np.zeros(3), 0.0, np.array([2.0, 2, 2]))
    b = geometry.canonical_box(np.array([0.9, 0.2, 0.0]), 0.0, np.array([0.4, 0.4, 0.4]))
    assert float(_depth(a, b)) == pytest.approx(0.3, abs=METRES)  # 1.0 - (0.9 - 0.2)
    moved = geometry.canonical_box(np.array([1.21, 0.2, 0.0]), 0.0, np.array([0.4, 0.4, 0.4]))
    assert float(_depth(a, moved)) == pytest.approx(-0.01, abs=METRES)


def test_a_box_far_out_overlaps_itself_wholly():
    box = geometry.canonical_box(np.array([80.0, -90.0, 1.0]), 0.3, np.array([0.08, 0.06, 0.1]))
    assert float(_iou(box, box)) == pytest.approx(1.0, abs=1e-3)


@pytest.mark.parametrize("yaw", [-3.0, -0.9, -np.pi / 4, 0.0, 0.7, np.pi / 4, 1.6, 3.1])
def test_canonical_box_is_the_same_solid_with_yaw_in_range(yaw):
    center, size = np.array([1.0, 2.0, 0.5]), np.array([0.6, 1.2, 0.9])
    box = geometry.canonical_box(center, yaw, size)
    assert -np.pi / 4 - 1e-6 <= float(box.yaw) < np.pi / 4 + 1e-6
    plain = Box(center, np.asarray(yaw), size)
    ours, theirs = slow.corners_of(box), slow.corners_of(plain)
    gaps = np.linalg.norm(ours[:, None] - theirs[None], axis=-1)
    assert gaps.min(1).max() < METRES


def test_points_in_box_frame_puts_corners_at_half_sizes():
    box = geometry.canonical_box(np.array([1.0, 2.0, 3.0]), 0.4, np.array([0.6, 1.2, 0.9]))
    local = geometry.points_in_box_frame(box, geometry.box_corners(box))
    np.testing.assert_allclose(np.abs(local), np.tile(box.size / 2, (8, 1)), atol=METRES)


def test_cube_rotations_are_the_rotation_group_of_the_cube():
    turns = geometry.CUBE_ROTATIONS
    assert turns.shape == (24, 3, 3)
    keys = {tuple(turn.ravel()) for turn in turns}
    assert len(keys) == 24
    for a in turns:
        np.testing.assert_array_equal(a @ a.T, np.eye(3))
        assert np.linalg.det(a) == pytest.approx(1.0)
        assert tuple(a.T.ravel()) in keys
        assert all(tuple((a @ b).ravel()) in keys for b in turns)


def test_first_four_rotations_are_upright_quarter_turns():
    for quarter, turn in enumerate(geometry.CUBE_ROTATIONS[:4]):
        expected = slow.rotation_z(quarter * np.pi / 2)
        np.testing.assert_allclose(turn, expected, atol=1e-7)
    assert not np.any(geometry.CUBE_ROTATIONS[4:, 2, 2] == 1)


def test_rotated_size_is_the_extent_of_the_turned_corners():
    size = np.array([0.3, 0.7, 1.9], np.float32)
    corners = slow.corners_of(Box(np.zeros(3), np.zeros(()), size))
    for turn in geometry.CUBE_ROTATIONS:
        extent = np.ptp(corners @ turn.T, axis=0)
        np.testing.assert_allclose(geometry.rotated_size(turn, size), extent, atol=1e-6)


@settings(max_examples=30, deadline=None, derandomize=True)
@given(
    scale=st.floats(0.3, 3.0),
    angle=st.floats(-3.0, 3.0),
    shift=st.tuples(*[st.floats(-3, 3)] * 3),
    seed=st.integers(0, 1000),
)
def test_moved_planes_hold_the_moved_points(scale, angle, shift, seed):
    rng = np.random.default_rng(seed)
    normal = rng.normal(size=(3, 3))
    normal = (normal / np.linalg.norm(normal, axis=-1, keepdims=True)).astype(np.float32)
    offset = rng.uniform(-2, 2, 3).astype(np.float32)
    turn = np.asarray(geometry.rot_z(jnp.float32(angle)) @ geometry.CUBE_ROTATIONS[seed % 24])
    shift = np.asarray(shift, np.float32)
    moved_n, moved_d = geometry.transform_planes(jnp.float32(scale), turn, shift, normal, offset)
    np.testing.assert_allclose(np.linalg.norm(moved_n, axis=-1), 1.0, atol=1e-5)
    on_plane = -offset[:, None] * normal + np.cross(normal, rng.normal(size=(3, 3)))
    moved = scale * on_plane @ turn.T + shift
    np.testing.assert_allclose(np.sum(moved_n * moved, -1) + moved_d, 0.0, atol=1e-4)


def test_height_of_a_tilted_plane():
    tilt = np.array([0.1, -0.05, 1.0])
    normal = (tilt / np.linalg.norm(tilt)).astype(np.float32)
    point = np.array([0.4, 1.5, 0.73], np.float32)
    offset = np.float32(-normal @ point)
    height = geometry.plane_height_at(normal, jnp.asarray(offset), point[:2])
    assert float(height) == pytest.approx(0.73, abs=METRES)


@pytest.mark.parametrize("seed", range(5))
def test_rigid_transforms_compose_and_invert(seed):
    rng = np.random.default_rng(seed)
    turn = geometry.rot_z(jnp.asarray(rng.uniform(-3, 3), jnp.float32))
    T = geometry.make_T(turn @ geometry.CUBE_ROTATIONS[9], jnp.asarray(rng.normal(size=3)))
    np.testing.assert_allclose(geometry.invert_T(T) @ T, np.eye(4), atol=1e-6)


@settings(max_examples=30, deadline=None, derandomize=True)
@given(st.floats(-50, 50))
def test_wrapped_angle_is_the_same_direction(angle):
    wrapped = float(geometry.wrap_angle(jnp.float32(angle)))
    assert -np.pi - 1e-5 <= wrapped <= np.pi + 1e-5
    assert np.cos(wrapped) == pytest.approx(np.cos(np.float32(angle)), abs=1e-4)
    assert np.sin(wrapped) == pytest.approx(np.sin(np.float32(angle)), abs=1e-4)


def test_point_triangle_distance_agrees_with_twin_also_on_degenerate_triangles():
    rng = np.random.default_rng(3)
    triangles = rng.normal(size=(300, 3, 3)).astype(np.float32)
    triangles[:50, 2] = triangles[:50, 1]  # a segment
    triangles[50:60] = triangles[50:60, :1]  # a point
    points = rng.normal(size=(300, 3)).astype(np.float32) * 2
    squared = jax.jit(jax.vmap(geometry.point_triangle_distance_sq))(points, triangles)
    expected = [slow.point_triangle_distance(*pair) for pair in zip(points, triangles)]
    np.testing.assert_allclose(np.sqrt(squared), expected, atol=2e-4)


def test_point_triangle_distance_has_finite_gradients():
    triangle = np.zeros((3, 3), np.float32)
    gradient = jax.grad(geometry.point_triangle_distance_sq)(np.ones(3, np.float32), triangle)
    assert np.all(np.isfinite(gradient))


def test_points_to_mesh_distance_of_a_box_is_analytic():
    size = np.array([0.8, 0.5, 0.3])
    mesh = box_mesh(size, spacing_m=0.2)
    rng = np.random.default_rng(5)
    points = rng.uniform(-1, 1, (300, 3)).astype(np.float32)
    out = np.abs(points) - size / 2
    outside = np.linalg.norm(np.maximum(out, 0), axis=-1)
    expected = np.where(outside > 0, outside, -out.max(-1))
    faces = np.concatenate([mesh.faces, np.zeros((7, 3), np.int32)])
    valid = np.arange(len(faces)) < len(mesh.faces)
    measured = geometry.points_to_mesh_distance(points, mesh.vertices, faces, valid)
    np.testing.assert_allclose(measured, expected, atol=METRES)


@pytest.mark.parametrize("count", [0, 1, 3])
def test_stacked_boxes_come_apart_again(count):
    rng = np.random.default_rng(count)
    boxes = [random_box(rng) for _ in range(count)]
    stacked = geometry.stack_boxes(boxes)
    assert stacked.center.shape == stacked.size.shape == (count, 3)
    for i, box in enumerate(boxes):
        for field in ("center", "yaw", "size"):
            apart = getattr(geometry.box_at(stacked, i), field)
            np.testing.assert_array_equal(apart, getattr(box, field))


@pytest.mark.parametrize("yaw", [0.0, 0.3, -0.7])
def test_tight_box_of_a_turned_box(yaw):
    points = box_mesh((1.0, 0.4, 0.8), (2, -1, 0.4), yaw, spacing_m=0.1).vertices
    box = tight_box(points)
    np.testing.assert_allclose(box.center, (2, -1, 0.4), atol=1e-5)
    np.testing.assert_allclose(sorted(box.size), (0.4, 0.8, 1.0), atol=1e-5)
    local = (points - box.center) @ rotation_z(float(box.yaw))
    assert np.all(np.abs(local) <= np.asarray(box.size) / 2 + 1e-5)


def test_the_tight_box_is_no_larger_than_any_turned_one():
    """Against every angle in steps of a quarter of a degree."""
    rng = np.random.default_rng(5)
    for _ in range(5):
        points = rng.normal(size=(40, 3)) * [1.0, 0.4, 0.2]
        box = tight_box(points)
        angles = np.deg2rad(np.arange(0, 90, 0.25))
        u = points[:, 0] * np.cos(angles)[:, None] + points[:, 1] * np.sin(angles)[:, None]
        v = points[:, 1] * np.cos(angles)[:, None] - points[:, 0] * np.sin(angles)[:, None]
        brute = (np.ptp(u, axis=1) * np.ptp(v, axis=1)).min()
        assert float(box.size[0] * box.size[1]) <= brute + 1e-6
        c, s = np.cos(float(box.yaw)), np.sin(float(box.yaw))
        local = (points - box.center) @ np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
        assert (np.abs(local) <= box.size / 2 + 1e-5).all()


@pytest.mark.parametrize(
    "points", [[[1, 2, 3]], [[0, 0, 0], [1, 1, 1]], [[0, 0, 0], [1, 1, 0], [2, 2, 5]]]
)
def test_points_without_a_footprint_have_a_flat_box(points):
    box = tight_box(np.array(points, float))
    assert np.isfinite(box.center).all() and min(box.size[:2]) == pytest.approx(0, abs=1e-6)
    assert np.hypot(*box.size[:2]) == pytest.approx(np.hypot(*np.ptp(points, axis=0)[:2]), abs=1e-6)


@pytest.mark.parametrize("seed", range(4))
def test_the_nearest_rotation_is_one_and_no_rotation_is_nearer(seed):
    rng = np.random.default_rng(seed)
    true = geometry.smallest_rotation(*(v / np.linalg.norm(v) for v in rng.normal(size=(2, 3))))
    matrix = true + rng.normal(0, 0.01, (3, 3))
    found = geometry.nearest_rotation(matrix)
    np.testing.assert_allclose(found @ found.T, np.eye(3), atol=1e-12)
    assert np.linalg.det(found) > 0
    np.testing.assert_allclose(geometry.nearest_rotation(true), true, atol=1e-12)
    for angle in rng.normal(0, 0.01, 20):
        other = found @ rotation_z(angle)
        assert np.linalg.norm(found - matrix) <= np.linalg.norm(other - matrix)


def test_host_and_kernel_agree_on_the_height_of_a_plane():
    rng = np.random.default_rng(0)
    normal = rng.normal((0, 0, 1), 0.2, (20, 3))
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    offset, xy = rng.normal(size=20), rng.normal(size=(20, 2))
    height = geometry.plane_heights(normal, offset, xy)
    on_plane = np.sum(normal * np.column_stack([xy, height]), 1) + offset
    np.testing.assert_allclose(on_plane, 0, atol=1e-12)
    kernel = jax.vmap(geometry.plane_height_at)(
        *(a.astype(np.float32) for a in (normal, offset, xy))
    )
    np.testing.assert_allclose(height, kernel, atol=METRES)


def test_stacked_planes_are_the_sets_and_finite_padding():
    sets = [box_planes((1, 1, 1), (0, 0, 0), faces=faces) for faces in ((0, 2, 3), (1,))]
    stacked = geometry.stack_planes(sets, 2)
    assert stacked.valid.tolist() == [[True, True, True], [True, False, False]]
    for row, planes in enumerate(sets):
        for leaf, whole in zip(jax.tree.leaves(planes), jax.tree.leaves(stacked), strict=True):
            np.testing.assert_array_equal(whole[row, : len(leaf)], leaf)
    np.testing.assert_array_equal(stacked.normal[1, 1:], [[0, 0, 1]] * 2)
    assert not np.any(stacked.corners[1, 1:]) and not np.any(stacked.offset[1, 1:])
    assert geometry.stack_planes(sets, 8).offset.shape == (2, 8)
    none: list[PlaneSet] = []
    assert geometry.stack_planes(none).offset.shape == (0, 1)


@pytest.mark.parametrize(
    ("shift_m", "slack_m", "beside"), [(0.0, 0.0, True), (3.0, 0.0, False), (3.0, 1.0, True)]
)
def test_a_box_is_beside_a_wall_along_its_length_only(shift_m, slack_m, beside):
    wall = np.array([(0, -1, 0), (0, 1, 0), (0, 1, 1), (0, -1, 1)], np.float32)
    box = np.array([(5.0, y + shift_m, z) for y in (-1.5, 1.5) for z in (7, 9)])
    normal = np.array([1.0, 0.0, 0.0])
    assert geometry.beside_wall(box, normal, wall, slack_m) == beside
