"""Bounds of `isr cad check`: every figure a model is judged by, with its unit and meaning."""

from __future__ import annotations

import dataclasses

from ...config.fields import Checked, setting


@dataclasses.dataclass(frozen=True)
class CheckSettings(Checked):
    """What counts as sound. The defaults are what the kit promises."""

    flat_m: float = setting(5e-5, "how far a hull may be from convex", unit="m", low=0.0)
    max_hull_vertices: int = setting(
        64, "most vertices of a hull, as simulators cut off the rest", low=4
    )
    overlap_m: float = setting(1e-4, "deepest contact between two links", unit="m", low=0.0)
    plane_m: float = setting(1e-3, "how far a plane may be off its surface", unit="m", low=1e-5)
    plane_share: float = setting(0.7, "part of a plane's area that rays must find", low=0, high=1)
    density_factor: float = setting(
        20.0, "mass over that of a box of the class's density: at most this, or 1 over it", low=1.0
    )
    handle_m: float = setting(0.02, "how far a handle may be off its link", unit="m", low=0.0)
    standing_s: float = setting(5.0, "how long a model must stand", unit="s", low=0.0)
    standing_m: float = setting(
        1e-3, "how far a standing model's corners may move", unit="m", low=0.0
    )
    travel_share: float = setting(0.95, "part of its range a joint must reach", low=0, high=1)
    force_n: float = setting(60.0, "most that the hand at a handle pulls", unit="N", low=0.0)
    opening_s: float = setting(
        1.2,
        "time in which the hand opens a slide, or turns a joint by 90 degrees",
        unit="s",
        low=0.1,
    )
    patience_s: float = setting(
        1.0, "how long the hand goes on when a joint lags", unit="s", low=0.0
    )
    tilt_rad: float = setting(0.1, "how far a free base may tilt when opened", unit="rad", low=0.0)
    sweep_positions: int = setting(33, "positions at which overlaps are looked for", low=2)
    timestep_s: float = setting(
        0.002, "time step of the simulation, as in exported scenes", unit="s", low=1e-4, high=0.01
    )
