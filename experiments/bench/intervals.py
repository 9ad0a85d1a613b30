"""Means over rooms, and how sure they are."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence

import numpy as np
from scipy.stats import bootstrap

RESAMPLES = 10_000
CONFIDENCE = 0.95
_SEED = 0


@dataclasses.dataclass(frozen=True)
class Interval:
    """A mean and its bootstrap interval."""

    mean: float
    low: float | None
    """None below two rooms."""
    high: float | None
    count: int
    """Rooms for which the value is defined."""


def mean_interval(values: Sequence[float]) -> Interval | None:
    """Mean with its percentile bootstrap interval (Efron 1979) over rooms; None without values.

    Rooms are drawn with replacement, since they are what another benchmark would have others of.
    """
    if len(values) == 0:
        return None
    mean = float(np.mean(values))
    if len(values) < 2:
        return Interval(mean, None, None, len(values))
    found = bootstrap(
        (np.asarray(values, float),),
        np.mean,
        n_resamples=RESAMPLES,
        confidence_level=CONFIDENCE,
        method="percentile",
        rng=np.random.default_rng(_SEED),
    ).confidence_interval
    return Interval(mean, float(found.low), float(found.high), len(values))


def paired_difference(ours: Mapping[str, float], theirs: Mapping[str, float]) -> Interval | None:
    """Mean of ours - theirs over the rooms that have both: how hard a room is cancels out."""
    return mean_interval([ours[room] - theirs[room] for room in sorted(ours.keys() & theirs)])
