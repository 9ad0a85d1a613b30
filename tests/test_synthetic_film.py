"""Synthetic frames: labels against geometry, noise against its model, files against themselves."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path

import cv2
import numpy as np
import pytest

from isr_jax.borders.raycast import camera_rays
from isr_jax.classes import class_named
from isr_jax.config import PoseNoise
from isr_jax.robot_model import link_transforms
from isr_jax.scene_file import read_scene
from isr_jax.synthetic import NO_NOISE, Room, make_room, render_sequence, true_entities
from isr_jax.synthetic.camera.cameras import default_camera, named_camera
from isr_jax.synthetic.camera.free_space import clearance_m, inside_room
from isr_jax.synthetic.camera.walk import camera_path
from isr_jax.synthetic.film.film import SURFACE_GRID_M, Film, SeenSurface, joined, thinned
from isr_jax.synthetic.image.shading import lamp_place
from isr_jax.synthetic.openings import WALL_M
from isr_jax.synthetic.surface import room_parts

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
            grown = WALL_M if entity.is_layout else 0.0  # the thickness shows in openings
            assert np.all(seen >= low - grown - 1e-4) and np.all(seen <= high + grown + 1e-4)
            if entity.is_layout:
                _assert_on_wall(seen @ entity.planes.normal[0] + entity.planes.offset[0], 1e-4)


def _assert_on_wall(off_m: np.ndarray, tolerance_m: float) -> None:
    """Before a wall is nothing of it; in its openings its thickness shows."""
    assert off_m.max(initial=0) < tolerance_m and off_m.min(initial=0) > -WALL_M - tolerance_m


def test_part_ids_name_the_link_that_was_hit():
    """Every point of a part lies in the box of its link's meshes, and the part's entity is its."""
    room = make_room(1, furniture_library(), kind="kitchen")
    camera = default_camera(320, 240)
    film = Film(room, camera, NO_NOISE, 0)
    parts = {part.id: part for part in room_parts(room)}
    items = {item.id: item for item in room.items}
    links_seen = set()
    for pose in camera_path(room, 12, 0, camera=camera)[::2]:
        shot = film.shoot(0, pose)
        points = (camera_rays(camera) * shot.true_depth_m[..., None]) @ pose[:3, :3].T
        points += pose[:3, 3]
        assert np.all((shot.part > 0) == (shot.instance > 0))
        for i in np.unique(shot.part[shot.part > 0]):
            part, rows = parts[int(i)], shot.part == i
            assert np.all(shot.instance[rows] == part.entity_id)
            if part.link is None:
                assert part.entity_id not in items
                continue
            item = items[part.entity_id]
            link = next(link for link in item.model.robot.links if link.name == part.link)
            T = link_transforms(item.model.robot)[part.link]
            local = np.concatenate([v.mesh.vertices for v in link.visuals])
            solid = item.to_world(local @ T[:3, :3].T + T[:3, 3])
            assert np.all(points[rows] > solid.min(0) - 1e-4)
            assert np.all(points[rows] < solid.max(0) + 1e-4)
            links_seen.add(part.link)
    assert {"base", "door"} <= links_seen


def test_class_images_say_what_each_instance_is(room):
    film = Film(room, default_camera(WIDTH, HEIGHT), NO_NOISE, 0)
    shot = film.shoot(0, camera_path(room, 3, 0)[1])
    names = {e.id: e.class_name for e in true_entities(room, spacing_m=1.0, with_stuff=True)}
    for i in np.unique(shot.instance[shot.instance > 0]):
        assert np.all(shot.class_id[shot.instance == i] == class_named(names[int(i)]).id)
    assert np.all(shot.class_id[shot.instance == 0] == 0)


@pytest.mark.parametrize("seed", [0, 1])
def test_the_walk_is_smooth_and_stays_clear(room, seed):
    path = camera_path(room, 150, seed)
    eyes, forward = path[:, :3, 3], path[:, :3, 2]
    assert np.linalg.norm(np.diff(eyes, axis=0), axis=1).max() < 0.25
    turn = np.arccos(np.clip(np.sum(forward[1:] * forward[:-1], 1), -1, 1))
    assert np.degrees(turn).max() < 25
    for T in path:
        np.testing.assert_allclose(T[:3, :3] @ T[:3, :3].T, np.eye(3), atol=1e-9)
        assert np.linalg.det(T[:3, :3]) == pytest.approx(1.0)
        assert abs(T[2, 0]) < 1e-9  # held level
    between = np.concatenate([eyes + s * (np.roll(eyes, -1, 0) - eyes) for s in (0, 0.5)])[:-1]
    assert clearance_m(room, between).min() > 0.19
    assert inside_room(room, between, 0.29).all()


def test_another_seed_walks_another_way(room):
    path = camera_path(room, 20, 0)
    np.testing.assert_array_equal(path, camera_path(room, 20, 0))
    assert np.abs(path - camera_path(room, 20, 1)).max() > 0.1


def test_the_lamp_hangs_clear_of_things(room):
    lamp = lamp_place(room)[None].astype(np.float64)
    assert clearance_m(room, lamp)[0] > 0.4 and inside_room(room, lamp, 0.1).all()


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
            _assert_on_wall((seen - patch.corners[0]) @ patch.normal, MILLIMETRE_M * 1.6)


def test_intrinsics_give_gravity_and_units(room, sequence):
    data = json.loads((sequence / "intrinsics.json").read_text())
    assert data["width"] == WIDTH and data["height"] == HEIGHT and data["depth_scale"] == 1000.0
    np.testing.assert_allclose(
        room.T_world_dataset[:3, :3] @ np.array(data["gravity"]), [0, 0, -1], atol=1e-12
    )


def test_part_images_are_of_the_panoptic_ones(sequence):
    parts = json.loads((sequence / "truth/parts.json").read_text())
    entity = np.zeros(len(parts) + 1, int)
    for part in parts:
        entity[part["id"]] = part["entity"]
    for index in range(FRAMES):
        image = cv2.imread(str(sequence / f"parts/{index:06d}.png"), cv2.IMREAD_UNCHANGED)
        panoptic = cv2.imread(str(sequence / f"panoptic/{index:06d}.png"), cv2.IMREAD_UNCHANGED)
        assert image.dtype == np.uint16
        ids = panoptic[..., 2] + 256 * panoptic[..., 1].astype(int)
        np.testing.assert_array_equal(entity[image], ids)


def test_true_poses_are_kept_beside_drifting_ones(room, sequence, tmp_path: Path):
    noise = PoseNoise(drift_m=0.05, drift_rad=0.05)
    options = {"frames": FRAMES, "width": WIDTH, "height": HEIGHT, "noise": NO_NOISE}
    render_sequence(room, tmp_path, pose_noise=noise, **options)
    assert not (sequence / "truth/poses").exists()
    off = []
    for index in range(FRAMES):
        name = f"{index:06d}.txt"
        true = (tmp_path / "truth/poses" / name).read_text()
        assert true == (sequence / "poses" / name).read_text()
        given = np.loadtxt(tmp_path / "poses" / name)
        off.append(np.linalg.norm((given - np.loadtxt(tmp_path / "truth/poses" / name))[:3, 3]))
    assert off[0] < 1e-9 and off[-1] > 0.02
    for folder in ("rgb", "depth", "panoptic"):  # the images are those of the true poses
        for path in (sequence / folder).iterdir():
            assert path.read_bytes() == (tmp_path / folder / path.name).read_bytes()


def test_a_camera_off_the_centre_is_written_as_it_is(room, tmp_path: Path):
    camera = named_camera("kinect_color", WIDTH, HEIGHT)
    render_sequence(
        room, tmp_path, frames=1, noise=NO_NOISE, camera="kinect_color", width=WIDTH, height=HEIGHT
    )
    data = json.loads((tmp_path / "intrinsics.json").read_text())
    assert (data["cx"], data["cy"]) == (camera.cx, camera.cy) != (WIDTH / 2, HEIGHT / 2)
    depth = cv2.imread(str(tmp_path / "depth/000000.png"), cv2.IMREAD_UNCHANGED) / 1000.0
    part = cv2.imread(str(tmp_path / "panoptic/000000.png"), cv2.IMREAD_UNCHANGED)[..., 2]
    T = room.T_world_dataset @ np.loadtxt(tmp_path / "poses/000000.txt")
    points = (camera_rays(camera) * depth[..., None]) @ T[:3, :3].T + T[:3, 3]
    for patch in room.layout:
        seen = points[(part == patch.id) & (depth > 0)]
        _assert_on_wall((seen - patch.corners[0]) @ patch.normal, MILLIMETRE_M * 1.6)


def test_panoptic_index_counts_the_pixels_of_the_images(sequence):
    data = json.loads((sequence / "panoptic.json").read_text())
    assert len(data["images"]) == len(data["annotations"]) == FRAMES
    names = {c["id"]: c["name"] for c in data["categories"]}
    record = json.loads((sequence / "truth/room.json").read_text())
    truth = {e.id: e.class_name for e in read_scene(sequence / "truth/scene.json").entities}
    truth |= {item["id"]: item["class"] for item in record["items"]}
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
        _assert_on_wall(off, 1e-4)
        front = normals[rows][off > -1e-4]
        # At the edge of an opening the faces of its sides begin in the plane of the wall.
        assert np.mean(np.abs(front @ patch.normal - 1) < 1e-5) > 0.98
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
        *(i.name for i in room.things),
    }
    for entity in scene.entities:
        assert (sequence / "truth" / entity.mesh).stat().st_size > 500


def test_the_same_seed_writes_the_same_bytes(room, tmp_path: Path):
    digests = []
    for name, seed in (("a", 4), ("b", 4), ("c", 5)):
        render_sequence(room, tmp_path / name, frames=3, width=WIDTH, height=HEIGHT, seed=seed)
        files = sorted(p for p in (tmp_path / name).rglob("*") if p.is_file())
        digests.append(
            [
                (p.relative_to(tmp_path / name), hashlib.sha256(p.read_bytes()).hexdigest())
                for p in files
            ]
        )
    assert digests[0] == digests[1] and len(digests[0]) > 12
    assert digests[0] != digests[2]


def test_progress_counts_frames(room, tmp_path: Path):
    calls: list[tuple[int, int]] = []
    render_sequence(
        room, tmp_path, frames=2, width=16, height=12, progress=lambda *c: calls.append(c)
    )
    assert calls == [(1, 2), (2, 2)]
