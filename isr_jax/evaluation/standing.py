"""What the judge of stability found, beside the scores of the reconstruction.

A scene that is welded down stands still, and one whose things all hover at their true places
falls; neither figure says much without the other.
"""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path
from typing import Any

from ..errors import SceneError
from .figures import Headline, millimetres, percent


@dataclasses.dataclass(frozen=True)
class SetStanding:
    """One simulation: of the scene as exported, or with everything freed."""

    bodies: int
    """Free bodies, and entities that never became a body."""
    within_1_cm: float | None
    """Share that drifted less from t = 0 to the end; failed entities count as not."""
    within_5_cm: float | None
    within_20_cm: float | None
    penetration_max_m: float | None
    """At t = 0."""
    penetration_mean_m: float | None
    drift_max_m: float | None
    phyrecon: float | None
    molmospaces_bodies: float | None
    molmospaces_joints: float | None


@dataclasses.dataclass(frozen=True)
class StandingScores:
    """ISR-Stab of the result, from its ``stability.json``."""

    exported: SetStanding
    freed: SetStanding | None
    """Everything freed but layout and what hangs on it; None where nothing could be freed."""
    reset_survival: float | None
    """Over (reset, body) pairs."""
    failed: int
    """Entities that are not in the simulation at all."""
    fixed: int
    """Bodies other than layout that the export fixed to the world."""
    scans_kept: int | None
    alignment_error_mean_m: float | None
    """Of the placed models: what it cost to stand."""

    def headline(self) -> Headline:
        a, b = self.exported, self.freed
        return (
            ("stands within 1 / 5 / 20 cm", percent(*_within(a))),
            ("  everything freed", percent(*_within(b))),
            ("  PhyRecon / MolmoSpaces", percent(a.phyrecon, a.molmospaces_bodies)),
            ("  penetration at t = 0, max", millimetres(a.penetration_max_m)),
            ("  alignment error beside it, mean", millimetres(self.alignment_error_mean_m)),
        )


def _within(bodies: SetStanding | None) -> tuple[float | None, float | None, float | None]:
    if bodies is None:
        return None, None, None
    return bodies.within_1_cm, bodies.within_5_cm, bodies.within_20_cm


def read_standing(folder: Path) -> StandingScores | None:
    """Read ``stability.json`` of a results folder; None where there is none.

    Raises:
        SceneError: the file is there and is not what the judge writes.
    """
    path = folder / "stability.json"
    try:
        data = json.loads(path.read_text("utf-8"))
        return StandingScores(
            exported=_set(data["exported"], len(data["failed"])),
            freed=None if data["freed"] is None else _set(data["freed"], len(data["failed"])),
            reset_survival=data["resets"]["body_survival"],
            failed=len(data["failed"]),
            fixed=len(data["fixed"]),
            scans_kept=data["scans_kept"],
            alignment_error_mean_m=data["alignment_error_mean_m"],
        )
    except FileNotFoundError:
        return None
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise SceneError(
            f"{path} cannot be read: {error!r}", "write it again with `isr settle`"
        ) from None


def _set(data: dict[str, Any], failed: int) -> SetStanding:
    rates = data["rates"] or {"within_1_cm": None, "within_5_cm": None, "within_20_cm": None}
    variants = data["variants"]
    drifts = [body["drift_end_m"] for body in data["bodies"]]
    # What flew off to infinity has no drift in JSON, and so the set has no largest one.
    known = [d for d in drifts if d is not None]
    return SetStanding(
        bodies=len(drifts) + failed,
        within_1_cm=rates["within_1_cm"],
        within_5_cm=rates["within_5_cm"],
        within_20_cm=rates["within_20_cm"],
        penetration_max_m=data["penetration_max_m"],
        penetration_mean_m=data["penetration_mean_m"],
        drift_max_m=max(known) if known and len(known) == len(drifts) else None,
        phyrecon=variants["phyrecon"],
        molmospaces_bodies=variants["molmospaces_bodies"],
        molmospaces_joints=variants["molmospaces_joints"],
    )
