"""The map's surface against the true one: accuracy, completeness, F-score.

Accuracy runs from the map to the whole true meshes, layout and stuff among them, so that what the
map has of an unseen side is no error. Completeness runs from the true points that the camera saw
to the triangles of the map. F(d) = 2 P(d) R(d) / (P(d) + R(d)), where P and R are the shares of
both within d (Knapitsch et al. 2017, Eq. 3-5).
"""

from __future__ import annotations

import dataclasses

import numpy as np
from jaxtyping import Float
from rich.table import Table

from ...geometry.surface_samples import surface_samples
from ...types import Mesh
from ..figures import Headline, millimetres, percent
from ..result_files import Result, Truth
from .true_surface import distance_to_surface

LIMITS_M = (0.01, 0.02, 0.05)
SAMPLES = 50_000
"""Points of either side: of the map evenly by area, of the seen points by chance, seed 0. The
standard error of a share is at most 0.22 %."""
FAR_M = 0.5
"""Distances are cut here before they are averaged."""


@dataclasses.dataclass(frozen=True)
class SurfaceRate:
    """Shares within one limit."""

    limit_m: float
    precision: float | None
    """Of the map, within the limit of the true surface."""
    recall: float
    """Of the seen true surface, within the limit of the map."""
    f_score: float | None


@dataclasses.dataclass(frozen=True)
class SurfaceScores:
    """Distances between the map and the true surface. None: there is no map, or no true mesh."""

    accuracy_mean_m: float | None
    """From the map to the true meshes, cut at `FAR_M`."""
    accuracy_median_m: float | None
    completeness_mean_m: float | None
    """From the seen true points to the map, cut at `FAR_M`."""
    completeness_median_m: float | None
    rates: tuple[SurfaceRate, ...]
    """At `LIMITS_M`."""

    def rate(self, limit_m: float) -> SurfaceRate:
        """The shares at one of `LIMITS_M`."""
        return next(r for r in self.rates if r.limit_m == limit_m)

    def headline(self) -> Headline:
        limits = " / ".join(f"{100 * r.limit_m:g}" for r in self.rates)
        return (
            (
                "surface accuracy, mean / median",
                millimetres(self.accuracy_mean_m, self.accuracy_median_m),
            ),
            (
                "surface completeness, mean / median",
                millimetres(self.completeness_mean_m, self.completeness_median_m),
            ),
            (f"surface F-score at {limits} cm", percent(*(r.f_score for r in self.rates))),
        )

    def table(self) -> Table:
        """One row per limit."""
        table = Table("surface within", "precision", "recall", "F-score")
        for r in self.rates:
            shares = (percent(v) for v in (r.precision, r.recall, r.f_score))
            table.add_row(f"{100 * r.limit_m:g} cm", *shares)
        return table


def score_surface(truth: Truth, result: Result) -> SurfaceScores:
    """Compare the surfaces, in the truth's world."""
    mesh = Mesh(result.points.astype(np.float32), result.faces.astype(np.int32))
    samples = surface_samples(result.points, result.faces, SAMPLES).points.astype(np.float64)
    accuracy = None
    if truth.mesh is not None and len(samples):
        accuracy = distance_to_surface(samples, truth.mesh, FAR_M)
    completeness = distance_to_surface(_some(truth.points), mesh, FAR_M)
    return SurfaceScores(
        _of(np.mean, accuracy),
        _of(np.median, accuracy),
        _of(np.mean, completeness if len(samples) else None),
        _of(np.median, completeness if len(samples) else None),
        tuple(surface_rate(limit_m, accuracy, completeness) for limit_m in LIMITS_M),
    )


def _some(points: Float[np.ndarray, "points 3"]) -> Float[np.ndarray, "some 3"]:
    """At most `SAMPLES` of the points."""
    if len(points) <= SAMPLES:
        return points
    return np.random.default_rng(0).choice(points, SAMPLES, replace=False)


def _of(summary, distance_m: np.ndarray | None) -> float | None:
    return None if distance_m is None or len(distance_m) == 0 else float(summary(distance_m))


def surface_rate(
    limit_m: float,
    accuracy_m: Float[np.ndarray, " samples"] | None,
    completeness_m: Float[np.ndarray, " points"],
) -> SurfaceRate:
    """Shares within a limit, and their harmonic mean (0 where both are 0).

    Args:
        limit_m: Distances equal to it are within.
        accuracy_m: From the map to the truth; None where there is nothing to measure.
        completeness_m: From the truth to the map.
    """
    recall = float(np.mean(completeness_m <= limit_m)) if len(completeness_m) else 0.0
    if accuracy_m is None:
        return SurfaceRate(limit_m, None, recall, None)
    precision = float(np.mean(accuracy_m <= limit_m))
    total = precision + recall
    return SurfaceRate(limit_m, precision, recall, 2 * precision * recall / total if total else 0.0)
