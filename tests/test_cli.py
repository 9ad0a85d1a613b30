"""The command line: help that teaches, errors that are one message."""

from __future__ import annotations

import importlib.metadata
import platform
import subprocess
import sys

import pytest

from isr_jax import cli
from isr_jax.config import section_names, settings_page

from .conftest import REPOSITORY

COMMANDS = [
    "demo",
    "run",
    "map",
    "synth",
    "inspect",
    "settle",
    "eval",
    "view",
    "cad",
    "classes",
    "settings",
]


@pytest.fixture
def isr(monkeypatch, capsys):
    """The command in this process: exit status, standard output, standard error."""

    def call(*arguments: str) -> tuple[int, str, str]:
        monkeypatch.setattr(sys, "argv", ["isr", *arguments])
        status = 0
        try:
            cli.main()
        except SystemExit as stop:
            status = int(stop.code or 0)
        return (status, *capsys.readouterr())

    return call


def test_help_lists_every_command_with_an_example(isr):
    status, out, _ = isr("--help")
    assert status == 0
    for command in COMMANDS:
        assert command in out
        assert f"Example: isr {command}" in out


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("run", "/nowhere", "--out", "{out}"), "/nowhere"),
        (("run", "{out}", "--out", "{out}/o", "--preset", "best"), "default, paper, voxblox++"),
        (("map", "/nowhere", "--out", "{out}/o"), "/nowhere"),
        (("settle", "{out}/scene.xml"), "scene.xml"),
        (("eval", "{out}", "{out}"), "scene.json"),
        (("view", "{out}"), "scene.json"),
        (("cad", "list", "{out}"), "{out}"),
        (("settings", "map"), "contact_graph"),
        (("settings", "--out", "{out}"), "{out}"),
        (("inspect", "{out}"), "{out}"),
        (("synth", "--out", "{out}/o", "--kind", "attic"), "kitchen, office, living"),
        (("synth", "--out", "{out}/o", "--size", "640"), "640x480"),
        (("synth", "--out", "{out}/o", "--frames", "0"), "0 frames"),
        (("synth", "--out", "{out}/o", "--library", "/nowhere"), "/nowhere"),
    ],
)
def test_a_user_error_is_one_message_and_status_2(isr, arguments, says, tmp_path):
    status, out, err = isr(*(a.format(out=tmp_path) for a in arguments))
    assert status == 2, out + err
    message = err.replace("\n", "")
    assert says.format(out=tmp_path) in message and "->" in message


def test_the_version_names_what_runs(isr):
    status, out, _ = isr("--version")
    assert status == 0
    for name in ("isr_jax", "jax", "mujoco"):
        assert f"{name} {importlib.metadata.version(name)}" in out
    assert f"python {platform.python_version()}" in out


def test_settings_prints_one_section_or_writes_the_page(isr, tmp_path):
    status, out, _ = isr("settings", "matching")
    assert status == 0 and "weight_upright" in out and "voxel_size_m" not in out
    path = tmp_path / "docs" / "settings.md"
    assert isr("settings", "--out", str(path)) == (0, "", "")
    assert path.read_text("utf-8") == settings_page()


def test_the_help_of_settings_names_every_section(isr):
    status, out, _ = isr("settings", "--help")
    assert status == 0 and all(name in out for name in section_names())


def test_synth_leaves_a_folder_alone_that_holds_something_else(isr, tmp_path):
    (tmp_path / "letters.txt").write_text("dear")
    status, _, err = isr("synth", "--out", str(tmp_path), "--frames", "1")
    assert status == 2 and "holds something else" in " ".join(err.split())
    assert [p.name for p in tmp_path.iterdir()] == ["letters.txt"]


def test_the_help_of_synth_teaches(isr):
    status, out, _ = isr("synth", "--help")
    assert status == 0
    for option in ("--seed", "--kind", "--library", "--frames", "--size", "--drift", "--sheet"):
        assert option in out
    assert "isr eval" in " ".join(out.split()) and "truth" in out


def test_a_process_of_its_own_ends_with_the_message_and_no_traceback(tmp_path):
    command = [sys.executable, "-m", "isr_jax", "inspect", str(tmp_path)]
    ended = subprocess.run(command, cwd=REPOSITORY, capture_output=True, text=True, timeout=120)
    assert ended.returncode == 2, ended.stdout + ended.stderr
    assert ended.stderr.startswith("error:") and "Traceback" not in ended.stderr
    assert str(tmp_path) in ended.stderr.replace("\n", "")
