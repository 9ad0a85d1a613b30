"""Does the scene stand still? ISR-Stab in MuJoCo, and the criteria of other works beside it."""

from .judge import settle
from .report import (
    BodyMotion,
    JointMotion,
    Overlap,
    Rates,
    ResetReport,
    SetReport,
    StabilityReport,
    VariantRates,
)

VERSION: int = 1

__all__ = [
    "VERSION",
    "BodyMotion",
    "JointMotion",
    "Overlap",
    "Rates",
    "ResetReport",
    "SetReport",
    "StabilityReport",
    "VariantRates",
    "settle",
]
