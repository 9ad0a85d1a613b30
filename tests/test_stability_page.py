"""docs/stability.md: its code runs, and its table names what the report prints."""

from __future__ import annotations

import re
from pathlib import Path

import mujoco
import pytest

from isr_jax import settle
from isr_jax.borders import simulation
from isr_jax.export import export_scene
from isr_jax.stability import StabilityReport

from .conftest import REPOSITORY
from .physics_scenes import furnished_scene

PAGE = (REPOSITORY / "docs" / "stability.md").read_text("utf-8")
CODE = re.findall(r"```python\n(.*?)```", PAGE, re.S)


@pytest.fixture
def here(tmp_path, monkeypatch):
    """A folder with an exported scene in it, and another below."""
    for folder in (tmp_path, tmp_path / "other"):
        export_scene(*furnished_scene().arguments, folder)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_the_code_of_the_page_runs(here, capsys):
    """Block by block, as one script."""
    names: dict = {}
    for block in CODE:
        exec(block, names)
    printed = capsys.readouterr().out
    assert "table_3 cup_4" in printed  # who touches whom
    assert re.search(r"cabinet_6_hinge .* (99|100) %", printed)
    assert [Path(r.scene).parent.name for r in names["reports"]] == ["other", ""]
    (one, two) = names["reports"]
    assert one.exported == two.exported == settle("scene.xml").exported


def test_a_urdf_is_what_the_page_says(tmp_path):
    """Ours floats on its root; a plain one is fused into the world, its fixed links too."""
    link = '<link name="{0}"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" '
    link += 'ixz="0" iyz="0"/></inertial><collision><geometry><box size=".1 .1 .1"/></geometry>'
    link += "</collision></link>"
    fixed = '<joint name="j" type="fixed"><parent link="a"/><child link="b"/></joint>'
    keep = '<mujoco><compiler fusestatic="false"/></mujoco>'
    bodies = {}
    for name, extra in (("plain", ""), ("kept", keep)):
        path = tmp_path / f"{name}.urdf"
        body = link.format("a") + link.format("b") + fixed
        path.write_text(f'<robot name="r">{extra}{body}</robot>')
        bodies[name] = simulation.static_bodies(simulation.load_model(path))
        assert settle(path).exported.bodies == ()
    assert bodies == {"plain": (), "kept": ("a",)}
    model = simulation.load_model(tmp_path / "kept.urdf")
    assert mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_BODY, 2) == "b"


def test_our_urdf_is_judged_too(here):
    (path,) = here.glob("scene_description/urdf/*.urdf")
    report = settle(path)
    assert {b.name for b in report.exported.bodies} >= {"cup_4", "chair_5"}


def test_the_table_names_every_row_of_the_report(here):
    report: StabilityReport = settle("scene.xml")
    rows = re.findall(r"^\| ([^|]+?) \|", PAGE, re.M)
    for name in (
        "penetration",
        "contacts",
        "drift",
        "turn",
        "within",
        "path",
        "left the room",
        "joint drift",
        "solver warnings",
        "PhyRecon",
        "MolmoSpaces",
        "survived resets",
        "entities without a body",
        "mean alignment error",
    ):
        assert any(name in row for row in rows) and name in str(report), name
