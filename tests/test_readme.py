"""What the README tells a newcomer to type exists."""

from __future__ import annotations

import functools
import re
import subprocess
import sys

import pytest

import isr_jax as isr

from .conftest import REPOSITORY
from .films import finished  # noqa: F401 (a fixture)

README = (REPOSITORY / "README.md").read_text("utf-8")
CODE = "\n".join(re.findall(r"```\w*\n(.*?)```", README, re.DOTALL))
INLINE = re.findall(r"`([^`\n]+)`", re.sub(r"```.*?```", "", README, flags=re.DOTALL))
SNIPPETS = [*CODE.replace("\\\n", " ").splitlines(), *INLINE]
COMMANDS = sorted(
    {
        match.group(1, 2)
        for snippet in SNIPPETS
        if (
            match := re.search(r"(?:^|/)isr (\w+)((?: (?!#).*)?)$", snippet.split("  #")[0].strip())
        )
    }
)
"""(subcommand, the rest of its line) of every command line in the text."""


@functools.cache
def help_of(*command: str) -> str:
    result = subprocess.run(
        [sys.executable, "-m", "isr_jax", *command, "--help"],
        cwd=REPOSITORY,
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert result.returncode == 0, result.stderr
    return result.stdout


def test_the_readme_is_read_right():
    known = {"demo", "run", "inspect", "map", "view", "cad", "synth", "eval"}
    assert known >= {c for c, _ in COMMANDS} >= {"run", "view"}


@pytest.mark.parametrize("command", sorted({command for command, _ in COMMANDS}))
def test_every_command_and_its_options_exist(command):
    for name, rest in COMMANDS:
        if name != command:
            continue
        text = help_of(command, rest.split()[0]) if command == "cad" else help_of(command)
        for option in re.findall(r"--[\w-]+", rest):
            assert re.search(rf"(?<![\w-]){option}(?![\w-])", text), f"isr {name} {option}"


def test_options_named_in_the_text_exist():
    options = {o for snippet in INLINE for o in re.findall(r"(?<![\w-])--[\w-]+", snippet)}
    known = help_of("run") + help_of("demo")
    assert options and all(re.search(rf"{o}(?![\w-])", known) for o in options)


def test_every_python_name_resolves():
    names = set(re.findall(r"\bisr\.(\w+)\(", README))
    assert len(names) >= 4
    for name in names:
        assert callable(getattr(isr, name)), name
    assert names <= set(isr.__all__)


def test_every_make_target_exists():
    makefile = (REPOSITORY / "Makefile").read_text("utf-8")
    targets = set(re.findall(r"\bmake (\w+)", README))
    assert targets
    for target in targets:
        assert re.search(rf"^{target}:", makefile, re.MULTILINE), target


def test_every_extra_exists():
    project = (REPOSITORY / "pyproject.toml").read_text("utf-8")
    extras = set(re.findall(r"\.\[(\w+)\]", README))
    assert extras
    for extra in extras:
        assert re.search(rf"^{extra} = \[", project, re.MULTILINE), extra


def test_every_path_in_the_repository_exists():
    linked = re.findall(r"\]\((?!http)([^)#]+)\)", README)
    named = [s for s in INLINE if re.fullmatch(r"(?:cad_db|notebooks|isr_jax|tests)/[\w./]*", s)]
    assert named
    for path in (*linked, *named):
        assert (REPOSITORY / path).exists(), path


def test_every_output_that_is_promised_is_written(finished):  # noqa: F811
    table = README[README.index("## What comes out") : README.index("## CAD models")]
    cells = re.findall(r"^\| (`.*?) \|", table, re.MULTILINE)
    promised = [name for cell in cells for name in re.findall(r"`([^`]+)`", cell)]
    assert len(promised) >= 8
    for name in promised:
        assert (finished.out_dir / name).exists(), name
