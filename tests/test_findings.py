"""findings/: every script is listed, stands alone, pins what it runs, and says what it shows."""

from __future__ import annotations

import os
import re

import pytest

from .conftest import REPOSITORY

FOLDER = REPOSITORY / "findings"
SCRIPTS = sorted(FOLDER.glob("*.sh"))
PAGE = (FOLDER / "README.md").read_text("utf-8")


def test_the_page_lists_the_scripts():
    listed = re.findall(r"^\| \[([\w.]+)\]\(([\w.]+)\) \|", PAGE, re.M)
    assert listed and all(name == target for name, target in listed)
    assert sorted(name for name, _ in listed) == [path.name for path in SCRIPTS]


@pytest.mark.parametrize("path", SCRIPTS, ids=lambda path: path.stem)
def test_a_script_stands_alone(path):
    text = path.read_text("utf-8")
    head = text[: text.index("set -eu")]
    assert os.access(path, os.X_OK) and text.startswith("#!/bin/sh\n")
    assert all(f"# {word}:" in head for word in ("Guess", "Truth", "Why it matters"))
    (installed,) = re.findall(r"pip install --quiet (.*)", text)
    assert all(re.fullmatch(r"[\w-]+==[\d.]+", package) for package in installed.split())
    assert "isr_jax" not in text and 'sys.exit("otherwise: ' in text


def test_paths_on_the_page_exist():
    named = re.findall(r"`((?:isr_jax|findings)/[\w/.]+)`", PAGE)
    assert named and all((REPOSITORY / path).is_file() for path in named)
