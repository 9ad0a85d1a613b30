"""Table I, end to end: a small room in SceneNN's formats, mapped with true masks and scored."""

from __future__ import annotations

import csv
import dataclasses
import json

import cv2
import numpy as np
import pytest
from rich.table import Table
from scipy.spatial import KDTree

from experiments.published import MEAN, POOLED, read_published
from experiments.table1.__main__ import CSV, Table1, main, run_table1, sequence_folders
from experiments.table1.printing import table
from experiments.table1.rows import ALL, RELEASED_WAY, THEIRS, ExactScores, exact_rows, source_name
from isr_jax.errors import SequenceError
from isr_jax.evaluation import BoxRow, BoxScores, ClassQuality, InstanceScores, PanopticScores
from isr_jax.runtime.render_text import render_text

from . import datasets_room as room
from . import scan_formats as scans

K = scans.matrix(room.FOCAL, room.FOCAL, room.WIDTH / 2, room.HEIGHT / 2)
CLASSES = {1: "floor", 2: "wall", 3: "ceiling", 4: "table"}
COARSE = (
    "mapping.voxel_size_m=0.04",
    "segmentation.min_segment_px=40",
    "segmentation.min_piece_px=10",
)


def points_of(shot) -> np.ndarray:
    """[height, width, 3]: what each pixel shows, world frame."""
    v, u = np.mgrid[: room.HEIGHT, : room.WIDTH]
    rays = [(u - room.WIDTH / 2) / room.FOCAL, (v - room.HEIGHT / 2) / room.FOCAL, np.ones(u.shape)]
    local = np.stack(rays, -1) * shot.depth_m[..., None]
    return local @ shot.T_world_camera[:3, :3].T + shot.T_world_camera[:3, 3]


def labels_of(shot) -> np.ndarray:
    """The class of what each pixel shows."""
    x, y, z = np.moveaxis(points_of(shot), -1, 0)
    on_table = (np.abs(x) < 0.605) & (np.abs(y) < 0.405) & (np.abs(z - room.TABLE_HEIGHT_M) < 5e-3)
    flat = [np.abs(z) < 5e-3, np.abs(z - room.ROOM_M[2]) < 5e-3, on_table]
    return np.select(flat, [1, 3, 4], 2)


def patch(corner, side_a, side_b, step=0.04):
    """A meshed rectangle."""
    a, b = np.asarray(side_a, float), np.asarray(side_b, float)
    m, n = (round(np.linalg.norm(s) / step) + 1 for s in (a, b))
    u, v = np.meshgrid(np.linspace(0, 1, m), np.linspace(0, 1, n), indexing="ij")
    k = np.arange(m * n).reshape(m, n)
    first = np.stack([k[:-1, :-1], k[1:, :-1], k[1:, 1:]], -1).reshape(-1, 3)
    second = np.stack([k[:-1, :-1], k[1:, 1:], k[:-1, 1:]], -1).reshape(-1, 3)
    points = np.asarray(corner, float) + u[..., None] * a + v[..., None] * b
    return points.reshape(-1, 3), np.concatenate([first, second])


def write_room(folder):
    """Images, poses, masks and annotation of the room; its four walls are one label each."""
    shots = room.shots(8)
    scans.write_scenenn(folder, scans.scan_frames(shots, scans.SCENENN_WORLD), K)
    (folder / "panoptic").mkdir()
    annotations = []
    for i, shot in enumerate(shots, 1):
        ids = labels_of(shot).astype(np.uint8)
        image = np.stack([ids * 0, ids * 0, ids], -1)
        cv2.imwrite(str(folder / f"panoptic/{i:05d}.png"), image)
        segments = [{"id": int(k), "category_id": int(k)} for k in np.unique(ids)]
        annotations.append({"file_name": f"{i:05d}.png", "segments_info": segments})
    categories = [{"id": k, "name": name} for k, name in CLASSES.items()]
    content = {"annotations": annotations, "categories": categories}
    (folder / "panoptic.json").write_text(json.dumps(content))
    x, y, z = room.ROOM_M / 2 * [1, 1, 2]
    parts = [
        ("floor", patch([-x, -y, 0], [2 * x, 0, 0], [0, 2 * y, 0])),
        ("wall", patch([-x, -y, 0], [2 * x, 0, 0], [0, 0, z])),
        ("wall", patch([-x, y, 0], [2 * x, 0, 0], [0, 0, z])),
        ("wall", patch([-x, -y, 0], [0, 2 * y, 0], [0, 0, z])),
        ("wall", patch([x, -y, 0], [0, 2 * y, 0], [0, 0, z])),
        ("ceiling", patch([-x, -y, z], [2 * x, 0, 0], [0, 2 * y, 0])),
        ("dining table", patch([-0.6, -0.4, 0.7], [1.2, 0, 0], [0, 0.8, 0])),
    ]
    vertices, faces, part = scans.merged([p for _, p in parts])
    # SceneNN's meshes, too, end where the camera saw nothing.
    seen, _ = KDTree(np.concatenate([points_of(s).reshape(-1, 3) for s in shots])).query(vertices)
    faces = faces[(seen[faces] < 0.06).all(1)]
    used, faces = np.unique(faces, return_inverse=True)
    vertices, part, faces = vertices[used], part[used], faces.reshape(-1, 3)
    T = scans.SCENENN_WORLD
    names = [scans.ScanLabel(i, text) for i, (text, _) in enumerate(parts, 1)]
    moved = vertices @ T[:3, :3].T + T[:3, 3]
    scans.write_scenenn_truth(folder, moved, faces, part, names)
    return folder


@pytest.fixture(scope="module")
def done(tmp_path_factory):
    """The command's work on one good sequence and one without annotation."""
    base = tmp_path_factory.mktemp("scenenn")
    write_room(base / "061")
    scans.write_scenenn(base / "086", scans.scan_frames(room.shots(3), scans.SCENENN_WORLD), K)
    options = Table1(base, preset=("default",), out=base / "out", set=COARSE, min_vertices=200)
    return options, *run_table1(options)


def mean_of(figures, counting, metric, scope="panoptic", sequence="061") -> float:
    (found,) = [
        f.percent
        for f in figures
        if f.source == source_name("default", counting) and f.class_name == MEAN
        if (f.metric, f.scope, f.sequence) == (metric, scope, sequence)
    ]
    return found


def test_true_masks_give_a_good_map_in_the_exact_counting(done):
    _, figures, _ = done
    # Floor, walls and table are all matched: RQ is 1; SQ is what 4 cm voxels leave.
    assert mean_of(figures, ALL, "RQ") == pytest.approx(100)
    assert mean_of(figures, ALL, "SQ") > 75
    assert mean_of(figures, ALL, "mAP", "instance") == pytest.approx(100)


def test_the_paper_s_classes_leave_the_others_out():
    # Over chair, ceiling and desk PQ is (0.9 + 0.3 + 0) / 3; the paper has no ceiling.
    rows = [
        ClassQuality("chair", "thing", 0.9, 0.9, 1.0, 1, 0, 0),
        ClassQuality("ceiling", "stuff", 0.3, 0.6, 0.5, 1, 1, 1),
        ClassQuality("desk", "thing", 0.0, 0.0, 0.0, 0, 1, 0),
    ]
    boxes = BoxScores.over(
        (BoxRow("chair", 1, 1, 0.5, 0.5, 0.5, 0.5), BoxRow("cup", 1, 1, *[1.0] * 4))
    )
    scores = ExactScores(PanopticScores.over(tuple(rows)), InstanceScores.over(()), boxes, boxes)
    figures = exact_rows("default", "061", "", scores)
    assert mean_of(figures, ALL, "PQ") == pytest.approx(40)
    assert mean_of(figures, THEIRS, "PQ") == pytest.approx(45)
    assert mean_of(figures, ALL, "mAP", "box") == pytest.approx(75)
    assert mean_of(figures, THEIRS, "mAP_re", "box") == pytest.approx(50)


def test_the_released_counting_has_its_traps(done):
    _, figures, _ = done
    by_class = {
        f.class_name: f.percent
        for f in figures
        if f.source == source_name("default", RELEASED_WAY)
        and (f.metric, f.sequence) == ("PQ", "061")
    }
    assert set(by_class) == {MEAN, "floor", "wall", "table"}
    assert by_class["wall"] == 0.0, "of four walls only the first one's vertices count"
    assert by_class["floor"] > 80 and by_class["table"] > 60
    kept = [by_class[name] for name in ("floor", "wall", "table")]
    assert by_class[MEAN] == pytest.approx(np.mean(kept))
    assert mean_of(figures, RELEASED_WAY, "mAP", "instance") == pytest.approx(100)
    pooled = mean_of(figures, RELEASED_WAY, "PQ", sequence=POOLED)
    assert pooled == pytest.approx(by_class[MEAN]), "one sequence is all"


def test_a_sequence_that_fails_is_a_row_with_its_problem(done):
    options, _, failures = done
    assert [f.sequence for f in failures] == ["086"]
    assert "086" in failures[0].problem and "SequenceError" in failures[0].problem
    with (options.out / CSV).open(newline="") as file:
        rows = list(csv.DictReader(file))
    lost = [row for row in rows if row["problem"]]
    assert len(lost) == 1 and lost[0]["sequence"] == "086" and lost[0]["percent"] == ""
    assert sum(row["source"] == "paper" for row in rows) == 40


def test_the_table_prints_ours_beside_theirs(done):
    _, figures, _ = done
    text = render_text(table(figures, [source_name("default", ALL)], ["061", "086"]))
    for part in ("isr_jax", "paper", "voxblox++", "released", "43.0", "27.3"):
        assert part in text
    assert isinstance(table(figures), Table)


def test_a_second_call_reuses_the_map(done):
    options, figures, _ = done

    class Remembers:
        reused: dict[str, bool] = {}  # noqa: RUF012

        def stage(self, name, reused):
            self.reused[name] = reused

        def progress(self, name, done, total): ...

        def note(self, text): ...

    again, _ = run_table1(dataclasses.replace(options, sequences=("061",)), Remembers())
    assert Remembers.reused == {"default, sequence 061": False, "mapping": True}
    assert sorted(again) == sorted(figures)


def test_without_data_the_published_figures_are_printed_alone(tmp_path, capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "150")
    with pytest.raises(SystemExit) as ended:
        main(["--out", str(tmp_path)])
    assert ended.value.code == 0
    text = " ".join(capsys.readouterr().out.split())
    for part in ("mean of the paper's 8", "37.3", "22.6", "33.1", "27.4", "--scenenn DIR"):
        assert part in text
    assert len((tmp_path / CSV).read_text().splitlines()) == 1 + len(read_published())


def test_the_command_says_what_failed(tmp_path, capsys):
    scans.write_scenenn(tmp_path / "086", scans.scan_frames(room.shots(1), scans.SCENENN_WORLD), K)
    command = ["--scenenn", str(tmp_path), "--preset", "paper", "--out", str(tmp_path / "out")]
    with pytest.raises(SystemExit) as ended:
        main(command)
    assert ended.value.code == 1
    assert "annotation of the same name" in " ".join(capsys.readouterr().out.split())
    with pytest.raises(SystemExit) as ended:
        main(["--scenenn", str(tmp_path / "nowhere")])
    assert ended.value.code == 2
    assert "is no folder" in capsys.readouterr().err


def test_means_say_how_many_sequences_they_are_of():
    figures = [f for f in read_published() if f.sequence in ("061", "223", "005")]
    lines = render_text(table(figures, sequences=["005", "061", "223"])).splitlines()
    start = next(i for i, line in enumerate(lines) if "mean of these 3" in line)
    # The paper has two of the three: (43.0 + 49.5) / 2.
    assert "46.2 (2)" in lines[start] or "46.3 (2)" in lines[start]


@pytest.mark.parametrize(
    ("wanted", "says"),
    [((), "holds no SceneNN sequence"), (("061",), "holds no SceneNN sequence")],
)
def test_a_folder_without_sequences_says_how_to_get_them(tmp_path, wanted, says):
    with pytest.raises(SequenceError, match=says) as error:
        sequence_folders(tmp_path, wanted)
    assert "playback tool" in error.value.hint
    with pytest.raises(SequenceError, match="is no folder"):
        sequence_folders(tmp_path / "nowhere", wanted)


def test_sequences_that_are_not_there_are_named(tmp_path):
    for name in ("061", "086"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "trajectory.log").write_text("")
    assert list(sequence_folders(tmp_path, ())) == ["061", "086"]
    assert list(sequence_folders(tmp_path, ("086",))) == ["086"]
    assert list(sequence_folders(tmp_path / "061", ())) == ["061"]
    with pytest.raises(SequenceError, match="223") as error:
        sequence_folders(tmp_path, ("061", "223"))
    assert "061, 086" in error.value.hint
