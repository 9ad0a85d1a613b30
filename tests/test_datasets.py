"""Readers, conventions, the world frame and prefetching, on a room known in closed form."""

from __future__ import annotations

import json
import shutil

import numpy as np
import pytest

from isr_jax.config import InputSettings
from isr_jax.datasets import CONVENTIONS, detect_format, open_sequence, prefetch
from isr_jax.datasets.images import ColorCamera, register_color
from isr_jax.errors import FrameError, SequenceError
from isr_jax.types import Camera, Frame, RgbdSequence

from . import datasets_room as room

WRITERS = {"plain": room.write_plain, "7scenes": room.write_7scenes, "tum": room.write_tum}
DEPTH_ROUNDING_M = 6e-4
"""Depth is written in whole millimetres."""
HEIGHT_TOLERANCE_M = 0.005
"""Of the floor: the median over blocks of pixels of depth in whole millimetres."""
GRAVITY_TOLERANCE_DEG = 0.5
"""Of the estimate, from normals of small, rounded images."""


@pytest.fixture(scope="module")
def shots():
    return room.shots()


@pytest.fixture(scope="module")
def folders(tmp_path_factory, shots):
    """One folder a layout; read only."""
    root = tmp_path_factory.mktemp("recordings")
    return {name: write(root / name, shots) for name, write in WRITERS.items()}


@pytest.fixture
def plain(tmp_path, folders):
    """A plain folder that a test may spoil."""
    return shutil.copytree(folders["plain"], tmp_path / "kitchen")


def heights_match(frame: Frame, T_true: np.ndarray) -> None:
    """Every pixel's point lies at its true height: gravity and floor are right."""
    v, u = np.mgrid[: room.HEIGHT, : room.WIDTH]
    z = frame.depth_m
    camera = np.stack([(u - 80) / 140.0 * z, (v - 60) / 140.0 * z, z], -1)[z > 0]
    world = camera @ frame.T_world_camera[:3, :3].T + frame.T_world_camera[:3, 3]
    true = camera @ T_true[:3, :3].T + T_true[:3, 3]
    np.testing.assert_allclose(world[:, 2], true[:, 2], atol=2 * HEIGHT_TOLERANCE_M)


@pytest.mark.parametrize("layout", WRITERS)
def test_layouts_give_the_same_frames_in_the_world(folders, shots, layout):
    assert detect_format(folders[layout]) == layout
    sequence = open_sequence(folders[layout], InputSettings(depth_max_m=20.0))
    assert isinstance(sequence, RgbdSequence)
    assert (len(sequence), sequence.name) == (len(shots), layout)
    for i in (0, 5, -1):
        frame, shot = sequence[i], shots[i]
        assert frame.color.dtype == np.uint8 and frame.depth_m.dtype == np.float32
        assert frame.index == i % len(shots)
        np.testing.assert_allclose(frame.depth_m, shot.depth_m, atol=DEPTH_ROUNDING_M)
        if layout != "tum":
            heights_match(frame, shot.T_world_camera)
        if layout == "tum":  # plain: JPEG of noise is far from it; 7-Scenes: colour is moved
            np.testing.assert_array_equal(frame.color, shot.color)


@pytest.mark.parametrize("layout", WRITERS)
def test_the_world_is_the_smallest_turn_and_the_floor_at_zero(folders, layout):
    sequence = open_sequence(folders[layout])
    R = sequence.T_world_dataset[:3, :3]
    down = R @ room.GRAVITY
    assert np.rad2deg(np.arccos(-down[2])) < GRAVITY_TOLERANCE_DEG
    turn = np.arccos((np.trace(R) - 1) / 2)
    needed = np.arccos(-sequence.world.gravity[2])
    assert turn == pytest.approx(needed, abs=1e-6)  # no yaw beyond it
    height = (sequence.T_world_dataset @ room.T_DATASET_WORLD)[2, 3]
    assert abs(height) < HEIGHT_TOLERANCE_M
    levels = sequence.world.levels
    assert levels[1][0] == pytest.approx(room.TABLE_HEIGHT_M, abs=2 * HEIGHT_TOLERANCE_M)


def test_gravity_is_estimated_where_none_is_given(tmp_path, shots):
    sequence = open_sequence(room.write_plain(tmp_path / "a", shots, with_gravity=False))
    angle = np.rad2deg(np.arccos(np.clip(sequence.world.gravity @ room.GRAVITY, -1, 1)))
    assert angle < GRAVITY_TOLERANCE_DEG
    assert abs((sequence.T_world_dataset @ room.T_DATASET_WORLD)[2, 3]) < 2 * HEIGHT_TOLERANCE_M


@pytest.mark.parametrize("convention", CONVENTIONS)
def test_every_convention_is_converted(tmp_path, folders, shots, convention):
    declared = {"convention": convention, "pose_convention": convention}
    path = room.write_plain(tmp_path / "a", shots, **declared)
    poses = [open_sequence(p)[3].T_world_camera for p in (folders["plain"], path)]
    np.testing.assert_allclose(*poses, atol=1e-5)


@pytest.mark.parametrize("convention", CONVENTIONS[1:])
def test_a_wrong_convention_is_refused_by_name(tmp_path, shots, convention):
    path = room.write_plain(tmp_path / "a", shots, convention=convention)
    with pytest.raises(SequenceError) as error:
        open_sequence(path)
    assert f'"pose_convention": "{convention}"' in error.value.hint
    assert "opencv_camera_to_world" in error.value.problem


def test_settings_pick_depth(plain):
    sequence = open_sequence(plain, InputSettings(depth_min_m=1.5, depth_max_m=2.0))
    depth = sequence[0].depth_m
    assert depth[depth > 0].min() >= 1.5 and depth.max() <= 2.0
    with pytest.raises(IndexError):
        sequence[12]


def test_both_marks_of_no_return_are_none(plain):
    depth = np.full((room.HEIGHT, room.WIDTH), 65535, np.uint16)
    depth[:5], depth[5:10] = 0, 1234
    room.write_depth(plain / "depth/000004.png", depth.astype(np.float64), 1.0)
    read = open_sequence(plain, InputSettings(depth_max_m=20.0))[4].depth_m
    assert np.unique(read).tolist() == [0.0, np.float32(1.234)]


def test_colour_of_another_size_is_resized_and_said(plain, shots):
    import cv2

    for i, shot in enumerate(shots):
        large = cv2.resize(shot.color, None, fx=2, fy=2, interpolation=cv2.INTER_NEAREST)
        cv2.imwrite(str(plain / f"rgb/{i:06d}.jpg"), large[..., ::-1])
    sequence = open_sequence(plain)
    assert sequence[0].color.shape == (room.HEIGHT, room.WIDTH, 3)
    assert any("320x240" in note for note in sequence.notes)


def test_content_hash_follows_contents_not_places_or_times(plain, tmp_path):
    first = open_sequence(plain).content_hash()
    moved = shutil.copytree(plain, tmp_path / "elsewhere", copy_function=shutil.copyfile)
    assert open_sequence(moved).content_hash() == first
    assert open_sequence(plain, InputSettings(depth_max_m=3.0)).content_hash() != first
    pose = plain / "poses/000004.txt"
    text = pose.read_text()
    pose.write_text(text[:5] + ("1" if text[5] != "1" else "2") + text[6:])
    assert len(text) == pose.stat().st_size
    assert open_sequence(plain).content_hash() != first
    pose.write_text(text)
    assert open_sequence(plain).content_hash() == first
    (plain / "depth/000004.png").unlink()
    assert open_sequence(plain).content_hash() != first


def damage(path, kind):
    names = "depth/000004.png", "rgb/000004.jpg", "poses/000004.txt"
    depth, color, pose = (path / name for name in names)
    if kind.startswith("no "):
        {"no depth": depth, "no colour": color, "no pose": pose}[kind].unlink()
    elif kind.startswith("cut"):
        file = {"cut depth": depth, "cut colour": color}[kind]
        file.write_bytes(file.read_bytes()[: file.stat().st_size * 2 // 3])
    elif kind == "empty colour":
        color.write_bytes(b"")
    elif kind == "broken depth":
        data = bytearray(depth.read_bytes())
        data[len(data) // 2 : len(data) // 2 + 64] = bytes(64)
        depth.write_bytes(data)
    elif kind == "depth of 8 bits":
        shutil.copy(color, depth)
    elif kind == "other size":
        room.write_depth(depth, np.ones((50, 60)), 1000.0)
    else:
        T = np.loadtxt(pose)
        if kind == "nan":
            T[0, 0] = np.nan
        elif kind == "scaled":
            T[:3, :3] *= 1.2
        elif kind == "mirrored":
            T[:3, 0] *= -1
        elif kind == "short":
            T = T[:3]
        np.savetxt(pose, T)
        if kind == "words":
            pose.write_text("lost lost lost")


@pytest.mark.parametrize(
    ("kind", "words"),
    [
        ("no depth", "frame 000004 has no depth"),
        ("no colour", "frame 000004 has no colour"),
        ("no pose", "frame 000004 has no pose"),
        ("cut depth", "000004.png is cut off"),
        ("cut colour", "000004.jpg is cut off"),
        ("empty colour", "000004.jpg is cut off"),
        ("broken depth", "000004.png"),
        ("depth of 8 bits", "000004.png holds 3 channel"),
        ("other size", "000004.png is 60x50"),
        ("nan", "000004.txt: the pose holds NaN"),
        ("scaled", "000004.txt: the pose is no rotation"),
        ("mirrored", "000004.txt: the pose is mirrored"),
        ("short", "000004.txt holds 12 numbers"),
        ("words", "000004.txt is no pose"),
    ],
)
def test_one_bad_frame_is_its_own_error(plain, kind, words):
    damage(plain, kind)
    sequence = open_sequence(plain)
    with pytest.raises(FrameError, match=words) as error:
        sequence[4]
    assert error.value.hint
    assert sequence[3].index == 3 and sequence[5].index == 5
    found = dict(prefetch(sequence, range(len(sequence))))
    assert [i for i, f in found.items() if isinstance(f, FrameError)] == [4]


def test_a_first_frame_of_another_size_is_not_the_measure(plain):
    room.write_depth(plain / "depth/000000.png", np.ones((50, 60)), 1000.0)
    sequence = open_sequence(plain)
    assert (sequence.camera.width, sequence.camera.height) == (room.WIDTH, room.HEIGHT)
    with pytest.raises(FrameError, match="60x50"):
        sequence[0]


def test_small_errors_of_a_rotation_are_repaired(plain):
    pose = plain / "poses/000004.txt"
    np.savetxt(pose, np.loadtxt(pose), fmt="%.3f")
    R = open_sequence(plain)[4].T_world_camera[:3, :3].astype(np.float64)
    np.testing.assert_allclose(R @ R.T, np.eye(3), atol=1e-6)


def edit_intrinsics(path, **changes):
    file = path / "intrinsics.json"
    data = {**json.loads(file.read_text()), **changes}
    file.write_text(json.dumps({k: v for k, v in data.items() if v is not None}))


@pytest.mark.parametrize(
    ("changes", "problem", "hint"),
    [
        ({"fx": None}, "intrinsics.json lacks fx", "for example"),
        ({"fy": -1}, "fy = -1", "positive"),
        ({"width": 320, "height": 240, "cx": 160, "cy": 120}, "320x240", "= 70, 70, 80, 60"),
        ({"cx": 20.0}, "another resolution", "depth image"),
        ({"depth_scale": 1.0}, "look like millimetres", "depth_scale to 1000"),
        ({"depth_scale": 100000.0}, "look like millimetres", "depth_scale to 1000"),
        ({"gravity": [0, 0, 0]}, "is no direction", "leave it out"),
        ({"gravity": [0, 1]}, "is no direction", "leave it out"),
        ({"pose_convention": "opengl"}, "pose_convention = 'opengl'", "opengl_camera_to_world"),
    ],
)
def test_intrinsics_that_cannot_be_are_refused(plain, changes, problem, hint):
    edit_intrinsics(plain, **changes)
    with pytest.raises(SequenceError) as error:
        open_sequence(plain)
    assert problem in error.value.problem
    assert hint in error.value.hint


def test_metres_in_the_file_are_told(tmp_path, shots):
    path = room.write_plain(tmp_path / "a", shots, units=5000.0)
    edit_intrinsics(path, depth_scale=100.0)
    with pytest.raises(SequenceError, match="5000") as error:
        open_sequence(path)
    assert "depth_scale" in error.value.hint


def test_folders_that_are_no_sequence(tmp_path, folders, plain):
    with pytest.raises(SequenceError, match="absent"):
        open_sequence(tmp_path / "absent")
    (tmp_path / "empty").mkdir()
    with pytest.raises(SequenceError, match="no known sequence"):
        open_sequence(tmp_path / "empty")
    with pytest.raises(SequenceError, match="holds sequences") as error:
        open_sequence(tmp_path)
    assert str(plain) in error.value.hint
    with pytest.raises(SequenceError, match="unknown format"):
        open_sequence(plain, format="bag")
    (plain / "intrinsics.json").unlink()
    with pytest.raises(SequenceError, match=r"no intrinsics\.json"):
        open_sequence(plain)


def test_no_frames_and_no_good_frames(plain):
    for file in (plain / "depth").iterdir():
        file.unlink()
    with pytest.raises(SequenceError, match=r"none of 12 sampled frames.*no depth file"):
        open_sequence(plain)
    for folder in ("rgb", "poses"):
        shutil.rmtree(plain / folder)
        (plain / folder).mkdir()
    with pytest.raises(SequenceError, match="has no frames"):
        open_sequence(plain)


def test_7scenes_without_intrinsics(folders, tmp_path):
    path = shutil.copytree(folders["7scenes"], tmp_path / "seq")
    (path / "camera-intrinsics.txt").rename(tmp_path / "camera-intrinsics.txt")
    assert len(open_sequence(path)) == 12  # beside all sequences of a scene
    (tmp_path / "camera-intrinsics.txt").unlink()
    with pytest.raises(SequenceError, match=r"no camera-intrinsics\.txt") as error:
        open_sequence(path)
    assert "585" in error.value.hint


def test_tum_interpolates_poses_and_names_lost_tracking(folders, shots, tmp_path):
    path = shutil.copytree(folders["tum"], tmp_path / "tum")
    sequence = open_sequence(path)
    T = room.stored_pose(shots[2].T_world_camera, "opencv_camera_to_world")
    np.testing.assert_allclose(sequence.recording.frames[2].pose, T, atol=1e-5)
    lines = (path / "groundtruth.txt").read_text().splitlines()
    kept = [line for line in lines if not line.startswith("1000.2")]
    (path / "groundtruth.txt").write_text("\n".join(kept))
    with pytest.raises(FrameError, match="no pose within 20 ms"):
        open_sequence(path)[2]


def test_tum_sensor_from_the_folder_name(folders, tmp_path):
    path = shutil.copytree(folders["tum"], tmp_path / "rgbd_dataset_freiburg3_office")
    (path / "calibration.txt").unlink()
    with pytest.raises(SequenceError, match=r"freiburg3.*another resolution"):
        open_sequence(path)


def test_prefetch_keeps_order_and_can_be_left(folders):
    sequence = open_sequence(folders["plain"])
    order = [7, 2, 2, 11, 0]
    assert [(i, f.index) for i, f in prefetch(sequence, order, workers=3, ahead=2)] == [
        (i, i) for i in order
    ]
    for i, _ in prefetch(sequence, range(12)):
        if i == 1:
            break


def test_colour_beside_the_depth_camera_is_moved_onto_it():
    """A colour image that encodes its own columns tells where each depth pixel looked."""
    depth_camera = Camera(500.0, 500.0, 80.0, 60.0, 160, 120)
    color_camera = ColorCamera(fx=450.0, fy=450.0, cx=82.0, cy=58.0, x_m=-0.03)
    columns = np.tile(np.arange(160, dtype=np.uint8), (120, 1))
    color = np.stack([columns, columns, columns], -1)
    depth_m = np.full((120, 160), 1.5, np.float32)
    depth_m[40:50, 60:70] = 0.0  # takes its neighbours' depth
    moved = register_color(color, depth_m, depth_camera, color_camera)
    u = np.arange(20, 140)
    expected = 82.0 + 450.0 * ((u - 80.0) / 500.0 - 0.03 / 1.5)
    rounding = 1.0
    np.testing.assert_allclose(moved[45, 20:140, 0].astype(float), expected, atol=rounding)


def test_colour_without_any_depth_is_left_as_it_is():
    color = np.arange(12 * 16 * 3, dtype=np.uint8).reshape(12, 16, 3)
    camera = Camera(20.0, 20.0, 8.0, 6.0, 16, 12)
    nothing = np.zeros((12, 16), np.float32)
    moved = register_color(color, nothing, camera, ColorCamera(20.0, 20.0, 8.0, 6.0, -0.03))
    np.testing.assert_array_equal(moved, color)
