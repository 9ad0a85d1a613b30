"""Means of what may be empty, and how figures print. Scores are 0 to 1, printed in percent."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

Headline = tuple[tuple[str, str], ...]
"""(name, value) of what is quoted first."""


def mean(values: Iterable[float]) -> float | None:
    """None of nothing, instead of NaN."""
    listed = list(values)
    return float(np.mean(listed)) if listed else None


def median(values: Iterable[float]) -> float | None:
    """None of nothing, instead of NaN."""
    listed = list(values)
    return float(np.median(listed)) if listed else None


def share(count: int, of: int) -> float | None:
    """None where there is nothing to take a share of."""
    return count / of if of else None


def percent(*values: float | None) -> str:
    """``97.1 / 3.0``; a dash where a score is undefined."""
    return " / ".join("-" if value is None else f"{100 * value:.1f}" for value in values)


def millimetres(*values: float | None) -> str:
    """``1.2 / 30.0 mm``; a dash where a length is undefined."""
    shown = " / ".join("-" if value is None else f"{1000 * value:.1f}" for value in values)
    return shown if shown.strip("- /") == "" else f"{shown} mm"


def counted(value: float | None, count: int, of: int) -> str:
    """``97.1 (33 of 34)``."""
    return f"{percent(value)} ({count} of {of})"
