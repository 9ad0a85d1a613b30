"""The world frame's own parts: the smallest rotation, level surfaces, voted gravity."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from isr_jax.datasets.world_frame import (
    Cloud,
    degrees_between,
    estimate_gravity,
    find_world_frame,
    level_surfaces,
)
from isr_jax.errors import SequenceError
from isr_jax.geometry import smallest_rotation

angles = st.floats(-3.2, 3.2)


def direction(a, b) -> np.ndarray:
    return np.array([np.cos(a) * np.cos(b), np.sin(a) * np.cos(b), np.sin(b)])


def sheet(rng, count, size, height, noise=0.002) -> np.ndarray:
    xy = rng.uniform(-0.5, 0.5, (count, 2)) * size
    return np.column_stack([xy, height + rng.normal(0, noise, count)])


@settings(max_examples=50, deadline=None)
@given(angles, angles, angles, angles)
def test_smallest_rotation(a, b, c, d):
    source, target = direction(a, b), direction(c, d)
    R = smallest_rotation(source, target)
    np.testing.assert_allclose(R @ R.T, np.eye(3), atol=1e-9)
    np.testing.assert_allclose(R @ source, target, atol=1e-6)
    angle = np.arccos(np.clip((np.trace(R) - 1) / 2, -1, 1))
    assert angle == pytest.approx(np.arccos(np.clip(source @ target, -1, 1)), abs=1e-5)


@pytest.mark.parametrize("source", np.eye(3))
def test_half_a_turn(source):
    R = smallest_rotation(source, -source)
    np.testing.assert_allclose(R @ source, -source, atol=1e-12)
    assert np.linalg.det(R) == pytest.approx(1)


def test_the_lowest_wide_surface_wins_over_the_largest_and_over_specks():
    rng = np.random.default_rng(0)
    floor, table = sheet(rng, 3000, (3, 2), 0.1), sheet(rng, 21000, (1.5, 1), 0.8)
    mirrored = sheet(rng, 300, (0.3, 0.2), -0.6)  # a reflection: many points, little area
    heights, areas = level_surfaces(np.concatenate([table, floor, mirrored]))
    np.testing.assert_allclose(heights[[0, -1]], [0.1, 0.8], atol=0.003)
    assert areas[0] == pytest.approx(6.0, rel=0.1)


def test_no_points_no_surface():
    heights, _ = level_surfaces(np.zeros((0, 3)))
    assert len(heights) == 0


def turned_cloud(R, normals, camera_down) -> Cloud:
    return Cloud(np.zeros((len(normals), 3)), normals @ R.T, camera_down @ R.T)


def noisy(rng, normal, count, degrees=8.0) -> np.ndarray:
    n = np.asarray(normal) + rng.normal(0, np.deg2rad(degrees) / np.sqrt(2), (count, 3))
    return n / np.linalg.norm(n, axis=1, keepdims=True)


def test_gravity_from_floor_walls_and_clutter():
    rng = np.random.default_rng(1)
    clutter = noisy(rng, (0, 0, 0), 1500)
    normals = np.concatenate(
        [
            noisy(rng, (0, 0, 1), 900),
            noisy(rng, (1, 0, 0), 1500),
            noisy(rng, (0.3, -1, 0) / np.hypot(0.3, 1), 1500),
            clutter,
        ]
    )
    # Cameras look 35 degrees down, so their own down leans as far from gravity.
    lean = np.deg2rad(35)
    turns = rng.uniform(-1.2, 1.2, 30)
    level = np.sin(lean) * np.stack([np.cos(turns), np.sin(turns)], 1)
    down = np.column_stack([-level, np.full(30, -np.cos(lean))])
    R = smallest_rotation(np.array([0, 0, 1.0]), direction(0.4, -0.7))
    found = estimate_gravity(turned_cloud(R, normals, down))
    assert np.rad2deg(np.arccos(found @ (R @ [0, 0, -1.0]))) < 1.5


def test_cameras_that_roll_say_so():
    rng = np.random.default_rng(2)
    down = noisy(rng, (0, 0, 0), 200)
    cloud = Cloud(np.zeros((500, 3)), noisy(rng, (0, 0, 1), 500), np.concatenate([down, -down]))
    with pytest.raises(SequenceError, match="gravity cannot be estimated") as error:
        find_world_frame(cloud, None)
    assert "gravity" in error.value.hint


def test_no_level_surface_is_an_error():
    cloud = Cloud(
        np.random.default_rng(3).uniform(size=(500, 3)),
        np.tile([1.0, 0, 0], (500, 1)),
        np.array([[0, 0, -1.0]]),
    )
    with pytest.raises(SequenceError, match="no floor"):
        find_world_frame(cloud, np.array([0, 0, -1.0]))


@pytest.mark.parametrize(("off_deg", "corrected"), [(0.3, False), (2.0, True), (12.0, False)])
def test_a_gravity_a_few_degrees_off_the_floor_is_levelled_by_it(off_deg, corrected):
    """Below, the estimate is no better; above, one of the two is wrong and the given one stands."""
    rng = np.random.default_rng(4)
    points = sheet(rng, 4000, 3.0, 0.0)
    walls = noisy(rng, (1, 0, 0), 2000, degrees=2.0)
    normals = np.concatenate([noisy(rng, (0, 0, 1), 4000, degrees=2.0), walls])
    cloud = Cloud(
        np.concatenate([points, np.tile([1.5, 0, 1.0], (2000, 1))]),
        normals,
        np.tile([0.0, 0.3, -0.95], (10, 1)),
    )
    off = np.deg2rad(off_deg)
    given = np.array([np.sin(off), 0.0, -np.cos(off)])
    found = find_world_frame(cloud, given).gravity
    left = degrees_between(found, np.array([0.0, 0.0, -1.0]))
    assert left < 0.3 if corrected else left == pytest.approx(off_deg, abs=1e-6)
