"""Synthetic frames: labels against geometry, noise against its model, files against themselves."""

from __future__ import annotations

import dataclasses
import hashlib
import json
from pathlib import Path

import cv2
import numpy as np
import pytest

from isr_jax.config import NoiseModel
from isr_jax.raycast import camera_rays
from isr_jax.scene_file import read_scene
from isr_jax.synthetic import NO_NOISE, Room, make_room, render_sequence, true_entities
from isr_jax.synthetic.filming import SURFACE_GRID_M, Film, SeenSurface, joined, thinned
from isr_jax.synthetic.noise import axial_sigma_m, depth_edges, quantum_m, sensor_depth
from isr_jax.synthetic.render import default_camera
from isr_jax.synthetic.walk import camera_path
from isr_jax.types import Camera

from .furniture import furniture_library

FRAMES, WIDTH, HEIGHT = 8, 80, 60
MILLIMETRE_M = 5.01e-4
"""Half a unit of the depth images."""


@pytest.fixture(scope="module")
def room() -> Room:
    return make_room(1, furniture_library())


@pytest.fixture(scope="module")
def sequence(room: Room, tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("film")
    render_sequence(room, out, frames=FRAMES, width=WIDTH, height=HEIGHT, noise=NO_NOISE)
    return out


@pytest.fixture(scope="module")
def kinect() -> Camera:
    return default_camera(640, 480)


def flat(depth_m: float, angle: float = 0.0, size: tuple[int, int] = (200, 200)):
    """Depth and incidence images of a facing plane."""
    return np.full(size, depth_m, np.float32), np.full(size, angle, np.float32)


# ---------------------------------------------------------------------- the sensor


@pytest.mark.parametrize("depth_m", [0.8, 1.5, 2.5, 3.5])
def test_depth_noise_grows_as_the_model_says(kinect, depth_m):
    noise = NoiseModel(dropout=0.0)
    depth, angle = flat(depth_m)
    # Disparity rounding is a staircase: over many true depths it averages to its variance.
    depth += np.linspace(-0.05, 0.05, depth.size, dtype=np.float32).reshape(depth.shape)
    error = sensor_depth(depth, angle, kinect, noise, np.random.default_rng(0)) - depth
    expected = 0.0012 + 0.0019 * (depth_m - 0.4) ** 2
    assert error.std() == pytest.approx(expected, rel=0.06)
    assert abs(error.mean()) < 5 * expected / np.sqrt(error.size) + 0.002 * expected + 5e-5


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


# ---------------------------------------------------------------------- frames


def test_labels_lie_on_the_surface_of_what_they_name(room):
    """Every labelled point lies in its entity's own (handle-grown) bounds."""
    camera = default_camera(WIDTH, HEIGHT)
    film = Film(room, camera, NO_NOISE, 0)
    scene = {e.id: e for e in true_entities(room, spacing_m=1.0)}
    for pose in camera_path(room, 4, 0):
        shot = film.shoot(0, pose)
        assert np.all(shot.instance[shot.true_depth_m > 0] > 0)
        points = (camera_rays(camera) * shot.true_depth_m[..., None]) @ pose[:3, :3].T
        points += pose[:3, 3]
        for i in np.unique(shot.instance[shot.instance > 0]):
            entity, seen = scene[int(i)], points[shot.instance == i]
            low, high = entity.mesh.vertices.min(0), entity.mesh.vertices.max(0)
            assert np.all(seen >= low - 1e-4) and np.all(seen <= high + 1e-4)
            if entity.is_layout:
                plane = seen @ entity.planes.normal[0] + entity.planes.offset[0]
                assert np.abs(plane).max() < 1e-4


def test_the_walk_is_smooth_and_stays_clear(room):
    path = camera_path(room, 150, 0)
    eyes, forward = path[:, :3, 3], path[:, :3, 2]
    assert np.linalg.norm(np.diff(eyes, axis=0), axis=1).max() < 0.25
    turn = np.arccos(np.clip(np.sum(forward[1:] * forward[:-1], 1), -1, 1))
    assert np.degrees(turn).max() < 25
    for T in path:
        np.testing.assert_allclose(T[:3, :3] @ T[:3, :3].T, np.eye(3), atol=1e-9)
        assert np.linalg.det(T[:3, :3]) == pytest.approx(1.0)
    for item in room.items:
        local = (eyes - item.center) @ item.T_world_cad[:3, :3]
        outside = np.abs(local) - item.scale * item.model.size / 2
        assert np.linalg.norm(np.maximum(outside, 0), axis=1).min() > 0.2, item.name
    inside = [(eyes - p.corners[0]) @ p.normal for p in room.layout]
    assert np.min(inside) > 0.3


def test_the_walk_sees_everything(room):
    film = Film(room, default_camera(WIDTH, HEIGHT), NO_NOISE, 0)
    pixels = np.zeros(len(room.layout) + len(room.items) + 1, np.int64)
    for index, pose in enumerate(camera_path(room, 120, 0)[::4]):
        pixels += np.bincount(film.shoot(index, pose).instance.ravel(), minlength=len(pixels))
    assert np.all(pixels[1:] > 30), pixels


# ---------------------------------------------------------------------- files


def test_frames_reproject_onto_each_other_through_the_files(room, sequence):
    """Depth and poses as written, read with nothing but the intrinsics: all points on surfaces."""
    camera = default_camera(WIDTH, HEIGHT)
    layout = room.layout
    for index in range(FRAMES):
        depth = cv2.imread(str(sequence / f"depth/{index:06d}.png"), cv2.IMREAD_UNCHANGED)
        T_dataset_camera = np.loadtxt(sequence / f"poses/{index:06d}.txt")
        panoptic = cv2.imread(str(sequence / f"panoptic/{index:06d}.png"), cv2.IMREAD_UNCHANGED)
        ids = panoptic[..., 2] + 256 * panoptic[..., 1].astype(int)
        rays = camera_rays(camera)
        T = room.T_world_dataset @ T_dataset_camera
        points = (rays * (depth / 1000.0)[..., None]) @ T[:3, :3].T + T[:3, 3]
        for patch in layout:
            seen = points[(ids == patch.id) & (depth > 0)]
            off = (seen - patch.corners[0]) @ patch.normal
            assert len(seen) == 0 or np.abs(off).max() < MILLIMETRE_M * 1.6


def test_intrinsics_give_gravity_and_units(room, sequence):
    data = json.loads((sequence / "intrinsics.json").read_text())
    assert data["width"] == WIDTH and data["height"] == HEIGHT and data["depth_scale"] == 1000.0
    np.testing.assert_allclose(
        room.T_world_dataset[:3, :3] @ np.array(data["gravity"]), [0, 0, -1], atol=1e-12
    )


def test_panoptic_index_counts_the_pixels_of_the_images(sequence):
    data = json.loads((sequence / "panoptic.json").read_text())
    assert len(data["images"]) == len(data["annotations"]) == FRAMES
    names = {c["id"]: c["name"] for c in data["categories"]}
    truth = {e.id: e.class_name for e in read_scene(sequence / "truth/scene.json").entities}
    for annotation in data["annotations"]:
        image = cv2.imread(str(sequence / "panoptic" / annotation["file_name"]))
        ids = image[..., 2].astype(int) + 256 * image[..., 1].astype(int)
        for segment in annotation["segments_info"]:
            assert segment["area"] == np.sum(ids == segment["id"])
            assert names[segment["category_id"]] == truth[segment["id"]]


def test_observed_surface_lies_on_the_true_one_and_faces_a_camera(room, sequence):
    data = np.load(sequence / "truth/observed.npz")
    points, normals, instance = data["points"], data["normals"], data["instance"]
    assert points.dtype == normals.dtype == np.float32 and instance.dtype == np.int32
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1, atol=1e-5)
    for patch in room.layout:
        rows = instance == patch.id
        off = (points[rows] - patch.corners[0]) @ patch.normal
        assert np.abs(off).max(initial=0) < 1e-4
        np.testing.assert_allclose(normals[rows] @ patch.normal, 1, atol=1e-5)
    cells = np.concatenate([np.floor(points / SURFACE_GRID_M), instance[:, None]], 1)
    assert len(np.unique(cells, axis=0)) == len(points)


def test_thinning_again_changes_nothing():
    rng = np.random.default_rng(0)
    points = rng.uniform(-1, 1, (2000, 3)).astype(np.float32)
    cloud = SeenSurface(points, points, rng.integers(1, 3, 2000).astype(np.int32))
    once = thinned(cloud)
    np.testing.assert_array_equal(joined([once, cloud]).points, once.points)


def test_truth_meshes_are_written_and_named_by_the_scene(room, sequence):
    scene = read_scene(sequence / "truth/scene.json")
    assert {e.name for e in scene.entities} == {
        *(p.name for p in room.layout),
        *(i.name for i in room.items),
    }
    for entity in scene.entities:
        assert (sequence / "truth" / entity.mesh).stat().st_size > 500


def test_the_same_seed_writes_the_same_bytes(room, tmp_path: Path):
    digests = []
    for name, seed in (("a", 4), ("b", 4), ("c", 5)):
        render_sequence(room, tmp_path / name, frames=3, width=WIDTH, height=HEIGHT, seed=seed)
        files = sorted(p for p in (tmp_path / name).rglob("*") if p.is_file())
        digests.append([
            (p.relative_to(tmp_path / name), hashlib.sha256(p.read_bytes()).hexdigest())
            for p in files
        ])  # fmt: skip
    assert digests[0] == digests[1] and len(digests[0]) > 12
    assert digests[0] != digests[2]


def test_progress_counts_frames(room, tmp_path: Path):
    calls: list[tuple[int, int]] = []
    render_sequence(
        room, tmp_path, frames=2, width=16, height=12, progress=lambda *c: calls.append(c)
    )
    assert calls == [(1, 2), (2, 2)]
