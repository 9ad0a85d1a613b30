"""The command line: help that teaches, errors that are one message."""

from __future__ import annotations

import subprocess
import sys

import pytest

from .conftest import REPOSITORY

COMMANDS = ["demo", "run", "inspect", "settle", "eval", "view", "cad"]


def isr(*arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "isr_jax.cli", *arguments],
        cwd=REPOSITORY,
        capture_output=True,
        text=True,
        timeout=120,
    )


def test_help_lists_every_command_with_an_example():
    result = isr("--help")
    assert result.returncode == 0
    for command in COMMANDS:
        assert command in result.stdout
        assert f"Example: isr {command}" in result.stdout


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("run", "/nowhere", "--out", "{out}"), "/nowhere"),
        (("run", "{out}", "--out", "{out}/o", "--preset", "best"), "default, paper, voxblox++"),
        (("settle", "{out}/scene.xml"), "scene.xml"),
        (("eval", "{out}", "{out}"), "scene.json"),
        (("view", "{out}"), "scene.json"),
        (("cad", "list", "{out}"), "{out}"),
        (("inspect", "{out}"), "{out}"),
    ],
)
def test_a_user_error_is_one_message_and_status_2(arguments, says, tmp_path):
    result = isr(*(a.format(out=tmp_path) for a in arguments))
    message = result.stderr.replace("\n", "")
    assert result.returncode == 2, result.stdout + result.stderr
    assert "Traceback" not in result.stderr
    assert says.format(out=tmp_path) in message and "->" in message
