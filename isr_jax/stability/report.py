"""What the judge found: plain data, JSON, and a table to read."""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Group
from rich.table import Table

from ..errors import OutputError
from ..runtime.render_text import render_text


@dataclasses.dataclass(frozen=True)
class BodyMotion:
    """How one free body moved from where the scene put it."""

    name: str
    drift_early_m: float
    """Distance of its centre of mass from the start, after `SetReport.early_s`."""
    drift_end_m: float
    drop_end_m: float
    """Part of the drift that is downwards."""
    turn_early_rad: float
    turn_end_rad: float
    path_m: float
    """Length of the way, sampled at 50 Hz: jitter makes it long without drift."""
    left_room: bool


@dataclasses.dataclass(frozen=True)
class JointMotion:
    """How far a hinge or slide strayed by itself."""

    name: str
    strayed: float
    """Radians or metres, the farthest at any time."""
    share_of_range: float | None
    """None for joints without limits."""


@dataclasses.dataclass(frozen=True)
class Overlap:
    """Two bodies that start inside each other."""

    body_a: str
    body_b: str
    depth_m: float


@dataclasses.dataclass(frozen=True)
class Rates:
    """Shares of bodies whose drift at the end stays below a limit."""

    within_1_cm: float
    within_5_cm: float
    within_20_cm: float
    total: int
    """Denominator: free bodies, and entities that never became a body."""


@dataclasses.dataclass(frozen=True)
class VariantRates:
    """Criteria of other works, applied to this joint simulation of all bodies at once."""

    phyrecon: float | None
    """Drop < 5 cm and tilt < 5 degrees after 3.3 s (there: each object alone, damped)."""
    molmospaces_bodies: float | None
    """From 1 s to 4 s: drift < 5 cm and path < 10 cm."""
    molmospaces_joints: float | None
    """Over the same time: less than 10 % of the range."""


@dataclasses.dataclass(frozen=True)
class SetReport:
    """One simulation: of the scene as exported, or with everything freed."""

    label: str
    bodies: tuple[BodyMotion, ...]
    joints: tuple[JointMotion, ...]
    overlaps: tuple[Overlap, ...]
    """At t = 0, deeper than 0.01 mm, deepest first."""
    penetration_max_m: float
    """At t = 0; 0 without contact."""
    penetration_mean_m: float
    """Over touching pairs at t = 0."""
    contacts: int
    """Contact points at t = 0."""
    warnings: dict[str, int]
    """Of the solver, over the whole time."""
    early_s: float
    end_s: float
    rates: Rates | None
    """None without any body."""
    variants: VariantRates
    left_room: int


@dataclasses.dataclass(frozen=True)
class ResetReport:
    """Repetitions with every free body put a little off its place."""

    resets: int
    perturbation_m: float
    survived: int
    """Resets in which every free body ended within 5 cm of its start and in the room, and the
    solver did not warn."""
    body_survival: float | None
    """The same over (reset, body) pairs; failed entities count as not."""


@dataclasses.dataclass(frozen=True)
class StabilityReport:
    """ISR-Stab of one scene."""

    scene: str
    """Its path, or ``MjModel`` or ``MjSpec`` and its name."""
    exported: SetReport
    freed: SetReport | None
    """Everything freed but layout and what hangs on it; shows what fixing hides."""
    not_freed: str | None
    """Why `freed` is None."""
    resets: ResetReport
    failed: tuple[str, ...]
    """Entities of scene.json that are not in the simulation at all."""
    fixed: tuple[str, ...]
    """Bodies other than layout that the export fixed to the world."""
    anchored: tuple[str, ...]
    """Bodies that stay fixed in the freed set too."""
    alignment_error_mean_m: float | None
    """Of the placed models, from scene.json: a scene can stand still and be wrong."""
    scans_kept: int | None
    """Entities that stayed scans, from scene.json."""

    def to_json(self) -> dict[str, Any]:
        """Plain data; infinite and undefined numbers as None."""
        return _plain(dataclasses.asdict(self))

    def write(self, path: Path) -> None:
        """Write ``stability.json``.

        Raises:
            OutputError: the file cannot be written.
        """
        try:
            path.write_text(json.dumps(self.to_json(), indent=1, allow_nan=False) + "\n", "utf-8")
        except OSError as error:
            raise OutputError(f"{path}: {error.strerror}", "give a writable folder") from None

    def table(self) -> Group:
        """Figures of both sets side by side, then every free body."""
        return Group(_summary(self), _bodies(self))

    def __str__(self) -> str:
        return render_text(self.table())


def _plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {k: _plain(v) for k, v in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(v) for v in value]
    if isinstance(value, (float, np.floating)):
        return float(value) if np.isfinite(value) else None
    return value


def _summary(report: StabilityReport) -> Table:
    sets = [each for each in (report.exported, report.freed) if each is not None]
    table = Table(title="ISR-Stab", title_justify="left")
    table.add_column("")
    for each in sets:
        table.add_column(each.label, justify="right")
    for name, cell in _ROWS:
        table.add_row(name, *(cell(each) for each in sets))
    resets, failed = report.resets, ", ".join(report.failed) or "none"
    table.add_row(
        f"survived resets ({_mm(resets.perturbation_m)} off)",
        f"{resets.survived} of {resets.resets}",
    )
    table.add_row("entities without a body", failed)
    error = report.alignment_error_mean_m
    table.add_row("mean alignment error of models", "-" if error is None else _mm(error))
    table.caption = None if report.not_freed is None else f"everything freed: {report.not_freed}"
    return table


_ROWS = (
    ("free bodies", lambda s: str(len(s.bodies))),
    ("penetration at t = 0, max", lambda s: _mm(s.penetration_max_m)),
    ("penetration at t = 0, mean", lambda s: _mm(s.penetration_mean_m)),
    ("contacts at t = 0", lambda s: str(s.contacts)),
    ("largest drift, early", lambda s: f"{_largest(s, 'drift_early_m')} ({s.early_s:g} s)"),
    ("largest drift, end", lambda s: f"{_largest(s, 'drift_end_m')} ({s.end_s:g} s)"),
    ("largest turn, early", lambda s: _turn(s, "turn_early_rad")),
    ("largest turn, end", lambda s: _turn(s, "turn_end_rad")),
    ("within 1 / 5 / 20 cm", lambda s: _rates(s.rates)),
    ("longest path", lambda s: _largest(s, "path_m")),
    ("left the room", lambda s: str(s.left_room)),
    ("largest joint drift", lambda s: _joint(s)),
    ("solver warnings", lambda s: ", ".join(f"{k} {v}" for k, v in s.warnings.items()) or "none"),
    ("PhyRecon criteria", lambda s: _share(s.variants.phyrecon)),
    ("MolmoSpaces criteria, bodies", lambda s: _share(s.variants.molmospaces_bodies)),
    ("MolmoSpaces criteria, joints", lambda s: _share(s.variants.molmospaces_joints)),
)


def _bodies(report: StabilityReport) -> Table:
    table = Table(title="free bodies", title_justify="left")
    for heading in ("body", "drift early", "drift end", "drop", "turn end", "path", ""):
        table.add_column(heading, justify="left" if heading in ("body", "") else "right")
    for m in sorted(report.exported.bodies, key=lambda m: -m.drift_end_m):
        table.add_row(
            m.name,
            _mm(m.drift_early_m),
            _mm(m.drift_end_m),
            _mm(m.drop_end_m),
            f"{np.rad2deg(m.turn_end_rad):.2f} deg",
            _mm(m.path_m),
            "left the room" if m.left_room else "",
        )
    return table


def _mm(value: float) -> str:
    return f"{1000 * value:.2f} mm" if np.isfinite(value) else "-"


def _share(value: float | None) -> str:
    return "-" if value is None else f"{100 * value:.0f} %"


def _rates(rates: Rates | None) -> str:
    if rates is None:
        return "-"
    shares = (rates.within_1_cm, rates.within_5_cm, rates.within_20_cm)
    return " / ".join(_share(v) for v in shares) + f" of {rates.total}"


def _largest(report: SetReport, field: str) -> str:
    worst = max(report.bodies, key=lambda m: getattr(m, field), default=None)
    return "-" if worst is None else f"{_mm(getattr(worst, field))} {worst.name}"


def _turn(report: SetReport, field: str) -> str:
    worst = max(report.bodies, key=lambda m: getattr(m, field), default=None)
    return "-" if worst is None else f"{np.rad2deg(getattr(worst, field)):.2f} deg {worst.name}"


def _joint(report: SetReport) -> str:
    worst = max(report.joints, key=lambda j: j.share_of_range or 0.0, default=None)
    if worst is None:
        return "-"
    return f"{_share(worst.share_of_range)} of range, {worst.name}"
