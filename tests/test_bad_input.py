"""Bad input through the whole way: refused before the first frame, or skipped, counted and said."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
import pytest

from isr_jax import pipeline
from isr_jax.cad import build_library
from isr_jax.errors import (
    IsrError,
    LibraryError,
    OutputError,
    SegmenterError,
    SequenceError,
    SettingError,
)
from isr_jax.scene_file import read_scene

from .films import FRAMES, Recorder, film, finished, run  # noqa: F401 (fixtures)

SHIPPED = "yolox_nano_coco80"


@pytest.fixture(autouse=True)
def undrawn(monkeypatch):
    """No pictures, which take longer than all the rest."""
    monkeypatch.setattr(pipeline, "_draw", lambda scene, out_dir: None)


@pytest.fixture
def sequence(film, tmp_path) -> Path:  # noqa: F811
    """A copy of the film, to be damaged."""
    return shutil.copytree(film, tmp_path / "sequence")


def refused(sequence: Path, out: Path, kind: type[IsrError], **options) -> str:
    """The message of a run that must stop before it integrates anything."""
    recorder = Recorder()
    with pytest.raises(kind) as caught:
        run(sequence, out, reporter=recorder, **options)
    assert not recorder.frames, "it went on to integrate frames"
    assert caught.value.hint, "the message shows no way out"
    return str(caught.value)


def edit_json(path: Path, change: Callable[[dict], object]) -> None:
    content = json.loads(path.read_text())
    change(content)
    path.write_text(json.dumps(content))


def cut(path: Path) -> None:
    content = path.read_bytes()
    path.write_bytes(content[: int(0.6 * len(content))])


def rewrite_poses(sequence: Path, change: Callable[[np.ndarray], np.ndarray]) -> None:
    for path in (sequence / "poses").iterdir():
        np.savetxt(path, change(np.loadtxt(path)))


def no_pose_is_finite(sequence: Path) -> None:
    rewrite_poses(sequence, lambda T: T * np.nan)


def poses_are_no_rotations(sequence: Path) -> None:
    rewrite_poses(sequence, lambda T: np.diag([2.0, 2.0, 2.0, 1.0]) @ T)


def cameras_on_another_continent(sequence: Path) -> None:
    def moved(T: np.ndarray) -> np.ndarray:
        T[0, 3] += 4e6
        return T

    rewrite_poses(sequence, moved)


def no_frames(sequence: Path) -> None:
    for folder in ("rgb", "depth", "poses"):
        shutil.rmtree(sequence / folder)
        (sequence / folder).mkdir()


def depth_said_to_be_in_metres(sequence: Path) -> None:
    edit_json(sequence / "intrinsics.json", lambda c: c.update(depth_scale=1.0))


def intrinsics_of_another_size(sequence: Path) -> None:
    edit_json(sequence / "intrinsics.json", lambda c: c.update(width=640, height=480))


def no_intrinsics(sequence: Path) -> None:
    (sequence / "intrinsics.json").unlink()


def colour_of_another_shape(sequence: Path) -> None:
    for path in (sequence / "rgb").iterdir():
        cv2.imwrite(str(path), cv2.imread(str(path))[:60])


def every_image_cut(sequence: Path) -> None:
    for path in (sequence / "depth").iterdir():
        cut(path)


@pytest.mark.parametrize(
    ("damage", "says"),
    [
        (no_frames, "no frames"),
        (no_pose_is_finite, "NaN or infinity"),
        (poses_are_no_rotations, "no rotation"),
        (cameras_on_another_continent, "beyond 500 m from the origin"),
        (depth_said_to_be_in_metres, "set depth_scale to 1000"),
        (intrinsics_of_another_size, "they say 640x480"),
        (no_intrinsics, "intrinsics.json"),
        (colour_of_another_shape, "cannot be of one view"),
        (every_image_cut, "is cut off"),
        (shutil.rmtree, "No such file"),
    ],
)
def test_a_sequence_that_is_bad_throughout_is_refused(sequence, tmp_path, damage, says):
    damage(sequence)
    message = refused(sequence, tmp_path / "out", SequenceError)
    assert says in message and str(sequence) in message
    assert "stopped: " in (tmp_path / "out" / "run.log").read_text()


def unknown_class(sequence: Path) -> None:
    def rename(content):
        content["categories"][3]["name"] = "chaise longue"

    edit_json(sequence / "panoptic.json", rename)


def annotations_without_files(sequence: Path) -> None:
    edit_json(sequence / "panoptic.json", lambda c: c["annotations"][2].pop("file_name"))


def annotations_without_segments(sequence: Path) -> None:
    edit_json(sequence / "panoptic.json", lambda c: c["annotations"][2].pop("segments_info"))


def no_annotation_of_any_frame(sequence: Path) -> None:
    edit_json(sequence / "panoptic.json", lambda c: c.update(annotations=[]))


def masks_of_another_size(sequence: Path) -> None:
    for path in (sequence / "panoptic").iterdir():
        cv2.imwrite(str(path), cv2.imread(str(path))[::2, ::2])


def no_masks(sequence: Path) -> None:
    (sequence / "panoptic.json").unlink()


@pytest.mark.parametrize(
    ("damage", "says"),
    [
        (unknown_class, "chaise longue"),
        (annotations_without_files, "annotations[2] has no file_name"),
        (annotations_without_segments, "annotations[2] has no segments_info"),
        (no_annotation_of_any_frame, "no annotation for frame '000000'"),
        (masks_of_another_size, "80x60, the depth image 160x120"),
        (no_masks, "panoptic.json does not exist"),
    ],
)
def test_masks_that_fit_no_frame_are_refused(sequence, tmp_path, damage, says):
    damage(sequence)
    message = refused(sequence, tmp_path / "out", SegmenterError)
    assert says in message and "panoptic" in message


def text_as_model(folder: Path) -> str:
    path = folder / f"{SHIPPED}.onnx"
    path.write_text("no model")
    return str(path)


def model_without_sidecar(folder: Path) -> str:
    path = folder / "mine.onnx"
    path.write_bytes(b"")
    return str(path)


@pytest.mark.parametrize(
    ("spec", "says"),
    [
        (text_as_model, "is not a model that ONNX Runtime can load"),
        (model_without_sidecar, "mine.onnx has no sidecar"),
        (lambda folder: str(folder / "absent.onnx"), "absent.onnx does not exist"),
        (lambda folder: "magic", "unknown segmenter 'magic'"),
        (lambda folder: "simulated:best", "perfect, strong, medium, weak"),
    ],
)
def test_a_segmenter_that_cannot_be_opened_is_refused(film, tmp_path, spec, says):  # noqa: F811
    options = {"segmenter": spec(tmp_path)}
    assert says in refused(film, tmp_path / "out", SegmenterError, **options)


def test_a_library_that_cannot_be_used_is_refused(film, tmp_path):  # noqa: F811
    (tmp_path / "empty").mkdir()
    build_library(tmp_path / "cut", ids=["bin/square_30"])
    model = tmp_path / "cut" / "bin" / "square_30" / "model.urdf"
    cut(model)
    for library, says in (("absent", "no CAD library"), ("empty", "no models"), ("cut", "model.")):
        options = {"library": tmp_path / library}
        message = refused(film, tmp_path / "out", LibraryError, **options)
        assert says in message and str(tmp_path / library) in message


@pytest.mark.parametrize("out", ["file", "file/below", "/proc/isr"])
def test_an_output_folder_that_cannot_be_written_is_refused(film, tmp_path, out):  # noqa: F811
    (tmp_path / "file").write_text("")
    message = refused(film, tmp_path / out, OutputError)
    assert str(tmp_path / out) in message and "--out" in message


def test_an_unknown_stage_is_refused(film, tmp_path):  # noqa: F811
    message = refused(film, tmp_path / "out", SettingError, start_from="fusing")
    assert "physical_check" in message


def test_some_bad_frames_are_skipped_counted_and_said(sequence, tmp_path):
    (sequence / "depth" / "000002.png").unlink()
    cut(sequence / "depth" / "000005.png")
    cut(sequence / "rgb" / "000008.jpg")
    np.savetxt(sequence / "poses" / "000011.txt", np.full((4, 4), np.nan))
    cut(sequence / "panoptic" / "000014.png")
    (sequence / "poses" / "000017.txt").unlink()
    (sequence / "poses" / "000017.txt").mkdir()
    (sequence / "depth" / "000020.png").unlink()
    (sequence / "depth" / "000020.png").symlink_to(tmp_path / "gone.png")
    words = ["000002 has no depth", "depth/000005.png is cut off", "rgb/000008.jpg is cut off"]
    words += ["000011.txt: the pose holds NaN", "panoptic/000014.png", "poses/000017.txt"]
    words += ["depth/000020.png"]
    lost = np.loadtxt(sequence / "poses" / "000022.txt")
    lost[:3, 3] += 1e4  # it would move the floor, and the world with it
    np.savetxt(sequence / "poses" / "000022.txt", lost)
    words += ["000022: the camera is at"]
    recorder = Recorder()
    result = run(sequence, tmp_path / "out", reporter=recorder)
    metrics = read_scene(tmp_path / "out" / "scene.json").metrics
    assert metrics["frames_used"] == FRAMES - len(words)
    assert len(metrics["frames_skipped"]) == len(words)
    for word, problem in zip(words, metrics["frames_skipped"], strict=True):
        assert word in problem
        assert any(word in note for note in recorder.notes)
        assert f"frame skipped: {problem}" in (tmp_path / "out" / "run.log").read_text()
    assert any(p.cad_id is not None for p in result.scene.placements)


def test_too_many_bad_frames_stop_the_run_and_what_was_fused_is_kept(sequence, tmp_path):
    out = tmp_path / "out"
    for i in range(7, 12):
        cut(sequence / "depth" / f"{i:06d}.png")
    recorder = Recorder()
    with pytest.raises(SequenceError, match=r"5 of 24 frames cannot be read.*000011\.png") as stop:
        run(sequence, out, "input.max_bad_fraction=0.2", reporter=recorder)
    assert "isr inspect" in stop.value.hint and recorder.frames[-1] == 11
    assert json.loads((out / "stages" / "mapping.checkpoint.json").read_text())["done"] == 10


def test_a_damaged_stored_result_is_named_and_can_be_computed_anew(
    film,  # noqa: F811
    finished,  # noqa: F811
    tmp_path,
):
    out = shutil.copytree(finished.out_dir, tmp_path / "out")
    cut(out / "stages" / "entities.npz")
    with pytest.raises(OutputError, match=r"(?s)entities\.npz is damaged.*--from"):
        run(film, out)
    run(film, out, start_from="entities")
    assert (out / "scene.json").read_bytes() == (finished.out_dir / "scene.json").read_bytes()


def test_masks_without_any_thing_leave_the_room_alone(sequence, tmp_path):
    def empty(content):
        for annotation in content["annotations"]:
            for segment in annotation["segments_info"]:
                segment["iscrowd"] = 1

    edit_json(sequence / "panoptic.json", empty)
    result = run(sequence, tmp_path / "out", "input.max_frames=8")
    assert all(e.type == "layout" for e in result.scene_file.entities)
    assert result.stability.exported.bodies == ()
