"""``isr cad``: build, add, check, list, show, sheet; help that teaches; docs that are true."""

from __future__ import annotations

import dataclasses
import json
import re
import sys

import pytest
from PIL import Image

from isr_jax import cli
from isr_jax.cad import save_model
from isr_jax.cad.kit.catalogue import KIT
from isr_jax.cad.pictures.groups import grouped
from isr_jax.cli.cad import OPEN_SHARE

from .builders import table_model
from .conftest import REPOSITORY
from .opening_models import door_model, drawer_model

ACTIONS = ("build", "add", "check", "list", "show", "sheet")
DOC = (REPOSITORY / "docs" / "cad_library.md").read_text("utf-8")


@pytest.fixture
def isr(monkeypatch, capsys):
    """The command in this process: exit status, standard output, standard error."""

    def call(*arguments: object) -> tuple[int, str, str]:
        monkeypatch.setattr(sys, "argv", ["isr", *map(str, arguments)])
        monkeypatch.setenv("COLUMNS", "160")
        status = 0
        try:
            cli.main()
        except SystemExit as stop:
            status = stop.code or 0
        return (status, *capsys.readouterr())

    return call


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A library of three sound models."""
    root = tmp_path_factory.mktemp("library")
    for model in (
        table_model(),
        door_model(),
        dataclasses.replace(drawer_model(), id="cabinet/drawer", notes=("front guessed",)),
    ):
        save_model(model, root)
    return root


@pytest.mark.parametrize("action", ACTIONS)
def test_help_of_every_action_has_an_example_of_itself(isr, action):
    status, out, _ = isr("cad", action, "--help")
    assert status == 0 and f"Example: isr cad {action}" in out
    assert action in isr("cad", "--help")[1]


def test_a_list_has_a_row_a_model(isr, folder):
    status, out, _ = isr("cad", "list", folder)
    assert status == 0 and "3 models" in out
    rows = {
        line.split("│")[1].strip(): line
        for line in out.splitlines()
        if "cm" not in line and "│" in line
    }
    assert {"cabinet/test", "cabinet/drawer", "table/test"} <= set(rows)
    for part in ("50 x 40 x 60", "floor", "2, 1 carry"):
        assert part in rows["cabinet/test"]
    assert "licence: MIT" in out
    only = isr("cad", "list", folder, "--class", "table")[1]
    assert "table/test" in only and "cabinet" not in only
    counted = isr("cad", "list", folder, "--count")[1]
    assert re.search(r"cabinet\s*│\s*2\s*│\s*2", counted)


def test_a_model_is_told_whole_and_drawn(isr, folder, tmp_path):
    status, out, _ = isr(
        "cad", "show", "cabinet/drawer", "--library", folder, "--out", tmp_path / "d.png"
    )
    assert status == 0
    for part in (
        "drawer_joint",
        "drawer on base",
        "0..300 mm",
        "front guessed",
        "drawer at 0, -177",
    ):
        assert part in out, part
    with Image.open(tmp_path / "d.png") as image:
        assert image.size[0] > 1.5 * image.size[1]  # closed and open


def test_a_sheet_is_written_for_a_class_or_for_each_group(isr, folder, tmp_path):
    status, out, _ = isr(
        "cad", "sheet", folder, "--out", tmp_path / "all.png", "--columns", 2, "--open"
    )
    assert status == 0 and "3 models" in out
    isr("cad", "sheet", folder, "--out", tmp_path / "one.png", "--class", "table")
    with Image.open(tmp_path / "all.png") as whole, Image.open(tmp_path / "one.png") as one:
        assert whole.size == (2 * one.size[0], 2 * one.size[1])
    status, *_ = isr("cad", "sheet", folder, "--all", "--out", tmp_path / "images")
    assert status == 0
    assert {p.name for p in (tmp_path / "images").iterdir()} == {
        "cad_cabinets.png",
        "cad_tables.png",
    }


def test_a_sound_library_passes_and_a_broken_one_gives_status_1(isr, folder, tmp_path):
    status, out, _ = isr(
        "cad", "check", folder, "--workers", 1, "--json", tmp_path / "r" / "c.json"
    )
    assert status == 0 and "3 models: all sound" in out
    assert json.loads((tmp_path / "r" / "c.json").read_text())["passed"] is True
    save_model(dataclasses.replace(door_model(), id="cabinet/bare", handles=()), tmp_path)
    status, out, _ = isr("cad", "check", tmp_path, "--workers", 1)
    assert status == 1
    assert "no handle is named" in out and "1 of 1 models failed" in out


def test_models_come_in_and_are_listed(isr, tmp_path):
    (tmp_path / "in").mkdir()
    (tmp_path / "in" / "side_table.obj").write_text(
        "".join(f"v {x} {y} {z}\n" for z in (0, 500) for y in (0, 400) for x in (0, 600))
        + "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n"
    )
    library = tmp_path / "library"
    frame = ("--unit-m", "0.001", "--up", 0, 0, 1)
    rest = ("--class", "table", "--licence", "CC0-1.0", "--workers", 0)
    status, out, _ = isr("cad", "add", tmp_path / "in", "--library", library, *frame, *rest)
    assert status == 0 and "1 models added" in out
    listed = isr("cad", "list", library)[1]
    assert "60 x 40 x 50" in listed and "CC0-1.0" in listed


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("list", "{out}"), "{out}"),
        (("list", "{lib}", "--class", "sofa"), "cabinet, table"),
        (("show", "cabinet/tset", "--library", "{lib}"), "cabinet/test"),
        (("sheet", "{lib}", "--columns", "0"), "0 columns"),
        (("check", "{out}"), "{out}"),
        (("check", "{lib}", "--model", "bed/x"), "bed/x"),
        (("add", "{out}/none", "--library", "{out}/lib"), "none"),
        (("build", "--out", "{lib}/table/test/model.json"), "model.json"),
    ],
)
def test_a_user_error_is_one_message_and_status_2(isr, arguments, says, folder, tmp_path):
    status, out, err = isr("cad", *(a.format(out=tmp_path, lib=folder) for a in arguments))
    assert status == 2, out + err
    message = err.replace("\n", "")
    assert says.format(out=tmp_path) in message and "->" in message


def test_building_says_how_many_in_how_many_classes(isr, tmp_path, monkeypatch):
    monkeypatch.setattr("isr_jax.cad.library.KIT", {k: KIT[k] for k in sorted(KIT)[:2]})
    status, out, _ = isr("cad", "build", "--out", tmp_path / "kit")
    assert status == 0
    said = re.search(r"2 models in 1 classes, ([\d.]+) MB", out)
    size = sum(p.stat().st_size for p in (tmp_path / "kit").rglob("*") if p.is_file())
    assert said and float(said.group(1)) == pytest.approx(size / 1e6, abs=0.05)


# docs/cad_library.md

CODE = "\n".join(re.findall(r"```\w*\n(.*?)```", DOC, re.DOTALL)).replace("\\\n", " ")
COMMANDS = sorted(set(re.findall(r"^isr (cad \w+.*?)(?:\s{2,}#.*)?$", CODE, re.MULTILINE)))


def test_every_command_of_the_doc_exists_with_its_options(isr):
    assert {command.split()[1] for command in COMMANDS} == set(ACTIONS)
    for command in COMMANDS:
        _, action, *rest = command.split()
        help_text = isr("cad", action, "--help")[1]
        for option in (part for part in rest if part.startswith("--")):
            assert re.search(rf"(?<![\w-]){option}(?![\w-])", help_text), command


def test_the_doc_shows_a_sheet_of_every_group():
    shown = re.findall(r"\]\((images/[\w.]+)\)", DOC)
    classes = dict.fromkeys(cad_id.split("/")[0] for cad_id in KIT)
    groups = grouped([dataclasses.replace(table_model(), class_name=name) for name in classes])
    assert set(shown) == {f"images/cad_{group}.png" for group in groups}
    assert "isr cad sheet --all --out docs/images" in CODE and 0 < OPEN_SHARE < 1
    for name in shown:
        path = REPOSITORY / "docs" / name
        assert path.stat().st_size < 600_000, name
        with Image.open(path) as image:
            assert image.format == "PNG"


def test_the_doc_counts_the_models_of_every_class():
    stated = dict(re.findall(r"^\| (\w+) \| (\d+) \|", DOC, re.MULTILINE))
    true: dict[str, int] = {}
    for cad_id in KIT:
        true[cad_id.split("/")[0]] = true.get(cad_id.split("/")[0], 0) + 1
    rows = "\n".join(f"| {name} | {count} |" for name, count in sorted(true.items()))
    assert {name: int(count) for name, count in stated.items()} == true, f"write:\n{rows}"
    assert f"{len(KIT)} models in {len(true)} classes" in " ".join(DOC.split())


def test_every_path_and_link_of_the_doc_exists():
    linked = re.findall(r"\]\((?!http)([^)#]+)\)", DOC)
    assert linked
    for path in linked:
        assert (REPOSITORY / "docs" / path).exists(), path
