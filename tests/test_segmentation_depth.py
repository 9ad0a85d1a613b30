"""Depth segments: kernels against their slow twins, and analytic scenes."""

from __future__ import annotations

import jax
import numpy as np
import pytest

from isr_jax.config import SegmentationSettings
from isr_jax.segmentation import depth_kernels, segment_depth
from isr_jax.types import Camera

from .reference import segmentation_reference as reference

SMALL = Camera(40.0, 42.0, 15.5, 12.0, 32, 24)
CAMERA = Camera(290.0, 290.0, 159.5, 119.5, 320, 240)
SETTINGS = SegmentationSettings()
NORMAL_TOLERANCE = 2e-4
"""Float32 sums over 169 inverse depths of about 0.5 1/m."""


def pixel_rays(camera: Camera) -> np.ndarray:
    """Viewing rays with z = 1."""
    return reference.back_project(np.ones((camera.height, camera.width)), camera)


def plane_depth(camera: Camera, normal, offset: float) -> np.ndarray:
    """Depth of the plane normal . v = offset; 0 where a ray misses it."""
    rays = pixel_rays(camera)
    slope = rays @ np.asarray(normal, np.float64)
    with np.errstate(divide="ignore"):
        depth = offset / slope
    return np.where((slope * offset > 0) & (depth < 10), depth, 0.0).astype(np.float32)


def box_depth(camera: Camera, low, high) -> np.ndarray:
    """Depth of a box of the camera frame; 0 where a ray misses it."""
    rays = pixel_rays(camera)
    rays = np.where(np.abs(rays) < 1e-9, 1e-9, rays)
    ends = np.stack([np.asarray(low) / rays, np.asarray(high) / rays])
    near, far = ends.min(0).max(-1), ends.max(0).min(-1)
    return np.where((near <= far) & (far > 0), near, 0.0).astype(np.float32)


def nearest(*depths: np.ndarray) -> np.ndarray:
    far = np.min([np.where(d > 0, d, np.inf) for d in depths], 0)
    return np.where(np.isfinite(far), far, 0).astype(np.float32)


@pytest.fixture(scope="module")
def small_depth() -> np.ndarray:
    """Two planes, a box, a step, noise and dropouts."""
    rng = np.random.default_rng(0)
    depth = nearest(
        plane_depth(SMALL, (0.1, -0.2, 1.0), 2.0),
        plane_depth(SMALL, (0.0, 0.8, 0.6), 1.1),
        box_depth(SMALL, (-0.4, -0.2, 1.2), (-0.1, 0.2, 1.6)),
    )
    depth = depth * (1 + 1e-3 * rng.standard_normal(depth.shape))
    depth[rng.random(depth.shape) < 0.05] = 0
    return depth.astype(np.float32)


def test_normals_equal_the_twin(small_depth):
    found, valid = jax.jit(depth_kernels.normals, static_argnums=2)(
        small_depth, SMALL, 7, np.array(0.05, np.float32)
    )
    wanted, wanted_valid = reference.normals(small_depth.astype(np.float64), SMALL, 7, 0.05)
    differs = np.asarray(valid) != wanted_valid
    assert differs.mean() < 0.01  # pixels on the edge of the gate or of rank 3
    both = np.asarray(valid) & wanted_valid
    gap = np.linalg.norm(np.asarray(found) - np.moveaxis(wanted, -1, 0), axis=0)[both]
    # A neighbour that float32 puts on the other side of the gate moves its pixel's normal.
    assert np.quantile(gap, 0.98) < NORMAL_TOLERANCE
    lengths = np.linalg.norm(np.asarray(found), axis=0)
    np.testing.assert_allclose(lengths, np.asarray(valid), atol=1e-5)


@pytest.mark.parametrize("normal", [(0, 0, 1), (0.3, -0.2, 0.9), (0, 0.8, 0.6)])
def test_normals_of_a_plane_are_exact(normal):
    unit = np.asarray(normal) / np.linalg.norm(normal)
    depth = plane_depth(CAMERA, unit, 1.5)
    found, valid = jax.jit(depth_kernels.normals, static_argnums=2)(
        depth, CAMERA, 13, np.array(0.05, np.float32)
    )
    inside = np.asarray(valid) & (depth < 4)
    assert inside.sum() > 0.3 * depth.size
    gap = np.linalg.norm(np.asarray(found) + unit[:, None, None], axis=0)[inside]
    # Rounding of inverse depth to 2^-24 over windows of 7 pixels to the side.
    assert np.quantile(gap, 0.99) < 2e-3


def test_discontinuity_and_convexity_equal_the_twin(small_depth):
    normal, _ = reference.normals(small_depth.astype(np.float64), SMALL, 7, 0.05)
    normal, images = normal.astype(np.float32), np.moveaxis(normal, -1, 0).astype(np.float32)
    ratio = np.array(0.01, np.float32)
    steps = depth_kernels.discontinuity_map(small_depth, images, SMALL, 3, ratio)
    wanted = reference.discontinuity_map(small_depth, normal, SMALL, 3, 0.01)
    assert (np.asarray(steps) != wanted).mean() < 0.002
    assert 0.05 < wanted.mean() < 0.6
    phi = depth_kernels.convexity_map(small_depth, images, SMALL, 5, np.array(-0.0005, np.float32))
    wanted = reference.convexity_map(small_depth, normal, SMALL, 5, -0.0005)
    assert np.quantile(np.abs(np.asarray(phi) - wanted), 0.99) < 1e-4
    assert wanted.min() < 0.9, "the scene has concave pixels"


def test_join_equals_the_twin(small_depth):
    label = np.zeros(small_depth.shape, np.int32)
    label[4:8, 4:9], label[14:20, 20:28], label[0:3, 26:30] = 1, 2, 3
    label[small_depth == 0] = 0
    found = depth_kernels.join_edges(label, small_depth, SMALL, 9, np.array(0.15, np.float32))
    wanted = reference.join_edges(label, small_depth.astype(np.float64), SMALL, 9, 0.15)
    assert (np.asarray(found) != wanted).mean() < 0.005  # ties of distance
    assert (np.asarray(found) > 0).sum() > (label > 0).sum()


def test_opening_and_closing_remove_specks_and_keep_planes():
    mask = np.ones((20, 30), bool)
    mask[5, 7] = False  # a speck of an edge
    mask[:, 18:22] = False  # an edge
    mask[10:12, 20] = True  # a speck on it
    result = np.asarray(depth_kernels.opened_closed(mask))
    assert result[5, 7]
    assert not result[10:12, 20].any()
    assert result[:, :17].all()
    assert not result[:, 19:21].any()


def test_a_grazing_floor_has_no_steps_and_a_ledge_has():
    normal = np.array([0, 0.995, 0.0995]) / np.linalg.norm([0, 0.995, 0.0995])
    floor = plane_depth(CAMERA, normal, 0.5)
    floor[floor > 3.5] = 0
    step = np.abs(np.diff(floor, axis=0))[(floor[1:] > 0) & (floor[:-1] > 0)]
    assert (step > 0.01 * 3).mean() > 0.01, "rows of pixels step by more than the ratio"
    normals = np.where(floor > 0, -normal[:, None, None], 0).astype(np.float32)
    ratio = np.array(0.01, np.float32)
    found = depth_kernels.discontinuity_map(floor, normals, CAMERA, 3, ratio)
    assert not np.asarray(found).any()
    ledge = np.where(np.arange(320) < 160, 1.0, 1.05) * np.ones((240, 1))
    facing = np.zeros((3, 240, 320), np.float32)
    facing[2] = -1
    found = depth_kernels.discontinuity_map(ledge.astype(np.float32), facing, CAMERA, 3, ratio)
    assert np.array_equal(np.flatnonzero(np.asarray(found).all(0)), [159, 160])


def dominant(label: np.ndarray, where: np.ndarray) -> tuple[int, float]:
    counts = np.bincount(label[where])
    return int(counts.argmax()), counts.max() / np.count_nonzero(where)


def corner(concave: bool) -> tuple[np.ndarray, np.ndarray]:
    """Two planes that meet at a vertical edge in the middle, at 90 degrees."""
    left = plane_depth(CAMERA, (0.7071, 0, 0.7071), 1.3)
    right = plane_depth(CAMERA, (-0.7071, 0, 0.7071), 1.3)
    # The nearer surface of two is an inner corner (a room's), the farther one an outer edge.
    both = np.stack([np.where(d > 0, d, np.inf) for d in (left, right)])
    depth = both.min(0) if concave else both.max(0)
    depth = np.where(np.isfinite(depth), depth, 0).astype(np.float32)
    return depth, np.broadcast_to(np.arange(320) < 160, depth.shape)


def test_a_concave_corner_divides():
    depth, is_left = corner(concave=True)
    label = segment_depth(depth, CAMERA, SETTINGS)
    left, share = dominant(label, is_left)
    right, share_right = dominant(label, ~is_left)
    assert left != right
    assert min(share, share_right) > 0.95


def test_a_convex_edge_does_not():
    depth, is_left = corner(concave=False)
    near = (depth > 0) & (depth < 3)
    label = segment_depth(depth, CAMERA, SETTINGS)
    left, share = dominant(label, is_left & near)
    right, share_right = dominant(label, ~is_left & near)
    assert left == right > 0
    assert min(share, share_right) > 0.95


@pytest.fixture(scope="module")
def box_on_plane():
    """A 20 cm box on a table top seen obliquely (camera frame, y down), a wall behind."""
    tilt = np.deg2rad(35)
    up = np.array([0, -np.cos(tilt), -np.sin(tilt)])
    floor = plane_depth(CAMERA, -up, 0.9)
    R = np.stack([[1, 0, 0], -up, np.cross([1, 0, 0], -up)], 1)
    rays = pixel_rays(CAMERA) @ R
    rays = np.where(np.abs(rays) < 1e-9, 1e-9, rays)
    ends = np.stack([np.array([-0.1, 0.7, 0.75]) / rays, np.array([0.1, 0.9, 0.95]) / rays])
    near, far = ends.min(0).max(-1), ends.max(0).min(-1)
    box = np.where(near <= far, near, 0).astype(np.float32)
    depth = nearest(floor, box, plane_depth(CAMERA, (0, 0, 1), 2.2))
    return depth, (box > 0) & (depth == box), (floor > 0) & (depth == floor)


@pytest.mark.parametrize("noise_m", [0.0, 0.0015])
def test_a_box_on_a_plane_is_a_segment_of_its_own(box_on_plane, noise_m):
    depth, is_box, is_floor = box_on_plane
    rng = np.random.default_rng(1)
    noisy = depth + (noise_m * depth**2 * rng.standard_normal(depth.shape)).astype(np.float32)
    label = segment_depth(noisy, CAMERA, SETTINGS)
    box, box_share = dominant(label, is_box)
    floor, floor_share = dominant(label, is_floor)
    assert box != floor and box > 0 and floor > 0
    # With noise the box's faces may part along its edges; neither may run into the other.
    assert box_share > (0.9 if noise_m == 0 else 0.5)
    assert floor_share > 0.95
    assert np.count_nonzero(is_floor & (label == box)) < 0.05 * np.count_nonzero(is_box)
    assert np.count_nonzero(is_box & (label == floor)) < 0.05 * np.count_nonzero(is_box)


def test_labels_are_dense_and_only_where_depth_is(box_on_plane):
    depth = box_on_plane[0].copy()
    depth[100:110, 50:90] = 0
    label = segment_depth(depth, CAMERA, SETTINGS)
    assert set(np.unique(label)) == set(range(label.max() + 1))
    assert not label[depth == 0].any()


def test_nothing_is_seen_in_an_empty_image():
    label = segment_depth(np.zeros((240, 320), np.float32), CAMERA, SETTINGS)
    assert not label.any()
