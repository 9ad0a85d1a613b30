"""docs/gradients.md: its code runs, block by block, on a scene of one table with a cup on it."""

from __future__ import annotations

import dataclasses
import re

import jax
import numpy as np
import pytest

import isr_jax as isr
from isr_jax.errors import SceneError
from isr_jax.types import AlignmentStatus

from .conftest import REPOSITORY
from .films import saved_table  # noqa: F401 (a fixture)

PAGE = (REPOSITORY / "docs" / "gradients.md").read_text("utf-8")
CODE = re.findall(r"```python\n(.*?)```", PAGE, re.S)


def test_the_code_of_the_page_runs(saved_table, monkeypatch, capsys):  # noqa: F811
    """Block by block, as one script; what it finds agrees with itself."""
    monkeypatch.chdir(saved_table)
    names: dict = {}
    for block in CODE:
        exec(block, names)
    problem, solution = names["problem"], names["solution"]
    count = len(names["scene"].shortlist.entity)
    assert problem.valid.sum() == count > 5
    usable = [AlignmentStatus(int(status)).usable for status in solution.status[:count]]
    assert all(usable)
    assert float(names["costs"][1]) == pytest.approx(float(solution.cost.sum()), rel=1e-3)
    assert names["by_input"].valid is None and names["by_input"].plane_supporting is None
    for tree in (names["by_weight"], names["by_input"], names["by_box"], names["slope"]):
        assert all(np.all(np.isfinite(leaf)) for leaf in jax.tree.leaves(tree))
    for leaf in jax.tree.leaves((names["scale_by_weight"], names["by_input"])):
        assert np.all(np.asarray(leaf)[count:] == 0)
    # A higher box wants a larger model.
    assert names["by_box"].size[:count, 2].sum() > 0
    assert f"mean AE {1000 * names['error_m']:.1f} mm" in capsys.readouterr().out
    aligned = names["scene"].aligned
    still = aligned.status != AlignmentStatus.SLID
    np.testing.assert_allclose(aligned.cost[still], solution.cost[:count][still], rtol=1e-4)
    mean = float(isr.alignment_error(solution, names["surfaces"]).sum()) / count
    assert float(names["error_m"]) == pytest.approx(mean, rel=1e-4)


def test_every_status_is_in_the_table():
    for status in AlignmentStatus:
        assert f"\n| {status.label} |" in PAGE


def test_a_scene_without_candidates_is_refused(saved_table):  # noqa: F811
    scene = isr.load_scene(saved_table / "out" / "kitchen")
    for door in (isr.alignment_problem, isr.alignment_surfaces):
        with pytest.raises(SceneError, match="1 of 1 scenes hold no candidates"):
            door(dataclasses.replace(scene, shortlist=None, aligned=None))
