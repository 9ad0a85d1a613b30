"""`inspect_sequence`: what a sequence is, which conventions hold, and what is wrong with it."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from rich.console import Group
from rich.table import Table

from ..config import InputSettings
from ..errors import FrameError, IsrError
from ..runtime.render_text import render_text
from ..types import Camera
from .checks import (
    Samples,
    check_convention_holds,
    check_depth_unit,
    read_samples,
    recorded_camera,
    sampled_cloud,
)
from .conventions import PoseConvention
from .images import check_complete
from .layouts import read_recording
from .recording import Recording, SequenceFormat, present
from .reprojection import convention_errors_m, holding
from .sequence import color_notes
from .world_frame import (
    Cloud,
    WorldFrame,
    degrees_between,
    estimate_gravity,
    find_world_frame,
)

_GRAVITY_DOUBT_DEG = 5.0
"""Given and estimated gravity differ by 1-2 degrees in good recordings."""
_LISTED = 10
"""Unusable frames that are printed one by one."""


@dataclasses.dataclass(frozen=True)
class ConventionScore:
    """How well depth reprojects between frames under one reading of the poses."""

    convention: PoseConvention
    error_mm: float
    """Median over pairs; infinite where the moved points miss the other image."""
    declared: bool
    holds: bool


@dataclasses.dataclass(frozen=True, eq=False)
class InspectReport:
    """What `inspect_sequence` found."""

    path: Path
    format: SequenceFormat
    frames: int
    incomplete: tuple[str, ...]
    """One line per frame that cannot be used: a missing file, a bad pose."""
    camera: Camera | None
    intrinsics_source: str
    units_per_metre: float
    depth_range_m: tuple[float, float, float]
    """1st percentile, median, 99th percentile of the sampled depth."""
    valid_depth_share: float
    gravity: np.ndarray | None
    """Unit, down, dataset frame: the one in use."""
    gravity_given: bool
    gravity_angle_deg: float | None
    """Between the given and the estimated one; None where one of them is missing."""
    levels: tuple[tuple[float, float], ...]
    """(height above the floor, area in m^2) of level surfaces; the first is the floor."""
    floor_height_dataset_m: float | None
    """Height of the floor along -gravity in the dataset's frame."""
    conventions: tuple[ConventionScore, ...]
    notes: tuple[str, ...]
    problems: tuple[str, ...]
    """What is wrong, each with its way out. Empty: the sequence can be opened as it is."""

    def table(self) -> Group:
        """All of it for a terminal; print it with a rich console."""
        lines = [f"[red]wrong:[/red] {problem}" for problem in self.problems]
        lines += [f"unusable: {line}" for line in self.incomplete[:_LISTED]]
        if len(self.incomplete) > _LISTED:
            lines.append(f"unusable: and {len(self.incomplete) - _LISTED} more")
        lines += [f"note: {note}" for note in self.notes]
        if not self.problems and not self.incomplete:
            lines.append("[green]nothing is wrong with it[/green]")
        return Group(self._facts(), self._conventions(), *lines)

    def __str__(self) -> str:
        return render_text(self.table())

    def _facts(self) -> Table:
        table = Table(title=f"{self.path} ({self.format})", show_header=False)
        for name, value in self._rows():
            table.add_row(name, value)
        return table

    def _rows(self) -> Iterator[tuple[str, str]]:
        c, (low, median, high) = self.camera, self.depth_range_m
        bad = f", {len(self.incomplete)} cannot be used" if self.incomplete else ""
        yield "frames", f"{self.frames}{bad}"
        if c is not None:
            yield "resolution", f"{c.width}x{c.height}"
            text = f"fx {c.fx:g}, fy {c.fy:g}, cx {c.cx:g}, cy {c.cy:g}"
            yield "intrinsics", f"{text} ({self.intrinsics_source})"
        yield "depth unit", f"{self.units_per_metre:g} units per metre"
        yield "depth", f"{low:.2f} to {high:.2f} m (1-99 %), median {median:.2f} m"
        yield "valid depth", f"{self.valid_depth_share:.0%} of the pixels"
        if self.gravity is not None:
            vector = ", ".join(f"{v:.4f}" for v in self.gravity)
            yield "gravity", f"({vector}) {'given' if self.gravity_given else 'estimated'}"
        if self.gravity_angle_deg is not None:
            yield "", f"{self.gravity_angle_deg:.2f} degrees from the estimated one"
        if self.floor_height_dataset_m is not None:
            yield "floor", f"{self.floor_height_dataset_m:.3f} m along up in the dataset's frame"
            above = ", ".join(f"{h:.2f} m ({a:.1f} m2)" for h, a in self.levels)
            yield "level surfaces", above

    def _conventions(self) -> Table:
        table = Table("pose convention", "reprojection (median)", "")
        for score in self.conventions:
            error = f"{score.error_mm:.1f} mm" if np.isfinite(score.error_mm) else "no overlap"
            words = ["declared"] * score.declared + ["[green]holds[/green]"] * score.holds
            table.add_row(score.convention, error, ", ".join(words))
        return table


def inspect_sequence(
    path: str | Path, settings: InputSettings | None = None, *, format: str | None = None
) -> InspectReport:
    """Look a sequence over without running anything on it.

    Raises:
        SequenceError: there is nothing to look at; everything else that is wrong comes in
            `InspectReport.problems`.
    """
    settings = settings or InputSettings()
    recording = read_recording(Path(path), format)
    samples = read_samples(recording)
    problems: list[str] = []
    camera = _noting(problems, recorded_camera, recording, samples)
    _noting(problems, check_depth_unit, recording, samples)
    scores: tuple[ConventionScore, ...] = ()
    world = estimated = None
    if camera is not None:
        scores = _convention_scores(recording, samples, camera)
        unconfirmed = _noting(problems, check_convention_holds, recording, samples, camera)
        problems += unconfirmed or ()
        cloud = sampled_cloud(samples, camera, settings)
        world = _noting(problems, find_world_frame, cloud, recording.gravity)
        estimated = _estimated_or_none(cloud)
    angle = _angle_deg(recording.gravity, estimated)
    if angle is not None and angle > _GRAVITY_DOUBT_DEG:
        problems.append(
            f"the given gravity is {angle:.1f} degrees from what the surfaces say; "
            "give it in the frame of the poses, or leave it out"
        )
    notes = None if camera is None else _noting(problems, color_notes, recording, camera)
    return _report(recording, samples, camera, world, angle, scores, problems, notes or ())


def _report(
    recording: Recording,
    samples: Samples,
    camera: Camera | None,
    world: WorldFrame | None,
    angle: float | None,
    scores: tuple[ConventionScore, ...],
    problems: list[str],
    color_note: tuple[str, ...],
) -> InspectReport:
    values = np.concatenate([d[::4, ::4].ravel() for d in samples.depth_m])
    returns = values[values > 0]
    low, median, high = np.percentile(returns, (1, 50, 99)) if len(returns) else (0.0, 0.0, 0.0)
    return InspectReport(
        path=recording.path,
        format=recording.format,
        frames=len(recording.frames),
        incomplete=tuple(_incomplete(recording)),
        camera=camera,
        intrinsics_source=recording.intrinsics.source,
        units_per_metre=recording.units_per_metre,
        depth_range_m=(float(low), float(median), float(high)),
        valid_depth_share=float(np.mean(values > 0)),
        gravity=None if world is None else world.gravity,
        gravity_given=recording.gravity is not None,
        gravity_angle_deg=angle,
        levels=() if world is None else world.levels,
        floor_height_dataset_m=None if world is None else -float(world.T_world_dataset[2, 3]),
        conventions=scores,
        notes=(*recording.notes, *color_note),
        problems=tuple(problems),
    )


def _noting(problems, check, *args):
    """The result of a check; what it raises becomes a line instead."""
    try:
        return check(*args)
    except IsrError as error:
        problems.append(f"{error.problem}: {error.hint}")
        return None


def _convention_scores(
    recording: Recording, samples: Samples, camera: Camera
) -> tuple[ConventionScore, ...]:
    declared = recording.convention
    errors_m = convention_errors_m(list(samples.pairs), camera, declared)
    found = holding(errors_m, declared)
    return tuple(
        ConventionScore(name, 1e3 * error, name == declared, name == found)
        for name, error in errors_m.items()
    )


def _estimated_or_none(cloud: Cloud) -> np.ndarray | None:
    try:
        return estimate_gravity(cloud)
    except IsrError:
        return None  # the report then shows no angle


def _angle_deg(given: np.ndarray | None, estimated: np.ndarray | None) -> float | None:
    if given is None or estimated is None:
        return None
    return degrees_between(given, estimated)


def _incomplete(recording: Recording) -> Iterator[str]:
    for frame in recording.frames:
        if isinstance(frame.pose, FrameError):
            yield frame.pose.problem
            continue
        try:
            for kind, path in (("colour", frame.color), ("depth", frame.depth)):
                check_complete(present(frame, path, kind))
        except FrameError as error:
            yield error.problem
