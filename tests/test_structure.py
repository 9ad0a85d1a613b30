"""The structure that the design promises: stages do not know each other, kernels know no files."""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

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
COMPOSERS = {"pipeline", "scene", "map_runs", "demonstration", "cli", "__init__", "__main__"}
"""The only modules that may import stages."""


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


def stage_violations(source: str, module: str) -> list[str]:
    """Imports of a stage that a module has no right to."""
    room = module.split(".")[1] if "." in module else "__init__"
    if room in COMPOSERS:
        return []
    imported = {
        m.split(".")[1] for m in imported_modules(source, module) if m.startswith("isr_jax.")
    }
    return sorted((imported & STAGES) - {room})


def package_modules() -> list[tuple[str, Path]]:
    modules = []
    for path in sorted(PACKAGE.rglob("*.py")):
        parts = path.relative_to(REPOSITORY).with_suffix("").parts
        modules.append((".".join(parts), path))
    return modules


def test_stages_do_not_import_each_other():
    broken = {
        name: violations
        for name, path in package_modules()
        if (violations := stage_violations(path.read_text("utf-8"), name))
    }
    assert not broken, f"stages are passed what they need, they import no other stage: {broken}"


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
    assert stage_violations(line, "isr_jax.alignment.kernels")


def test_lower_layer_and_own_modules_are_allowed():
    fine = "from ..geometry import rot_z\nfrom .kernels import solve\nfrom isr_jax.types import Box"
    assert not stage_violations(fine, "isr_jax.alignment.solve")
    assert not stage_violations("from .matching import match", "isr_jax.pipeline")
    assert stage_violations("from .matching import match", "isr_jax.geometry")


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
