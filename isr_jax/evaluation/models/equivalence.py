"""Functional equivalence: does what stands for a thing do what the thing did?

The paper (section I) asks that a replacement preserve, with decreasing importance, (i) class and
spatial relations, (ii) affordance, (iii) size and shape, (iv) appearance; it gives no formula. Here
each is a part in 0..1:

    relations   class (1; another of its match group 0.5; else 0) times the F1 of its support edges
    affordance  least of joints, carrying planes, openable room, where they apply (`affordance`)
    geometry    mean of size, IoU of the upright boxes, and Chamfer distance over the diagonal
    appearance  1 - CIEDE2000 / 50 between the mean colours

and each part has a grade g: 2 = kept (at least 0.9), 1 = partly (at least 0.5), 0 = lost. The score
reads the grades as a number of base 3,

    score = (27 g_1 + 9 g_2 + 3 g_3 + g_4) / 80,

so that one grade of an earlier criterion outweighs all later ones together (27 > 18 + 6 + 2), and
what keeps everything scores 1. What is missing scores 0.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence

import numpy as np

from ...config import DEFAULT_SUPPORT, SupportSettings
from ...geometry import canonical_box
from ...scene_file import EntityRecord, SceneFile
from ...types import Box
from ..figures import Headline, mean, percent
from ..maps.boxes import box_iou_matrix
from ..matches import Match
from ..result_files import Result, Truth, moved_box
from .affordance import (
    MovingPart,
    asked_places,
    carrying_agreement,
    carrying_planes,
    joint_agreement,
    moving_parts,
    volume_agreement,
)
from .appearance import delta_e, mean_lab
from .cad_cases import CadCase, PosedModel
from .relations import Supports, class_agreement, edge_agreement, found_supports, true_supports

KEPT, PARTLY = 0.9, 0.5
_WEIGHTS = (27, 9, 3, 1)
_ALIKE_E = 50.0
"""Difference of colours at which appearance is lost altogether; half of black to white."""
_FAR_SHARE = 0.1
"""Chamfer distance, as a share of the diagonal, at which a shape is lost altogether."""
_SIZE_SHARE = 0.5
"""Mean error of the three sides at which a size is lost altogether."""
_EQUAL = 1e-4
"""Parts are compared with their limits up to this: float32 rounds."""


@dataclasses.dataclass(frozen=True)
class PartDetails:
    """What the parts are made of, 0 to 1; None where it does not apply."""

    class_same: float
    supports: float
    """F1 of the support edges."""
    joints: float | None
    """None where neither has joints."""
    carrying: float | None
    """None where nothing stands on the true thing and it offers no place."""
    openable: float | None
    """None where the true thing does not open."""
    size: float
    box_iou: float
    shape: float | None
    """None for a scan, which has no model surface."""
    color_difference: float | None
    """CIEDE2000, 0 to 100; None for a scan."""


@dataclasses.dataclass(frozen=True)
class EquivalenceRow:
    """One true thing and how far what stands for it is its equivalent. Parts are 0 to 1."""

    truth: str
    class_name: str
    predicted: str | None
    id: str | None
    relations: float
    affordance: float
    geometry: float
    appearance: float
    grades: tuple[int, int, int, int]
    """Of the four parts: 2 = kept, 1 = partly, 0 = lost."""
    score: float
    equivalent: bool
    """Class, relations and affordance are kept, and size and shape at least partly."""
    details: PartDetails | None
    """None where nothing stands for it."""

    @staticmethod
    def of(
        case: CadCase, parts: tuple[float, float, float, float], details: PartDetails | None
    ) -> EquivalenceRow:
        """Grade the parts."""
        a, b, c, d = (grade(part) for part in parts)
        return EquivalenceRow(
            case.true.name,
            case.true.class_name,
            None if case.found is None else case.found.name,
            None if case.placed is None else case.placed.model.id,
            *parts,
            grades=(a, b, c, d),
            score=combined((a, b, c, d)),
            equivalent=a == b == 2 and c >= 1,
            details=details,
        )


def grade(part: float) -> int:
    """2 = kept, 1 = partly, 0 = lost."""
    return int(part >= KEPT - _EQUAL) + int(part >= PARTLY - _EQUAL)


def combined(grades: tuple[int, int, int, int]) -> float:
    """The score of grades, 0 to 1; orders them as words in a dictionary."""
    return sum(w * g for w, g in zip(_WEIGHTS, grades, strict=True)) / (2 * sum(_WEIGHTS))


@dataclasses.dataclass(frozen=True)
class EquivalenceScores:
    """Functional equivalence over all seen true things with a model; missing ones count 0."""

    score: float | None
    class_score: float | None
    """Mean over the classes of their means."""
    equivalent: float | None
    """Share of functionally equivalent things: see `EquivalenceRow.equivalent`."""
    relations: float | None
    affordance: float | None
    geometry: float | None
    appearance: float | None
    articulated_affordance: float | None
    """Mean affordance of the true things that have joints."""
    rows: tuple[EquivalenceRow, ...]

    @staticmethod
    def over(rows: tuple[EquivalenceRow, ...], articulated: set[str]) -> EquivalenceScores:
        """Average the rows; ``articulated`` names the things whose true model has joints."""
        names = sorted({r.class_name for r in rows})
        by_class = [[r.score for r in rows if r.class_name == name] for name in names]
        return EquivalenceScores(
            score=mean(r.score for r in rows),
            class_score=mean(float(np.mean(scores)) for scores in by_class),
            equivalent=mean(float(r.equivalent) for r in rows),
            relations=mean(r.relations for r in rows),
            affordance=mean(r.affordance for r in rows),
            geometry=mean(r.geometry for r in rows),
            appearance=mean(r.appearance for r in rows),
            articulated_affordance=mean(r.affordance for r in rows if r.truth in articulated),
            rows=rows,
        )

    def headline(self) -> Headline:
        parts = (self.relations, self.affordance, self.geometry, self.appearance)
        return (
            ("functional equivalence: score / share", percent(self.score, self.equivalent)),
            ("  relations / affordance / geometry / appearance", percent(*parts)),
        )


def score_equivalence(
    truth: Truth,
    result: Result,
    matches: tuple[Match, ...],
    cases: Sequence[CadCase],
    support: SupportSettings = DEFAULT_SUPPORT,
) -> EquivalenceScores:
    """Score every case; both scenes' supports are compared under the matching of entities.

    ``support`` says which planes may carry (a_th)."""
    supports = true_supports(truth.scene, matches), found_supports(result.scene, matches)
    overlaps = _box_overlaps(cases, result)
    rows = tuple(
        _row(case, truth.scene, supports, result.T_truth_result, overlap, support)
        for case, overlap in zip(cases, overlaps, strict=True)
    )
    articulated = {c.true.name for c in cases if c.true_model.model.articulated}
    return EquivalenceScores.over(rows, articulated)


def _row(
    case: CadCase,
    scene: SceneFile,
    supports: tuple[Supports, Supports],
    T: np.ndarray,
    box_iou: float,
    support: SupportSettings,
) -> EquivalenceRow:
    true, found, placed = case.true, case.found, case.placed
    if found is None:
        return EquivalenceRow.of(case, (0.0, 0.0, 0.0, 0.0), None)
    class_name = found.class_name if placed is None else placed.model.class_name
    offers = _affordance(case, scene, supports[0], T, support)
    details = PartDetails(
        class_agreement(true.class_name, class_name),
        edge_agreement(*supports, true.name),
        *offers,
        size=_size(case, T),
        box_iou=box_iou,
        shape=_shape(case),
        color_difference=_color_difference(case),
    )
    color = details.color_difference
    parts = (
        details.class_same * details.supports,
        # A thing that offers nothing loses nothing.
        min((offer for offer in offers if offer is not None), default=1.0),
        float(np.mean([v for v in (details.size, box_iou, details.shape) if v is not None])),
        0.0 if color is None else 1 - min(1.0, color / _ALIKE_E),
    )
    return EquivalenceRow.of(case, parts, details)


def _affordance(
    case: CadCase, scene: SceneFile, true: Supports, T: np.ndarray, support: SupportSettings
) -> tuple[float | None, float | None, float | None]:
    """Agreement of joints, carrying planes and openable room."""
    assert case.found is not None
    there = moving_parts(case.true_model)
    here: tuple[MovingPart, ...] = () if case.placed is None else moving_parts(case.placed)
    children = [scene.entity(name) for name in sorted(true.children.get(case.true.name, ()))]
    rectangles = carrying_planes(case.found, case.placed, T, support)
    return (
        joint_agreement(there, here),
        carrying_agreement(asked_places(case.true_model, children, support), rectangles),
        volume_agreement(there, here),
    )


def _size(case: CadCase, T: np.ndarray) -> float:
    """1 - (mean error of the sides) / 50 %, along the true model's axes."""
    true = case.true_model
    if case.placed is not None:
        size = case.placed.size_along(true.rotation)
    else:
        assert case.found is not None
        size = _scan_size(case.found, true, T)
    return 1 - min(1.0, float(np.abs(size / true.size - 1).mean()) / _SIZE_SHARE)


def _scan_size(found: EntityRecord, true: PosedModel, T: np.ndarray) -> np.ndarray:
    box = moved_box(found.box, T)
    c, s = np.cos(float(box.yaw)), np.sin(float(box.yaw))
    axes = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    nearest = np.argmax(np.abs(axes.T @ true.rotation), axis=0)
    return np.asarray(box.size, np.float64)[nearest]


def _shape(case: CadCase) -> float | None:
    if case.distance is None:
        return None
    diagonal = float(np.linalg.norm(case.true_model.size))
    return 1 - min(1.0, case.distance.two_way_m / (_FAR_SHARE * diagonal))


def _color_difference(case: CadCase) -> float | None:
    if case.placed is None:
        return None
    true, placed = mean_lab(case.true_model.model.mesh), mean_lab(case.placed.model.mesh)
    return None if true is None or placed is None else delta_e(true, placed)


def _box_overlaps(cases: Sequence[CadCase], result: Result) -> list[float]:
    """IoU of the upright box of each true model with that of what stands for it."""
    with_found = [i for i, case in enumerate(cases) if case.found is not None]
    true = [upright_box(cases[i].true_model) for i in with_found]
    found = [_found_box(cases[i], result) for i in with_found]
    overlaps = [0.0] * len(cases)
    for i, value in zip(with_found, np.diag(box_iou_matrix(true, found)), strict=True):
        overlaps[i] = float(value)
    return overlaps


def _found_box(case: CadCase, result: Result) -> Box:
    assert case.found is not None
    if case.placed is not None:
        return upright_box(case.placed)
    return moved_box(case.found.box, result.T_truth_result)


def upright_box(posed: PosedModel) -> Box:
    """The gravity-aligned box about a model's own box, along its most level axis."""
    R = posed.rotation
    level = int(np.argmin(np.abs(R[2])))
    yaw = float(np.arctan2(R[1, level], R[0, level]))
    c, s = np.cos(yaw), np.sin(yaw)
    size = np.abs(np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]]) @ R) @ posed.size
    return canonical_box(posed.center, yaw, size)
