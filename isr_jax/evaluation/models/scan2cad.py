"""CAD alignment accuracy of Scan2CAD (Avetisyan et al. 2019), by its own counting and strictly.

Both ask for the centre within 20 cm, the rotation within 20 degrees and the scale within 20 %, and
both average over instances and over classes.

*Official* is what the benchmark's script counts, its known behaviours kept for comparison:

- the scale error is |mean(s / s_true) - 1|: an axis too long and one too short cancel, and scales
  of different models are compared as if they were sizes;
- predictions are taken in their order; each takes the first true model of its class that it fits,
  be it the nearest or not;
- predictions of a CAD id count only as often as that very id occurs in the true scene: a model
  that is not in the truth never counts, however well it fits;
- a round model has 36 steps of 10 degrees, so that it may be up to 5 degrees off for nothing, and
  symmetry is that of the predicted id.

Of the script's classes (the eight largest, and one of all others) only the principle is kept:
every class counts by itself.

*Strict* asks for every axis by itself, compares sizes instead of scales (so that another model of
the class counts if it is as large), and assigns one to one so that most true models are met.
"""

from __future__ import annotations

import dataclasses
from collections import Counter
from collections.abc import Sequence

import numpy as np
from jaxtyping import Float
from scipy.optimize import linear_sum_assignment

from .cad_alignment import ROUND, AlignmentLimits, rotation_error_rad

_ROUND_STEPS = 36


@dataclasses.dataclass(frozen=True, eq=False)
class PosedCad:
    """One CAD of a scene, true or predicted."""

    id: str
    class_name: str
    rotation: Float[np.ndarray, "3 3"]
    """Model axes in the world, without scale."""
    center: Float[np.ndarray, "3"]
    """Metres."""
    scale: Float[np.ndarray, "3"]
    size: Float[np.ndarray, "3"]
    """Scaled extent along the model's own axes, metres."""
    symmetry: int
    """Order about the model's up: 1, 2, 4, or 0 = round."""


@dataclasses.dataclass(frozen=True)
class ClassCount:
    """True CADs of one class that were met, of all."""

    good: int
    total: int


@dataclasses.dataclass(frozen=True)
class AlignmentAccuracy:
    """Alignment accuracy under one way of counting."""

    instances: float | None
    """Share of all true CADs; None without any."""
    classes: float | None
    """Mean of the shares of the classes."""
    by_class: dict[str, ClassCount]

    @staticmethod
    def over(by_class: dict[str, ClassCount]) -> AlignmentAccuracy:
        """Average the counts; those of many scenes may be added up before."""
        total = sum(c.total for c in by_class.values())
        good = sum(c.good for c in by_class.values())
        shares = [c.good / c.total for c in by_class.values() if c.total]
        return AlignmentAccuracy(
            good / total if total else None,
            float(np.mean(shares)) if shares else None,
            by_class,
        )


@dataclasses.dataclass(frozen=True)
class Scan2CadScores:
    """Alignment accuracy by both countings."""

    official: AlignmentAccuracy
    """As the benchmark's script counts, traps included: for comparison only."""
    strict: AlignmentAccuracy


def score_scan2cad(
    truth: Sequence[PosedCad],
    predicted: Sequence[PosedCad],
    limits: AlignmentLimits | None = None,
) -> Scan2CadScores:
    """Alignment accuracy of one scene. ``predicted`` stands in the order of its file."""
    limits = limits or AlignmentLimits()
    return Scan2CadScores(
        _accuracy(truth, official_hits(truth, predicted, limits)),
        _accuracy(truth, strict_hits(truth, predicted, limits)),
    )


def _accuracy(truth: Sequence[PosedCad], hits: list[tuple[int, int]]) -> AlignmentAccuracy:
    total = Counter(cad.class_name for cad in truth)
    good = Counter(truth[t].class_name for t, _ in hits)
    return AlignmentAccuracy.over(
        {name: ClassCount(good[name], count) for name, count in sorted(total.items())}
    )


def official_hits(
    truth: Sequence[PosedCad], predicted: Sequence[PosedCad], limits: AlignmentLimits
) -> list[tuple[int, int]]:
    """(true, predicted) positions that the benchmark's script counts as aligned."""
    allowed = Counter(cad.id for cad in truth)
    symmetry = {cad.id: cad.symmetry for cad in truth}
    used: Counter[str] = Counter()
    free = list(range(len(truth)))
    hits = []
    for p, cad in enumerate(predicted):
        if used[cad.id] >= allowed[cad.id]:
            continue
        used[cad.id] += 1
        for t in free:
            if truth[t].class_name == cad.class_name and _official_fit(
                truth[t], cad, symmetry[cad.id], limits
            ):
                hits.append((t, p))
                free.remove(t)
                break
    return hits


def _official_fit(true: PosedCad, cad: PosedCad, symmetry: int, limits: AlignmentLimits) -> bool:
    steps = _ROUND_STEPS if symmetry == ROUND else symmetry
    return bool(
        np.linalg.norm(cad.center - true.center) <= limits.center_m
        and rotation_error_rad(true.rotation, cad.rotation, steps) <= limits.rotation_rad
        and abs(np.mean(cad.scale / true.scale) - 1) <= limits.size_ratio
    )


def strict_hits(
    truth: Sequence[PosedCad], predicted: Sequence[PosedCad], limits: AlignmentLimits
) -> list[tuple[int, int]]:
    """(true, predicted) positions of the largest one-to-one assignment of fits in one class."""
    if not truth or not predicted:
        return []
    fits = np.array([[_strict_fit(t, p, limits) for p in predicted] for t in truth])
    rows, columns = linear_sum_assignment(fits, maximize=True)
    return [(int(t), int(p)) for t, p in zip(rows, columns, strict=True) if fits[t, p]]


def _strict_fit(true: PosedCad, cad: PosedCad, limits: AlignmentLimits) -> bool:
    return bool(
        true.class_name == cad.class_name
        and np.linalg.norm(cad.center - true.center) <= limits.center_m
        and rotation_error_rad(true.rotation, cad.rotation, true.symmetry) <= limits.rotation_rad
        and _largest_size_error(true, cad) <= limits.size_ratio
    )


def _largest_size_error(true: PosedCad, cad: PosedCad) -> float:
    """Largest over the axes of |s' / s - 1|; a round or square model may swap x and y."""
    sizes = [cad.size, cad.size[[1, 0, 2]]] if true.symmetry in (ROUND, 4) else [cad.size]
    return min(float(np.abs(size / true.size - 1).max()) for size in sizes)
