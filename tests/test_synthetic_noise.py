"""The sensor and the tracker: statistics against the stated equations, worked by hand."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from isr_jax.borders.raycast import camera_rays
from isr_jax.config import NoiseModel, PoseNoise
from isr_jax.errors import SettingError
from isr_jax.synthetic import NO_NOISE
from isr_jax.synthetic.camera.cameras import CAMERAS, default_camera, named_camera
from isr_jax.synthetic.camera.drift import NO_DRIFT, tracked_path
from isr_jax.synthetic.image.noise import (
    axial_sigma_m,
    correlated,
    depth_edges,
    lateral_sigma_px,
    quantum_m,
    sensor_depth,
    too_dim,
)
from isr_jax.synthetic.image.projector import unlit
from isr_jax.types import Camera

WIDTH, HEIGHT = 80, 60
FOCAL_BASELINE = 585.0 * 0.075
"""43.875 pixel metres."""


@pytest.fixture(scope="module")
def kinect() -> Camera:
    return default_camera(640, 480)


def flat(depth_m: float, angle: float = 0.0, size: tuple[int, int] = (200, 200)):
    """Depth and incidence images of a facing plane."""
    return np.full(size, depth_m, np.float32), np.full(size, angle, np.float32)


@pytest.mark.parametrize("depth_m", [1.0, 2.0, 3.0])
@pytest.mark.parametrize("share", [0.0, 0.5])
def test_depth_noise_grows_as_the_model_says(kinect, depth_m, share):
    noise = NoiseModel(dropout=0.0, correlated_share=share)
    depth, angle = flat(depth_m, size=(400, 400))
    # Disparity rounding is a staircase: over many true depths it averages to its variance.
    depth += np.linspace(-0.05, 0.05, depth.size, dtype=np.float32).reshape(depth.shape)
    error = sensor_depth(depth, angle, kinect, noise, np.random.default_rng(0)) - depth
    expected = 0.0012 + 0.0019 * (depth_m - 0.4) ** 2
    assert error.std() == pytest.approx(expected, rel=0.05)
    # The mean of n pixels of which a share is common to windows of 81.
    of_mean = expected * np.sqrt((1 - share + 81 * share) / error.size)
    assert abs(error.mean()) < 5 * of_mean + 0.002 * expected + 5e-5


def test_sigma_is_the_published_formula():
    depth, angle = np.float32([1.0, 2.0, 3.0]), np.float32([0.0, 0.0, 1.2])
    sigma = axial_sigma_m(NoiseModel(), depth, angle)
    grazing = 1e-4 / np.sqrt(3.0) * 1.2**2 / (np.pi / 2 - 1.2) ** 2
    expected = [0.0012 + 0.0019 * 0.36, 0.0012 + 0.0019 * 2.56, 0.0012 + 0.0019 * 6.76 + grazing]
    np.testing.assert_allclose(sigma, expected, rtol=1e-5)


def test_depth_comes_in_steps_of_the_disparity(kinect):
    noise = NoiseModel(axial_m=0.02, dropout=0.0)
    depth, angle = flat(3.0)
    values = np.unique(sensor_depth(depth, angle, kinect, noise, np.random.default_rng(1)))
    near = values[np.abs(values - 3.0) < 0.06]
    step = quantum_m(noise, kinect, np.float32(3.0)[None])[0]
    np.testing.assert_allclose(np.diff(near), step, rtol=0.05)


def test_a_plane_has_no_edges_and_a_step_has_two_sides():
    rays = camera_rays(default_camera(WIDTH, HEIGHT))
    slanted = (2.0 / (1.0 + 0.8 * rays[..., 0])).astype(np.float32)
    assert not depth_edges(slanted).any()
    step = np.where(np.arange(WIDTH) < 30, 1.0, 2.0) * np.ones((HEIGHT, 1))
    columns = np.flatnonzero(depth_edges(step.astype(np.float32)).all(0))
    np.testing.assert_array_equal(columns, [29, 30])


def test_edges_wander_and_lose_pixels(kinect):
    step = np.where(np.arange(200) < 100, 1.0, 2.0).astype(np.float32) * np.ones((300, 1), "f4")
    angle = np.zeros_like(step)
    still = dataclasses.replace(NO_NOISE, lateral_px=0.8)
    moved = sensor_depth(step, angle, kinect, still, np.random.default_rng(0))
    swapped = np.mean((moved != step)[:, 99:101])
    # Of a unit Gaussian times 0.8 px, what rounds to a step of one or more to the other side.
    assert swapped == pytest.approx(0.266, abs=0.06)
    assert np.all(moved[:, :98] == 1.0) and np.all(moved[:, 102:] == 2.0)
    lossy = NoiseModel(edge_dropout=0.4, dropout=0.0)
    lost = sensor_depth(step, angle, kinect, lossy, np.random.default_rng(0)) == 0
    assert lost[:, 99:101].mean() == pytest.approx(0.4, abs=0.08)
    assert not lost[:, :98].any()


@pytest.mark.parametrize(
    ("depth_m", "angle", "returns"),
    [(1.0, 0.0, True), (0.3, 0.0, False), (4.8, 0.0, False), (2.0, 1.45, False), (2.0, 1.3, True)],
)
def test_range_and_grazing_angles(kinect, depth_m, angle, returns):
    noise = NoiseModel(dropout=0.0)
    out = sensor_depth(*flat(depth_m, angle), kinect, noise, np.random.default_rng(0))
    assert np.all(out > 0) if returns else np.all(out == 0)


def test_nothing_there_returns_nothing(kinect):
    out = sensor_depth(*flat(0.0), kinect, NoiseModel(), np.random.default_rng(0))
    assert np.all(out == 0)


# ---------------------------------------------------------------------- the sensor's parts


def test_the_quantum_is_the_measured_one(kinect):
    """q / (f b) = 0.125 / 43.875 = 2.849e-3 per metre; 7 cm at 5 m, as measured in 2012."""
    step = quantum_m(NoiseModel(), kinect, np.float32([1.0, 5.0]))
    np.testing.assert_allclose(step, [2.849e-3, 0.0712], rtol=1e-3)


def test_edges_wander_more_at_grazing_angles():
    """0.8 + 0.035 * 1.2 / (pi/2 - 1.2) = 0.8 + 0.035 * 3.2363 = 0.9133."""
    sigma = lateral_sigma_px(NoiseModel(), np.float32([0.0, 1.2]))
    np.testing.assert_allclose(sigma, [0.8, 0.9133], rtol=1e-4)


def test_common_noise_is_common_over_its_window():
    noise = correlated((1200, 1200), 9, np.random.default_rng(3))
    assert noise.std() == pytest.approx(1.0, abs=0.01)
    for lag, expected in ((1, 8 / 9), (3, 6 / 9), (9, 0.0), (20, 0.0)):
        assert np.mean(noise[:, lag:] * noise[:, :-lag]) == pytest.approx(expected, abs=0.03)
        assert np.mean(noise[lag:] * noise[:-lag]) == pytest.approx(expected, abs=0.03)


def test_the_projector_leaves_a_band_to_the_left_of_near_things():
    """A block at 1 m before a wall at 3 m: the band is 43.875 (1 - 1/3) = 29.25 pixels wide."""
    depth = np.full((40, 400), 3.0, np.float32)
    depth[10:30, 200:300] = 1.0
    lost = unlit(depth, FOCAL_BASELINE)
    assert not lost[:10].any() and not lost[30:].any() and not lost[:, 200:].any()
    columns = np.flatnonzero(lost[20])
    assert columns[-1] == 199 and len(columns) == pytest.approx(29.25, abs=1)
    np.testing.assert_array_equal(lost[10:30], np.tile(lost[20], (20, 1)))


def test_the_shadow_of_a_pole_stands_apart_from_it():
    """5 pixels at 1.5 m before 3 m throw 5 pixels, 43.875 (1/1.5 - 1/3) = 14.6 to the left."""
    depth = np.full((4, 300), 3.0, np.float32)
    depth[:, 200:205] = 1.5
    for row in unlit(depth, FOCAL_BASELINE):
        columns = np.flatnonzero(row)
        assert columns.mean() == pytest.approx(202 - 14.6, abs=1.0)
        assert len(columns) == pytest.approx(5, abs=1)


def test_a_slanted_plane_throws_no_shadow():
    rays = camera_rays(default_camera(640, 480))
    for slope in (-1.2, 0.5, 1.2):
        depth = (2.0 / (1.0 + slope * rays[..., 0])).astype(np.float32)
        assert not unlit(depth, FOCAL_BASELINE).any()


def test_without_a_baseline_there_is_no_shadow_and_no_step():
    depth = np.where(np.arange(100) < 50, 3.0, 1.0).astype(np.float32) * np.ones((4, 1), "f4")
    assert not unlit(depth, 0.0).any()
    near = default_camera(640, 480)
    noise = dataclasses.replace(NO_NOISE, baseline_m=0.0, disparity_step_px=0.125)
    out = sensor_depth(depth, np.zeros_like(depth), near, noise, np.random.default_rng(0))
    np.testing.assert_array_equal(out, depth)


def test_dark_things_return_less_the_farther_they_are():
    """s = 0.04 / 9 = 2.2 s_0 at 3 m; 0.04 / 16 = 1.25 s_0 at 4 m, lost with 0.75; 0.8 s_0 at 5."""
    noise, draw = NoiseModel(), np.random.default_rng(0).random(40000).astype(np.float32)
    black, facing = np.full_like(draw, 0.04), np.zeros_like(draw)
    for depth_m, share in ((3.0, 0.0), (4.0, 0.75), (5.0, 1.0)):
        lost = too_dim(noise, np.full_like(draw, depth_m), facing, black, draw)
        assert lost.mean() == pytest.approx(share, abs=0.01)


def test_no_noise_is_the_depth_itself(kinect):
    rng = np.random.default_rng(0)
    depth = rng.uniform(0.3, 6, (60, 80)).astype(np.float32)
    angle, black = np.full_like(depth, 1.5), np.zeros_like(depth)
    out = sensor_depth(depth, angle, kinect, NO_NOISE, rng, albedo=black)
    np.testing.assert_array_equal(out, depth)


def test_noise_out_of_bounds_is_refused():
    with pytest.raises(SettingError, match="correlated_share"):
        NoiseModel(correlated_share=1.5)
    with pytest.raises(SettingError, match="drift_m"):
        PoseNoise(drift_m=-0.1)


# ---------------------------------------------------------------------- the tracker


def straight_way(steps: int, length_m: float = 10.0) -> np.ndarray:
    """Poses along +x, looking the same way throughout."""
    poses = np.tile(np.eye(4), (steps + 1, 1, 1))
    poses[:, 0, 3] = np.linspace(0, length_m, steps + 1)
    return poses


def turning(steps: int, angle_rad: float = 2.0) -> np.ndarray:
    """Poses in one place that turn about z."""
    poses = np.tile(np.eye(4), (steps + 1, 1, 1))
    angle = np.linspace(0, angle_rad, steps + 1)
    poses[:, 0, 0] = poses[:, 1, 1] = np.cos(angle)
    poses[:, 1, 0], poses[:, 0, 1] = np.sin(angle), -np.sin(angle)
    return poses


@pytest.mark.parametrize("steps", [20, 80])
def test_drift_grows_with_the_root_of_the_way_in_however_many_frames(steps):
    """0.01 m after 1 m: 0.01 sqrt(10) = 0.0316 m an axis after 10 m, 0.0158 after 2.5 m."""
    way, noise = straight_way(steps), PoseNoise(drift_m=0.01)
    error = np.array([tracked_path(way, noise, seed) - way for seed in range(400)])[..., :3, 3]
    assert np.all(error[:, 0] == 0)
    np.testing.assert_allclose(error[:, -1].std(0), 0.01 * np.sqrt(10.0), rtol=0.12)
    np.testing.assert_allclose(error[:, steps // 4].std(0), 0.01 * np.sqrt(2.5), rtol=0.12)


def test_the_heading_drifts_and_gravity_does_not():
    """0.02 rad after 1 rad: 0.02 sqrt(2) = 0.0283 rad after 2 rad; z stays z."""
    way, noise = turning(40), PoseNoise(drift_rad=0.02)
    given = np.array([tracked_path(way, noise, seed) for seed in range(400)])
    relative = np.einsum("fij,sfkj->sfik", way[:, :3, :3], given[..., :3, :3])
    heading = np.arctan2(relative[..., 0, 1], relative[..., 0, 0])
    assert heading[:, -1].std() == pytest.approx(0.0283, rel=0.12)
    np.testing.assert_allclose(given[..., 2, :3], np.broadcast_to([0, 0, 1.0], (400, 41, 3)))
    np.testing.assert_allclose(given[..., :3, 3], 0, atol=1e-12)


def test_a_wrong_heading_bends_the_way_and_keeps_its_length():
    way = turning(30)
    way[:, 0, 3] = np.linspace(0, 3, 31)
    ends = []
    for seed in range(20):
        given = tracked_path(way, PoseNoise(drift_rad=0.3), seed)
        steps = np.linalg.norm(np.diff(given[:, :3, 3], axis=0), axis=1)
        np.testing.assert_allclose(steps, 0.1, rtol=1e-9)
        ends.append(np.linalg.norm(given[-1, :3, 3] - way[-1, :3, 3]))
    assert np.median(ends) > 0.05


def test_jitter_is_forgotten_from_frame_to_frame():
    way = straight_way(2000)
    given = tracked_path(way, PoseNoise(jitter_m=0.003, jitter_rad=0.01), 0)
    error = (given - way)[:, :3, 3]
    np.testing.assert_allclose(error.std(0), 0.003, rtol=0.06)
    assert abs(np.mean(error[1:] * error[:-1])) < 0.1 * 0.003**2
    turn = np.arccos(np.clip((np.trace(given[:, :3, :3], axis1=1, axis2=2) - 1) / 2, -1, 1))
    # The mean length of a Gaussian 3-vector is sigma sqrt(8 / pi).
    assert turn.mean() == pytest.approx(0.01 * np.sqrt(8 / np.pi), rel=0.05)


def test_no_pose_noise_is_the_true_way_to_the_last_bit():
    way = turning(9)
    np.testing.assert_array_equal(tracked_path(way, NO_DRIFT, 5), way)


# ---------------------------------------------------------------------- cameras


def test_published_cameras_scale_with_the_image():
    for name in CAMERAS:
        whole, half = named_camera(name, 640, 480), named_camera(name, 320, 240)
        np.testing.assert_allclose(half.K[:2], whole.K[:2] / 2)
    assert named_camera("kinect_color", 640, 480).cy == 255.3  # off the middle
    np.testing.assert_array_equal(named_camera("kinect", 640, 480).K, default_camera(640, 480).K)


def test_an_unknown_camera_is_refused_and_the_known_are_named():
    with pytest.raises(SettingError, match="zed") as caught:
        named_camera("zed", 640, 480)
    assert "kinect_depth" in str(caught.value)
