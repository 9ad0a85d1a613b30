"""The benchmark commands run on a tiny setup and print their tables; no clock is judged."""

from __future__ import annotations

from contextlib import nullcontext

import pytest

from benchmarks import mapping as command
from benchmarks.figures import Figure
from benchmarks.filmed import read_film
from isr_jax.errors import SettingError

from .films import film  # noqa: F401 (a fixture)

FRAMES = 3
TINY = {"voxels_m": (0.1,), "frames": FRAMES, "variants": ()}


@pytest.fixture
def alone(film, monkeypatch, tmp_path):  # noqa: F811
    """The tests' film, no peer, no kitchen, lines wide enough for a table."""
    monkeypatch.setattr(command, "filmed_room", lambda *_: nullcontext(read_film(film, FRAMES)))
    for module in ("mapping", "map_surface"):
        monkeypatch.setattr(f"benchmarks.{module}.is_installed", lambda *_: False)
    monkeypatch.setenv("ISR_SHARED_DATA", str(tmp_path))
    monkeypatch.setenv("COLUMNS", "120")


def test_mapping_prints_its_tables_without_the_peer(alone, capsys):
    command.mapping(**TINY, surface=True, long=8)
    told = capsys.readouterr().out
    assert "Open3D is not installed" in told and "pip install" in told
    for title in ("mapping, 10 cm", "surface, 10 cm", "live loop, 2 cm", "growth, 5 cm"):
        assert title in told
    figures = ("labels add", "bytes per voxel", "bound of that bandwidth", "late / early")
    for figure in (*figures, "depth segmentation", "whole loop / one thread"):
        assert figure in told
    assert "Open3D / ours" not in told and "YOLOX" not in told


def test_an_unknown_variant_is_refused(alone):
    with pytest.raises(SettingError, match="carving"):
        command.mapping(**TINY | {"variants": ("mapping.carving=false",), "live": False})


@pytest.mark.parametrize(
    ("better", "value", "kept"),
    [("higher", 2.0, True), ("higher", 1.9, False), ("lower", 2.1, False)],
)
def test_a_figure_says_whether_its_bound_is_kept(better, value, kept):
    assert Figure("x", value, "ms", better, 2.0).kept is kept
    assert Figure("x", value, "ms", better).kept is None
