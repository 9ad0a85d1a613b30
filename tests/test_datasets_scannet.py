"""ScanNet: ``.sens`` files, exported folders and annotations, in the exact formats."""

from __future__ import annotations

import json
import struct
import tracemalloc

import cv2
import numpy as np
import pytest

from isr_jax.datasets import (
    detect_format,
    inspect_sequence,
    open_sequence,
    read_scannet_truth,
    truth_from_annotation,
)
from isr_jax.datasets.images import ColorCamera, check_complete, read_color, read_depth
from isr_jax.datasets.layouts import read_recording
from isr_jax.datasets.sens_file import index_sens
from isr_jax.errors import FrameError, SequenceError
from isr_jax.scene_file import read_scene

from . import datasets_room as room
from . import scan_formats as scans

K_SMALL = scans.matrix(40, 41, 15.5, 11.5)
K_COLOR = scans.matrix(80, 82, 31.5, 23.5)
HEADER_BYTES = 12 + 15 + 256 + 8 + 16 + 4 + 8
"""Version and length; "StructureSensor"; four matrices; codings; sizes; units; number of frames."""


def small_frames(count: int = 3, color_scale: int = 1) -> list[scans.ScanFrame]:
    rng = np.random.default_rng(4)
    frames = []
    for _ in range(count):
        pose = np.eye(4)
        pose[:3, :3] = cv2.Rodrigues(rng.normal(size=3))[0]
        pose[:3, 3] = rng.normal(size=3)
        shape = (24 * color_scale, 32 * color_scale, 3)
        depth = rng.integers(0, 5000, (24, 32)).astype(np.uint16)
        frames.append(scans.ScanFrame(rng.integers(0, 255, shape, np.uint8), depth, pose))
    return frames


def room_scans(count: int = 12) -> list[scans.ScanFrame]:
    return scans.scan_frames(room.shots(count), scans.SCANNET_WORLD)


ROOM_K = scans.matrix(room.FOCAL, room.FOCAL, room.WIDTH / 2, room.HEIGHT / 2)


def written(tmp_path, data: bytes):
    path = tmp_path / "scene0000_00" / "scene0000_00.sens"
    path.parent.mkdir(exist_ok=True)
    path.write_bytes(data)
    return path


# .sens


@pytest.mark.parametrize("color", ["raw", "png", "jpeg"])
@pytest.mark.parametrize("depth", ["raw_ushort", "zlib_ushort"])
def test_a_sens_file_comes_back_exactly(tmp_path, color, depth):
    frames = small_frames()
    data, starts = scans.sens_bytes(frames, K_COLOR, K_SMALL, color=color, depth=depth)
    found = index_sens(written(tmp_path, data))
    assert starts[0] == HEADER_BYTES and found.header == data[:HEADER_BYTES]
    assert (found.sensor, found.declared, len(found.frames)) == ("StructureSensor", 3, 3)
    assert (found.color_size, found.depth_size, found.units_per_metre) == ((32, 24), (32, 24), 1000)
    np.testing.assert_allclose(found.color_intrinsic, K_COLOR)
    np.testing.assert_allclose(found.depth_intrinsic, K_SMALL)
    for i, (true, frame) in enumerate(zip(frames, found.frames, strict=True)):
        np.testing.assert_array_equal(frame.pose, true.pose.astype(np.float32))
        assert (frame.color_time, frame.depth_time) == (33333 * i, 33333 * i + 7)
        expected = true.color
        if color == "jpeg":
            stored = cv2.imencode(".jpg", np.ascontiguousarray(true.color[..., ::-1]))[1]
            expected = cv2.imdecode(stored, cv2.IMREAD_COLOR_RGB)
        np.testing.assert_array_equal(read_color(frame.color), expected)
        depth_m = read_depth(frame.depth, found.units_per_metre)
        np.testing.assert_array_equal(depth_m, true.depth.astype(np.float32) / np.float32(1000))
        check_complete(frame.color)
        check_complete(frame.depth)


def test_a_room_opens_upright_with_colour_of_another_size(tmp_path):
    """Colour of 320x240 from a camera of other intrinsics: its columns tell where it looked."""
    frames = room_scans()
    columns = np.tile(np.linspace(0, 255, 320).astype(np.uint8)[None, :, None], (240, 1, 3))
    frames = [scans.ScanFrame(columns, f.depth, f.pose) for f in frames]
    K_color = scans.matrix(300, 300, 165.5, 118.5)
    path = scans.write_sens(tmp_path / "scene0001_00", frames, K_color, ROOM_K, color="png")
    assert detect_format(path) == "scannet"
    sequence = open_sequence(path)
    true = room.shots()[3].T_world_camera
    found = sequence[3].T_world_camera
    np.testing.assert_allclose(sequence.T_world_dataset[2, :3], [0, 0, 1], atol=0.01)
    assert found[2, 3] == pytest.approx(true[2, 3], abs=0.01)
    # u' = 165.5 + 300 (u - 80) / 140; the gradient is 255 / 319 a column.
    u = np.arange(30, 130)
    expected = (165.5 + 300 * (u - 80) / 140) * 255 / 319
    tolerance = 1.5  # 8-bit steps, and averaging of two columns
    seen = sequence[3].color[60, 30:130, 0].astype(float)
    np.testing.assert_allclose(seen, expected, atol=tolerance)
    assert any("320x240" in note for note in sequence.notes)
    report = inspect_sequence(path)
    assert report.problems == () and report.incomplete == () and report.gravity_given
    assert report.format == "scannet"


def test_invalid_poses_are_skipped_and_said(tmp_path):
    frames = room_scans()
    lost = np.full((4, 4), -np.inf)
    frames[2] = scans.ScanFrame(frames[2].color, frames[2].depth, lost)
    path = scans.write_sens(tmp_path / "s", frames, ROOM_K, ROOM_K)
    sequence = open_sequence(path)
    with pytest.raises(FrameError, match=r"frame 2: the pose holds NaN or infinity"):
        sequence[2]
    assert any("1 of 12 frames lack a file or a pose" in note for note in sequence.notes)
    assert len(inspect_sequence(path).incomplete) == 1


def test_indexing_touches_no_image(tmp_path):
    """A sparse file of 750 MB whose images were never written is indexed in a few kilobytes."""
    frames = small_frames(1)
    data, starts = scans.sens_bytes(
        frames, K_COLOR, K_SMALL, color="raw", depth="raw_ushort", sizes=(1296, 968, 640, 480)
    )
    path = written(tmp_path, b"")
    images = 1296 * 968 * 3, 640 * 480 * 2
    head = data[starts[0] : starts[0] + 80] + struct.pack("<QQ", *images)
    count = 172
    with path.open("wb") as file:
        file.write(data[: starts[0] - 8] + struct.pack("<Q", count))
        for _ in range(count):
            file.write(head)
            file.seek(sum(images), 1)
        file.truncate(file.tell())
    assert path.stat().st_size > 7.4e8
    tracemalloc.start()
    found = index_sens(path)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert len(found.frames) == count and peak < 1e6
    assert found.frames[-1].depth.offset + images[1] == path.stat().st_size


def test_a_cut_file_keeps_its_whole_frames_wherever_it_is_cut(tmp_path):
    frames = [scans.ScanFrame(f.color[:2, :3], f.depth[:2, :3], f.pose) for f in small_frames(2)]
    data, starts = scans.sens_bytes(frames, K_COLOR, K_SMALL, color="raw")
    path = written(tmp_path, b"")
    for cut in range(len(data)):
        path.write_bytes(data[:cut])
        if cut < HEADER_BYTES:
            with pytest.raises(SequenceError, match="cut off within its header"):
                index_sens(path)
            continue
        found = index_sens(path)
        assert len(found.frames) == sum(cut >= end for end in starts[1:]), cut
        for true, frame in zip(frames, found.frames, strict=False):
            np.testing.assert_array_equal(frame.color.rgb(), true.color)


def test_a_cut_file_says_how_much_is_left(tmp_path):
    frames = room_scans()
    data, starts = scans.sens_bytes(frames, ROOM_K, ROOM_K)
    path = written(tmp_path, data[: starts[10] + 50])
    sequence = open_sequence(path.parent)
    assert len(sequence) == 10
    assert any("10 of 12 frames are whole and used" in note for note in sequence.notes)
    path.write_bytes(data[: starts[0] + 50])
    with pytest.raises(SequenceError, match="no whole frame of the 12"):
        open_sequence(path.parent)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"version": 3}, "version 3, not 4"),
        ({"version": 0x89504E47}, "no .sens file"),
        ({"depth": "occi_ushort"}, "occi_ushort.*not read"),
        ({"sizes": (0, 24, 32, 24)}, "colour images of 0x24"),
        ({"sizes": (32, 24, 4000000000, 24)}, "depth images of 4000000000x24"),
        ({"units": 0.0}, "0.0 units per metre"),
        ({"units": float("nan")}, "nan units per metre"),
        ({"sensor": b"x" * 5000}, "5000 bytes long"),
    ],
)
def test_headers_that_cannot_be_are_refused(tmp_path, changes, message):
    data, _ = scans.sens_bytes(small_frames(1), K_COLOR, K_SMALL, **changes)
    with pytest.raises(SequenceError, match=message) as caught:
        index_sens(written(tmp_path, data))
    assert "scene0000_00.sens" in caught.value.problem and caught.value.hint


@pytest.mark.parametrize("K", [np.full((4, 4), np.nan), np.zeros((4, 4)), -np.eye(4)])
def test_intrinsics_that_cannot_be_are_refused(tmp_path, K):
    data, _ = scans.sens_bytes(small_frames(1), K_COLOR, K)
    with pytest.raises(SequenceError, match="intrinsics of the depth camera"):
        index_sens(written(tmp_path, data))


@pytest.mark.parametrize(("at", "kind"), [(80, "colour"), (88, "depth")])
def test_sizes_that_cannot_be_are_refused(tmp_path, at, kind):
    data, starts = scans.sens_bytes(small_frames(2), K_COLOR, K_SMALL)
    damaged = bytearray(data)
    struct.pack_into("<Q", damaged, starts[1] + at, 1 << 60)
    with pytest.raises(SequenceError, match=rf"frame 1 .* claims {1 << 60} bytes of {kind}"):
        index_sens(written(tmp_path, bytes(damaged)))


def test_a_huge_number_of_declared_frames_costs_nothing(tmp_path):
    data, _ = scans.sens_bytes(small_frames(2), K_COLOR, K_SMALL, declared=1 << 62)
    data = data[: data.rindex(struct.pack("<Q", 1))]  # without what follows the frames
    assert len(index_sens(written(tmp_path, data)).frames) == 2


def test_flipped_bytes_raise_nothing_but_our_errors(tmp_path):
    data, _ = scans.sens_bytes(small_frames(2), K_COLOR, K_SMALL, color="png")
    rng = np.random.default_rng(2)
    outcomes = {"refused": 0, "frame": 0, "read": 0}
    for i in range(300):
        damaged = bytearray(data)
        last = HEADER_BYTES if i % 2 else len(data)
        damaged[rng.integers(last)] ^= 1 << int(rng.integers(8))
        path = written(tmp_path, bytes(damaged))
        try:
            found = index_sens(path)
        except SequenceError:
            outcomes["refused"] += 1
            continue
        try:
            for frame in found.frames:
                read_color(frame.color)
                read_depth(frame.depth, found.units_per_metre)
            outcomes["read"] += 1
        except FrameError:
            outcomes["frame"] += 1
    assert min(outcomes.values()) > 10, outcomes


def test_inflating_stops_at_the_image(tmp_path):
    """A deflated image that would fill far more than its pixels is refused, not inflated."""
    frames = small_frames(1)
    bomb = np.zeros((2000, 2000), np.uint16)
    frames = [scans.ScanFrame(frames[0].color, bomb, frames[0].pose)]
    data, _ = scans.sens_bytes(frames, K_COLOR, K_SMALL, sizes=(32, 24, 32, 24))
    found = index_sens(written(tmp_path, data))
    tracemalloc.start()
    with pytest.raises(FrameError, match="holds more than 1536 bytes of pixels, 32x24 need 1536"):
        read_depth(found.frames[0].depth, 1000.0)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 1e6


def test_two_files_or_none(tmp_path):
    path = scans.write_sens(tmp_path / "s", small_frames(1), K_COLOR, K_SMALL)
    (path / "other.sens").write_bytes(b"")
    with pytest.raises(SequenceError, match=r"holds 2 \.sens files"):
        open_sequence(path)
    with pytest.raises(SequenceError, match="holds sequences"):
        detect_format(tmp_path)


def test_the_hash_depends_on_header_poses_and_images(tmp_path):
    frames = small_frames(2)

    def hashed(name, frames, K_depth=K_SMALL):
        path = scans.write_sens(tmp_path / name / "s", frames, K_COLOR, K_depth)
        return read_recording(path, None).content_hash()

    same = hashed("a", frames)
    moved = [scans.ScanFrame(f.color, f.depth, f.pose + np.eye(4, k=3)) for f in frames]
    other = [scans.ScanFrame(f.color, f.depth + 1, f.pose) for f in frames]
    hashes = [
        same,
        hashed("c", moved),
        hashed("d", other),
        hashed("e", frames, scans.matrix(40, 41, 15, 12)),
    ]
    assert hashed("b", frames) == same and len(set(hashes)) == 4


def test_a_file_that_shrinks_after_it_was_indexed_says_so(tmp_path):
    data, starts = scans.sens_bytes(small_frames(2), K_COLOR, K_SMALL)
    path = written(tmp_path, data)
    found = index_sens(path)
    path.write_bytes(data[: starts[1] + 100])
    with pytest.raises(FrameError, match="bytes are left"):
        read_color(found.frames[1].color)


# Exported folders


def test_exported_folders_say_what_the_file_says(tmp_path):
    frames = small_frames(12, color_scale=2)
    path = scans.write_scannet_folders(tmp_path / "scene0000_00", frames, K_COLOR, K_SMALL)
    (path / "color" / "notes.txt").write_text("")
    sens = read_recording(scans.write_sens(tmp_path / "s", frames, K_COLOR, K_SMALL), None)
    folders = read_recording(path, None)
    assert folders.format == "scannet" and folders.color_camera is not None
    assert [f.name for f in folders.frames] == [f.name for f in sens.frames]
    rounding = 1e-5  # SensReader writes six digits
    for a, b in zip(folders.frames, sens.frames, strict=True):
        np.testing.assert_allclose(a.pose, b.pose, atol=rounding)
        np.testing.assert_array_equal(folders.depth_m(a), sens.depth_m(b))
    K = folders.intrinsics
    assert (K.fx, K.fy, K.cx, K.cy) == (40, 41, 15.5, 11.5)


def test_folders_open_and_lost_poses_are_skipped(tmp_path):
    path = scans.write_scannet_folders(tmp_path / "s", room_scans(), ROOM_K, ROOM_K)
    (path / "pose/3.txt").write_text("-inf -inf -inf -inf\n" * 4)
    (path / "pose/5.txt").unlink()
    sequence = open_sequence(path)
    assert any("2 of 12 frames" in note for note in sequence.notes)
    for i in (3, 5):
        with pytest.raises(FrameError):
            sequence[i]
    report = inspect_sequence(path)
    assert len(report.incomplete) == 2 and report.problems == ()


def test_colour_made_smaller_keeps_its_camera(tmp_path):
    """1296x968 intrinsics beside 648x484 images: half of all, with centres on whole pixels."""
    frames = small_frames(2)
    color = np.zeros((484, 648, 3), np.uint8)
    frames = [scans.ScanFrame(color, f.depth, f.pose) for f in frames]
    stated = scans.matrix(1170, 1171, 647.5, 483.5)
    path = scans.write_scannet_folders(tmp_path / "s", frames, stated, K_SMALL)
    camera = read_recording(path, None).color_camera
    assert camera == ColorCamera(585.0, 585.5, 323.5, 241.5, 0.0, 648, 484)
    np.savetxt(path / "intrinsic/intrinsic_color.txt", scans.matrix(50, 50, 20, 15))
    with pytest.raises(SequenceError, match="not near the middle of images of 648x484"):
        read_recording(path, None)


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("intrinsic/intrinsic_depth.txt", None, "has no intrinsic/intrinsic_depth.txt"),
        ("intrinsic/intrinsic_depth.txt", "1 2 3", "holds 3 numbers"),
        ("intrinsic/intrinsic_depth.txt", "a b", "intrinsic_depth.txt"),
        ("intrinsic/intrinsic_color.txt", "nan " * 16, "intrinsic_color.txt"),
    ],
)
def test_folders_without_a_camera_are_refused(tmp_path, name, text, message):
    path = scans.write_scannet_folders(tmp_path / "s", small_frames(1, 2), K_COLOR, K_SMALL)
    (path / name).unlink() if text is None else (path / name).write_text(text)
    with pytest.raises(SequenceError, match=message):
        read_recording(path, None)


# Annotation

VERTICES = np.array(
    [[x, y, 0.5 * y] for y in range(3) for x in range(4)], np.float32
)  # a slope of 4 x 3
FACES = np.array([[0, 1, 5], [0, 5, 4], [1, 2, 6], [1, 6, 5], [4, 5, 9], [4, 9, 8]])
SEGMENT = np.array([9, 9, 2, 2, 9, 9, 2, 2, 5, 5, 70, 70])
GROUPS = [(0, "office chair", [9]), (1, "couch", [2]), (4, "trash can", [5])]
NYU40 = {"office chair": 5, "couch": 6, "trash can": 39, "kitchen counter": 12, "ottoman": 5}


def write_truth(path, groups=GROUPS, **changes):
    return scans.write_scannet_truth(path, VERTICES, FACES, SEGMENT, groups, **changes)


def test_an_annotated_scan_comes_back_exactly(tmp_path):
    turn = np.diag([-1.0, -1.0, 1.0, 1.0])
    path = write_truth(tmp_path / "scene0000_00", nyu40=NYU40, axis_alignment=turn)
    found = read_scannet_truth(path)
    np.testing.assert_array_equal(found.mesh.vertices, VERTICES)
    np.testing.assert_array_equal(found.mesh.faces, FACES)
    np.testing.assert_array_equal(found.mesh.colors, np.full((12, 3), (90, 100, 110)))
    np.testing.assert_array_equal(found.instance, [1, 1, 2, 2, 1, 1, 2, 2, 5, 5, 0, 0])
    assert [(i.id, i.class_name) for i in found.instances] == [
        (1, "chair"),
        (2, "sofa"),
        (5, "bin"),
    ]
    np.testing.assert_array_equal(found.T_aligned_dataset, turn)
    assert (found.name, found.annotation) == ("scene0000_00", "ScanNet v2")
    assert found.notes == ("16.7% of the vertices are not annotated",)


def test_the_label_table_names_what_no_name_does(tmp_path):
    groups = [(0, "ottoman", [9]), (1, "gizmo", [2])]
    alone = read_scannet_truth(write_truth(tmp_path / "a/b/s", groups))
    assert [i.class_name for i in alone.instances] == [None, None]
    assert any("no scannetv2-labels.combined.tsv" in note for note in alone.notes)
    listed = read_scannet_truth(write_truth(tmp_path / "c/s", groups, nyu40=NYU40))
    assert [i.class_name for i in listed.instances] == ["chair", None]
    assert any("1 of 2 instances" in n and "'gizmo'" in n for n in listed.notes)


def test_segments_of_two_groups_and_of_none_are_said(tmp_path):
    groups = [(0, "chair", [9, 2]), (1, "couch", [2, 1234]), (2, "bin", [])]
    found = read_scannet_truth(write_truth(tmp_path / "s", groups))
    np.testing.assert_array_equal(found.instance, [1, 1, 2, 2, 1, 1, 2, 2, 0, 0, 0, 0])
    text = "\n".join(found.notes)
    assert "1 segments are in several groups" in text
    assert "names 1 segments that the mesh does not have" in text
    assert "instances without any vertex: 3" in text


def test_the_truth_of_a_scan_can_be_read(tmp_path):
    found = read_scannet_truth(write_truth(tmp_path / "s", nyu40=NYU40))
    truth_from_annotation(found, np.eye(4), tmp_path / "truth")
    scene = read_scene(tmp_path / "truth/scene.json")
    assert [e.name for e in scene.entities] == ["chair_1", "sofa_2", "bin_5"]
    # chair_1 is vertices (0, 0), (1, 0), (0, 1), (1, 1) at heights 0 and 0.5.
    np.testing.assert_allclose(scene.entities[0].box.center, [0.5, 0.5, 0.25], atol=1e-6)
    np.testing.assert_allclose(scene.entities[0].box.size, [1, 1, 0.5], atol=1e-6)
    with np.load(tmp_path / "truth/observed.npz") as data:
        assert data["instance"].tolist() == found.instance.tolist()


def _edit(path, name, change):
    file = path / f"{path.name}{name}"
    data = json.loads(file.read_text())
    change(data)
    file.write_text(json.dumps(data))


SEGS, GROUPS_FILE = "_vh_clean_2.0.010000.segs.json", ".aggregation.json"


@pytest.mark.parametrize(
    ("name", "change", "message"),
    [
        (SEGS, lambda d: d["segIndices"].pop(), "has 11 segIndices, .* has 12 vertices"),
        (SEGS, lambda d: d.pop("segIndices"), "segIndices is no list"),
        (SEGS, lambda d: d["segIndices"].append(-1), "segIndices is no list"),
        (SEGS, lambda d: d["segIndices"].append(True), "segIndices is no list"),
        (GROUPS_FILE, lambda d: d.pop("segGroups"), "segGroups entry 0"),
        (GROUPS_FILE, lambda d: d["segGroups"].append({"label": 3}), "segGroups entry 3"),
        (
            GROUPS_FILE,
            lambda d: d["segGroups"][1].update(objectId=0),
            r"objectId \[0\] stands",
        ),
        (GROUPS_FILE, lambda d: d["segGroups"][0].update(segments=["9"]), "segGroups entry 0"),
    ],
)
def test_bad_annotations_are_named(tmp_path, name, change, message):
    path = write_truth(tmp_path / "s")
    _edit(path, name, change)
    with pytest.raises(SequenceError, match=message) as caught:
        read_scannet_truth(path)
    assert f"s{name}" in caught.value.problem and caught.value.hint


@pytest.mark.parametrize("name", ["_vh_clean_2.ply", SEGS, GROUPS_FILE])
def test_missing_and_cut_files_are_named(tmp_path, name):
    path = write_truth(tmp_path / "s")
    file = path / f"s{name}"
    whole = file.read_bytes()
    for cut in (0, 1, len(whole) // 2, len(whole) - 2):
        file.write_bytes(whole[:cut])
        with pytest.raises(SequenceError, match=r"s_vh_clean_2|aggregation"):
            read_scannet_truth(path)
    file.unlink()
    with pytest.raises(SequenceError, match=name.replace(".", r"\.")):
        read_scannet_truth(path)


def test_the_high_resolution_name_of_the_groups_is_found(tmp_path):
    path = write_truth(tmp_path / "s")
    (path / "s.aggregation.json").rename(path / "s_vh_clean.aggregation.json")
    assert len(read_scannet_truth(path).instances) == 3


@pytest.mark.parametrize("text", ["axisAlignment = 1 2 3\n", "axisAlignment = " + "nan " * 16])
def test_a_bad_alignment_is_named(tmp_path, text):
    path = write_truth(tmp_path / "s")
    (path / "s.txt").write_text(text)
    with pytest.raises(SequenceError, match=r"s\.txt: axisAlignment"):
        read_scannet_truth(path)


def test_a_bad_label_table_is_named(tmp_path):
    path = write_truth(tmp_path / "s")
    (tmp_path / "scannetv2-labels.combined.tsv").write_text("id\tlabel\n1\tchair\n")
    with pytest.raises(SequenceError, match=r"scannetv2-labels\.combined\.tsv.*raw_category"):
        read_scannet_truth(path)
