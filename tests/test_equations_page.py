"""docs/equations.md: each equation has a function that cites it, and settings that exist."""

from __future__ import annotations

import pkgutil
import re

import pytest

from isr_jax.config import Settings, preset, with_overrides

from .conftest import REPOSITORY

PAGE = (REPOSITORY / "docs" / "equations.md").read_text("utf-8")
ROWS = {
    int(cells[0]): cells
    for line in PAGE.splitlines()
    if re.match(r"\| \d", line)
    for cells in [[cell.strip() for cell in line.strip("|").split("|")]]
}
SET_BACK = {n: re.findall(r"`([\w.]+=[\w.]+)`", cells[4]) for n, cells in ROWS.items()}


def test_every_equation_of_the_paper_has_a_row():
    assert list(ROWS) == list(range(1, 12))
    assert all(len(cells) == 6 and cells[1] and cells[3] for cells in ROWS.values())


@pytest.mark.parametrize("number", range(1, 12))
def test_the_function_cites_its_equation(number):
    (path,) = re.findall(r"`([\w.]+)`", ROWS[number][2])
    function = pkgutil.resolve_name(path)
    assert callable(function)
    assert re.search(rf"\bEq\. {number}\b", function.__doc__), f"{path} does not cite it"


@pytest.mark.parametrize("number", range(1, 12))
def test_the_test_of_an_equation_exists(number):
    (path, name) = ROWS[number][5].strip("`").split("::")
    assert f"\ndef {name}(" in (REPOSITORY / path).read_text("utf-8")


def test_other_functions_of_the_page_exist():
    for path in re.findall(r"`(isr_jax\.[\w.]+)`", PAGE):
        assert pkgutil.resolve_name(path).__doc__


@pytest.mark.parametrize("number", range(1, 12))
def test_what_is_set_back_exists_and_is_a_departure(number):
    assert bool(SET_BACK[number]) == (ROWS[number][3] != "none")
    for override in SET_BACK[number]:
        assert with_overrides(Settings(), [override]) != Settings(), f"{override} is the default"


def test_what_the_preset_of_the_paper_changes_is_on_the_page():
    named = {override.split("=")[0] for overrides in SET_BACK.values() for override in overrides}
    for section in ("matching", "alignment"):
        ours, theirs = vars(getattr(Settings(), section)), vars(getattr(preset("paper"), section))
        changed = {f"{section}.{name}" for name in ours if ours[name] != theirs[name]}
        assert changed - {"alignment.max_steps"} <= named
