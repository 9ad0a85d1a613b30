"""What `isr cad check` found: one row per model, reasons first."""

from __future__ import annotations

import dataclasses
import json
from typing import Any, Literal

from rich.console import Group, RenderableType
from rich.markup import escape
from rich.table import Table

from .settings import CheckSettings

CHECKS = ("files", "hulls", "inertia", "joints", "planes", "standing", "opening")
Outcome = Literal["passed", "failed", "skipped"]


@dataclasses.dataclass(frozen=True)
class Fault:
    """One thing that is wrong with a model."""

    check: str
    """One of `CHECKS`."""
    reason: str
    """What, where, by how much."""


@dataclasses.dataclass(frozen=True)
class ModelCheck:
    """What was found about one model."""

    id: str
    faults: tuple[Fault, ...] = ()
    skipped: tuple[Fault, ...] = ()
    """Checks that could not be made, and why."""
    drift_m: float | None = None
    """Farthest that a corner moved while standing; None: not simulated."""
    share: float | None = None
    """Least part of its range that a joint travelled; None: no joints, or not simulated."""
    effort_n: float | None = None
    """Largest force that a hand needed."""
    seconds: float = 0.0

    @property
    def passed(self) -> bool:
        return not self.faults

    def outcome(self, check: str) -> Outcome:
        """Of one of `CHECKS`."""
        if any(fault.check == check for fault in self.faults):
            return "failed"
        return "skipped" if any(fault.check == check for fault in self.skipped) else "passed"

    def record(self) -> dict[str, Any]:
        """As plain data for JSON."""
        return {
            **dataclasses.asdict(self),
            "outcome": {check: self.outcome(check) for check in CHECKS},
        }


@dataclasses.dataclass(frozen=True)
class CheckReport:
    """All models of a library."""

    source: str
    models: tuple[ModelCheck, ...]
    settings: CheckSettings
    seconds: float

    @property
    def failed(self) -> tuple[ModelCheck, ...]:
        return tuple(model for model in self.models if not model.passed)

    @property
    def passed(self) -> bool:
        return not self.failed

    def json(self) -> str:
        """The whole report."""
        whole = {
            "source": self.source,
            "passed": self.passed,
            "seconds": round(self.seconds, 1),
            "settings": dataclasses.asdict(self.settings),
            "models": [model.record() for model in self.models],
        }
        return json.dumps(whole, indent=1) + "\n"

    def table(self, *, every_model: bool = False) -> RenderableType:
        """What is wrong with each failing model, what was skipped, and totals by check.

        Args:
            every_model: Also the figures of every model.
        """
        parts: list[RenderableType] = [self._figures_table()] if every_model else []
        if any(model.skipped for model in self.models):
            parts.append(self._skipped_table())
        if self.failed:
            parts.append(self._faults_table())
        return Group(*parts, self._totals_table())

    def _faults_table(self) -> Table:
        table = Table(title=f"what is wrong in {escape(self.source)}", title_justify="left")
        table.add_column("model", overflow="fold")
        table.add_column("check", no_wrap=True, style="red")
        table.add_column("reason")
        for model in self.failed:
            for i, fault in enumerate(model.faults):
                table.add_row("" if i else model.id, fault.check, escape(fault.reason))
        return table

    def _skipped_table(self) -> Table:
        reasons: dict[str, list[ModelCheck]] = {}
        for model in self.models:
            for reason in dict.fromkeys(fault.reason for fault in model.skipped):
                reasons.setdefault(reason, []).append(model)
        table = Table(title="what could not be checked", title_justify="left")
        for heading in ("models", "for one", "checks", "why"):
            table.add_column(heading)
        for reason, models in reasons.items():
            checks = ", ".join(f.check for f in models[0].skipped if f.reason == reason)
            table.add_row(str(len(models)), models[0].id, checks, escape(reason))
        return table

    def _figures_table(self) -> Table:
        table = Table(title=f"models of {escape(self.source)}", title_justify="left")
        for heading in ("model", "failed"):
            table.add_column(heading, overflow="fold")
        for heading in ("drift", "travel", "force"):
            table.add_column(heading, justify="right", no_wrap=True)
        for model in self.models:
            failed = ", ".join(check for check in CHECKS if model.outcome(check) == "failed")
            table.add_row(model.id, failed, *_figures(model))
        return table

    def _totals_table(self) -> Table:
        count, failed = len(self.models), len(self.failed)
        verdict = f"[red]{failed} of {count} models failed[/]" if failed else f"{count} models: all"
        title = f"{verdict} sound" if not failed else verdict
        table = Table(title=f"{title} ({self.seconds:.0f} s)", title_justify="left")
        for heading in ("check", "passed", "failed", "skipped"):
            table.add_column(heading)
        for check in CHECKS:
            outcomes = [model.outcome(check) for model in self.models]
            counts = [outcomes.count(k) for k in ("passed", "failed", "skipped")]
            table.add_row(check, *(str(n or "") for n in counts))
        return table


def _figures(model: ModelCheck) -> tuple[str, str, str]:
    return (
        "" if model.drift_m is None else f"{1000 * model.drift_m:.2f} mm",
        "" if model.share is None else f"{100 * model.share:.0f} %",
        "" if model.effort_n is None else f"{model.effort_n:.0f} N",
    )
