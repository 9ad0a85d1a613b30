"""One word for one thing: names that were retired do not come back."""

from __future__ import annotations

import re

import pytest

from .conftest import REPOSITORY

RETIRED = {
    r"fuse_usable|\bfusing\.|class Fusion\b|fusion_step": "integrate a frame; Integrator",
    r"\.refuse\(|def refuse\(": "reintegrate(poses); to reject input is to raise",
    r"\b(freshen|relabel)\b": "renumber",
    r"\bvoxel_corners\b|\bvoxel_places\b": "block_corners_in_camera, voxel_centers_in_camera",
    r"\b(LabelFusion|FusionScale|Renaming)\b": "MapLabels, MapScale, Renumbering",
    r"\bwide_jit\b": "jit_wide_vectors",
    r"\bworking_ahead\b|\bmap_ahead\b": "prefetch",
    r"\bplain_text\b": "render_text",
    r"\bone_thing\b|\baskers\b": "nouns: mergeable_pair, queries",
    r"\btypes\.Sequence\b": "RgbdSequence",
    r"\bsettle_down\b|settle_labels": "settle is MuJoCo's; rest_on_supports, renumber",
    r"pipeline\.furnish\b|isr\.furnish\b": "replace_with_cad, furnish_scenes",
    r"\bisr\.fit\b|cad import fit\b": "fit_cad",
    r"\bcad_types\b|\bcad_arrays\b|\bstage_runner import STAGES as\b": "library",
    r"isr_jax\.(live|fusing|map_making|map_files|demonstration\.demonstration)\b": "map_runs, ...",
    r"\bmodel_columns\b|\bis_mjcf\b|\bsolid_depth\b": "dead, and gone",
    r"# fmt: skip": "write what ruff formats well",
}
"""What was called so, and what it is called now."""
KEPT = {
    "tests/test_names.py",
    "isr_jax/pipeline.py",  # the old name of replace_with_cad, for one release
    "isr_jax/__init__.py",
    "tests/test_scene.py",
    "CHANGELOG.md",  # says what was renamed
}
SUFFIXES = {".py", ".md", ".toml", ".ipynb", ".sh"}
PLACES = ("isr_jax", "tests", "experiments", "benchmarks", "examples", "docs", "notebooks")


def texts():
    for place in PLACES:
        for path in sorted((REPOSITORY / place).rglob("*")):
            if path.suffix in SUFFIXES and path.is_file():
                yield str(path.relative_to(REPOSITORY)), path.read_text("utf-8")
    for name in ("README.md", "CONTRIBUTING.md", "pyproject.toml"):
        yield name, (REPOSITORY / name).read_text("utf-8")


@pytest.mark.parametrize("retired", RETIRED)
def test_a_retired_name_is_nowhere(retired):
    found = [
        f"{name}:{text[: match.start()].count(chr(10)) + 1}: {match[0]}"
        for name, text in texts()
        if name not in KEPT
        for match in re.finditer(retired, text)
    ]
    assert not found, f"rather {RETIRED[retired]}: {found[:20]}"
