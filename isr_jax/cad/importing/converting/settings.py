"""Bounds of what an imported model may be, and of what is estimated about it."""

from __future__ import annotations

import dataclasses

from ....config import setting


@dataclasses.dataclass(frozen=True)
class ConvertSettings:
    """How a found model becomes one of a library."""

    min_size_m: float = setting(0.004, "least length of a model's largest side", unit="m")
    max_size_m: float = setting(60.0, "greatest length of a model's largest side", unit="m")
    size_mismatch: float = setting(0.05, "stretch to the stated size from which a note is made")
    min_side_m: float = setting(0.001, "least thickness of a flat model's box", unit="m")
    plane_angle_rad: float = setting(0.05, "greatest angle between faces of one plane", unit="rad")
    plane_gap_m: float = setting(0.003, "distance within which faces of one plane lie", unit="m")
    symmetry_share: float = setting(
        0.02, "a turned surface that stays within this share of the diagonal is the same"
    )


DEFAULT = ConvertSettings()
