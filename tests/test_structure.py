"""The structure that the design promises: stages do not know each other, kernels know no files."""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

import networkx
import pytest

from .conftest import REPOSITORY

PACKAGE = REPOSITORY / "isr_jax"
STAGES = {
    "datasets",
    "segmentation",
    "mapping",
    "entities",
    "contact_graph",
    "cad",
    "matching",
    "alignment",
    "physical_check",
    "export",
    "stability",
    "evaluation",
    "synthetic",
    "viewer",
}
LAYERS = (
    {"errors", "types"},
    {"config", "classes", "geometry", "robot_model"},
    {"library", "borders", "runtime"},
    {"scene_file"},
    STAGES,
    {"scene", "map_runs"},
    {"pipeline"},
    {"demonstration"},
    {"cli"},
    {"__init__", "__main__"},
)
"""The rooms of the package from the ground up: a room imports only what lies below it, or beside it
where it is no stage."""
HEIGHT = {room: height for height, layer in enumerate(LAYERS) for room in layer}
COMPOSERS = set().union(*LAYERS[LAYERS.index(STAGES) + 1 :])
"""The only rooms that may import stages."""
MOST_ROOT_MODULES = 10


def imported_modules(source: str, module: str) -> set[str]:
    """Absolute names of what a module of the package imports, anywhere in its body."""
    found, parts = set(), module.split(".")
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            base = parts[: len(parts) - node.level] if node.level else []
            stem = ".".join([*base, *([node.module] if node.module else [])])
            found |= {stem} | {f"{stem}.{alias.name}" for alias in node.names}
    return found


def room_of(module: str) -> str:
    return module.split(".")[1] if "." in module else "__init__"


def rooms_above(source: str, module: str) -> list[str]:
    """Rooms that a module imports and has no right to."""
    room = room_of(module)
    imported = {
        room_of(name)
        for name in imported_modules(source, module)
        if name.startswith("isr_jax.") and room_of(name) in HEIGHT
    } - {room}
    beside = set() if room in STAGES else LAYERS[HEIGHT[room]]
    return sorted(r for r in imported if HEIGHT[r] >= HEIGHT[room] and r not in beside)


def package_modules() -> list[tuple[str, Path]]:
    modules = []
    for path in sorted(PACKAGE.rglob("*.py")):
        parts = path.relative_to(REPOSITORY).with_suffix("").parts
        modules.append((".".join(parts), path))
    return modules


def home_of(name: str, modules: set[str]) -> str:
    """The module that defines a dotted name; a package is its ``__init__``."""
    while name:
        for module in (name, f"{name}.__init__"):
            if module in modules:
                return module
        name = name.rpartition(".")[0]
    return ""


def test_the_rooms_are_those_of_the_plan():
    found = {path.stem for path in PACKAGE.glob("*.py")}
    assert len(found) <= MOST_ROOT_MODULES, f"the root is no heap: {sorted(found)}"
    found |= {path.parent.name for path in PACKAGE.glob("*/__init__.py")}
    assert found == set(HEIGHT)


def test_nothing_imports_back_up():
    broken = {
        name: above
        for name, path in package_modules()
        if (above := rooms_above(path.read_text("utf-8"), name))
    }
    assert not broken, f"a room imports what lies below it alone: {broken}"


def test_no_module_imports_itself_by_way_of_others():
    modules = dict(package_modules())
    known = set(modules)
    arrows = networkx.DiGraph()
    for name, path in modules.items():
        for other in imported_modules(path.read_text("utf-8"), name):
            home = home_of(other, known) if other.startswith("isr_jax.") else ""
            if home and home != name and not home.endswith("__init__"):
                arrows.add_edge(name, home)
    circles = [sorted(c) for c in networkx.strongly_connected_components(arrows) if len(c) > 1]
    assert not circles


@pytest.mark.parametrize(
    "line",
    [
        "from ..matching import match",
        "from isr_jax.matching import match",
        "import isr_jax.matching.kernels",
        "from .. import matching",
        "def late():\n    from ..cad.library import load_library",
    ],
)
def test_a_stage_that_imports_a_stage_is_caught(line):
    assert rooms_above(line, "isr_jax.alignment.kernels")


def test_lower_rooms_and_own_modules_are_allowed():
    fine = "from ..geometry import rot_z\nfrom .kernels import solve\nfrom isr_jax.types import Box"
    assert not rooms_above(fine, "isr_jax.alignment.solve")
    assert not rooms_above("from .matching import match", "isr_jax.pipeline")
    assert rooms_above("from ..matching import match", "isr_jax.geometry.boxes")
    assert rooms_above("from ..runtime import stage", "isr_jax.geometry.boxes")


def test_every_stage_has_a_version_and_public_names():
    for stage in STAGES:
        tree = ast.parse((PACKAGE / stage / "__init__.py").read_text("utf-8"))
        assigned = {
            target.id
            for node in tree.body
            if isinstance(node, ast.Assign | ast.AnnAssign)
            for target in (node.targets if isinstance(node, ast.Assign) else [node.target])
            if isinstance(target, ast.Name)
        }
        assert {"VERSION", "__all__"} <= assigned, f"isr_jax/{stage}/__init__.py"


@pytest.mark.parametrize("library", ["trimesh", "mujoco", "cv2", "fcl", "onnxruntime", "embreex"])
def test_the_border_rule_catches_a_border_library_in_a_kernel(library):
    """Ruff's TID251, as configured, on a kernel module that breaks it."""
    run = subprocess.run(
        [
            sys.executable,
            "-m",
            "ruff",
            "check",
            "--select",
            "TID251",
            "--stdin-filename",
            "isr_jax/geometry/boxes.py",
            "-",
        ],
        input=f"import {library}\n",
        cwd=REPOSITORY,
        capture_output=True,
        text=True,
    )
    assert run.returncode == 1 and "TID251" in run.stdout, run.stdout + run.stderr


def test_the_border_rule_holds_in_the_package():
    run = subprocess.run(
        [sys.executable, "-m", "ruff", "check", "--select", "TID251", "isr_jax"],
        cwd=REPOSITORY,
        capture_output=True,
        text=True,
    )
    assert run.returncode == 0, run.stdout
