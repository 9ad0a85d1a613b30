"""SceneNN: extracted frames with their trajectory, and annotated meshes, in the exact formats."""

from __future__ import annotations

import dataclasses
import json
import struct

import cv2
import numpy as np
import pytest

from isr_jax.borders.ply import write_ply
from isr_jax.classes import class_named
from isr_jax.datasets import (
    detect_format,
    inspect_sequence,
    open_sequence,
    read_scenenn_truth,
    truth_from_annotation,
)
from isr_jax.datasets.annotated_mesh import AnnotatedBox, AnnotatedInstance, AnnotatedMesh
from isr_jax.datasets.annotation_names import NYU40_NAMES, class_of_name
from isr_jax.datasets.annotation_truth import gravity_aligned
from isr_jax.datasets.images import read_color, read_depth
from isr_jax.datasets.layouts import read_recording
from isr_jax.datasets.ply_tables import read_ply_mesh
from isr_jax.datasets.scenenn_truth import VERSIONS
from isr_jax.errors import FrameError, IsrError, SequenceError
from isr_jax.evaluation import evaluate
from isr_jax.geometry.boxes import box_corners
from isr_jax.scene_file import read_scene, write_scene
from isr_jax.types import Mesh

from . import datasets_room as room
from . import scan_formats as scans

ROUNDING = 1e-6


def small_frames(count: int = 3, height: int = 24, width: int = 32) -> list[scans.ScanFrame]:
    """Frames of noise; frame i stands at x = i + 1 metres."""
    rng = np.random.default_rng(3)
    frames = []
    for i in range(count):
        pose = np.eye(4)
        pose[0, 3] = i + 1
        color = rng.integers(0, 255, (height, width, 3), np.uint8)
        frames.append(
            scans.ScanFrame(color, rng.integers(0, 5000, (height, width)).astype(np.uint16), pose)
        )
    return frames


def room_scans(count: int = 12) -> list[scans.ScanFrame]:
    return scans.scan_frames(room.shots(count), scans.SCENENN_WORLD)


ROOM_K = scans.matrix(room.FOCAL, room.FOCAL, room.WIDTH / 2, room.HEIGHT / 2)


# Frames


def test_images_and_poses_come_back_exactly(tmp_path):
    frames = small_frames()
    path = scans.write_scenenn(tmp_path / "005", frames, scans.matrix(40, 41, 16, 12))
    assert detect_format(path) == "scenenn"
    recording = read_recording(path, None)
    assert [f.name for f in recording.frames] == ["00001", "00002", "00003"]
    for true, found in zip(frames, recording.frames, strict=True):
        np.testing.assert_array_equal(read_color(found.color), true.color)
        millimetres = 1000 * read_depth(found.depth, recording.units_per_metre)
        np.testing.assert_array_equal(np.round(millimetres).astype(np.uint16), true.depth)
        np.testing.assert_allclose(found.pose, true.pose, atol=ROUNDING)
    K = recording.intrinsics
    assert (K.fx, K.fy, K.cx, K.cy, K.width, K.height) == (40, 41, 16, 12, 32, 24)


def test_an_image_takes_the_pose_that_names_its_number(tmp_path):
    """Frame i of the trajectory is image i + 1, also where images are missing."""
    path = scans.write_scenenn(tmp_path / "a", small_frames(4), ROOM_K, ending="jpg")
    (path / "image/image00002.jpg").unlink()
    (path / "depth/depth00002.png").unlink()
    recording = read_recording(path, None)
    assert [(f.name, f.pose[0, 3]) for f in recording.frames] == [
        ("00001", 1.0),
        ("00003", 3.0),
        ("00004", 4.0),
    ]
    assert any("1 of 4 poses" in note for note in recording.notes)


def test_a_room_opens_with_its_floor_found(tmp_path):
    path = scans.write_scenenn(tmp_path / "061", room_scans(), ROOM_K)
    sequence = open_sequence(path)
    shots = room.shots()
    up = sequence.T_world_dataset[2, :3]
    np.testing.assert_allclose(up, [0, 1, 0], atol=0.01)
    frame = sequence[4]
    # The world is known up to a turn about z and a shift along the floor: heights are absolute.
    assert frame.T_world_camera[2, 3] == pytest.approx(shots[4].T_world_camera[2, 3], abs=0.01)
    report = inspect_sequence(path)
    assert report.problems == () and report.incomplete == () and report.format == "scenenn"
    assert not report.gravity_given
    assert report.levels[1][0] == pytest.approx(room.TABLE_HEIGHT_M, abs=0.02)


def test_published_intrinsics_stand_in_for_the_file_but_not_for_other_sizes(tmp_path):
    path = scans.write_scenenn(tmp_path / "a", room_scans())
    assert read_recording(path, None).intrinsics.fx == 544.47329
    with pytest.raises(SequenceError, match=r"640x480.*160x120"):
        open_sequence(path)


def test_the_file_beside_all_scenes_is_found(tmp_path):
    path = scans.write_scenenn(tmp_path / "scenes/a", small_frames(), scans.matrix(40, 41, 16, 12))
    (path / "intrinsic").rename(tmp_path / "scenes/intrinsic")
    assert read_recording(path, None).intrinsics.fx == 40


@pytest.mark.parametrize(
    "text", ["fx 40\nfy 40\n", "depth_width 32\ndepth_height 24\nfx nan\nfy 4\n", "fx forty\n"]
)
def test_bad_intrinsics_are_named(tmp_path, text):
    path = scans.write_scenenn(tmp_path / "a", small_frames(), ROOM_K)
    (path / "intrinsic/asus.ini").write_text(text)
    with pytest.raises(SequenceError, match=r"asus\.ini"):
        read_recording(path, None)


@pytest.mark.parametrize("value", ["0 0 0 0.03", "nan nan nan 0", "-inf 0 0 0"])
def test_lost_tracking_skips_the_frame_and_says_so(tmp_path, value):
    path = scans.write_scenenn(tmp_path / "a", room_scans(), ROOM_K)
    lines = (path / "trajectory.log").read_text().splitlines()
    lines[11] = value  # first row of image 3
    (path / "trajectory.log").write_text("\n".join(lines) + "\n")
    sequence = open_sequence(path)
    assert any("1 of 12 frames lack a file or a pose" in note for note in sequence.notes)
    with pytest.raises(FrameError, match=r"trajectory\.log, image 3"):
        sequence[2]
    assert sequence[3].index == 3


def test_a_trajectory_that_ends_early_leaves_frames_without_pose(tmp_path):
    path = scans.write_scenenn(tmp_path / "a", small_frames(), ROOM_K)
    lines = (path / "trajectory.log").read_text().splitlines()
    (path / "trajectory.log").write_text("\n".join(lines[:10]))
    last = read_recording(path, None).frames[2]
    assert isinstance(last.pose, FrameError) and "no pose of image 3" in last.pose.problem


@pytest.mark.parametrize(
    ("line", "text"),
    [(0, "0 0"), (0, "0 0 5"), (5, "0 0 1"), (2, "0 1 0"), (3, "0 0 x 1"), (5, "a b c")],
)
def test_a_block_that_is_none_is_refused(tmp_path, line, text):
    path = scans.write_scenenn(tmp_path / "a", small_frames(), ROOM_K)
    lines = (path / "trajectory.log").read_text().splitlines()
    lines[line] = text
    (path / "trajectory.log").write_text("\n".join(lines) + "\n")
    with pytest.raises(SequenceError, match=rf"trajectory\.log: block {line // 5}"):
        read_recording(path, None)


def test_a_cut_trajectory_never_fails_otherwise(tmp_path):
    path = scans.write_scenenn(tmp_path / "a", small_frames(), ROOM_K)
    whole = (path / "trajectory.log").read_bytes()
    kept = set()
    for cut in range(len(whole)):
        (path / "trajectory.log").write_bytes(whole[:cut])
        try:
            recording = read_recording(path, None)
        except SequenceError:
            continue
        found = [f.pose for f in recording.frames if not isinstance(f.pose, FrameError)]
        kept.add(len(found))
        for i, pose in enumerate(found):
            assert pose[0, 3] == i + 1
    assert kept == {0, 1, 2, 3}


def test_without_images_it_says_how_to_get_them(tmp_path):
    path = scans.write_scenenn(tmp_path / "a", small_frames(), ROOM_K)
    (path / "image").rename(path / "elsewhere")
    with pytest.raises(SequenceError, match="playback tool"):
        open_sequence(path)


def test_two_images_of_one_number_are_refused(tmp_path):
    path = scans.write_scenenn(tmp_path / "a", small_frames(), ROOM_K)
    (path / "image/frame00002.png").write_bytes((path / "image/image00002.png").read_bytes())
    with pytest.raises(SequenceError, match="two images of number 2"):
        read_recording(path, None)


# Names


def test_names_of_annotators():
    said = {
        "Backpack": "bag",
        "bag": "bag",
        "TV": "monitor",
        "tv/monitor": None,
        "Couch": "sofa",
        "Refridgerator": "fridge",
        "fridge": "fridge",
        "chair 2": "chair",
        "chair12": "chair",
        "trash_bin": "bin",
        "Night Stand": "nightstand",
        "books": "book",
        "desk": "desk",
        "floor mat": "rug",
        "otherprop": None,
        "gizmo": None,
        "none": None,
        "washing-machine": "washing_machine",
        "whiteboard": "picture",
        "shower curtain": "curtain",
    }
    assert {name: class_of_name(name) for name in said} == said


def test_every_nyu40_name_agrees_with_the_table_of_classes():
    """Where the table maps the id of a name, the name gives the same class (or a finer own one)."""
    for id, name in enumerate(NYU40_NAMES, 1):
        found = class_of_name(name)
        if found is not None:
            assert id in class_named(found).labels["nyu40"], name
    assert [class_of_name(n) for n in ("otherstructure", "clothes", "towel")] == [None] * 3


# PLY


def tiny_mesh():
    vertices = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0.25], [0, 1, -2.5], [3, 3, 3]], np.float32)
    table = scans.vertex_table(vertices, label=np.array([1, 1, 2, 65535, 0], np.uint16))
    return table, [(0, 1, 2), (0, 2, 3)]


@pytest.mark.parametrize("format", ["binary_little_endian", "binary_big_endian", "ascii"])
@pytest.mark.parametrize("faces", [[(0, 1, 2), (0, 2, 3)], [(0, 1, 2, 3)], [(0, 1, 2), (3, 4)]])
def test_ply_meshes_come_back_exactly(tmp_path, format, faces):
    table, _ = tiny_mesh()
    found = read_ply_mesh(scans.write_ply(tmp_path / "a.ply", table, faces, format=format))
    np.testing.assert_array_equal(found.vertices["label"], table["label"])
    for axis in "xyz":
        np.testing.assert_array_equal(found.vertices[axis], table[axis])
    expected = {2: [[0, 1, 2], [0, 2, 3]], 1: [[0, 1, 2], [0, 2, 3]]}[len(faces)]
    expected = expected if len(faces[-1]) > 2 else [[0, 1, 2]]
    np.testing.assert_array_equal(found.faces, expected)


@pytest.mark.parametrize("corners", [3, 4])
def test_faces_with_more_than_corners_are_read(tmp_path, corners):
    """A flag before the list and a list of texture coordinates after it."""
    table, _ = tiny_mesh()
    whole = scans.ply_bytes(table, [])
    old = b"element face 0\nproperty list uchar int vertex_indices\n"
    new = (
        b"element face 1\nproperty short flags\nproperty list uchar int vertex_indices\n"
        b"property list uchar float texcoord\n"
    )
    row = struct.pack("<hB", 7, corners) + np.arange(corners, dtype="<i4").tobytes()
    row += struct.pack("<B2f", 2, 0.5, 0.25)
    (tmp_path / "a.ply").write_bytes(whole.replace(old, new) + row)
    expected = [[0, 1, 2], [0, 2, 3]][: corners - 2]
    np.testing.assert_array_equal(read_ply_mesh(tmp_path / "a.ply").faces, expected)


@pytest.mark.parametrize("format", ["binary_little_endian", "ascii"])
def test_a_cut_ply_is_always_refused(tmp_path, format):
    table, faces = tiny_mesh()
    whole = scans.ply_bytes(table, faces, format=format)
    path = tmp_path / "a.ply"
    last = len(whole) - (2 if format == "ascii" else 1)  # the newline, then a digit
    for cut in range(last):
        path.write_bytes(whole[:cut])
        with pytest.raises(SequenceError, match=r"a\.ply"):
            read_ply_mesh(path)


def test_flipped_bytes_of_a_ply_raise_nothing_else(tmp_path):
    table, faces = tiny_mesh()
    whole = bytearray(scans.ply_bytes(table, faces))
    rng = np.random.default_rng(1)
    path = tmp_path / "a.ply"
    refused = 0
    for _ in range(300):
        damaged = whole.copy()
        damaged[rng.integers(len(whole))] ^= 1 << int(rng.integers(8))
        path.write_bytes(bytes(damaged))
        try:
            read_ply_mesh(path)
        except SequenceError:
            refused += 1
    assert refused > 100


def test_counts_that_cannot_be_are_refused_before_anything_is_made(tmp_path):
    table, faces = tiny_mesh()
    whole = scans.ply_bytes(table, faces)
    path = tmp_path / "a.ply"
    path.write_bytes(whole.replace(b"element vertex 5", b"element vertex 99999999999"))
    with pytest.raises(SequenceError, match="claims 99999999999 of vertex"):
        read_ply_mesh(path)


# Annotation


def patch(corner, side_a, side_b, step=0.02):
    """A densely meshed rectangle: vertices, faces."""
    a, b = np.asarray(side_a, float), np.asarray(side_b, float)
    m, n = (round(np.linalg.norm(s) / step) + 1 for s in (a, b))
    u, v = np.meshgrid(np.linspace(0, 1, m), np.linspace(0, 1, n), indexing="ij")
    points = np.asarray(corner, float) + u[..., None] * a + v[..., None] * b
    k = np.arange(m * n).reshape(m, n)
    first = np.stack([k[:-1, :-1], k[1:, :-1], k[1:, 1:]], -1).reshape(-1, 3)
    second = np.stack([k[:-1, :-1], k[1:, 1:], k[:-1, 1:]], -1).reshape(-1, 3)
    return points.reshape(-1, 3), np.concatenate([first, second])


def block(low, high):
    """The five seen sides of a box."""
    x, y, z = np.subtract(high, low)
    top = patch([low[0], low[1], high[2]], [x, 0, 0], [0, y, 0])
    sides = [
        patch(low, [x, 0, 0], [0, 0, z]),
        patch([low[0], high[1], low[2]], [x, 0, 0], [0, 0, z]),
        patch(low, [0, y, 0], [0, 0, z]),
        patch([high[0], low[1], low[2]], [0, y, 0], [0, 0, z]),
    ]
    vertices, faces, _ = scans.merged([top, *sides])
    return vertices, faces


NAMES = ("floor", "chair", "Couch", "picture", "gizmo", "unknown")
IDS = (3, 7, 11, 12, 20, 21)


def annotated_parts():
    """World frame: a floor, a chair, a sofa, a picture, a thing of no class, and something."""
    return [
        patch([0, 0, 0], [2, 0, 0], [0, 2, 0]),
        block([0.2, 0.2, 0.03], [0.6, 0.6, 0.8]),  # clear of the floor: no two points coincide
        block([1.0, 1.2, 0.03], [1.8, 1.8, 0.43]),
        patch([0, 1.0, 1.0], [0, 0.4, 0], [0, 0, 0.4]),
        block([1.2, 0.2, 0.03], [1.4, 0.4, 0.2]),
        patch([1.9, 0, 0.5], [0, 0.2, 0], [0, 0, 0.2]),
    ]


def write_annotated(path, *, T=scans.SCENENN_WORLD, changes=None, obbox=None):
    vertices, faces, part = scans.merged(annotated_parts())
    labels = [
        scans.ScanLabel(id, name, obbox=obbox if name == "chair" else None)
        for id, name in zip(IDS, NAMES, strict=True)
    ]
    label = np.array([0, *IDS])[part]
    label[-3:] = 999  # of nothing that the XML lists
    moved = vertices @ T[:3, :3].T + T[:3, 3]
    scans.write_scenenn_truth(path, moved, faces, label, labels if changes is None else changes)
    return moved, faces, label


def test_an_annotated_mesh_comes_back_exactly(tmp_path):
    vertices, faces, label = write_annotated(tmp_path / "005")
    found = read_scenenn_truth(tmp_path / "005")
    np.testing.assert_array_equal(found.mesh.vertices, vertices.astype(np.float32))
    np.testing.assert_array_equal(found.mesh.faces, faces)
    np.testing.assert_array_equal(found.instance, np.where(np.isin(label, [21, 999]), 0, label))
    classes = {i.id: (i.label, i.class_name) for i in found.instances}
    assert classes == {
        3: ("floor", "floor"),
        7: ("chair", "chair"),
        11: ("Couch", "sofa"),
        12: ("picture", "picture"),
        20: ("gizmo", None),
    }
    assert found.annotation == VERSIONS[0] and found.name == "005"
    notes = "\n".join(found.notes)
    assert "'gizmo'" in notes and "999" in notes and "not annotated" in notes


def test_the_two_annotations_differ_and_are_named(tmp_path):
    labels = [
        scans.ScanLabel(id, name, nyu_class={"chair": "sofa"}.get(name, name))
        for id, name in zip(IDS, NAMES, strict=True)
    ]
    write_annotated(tmp_path / "a", changes=labels)
    later = read_scenenn_truth(tmp_path / "a")
    earlier = read_scenenn_truth(tmp_path / "a", version=VERSIONS[0])
    name = {a.annotation: {i.id: i.class_name for i in a.instances}[7] for a in (later, earlier)}
    assert name == {VERSIONS[1]: "sofa", VERSIONS[0]: "chair"}
    with pytest.raises(SequenceError, match="unknown annotation version"):
        read_scenenn_truth(tmp_path / "a", version="v2")


def test_oriented_boxes_are_read_as_centre_size_quaternion(tmp_path):
    """A turn by 30 degrees about y is the quaternion (0, sin 15, 0, cos 15)."""
    half = np.deg2rad(15)
    obbox = (1.0, 2.0, 3.0, 0.4, 0.8, 0.6, 0.0, np.sin(half), 0.0, np.cos(half))
    write_annotated(tmp_path / "a", obbox=obbox)
    found = read_scenenn_truth(tmp_path / "a")
    box = next(i.box for i in found.instances if i.id == 7)
    np.testing.assert_allclose(box.center, [1, 2, 3])
    np.testing.assert_allclose(box.size, [0.4, 0.8, 0.6])
    c, s = np.cos(2 * half), np.sin(2 * half)
    np.testing.assert_allclose(box.R_dataset_box, [[c, 0, s], [0, 1, 0], [-s, 0, c]], atol=1e-6)
    assert [i.box for i in found.instances if i.id != 7] == [None] * 4


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (("<annotation>", "<!DOCTYPE a [<!ENTITY b 'c'>]><annotation>"), "document type"),
        (("</annotation>", ""), "no valid XML"),
        (('id="7"', 'id="-7"'), "has the id '-7'"),
        (('id="7"', 'id="3"'), r"labels \[3\] are listed more than once"),
        (("label ", "part "), "no element `label`"),
        (('text="chair"', 'text="chair" obbox="1 2 3"'), "label 7 has obbox = '1 2 3'"),
        (('text="chair"', 'text="chair" obbox="0 0 0 1 1 1 0 0 0 nan"'), "label 7 has obbox"),
    ],
)
def test_bad_annotations_are_named(tmp_path, change, message):
    write_annotated(tmp_path / "a")
    path = tmp_path / "a/a.xml"
    path.write_text(path.read_text().replace(*change))
    with pytest.raises(SequenceError, match=message):
        read_scenenn_truth(tmp_path / "a")


def test_bad_meshes_are_named(tmp_path):
    vertices, faces, label = write_annotated(tmp_path / "a")
    path = tmp_path / "a/a.ply"
    for bad in (np.nan, -np.inf):
        broken = vertices.copy()
        broken[5, 1] = bad
        table = scans.vertex_table(broken, label=label.astype(np.uint16))
        scans.write_ply(path, table, faces)
        with pytest.raises(SequenceError, match=r"1 of \d+ vertices are not finite"):
            read_scenenn_truth(tmp_path / "a")
    scans.write_ply(path, scans.vertex_table(vertices), faces)
    with pytest.raises(SequenceError, match="no whole-number column 'label'"):
        read_scenenn_truth(tmp_path / "a")
    table = scans.vertex_table(vertices, label=label.astype(np.uint16))
    scans.write_ply(path, table, [*faces, (0, 1, len(vertices))])
    with pytest.raises(SequenceError, match="faces name vertices 0 to"):
        read_scenenn_truth(tmp_path / "a")
    (tmp_path / "a/a.xml").unlink()
    with pytest.raises(SequenceError, match="found none"):
        read_scenenn_truth(tmp_path / "a")


# Truth folders

T_WORLD = np.linalg.inv(scans.SCENENN_WORLD)


def test_a_truth_folder_says_what_was_annotated(tmp_path):
    write_annotated(tmp_path / "a")
    annotated = read_scenenn_truth(tmp_path / "a")
    truth_from_annotation(annotated, T_WORLD, tmp_path / "truth", write_mesh=write_ply)
    scene = read_scene(tmp_path / "truth/scene.json")
    assert [(e.name, e.type, e.parent, e.attachment) for e in scene.entities] == [
        ("floor_3", "layout", "room", "none"),
        ("chair_7", "scan", None, "none"),
        ("sofa_11", "scan", None, "none"),
    ]
    box = scene.entity("sofa_11").box
    np.testing.assert_allclose(box.center, [1.4, 1.5, 0.23], atol=1e-5)
    np.testing.assert_allclose(box.size, [0.8, 0.6, 0.4], atol=1e-5)
    assert scene.settings["supports"] == "not annotated"
    assert scene.settings["annotation"] == VERSIONS[0]
    assert any("gizmo" in note for note in scene.settings["notes"])
    json.dumps(scene.settings)


def test_points_of_the_truth_keep_labels_and_thin_to_the_grid(tmp_path):
    write_annotated(tmp_path / "a")
    annotated = read_scenenn_truth(tmp_path / "a")
    truth_from_annotation(annotated, T_WORLD, tmp_path / "truth")
    with np.load(tmp_path / "truth/observed.npz") as data:
        points, instance, class_id = data["points"], data["instance"], data["class_id"]
        normals = data["normals"]
    named = {id: class_named(n).id for id, n in ((3, "floor"), (7, "chair"), (11, "sofa"))}
    named |= {12: class_named("picture").id, 0: 0}
    assert set(instance.tolist()) == set(named)  # neither the gizmo nor the unknown
    np.testing.assert_array_equal(class_id, [named[i] for i in instance.tolist()])
    on_floor = instance == 3
    np.testing.assert_allclose(points[on_floor, 2], 0, atol=1e-6)
    np.testing.assert_allclose(np.abs(normals[on_floor, 2]), 1, atol=1e-5)
    cells = np.unique(np.floor(points[on_floor] / 0.02 + 1e-4), axis=0)
    assert 0.25 * 101 * 101 < len(cells) <= on_floor.sum() <= 101 * 101
    assert not (tmp_path / "truth/meshes").exists()


def test_the_meshes_of_a_truth_are_the_whole_mesh_once(tmp_path):
    write_annotated(tmp_path / "a")
    annotated = read_scenenn_truth(tmp_path / "a")
    truth_from_annotation(annotated, T_WORLD, tmp_path / "truth", write_mesh=write_ply)
    files = sorted(p.name for p in (tmp_path / "truth/meshes").iterdir())
    assert files == ["chair_7.ply", "floor_3.ply", "remainder.ply", "sofa_11.ply"]
    found = [read_ply_mesh(tmp_path / "truth/meshes" / name) for name in files]
    assert sum(len(m.faces) for m in found) == len(annotated.mesh.faces)
    floor = found[1].vertices
    assert len(floor) == 101 * 101
    np.testing.assert_allclose(floor["z"], 0, atol=1e-6)


def test_a_perfect_answer_scores_one_and_a_missing_thing_costs(tmp_path):
    write_annotated(tmp_path / "a")
    annotated = read_scenenn_truth(tmp_path / "a")
    scene = truth_from_annotation(annotated, T_WORLD, tmp_path / "truth", write_mesh=write_ply)
    result = tmp_path / "result"
    (result / "map").mkdir(parents=True)
    world = annotated.mesh.vertices @ T_WORLD[:3, :3].T + T_WORLD[:3, 3]
    table = np.zeros(annotated.instance.max() + 1, np.int32)
    for item in annotated.instances:
        table[item.id] = class_named(item.class_name).id if item.class_name else 0
    mesh = Mesh(world.astype(np.float32), annotated.mesh.faces)

    def score(instance):
        extra = {"instance": instance, "class": table[instance]}
        write_ply(result / "map/panoptic.ply", mesh, extra)
        write_scene(scene, result / "scene.json")
        return evaluate(result, tmp_path / "truth")

    best = score(annotated.instance)
    assert best.panoptic.pq == pytest.approx(1.0) and best.panoptic.sq == pytest.approx(1.0)
    assert {c.class_name for c in best.panoptic.classes} == {"floor", "chair", "sofa", "picture"}
    assert best.boxes.map50 == pytest.approx(1.0) and best.supports.true == 0
    worse = score(np.where(annotated.instance == 7, 0, annotated.instance))
    assert worse.panoptic.pq == pytest.approx(0.75)  # three of the four classes


# Boxes


def corner_set(points):
    return np.array(sorted(np.round(np.asarray(points, np.float64), 4).tolist()))


@pytest.mark.parametrize("up", [0, 1, 2])
def test_upright_boxes_keep_their_corners(up):
    """Whatever axis of the box is up, and however it is turned about the vertical."""
    signs = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) / 2
    cyclic = np.roll(np.eye(3), up + 1, axis=0)  # box axis `up` along world z
    for turn in np.linspace(-3, 3, 9):
        c, s = np.cos(turn), np.sin(turn)
        R_world_box = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]) @ cyclic
        R = scans.SCENENN_WORLD[:3, :3] @ R_world_box
        box = AnnotatedBox(np.array([0.3, 1.0, -2.0]), np.array([0.4, 0.7, 1.1]), R)
        found, tilt_deg = gravity_aligned(box, T_WORLD)
        corners = signs * box.size @ R.T + box.center
        world = corners @ T_WORLD[:3, :3].T + T_WORLD[:3, 3]
        np.testing.assert_allclose(corner_set(box_corners(found)), corner_set(world), atol=2e-4)
        assert tilt_deg < 1e-3 and abs(float(found.yaw)) <= np.pi / 4 + 1e-6


def test_a_leaning_box_is_refitted_and_the_user_told(tmp_path):
    turn = cv2.Rodrigues(np.array([0.0, 0.0, np.deg2rad(25)]))[0]  # about z, level in a y-up frame
    vertices, faces, part = scans.merged([block([0, 0, 0], [0.4, 0.6, 0.8])])
    moved = vertices @ scans.SCENENN_WORLD[:3, :3].T + scans.SCENENN_WORLD[:3, 3]
    box = AnnotatedBox(moved.mean(0), np.array([0.4, 0.8, 0.6]), turn)
    instance = AnnotatedInstance(1, "chair", "chair", box)
    mesh = Mesh(moved.astype(np.float32), faces.astype(np.int32))
    annotated = AnnotatedMesh("a", "test", mesh, part, (instance,), ())
    scene = truth_from_annotation(annotated, T_WORLD, tmp_path)
    np.testing.assert_allclose(scene.entities[0].box.size, [0.4, 0.6, 0.8], atol=1e-5)
    assert any("leans by 25 degrees" in note for note in scene.settings["notes"])


def test_a_world_that_is_not_finite_is_refused(tmp_path):
    write_annotated(tmp_path / "a")
    with pytest.raises(IsrError, match="T_world_dataset"):
        truth_from_annotation(read_scenenn_truth(tmp_path / "a"), np.full((4, 4), np.nan), tmp_path)


@pytest.mark.parametrize("scale", [0.0, 1e30])
def test_a_mesh_that_is_no_room_is_refused(tmp_path, scale):
    write_annotated(tmp_path / "a")
    found = read_scenenn_truth(tmp_path / "a")
    mesh = Mesh((found.mesh.vertices * np.float32(scale)).astype(np.float32), found.mesh.faces)
    with pytest.raises(SequenceError, match=r"the mesh of a extends over"):
        truth_from_annotation(dataclasses.replace(found, mesh=mesh), np.eye(4), tmp_path / "truth")
