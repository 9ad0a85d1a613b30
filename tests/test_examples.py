"""Every example runs and answers its question."""

from __future__ import annotations

import importlib.util

import pytest

from isr_jax.cad import build_library

from .conftest import REPOSITORY
from .films import COARSE, film, finished, saved_table  # noqa: F401 (fixtures)

EXAMPLES = REPOSITORY / "examples"


def run(name: str, *arguments: str) -> None:
    spec = importlib.util.spec_from_file_location(f"example_{name}", EXAMPLES / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    module.main(list(arguments))


def test_the_list_of_examples_is_whole():
    listed = (EXAMPLES / "README.md").read_text("utf-8")
    names = sorted(path.name for path in EXAMPLES.glob("*.py"))
    assert len(names) == 6 and all(f"({name})" in listed for name in names)


def test_reconstruct_folder(film, tmp_path, capsys):  # noqa: F811
    few = [*COARSE, "input.stride=3"]
    run(
        "reconstruct_folder",
        str(film),
        str(tmp_path / "scene"),
        "--segmenter",
        "simulated:perfect",
        "--set",
        *few,
    )
    assert (tmp_path / "scene" / "scene.xml").is_file()
    said = capsys.readouterr().out
    assert "floor" in said and "drift" in said


def test_live_camera(film, capsys):  # noqa: F811
    options = ("--segmenter", "simulated:perfect", "--every", "12", "--set", *COARSE)
    run("live_camera", str(film), *options)
    said = capsys.readouterr().out
    assert "after 12 frames" in said and "after 24 frames" in said and "floor" in said


def test_own_cad_folder(finished, tmp_path, capsys):  # noqa: F811
    names = [p.cad_id for p in finished.scene.placements if p.cad_id is not None][:2]
    build_library(tmp_path / "mine", ids=names)
    run("own_cad_folder", str(finished.out_dir), str(tmp_path / "mine"), str(tmp_path / "out"))
    assert (tmp_path / "out" / "scene.json").is_file()
    assert "->" in capsys.readouterr().out


def test_gradients_of_alignment(saved_table, capsys):  # noqa: F811
    run("gradients_of_alignment", str(saved_table / "out" / "kitchen"))
    said = capsys.readouterr().out
    assert "d cost / d footprint" in said and "mean AE" in said and "nan" not in said


def test_batch_of_scenes(saved_table, capsys):  # noqa: F811
    folder = str(saved_table / "out" / "kitchen")
    run("batch_of_scenes", folder, folder, "--weights", "1.0")
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) == 2 and lines[0] == lines[1] and "models placed" in lines[0]


@pytest.mark.parametrize("kind", ["scene.xml", "scene_description/urdf/scene.urdf"])
def test_judge_any_mjcf(finished, kind, capsys):  # noqa: F811
    run("judge_any_mjcf", str(finished.out_dir / kind), "--seconds", "0.3")
    assert "moved more than 5 cm" in capsys.readouterr().out
