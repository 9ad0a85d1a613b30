"""Adding models: the good ones come in whole, the bad ones are named, nothing is done twice."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from isr_jax.cad import load_library
from isr_jax.cad.importing import AddOptions, ReadLimits, add_models, report_tables
from isr_jax.cad.importing import add as add_module
from isr_jax.cad.importing.add_report import REPORT_NAME
from isr_jax.cad.importing.isolation import Failure, run_isolated
from isr_jax.errors import ClassError, LibraryError, OutputError, SettingError
from isr_jax.runtime.render_text import render_text

from .foreign_models import BOMB, MJCF, cube_obj, cube_stl, png, urdf, write, write_zip
from .isolated_work import work


def chair(width: float = 0.5) -> str:
    """A block of a chair's size in metres, z up."""
    return cube_obj((width, 0.5, 0.9))


def bytes_of(folder: Path) -> dict[str, bytes]:
    return {
        p.relative_to(folder).as_posix(): p.read_bytes() for p in folder.rglob("*.*") if p.is_file()
    }


def mixed_folder(root: Path) -> Path:
    """Three good models between bad ones."""
    textured = cube_obj((0.5, 0.5, 0.9), head="mtllib c.mtl\nusemtl a", uv=True)
    write(
        root,
        {
            "a_empty.obj": "",
            "b_chair.obj": chair(),
            "c_chair.obj": textured,
            "c.mtl": "newmtl a\nmap_Kd t.png",
            "t.png": png(),
            "d_chair_nan.obj": chair().replace("v 0 0 0.9", "v nan 0 0.9"),
            "e_huge.stl": bytes(80) + np.uint32(50_000_000).tobytes(),
            "f_bomb.dae": f"{BOMB}<COLLADA/>",
            "g_out.obj": chair() + "mtllib ../../../etc/passwd\n",
            "h/cabinet.urdf": urdf(),
            "h/meshes/door.obj": cube_obj(),
            "i.urdf": urdf("../../etc/passwd"),
            "j.xml": MJCF.replace("front.stl", "gone.stl"),
            "k_cut.stl": cube_stl()[:-9],
        },
    )
    write_zip(root / "l.zip", {"../evil.obj": chair()})
    return root


REASONS = {
    "a_empty.obj": "is empty",
    "d_chair_nan.obj": "not finite",
    "e_huge.stl": "50000000 triangles",
    "f_bomb.dae": "document type",
    "g_out.obj": "leads out",
    "i.urdf": "leads out",
    "j.xml": "not there",
    "k_cut.stl": "cut off",
}


def test_the_rest_of_a_folder_comes_in(tmp_path: Path) -> None:
    root, library = mixed_folder(tmp_path / "mixed"), tmp_path / "library"
    seen: list[tuple[int, int]] = []
    report = add_models(root, library, workers=0, progress=lambda d, n: seen.append((d, n)))
    assert {a.source for a in report.accepted} == {
        "mixed/b_chair.obj",
        "mixed/c_chair.obj",
        "mixed/h/cabinet.urdf",
    }
    reasons = {r.source.removeprefix("mixed/"): r.reason for r in report.rejected}
    assert set(reasons) == {*REASONS, "l.zip/../evil.obj"}
    for source, reason in REASONS.items():
        assert reason in reasons[source], source
    assert all(r.hint for r in report.rejected)
    assert report.accepted_share == 3 / 12
    assert seen == [(k + 1, 12) for k in range(12)]
    loaded = load_library(library)
    assert {m.id for m in loaded.models} == {a.id for a in report.accepted}
    joints = {m.id: m.moving_joints for m in loaded.models}
    (cabinet,) = (a.id for a in report.accepted if a.source.endswith(".urdf"))
    assert joints[cabinet] == ("door_hinge",)
    (painted,) = (a.id for a in report.accepted if a.source.endswith("c_chair.obj"))
    texture = loaded.by_id(painted).robot.links[0].visuals[0].texture
    assert texture is not None and texture.content == png()
    assert not (library / ".incoming").exists()
    stored = json.loads((library / REPORT_NAME).read_text())
    assert [len(stored["accepted"]), len(stored["rejected"])] == [3, 9]
    text = "\n".join(render_text(table) for table in report_tables(report))
    assert "3 models added" in text and "9 rejected" in text and "mixed/j.xml" in text


def test_adding_again_changes_nothing_and_says_so(tmp_path: Path) -> None:
    root = write(tmp_path / "in", {"chair.obj": chair(), "x/chair.obj": chair(0.6)})
    first = add_models(root, tmp_path / "lib", workers=0)
    before = bytes_of(tmp_path / "lib")
    second = add_models(root, tmp_path / "lib", workers=0)
    assert [a.id for a in first.accepted] == [a.id for a in second.accepted]
    assert not any(a.already for a in first.accepted) and all(a.already for a in second.accepted)
    assert bytes_of(tmp_path / "lib") == before
    assert "2 of them there before" in render_text(report_tables(second)[0])


def test_the_same_files_elsewhere_give_the_same_library(tmp_path: Path) -> None:
    for place in ("one", "two"):
        root = write(tmp_path / place / "in", {"chair.obj": chair(), "x/chair.obj": chair(0.6)})
        add_models(root, tmp_path / place / "lib", workers=0)
    assert bytes_of(tmp_path / "one" / "lib") == bytes_of(tmp_path / "two" / "lib")


def test_models_of_one_name_get_names_of_their_own(tmp_path: Path) -> None:
    files = {f"{d}/Old Chair!.obj": chair(w) for d, w in (("a", 0.5), ("b", 0.6), ("c", 0.7))}
    report = add_models(write(tmp_path / "in", files), tmp_path / "lib", workers=0)
    ids = [a.id for a in report.accepted]
    assert ids[0] == "chair/old_chair" and len(set(ids)) == 3
    assert all(i.startswith("chair/old_chair_") and len(i) == 24 for i in ids[1:])
    assert any("another model is called old_chair" in n for n in report.accepted[1].notes)
    widths = {m.id: np.sort(m.size)[1] for m in load_library(tmp_path / "lib").models}
    np.testing.assert_allclose([widths[i] for i in ids], [0.5, 0.6, 0.7], atol=1e-5)


def test_what_the_caller_says_goes_over_the_files(tmp_path: Path) -> None:
    root = write(tmp_path / "in", {"thing.obj": cube_obj((50, 90, 60))})
    options = AddOptions(
        class_name="cabinet",
        up=(0.0, 1.0, 0.0),
        front=(0.0, 0.0, 5.0),
        unit_m=0.01,
        licence="CC0",
        creator="Me",
    )
    report = add_models(root, tmp_path / "lib", options=options, workers=0)
    (model,) = load_library(tmp_path / "lib").models
    assert model.id == report.accepted[0].id == "cabinet/thing"
    np.testing.assert_allclose(model.size, [0.5, 0.6, 0.9], atol=1e-5)
    assert (model.licence, model.creator, model.source) == ("CC0", "Me", "in/thing.obj")


def test_impossible_options_are_refused(tmp_path: Path) -> None:
    with pytest.raises(SettingError, match="one line"):
        AddOptions(up=(0.0, 0.0, 1.0), front=(0.0, 0.0, -2.0))
    with pytest.raises(SettingError, match="up = "):
        AddOptions(up=(0.0, 0.0, 0.0))
    with pytest.raises(SettingError, match="unit_m"):
        AddOptions(unit_m=0.0)
    with pytest.raises(ClassError):
        AddOptions(class_name="chairr")
    write(tmp_path / "in", {"a.obj": chair()})
    with pytest.raises(SettingError, match="workers = -1"):
        add_models(tmp_path / "in", tmp_path / "lib", workers=-1)
    with pytest.raises(LibraryError, match="no such file"):
        add_models(tmp_path / "none", tmp_path / "lib", workers=0)
    (tmp_path / "file").write_text("x")
    with pytest.raises(OutputError, match="file"):
        add_models(tmp_path / "in", tmp_path / "file", workers=0)


def test_a_broken_report_of_before_is_not_overwritten_in_silence(tmp_path: Path) -> None:
    root = write(tmp_path / "in", {"a.obj": chair()})
    write(tmp_path / "lib", {REPORT_NAME: "{no json"})
    with pytest.raises(OutputError, match="no report of an import"):
        add_models(root, tmp_path / "lib", workers=0)


def test_reports_of_several_calls_add_up(tmp_path: Path) -> None:
    for name, content in (("a", chair()), ("b", ""), ("b", chair(0.6))):
        add_models(write(tmp_path / name, {"chair.obj": content}), tmp_path / "lib", workers=0)
        stored = json.loads((tmp_path / "lib" / REPORT_NAME).read_text())
        if name == "b" and not content:
            assert [r["source"] for r in stored["rejected"]] == ["b/chair.obj"]
    assert [r["source"] for r in stored["accepted"]] == ["a/chair.obj", "b/chair.obj"]
    assert stored["rejected"] == []


def test_what_is_in_stays_when_the_rest_is_broken_off(tmp_path: Path, monkeypatch) -> None:
    root = write(tmp_path / "in", {f"chair_{k}.obj": chair(0.5 + 0.1 * k) for k in range(4)})
    calls = []

    def interrupted(task):
        calls.append(task)
        if len(calls) == 3:
            raise KeyboardInterrupt
        return real(task)

    real = add_module._work
    monkeypatch.setattr(add_module, "_work", interrupted)
    with pytest.raises(KeyboardInterrupt):
        add_models(root, tmp_path / "lib", workers=0)
    assert [m.id for m in load_library(tmp_path / "lib").models] == [
        "chair/chair_0",
        "chair/chair_1",
    ]
    stored = json.loads((tmp_path / "lib" / REPORT_NAME).read_text())
    assert len(stored["accepted"]) == 2
    assert not (tmp_path / "lib" / ".incoming").exists()
    monkeypatch.setattr(add_module, "_work", real)
    again = add_models(root, tmp_path / "lib", workers=0)
    assert [a.already for a in again.accepted] == [True, True, False, False]


def test_a_worker_that_dies_or_hangs_costs_its_own_task_alone() -> None:
    done = dict(run_isolated(work, ["die", "a", "hang", "b"], workers=2, time_limit_s=1.0))
    assert [done[1], done[3]] == ["A", "B"]
    assert done[0] == Failure("reading it ended its process (exit 3)")
    assert "not done after 1 s" in done[2].problem


def test_work_that_fails_costs_its_own_task_alone() -> None:
    done = dict(run_isolated(work, ["refuse", "a", "trip", "nest"], workers=0, time_limit_s=1.0))
    assert done[0] == Failure("it is bad", "make it good")
    assert done[1] == "A"
    assert "ZeroDivisionError: by zero" in done[2].problem
    assert done[3] == Failure("it nests too deep")


@pytest.mark.slow
def test_processes_of_their_own_give_the_same_library(tmp_path: Path) -> None:
    root = write(tmp_path / "in", {"chair.obj": chair(), "x/chair.obj": chair(0.6), "bad.obj": "f"})
    reports = [add_models(root, tmp_path / f"lib{n}", workers=n) for n in (0, 1)]
    assert [a.id for a in reports[0].accepted] == [a.id for a in reports[1].accepted]
    assert reports[0].rejected == reports[1].rejected
    assert bytes_of(tmp_path / "lib0") == bytes_of(tmp_path / "lib1")


def test_limits_reach_the_readers(tmp_path: Path) -> None:
    root = write(tmp_path / "in", {"chair.obj": chair()})
    options = AddOptions(limits=ReadLimits(max_faces=5))
    (rejected,) = add_models(root, tmp_path / "lib", options=options, workers=0).rejected
    assert "6 triangles, above 5" in rejected.reason
