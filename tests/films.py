"""A tiny film of a furnished room, made once a session, and the run on it that tests share."""

from __future__ import annotations

import functools
from pathlib import Path

import pytest

from isr_jax import pipeline, synthetic
from isr_jax.cad import default_library
from isr_jax.config import Settings, preset, with_overrides

from .builders import box_entity, floor_entity, scene_of

FRAMES, WIDTH, HEIGHT = 24, 160, 120
COARSE = (
    "mapping.voxel_size_m=0.04",
    "mapping.checkpoint_every=5",
    "segmentation.min_segment_px=40",
    "segmentation.min_piece_px=10",
    "matching.shortlist=2",
    "alignment.max_points=256",
    "physical_check.max_nudge_m=0.0",
    "stability.duration_s=0.5",
    "stability.perturbed_resets=0",
)
"""Settings at which the whole way takes seconds on images this small."""


def coarse(*overrides: str) -> Settings:
    return with_overrides(preset("default"), [*COARSE, *overrides])


class Recorder:
    """A reporter that remembers; it may kill the run after so many frames, as Ctrl-C does."""

    def __init__(self, die_after: int | None = None):
        self.reused: dict[str, bool] = {}
        self.notes: list[str] = []
        self.frames: list[int] = []
        self._die_after = die_after

    def stage(self, name, reused):
        self.reused[name] = reused

    def progress(self, name, done, total):
        if name == "mapping":
            self.frames.append(done)
            if done == self._die_after:
                raise KeyboardInterrupt

    def note(self, text):
        self.notes.append(text)


def run(sequence: Path, out: Path, *overrides: str, **options) -> pipeline.RunResult:
    """`pipeline.run` with true masks and coarse settings."""
    options = {"segmenter": "simulated:perfect", "settings": coarse(*overrides)} | options
    return pipeline.run(sequence, out, **options)


# Cached by the session's folder: a fixture imported by two modules would be made twice.
@functools.cache
def _film(base: Path) -> Path:
    folder = base / "film"
    room = synthetic.builtin_room(default_library())
    synthetic.render_sequence(room, folder, frames=FRAMES, width=WIDTH, height=HEIGHT)
    return folder


@functools.cache
def _finished(base: Path) -> pipeline.RunResult:
    return run(_film(base), base / "finished")


@pytest.fixture(scope="session")
def film(tmp_path_factory) -> Path:
    """A sequence with its masks and its truth; copy it before changing it."""
    return _film(tmp_path_factory.getbasetemp())


@pytest.fixture(scope="session")
def finished(tmp_path_factory) -> pipeline.RunResult:
    """The whole way through on the film; copy its folder before changing it."""
    return _finished(tmp_path_factory.getbasetemp())


@functools.cache
def _saved_table(base: Path) -> Path:
    table = box_entity(2, "table", (0, 0, 0.37), (1.2, 0.8, 0.74), 0.2)
    cup = box_entity(3, "cup", (0.1, 0.1, 0.79), (0.08, 0.08, 0.1))
    pipeline.replace_with_cad(scene_of(floor_entity(), table, cup)).save(base / "out" / "kitchen")
    return base


@pytest.fixture(scope="session")
def saved_table(tmp_path_factory) -> Path:
    """A folder with a small scene, a cup on a table, saved at ``out/kitchen``."""
    return _saved_table(tmp_path_factory.getbasetemp())
