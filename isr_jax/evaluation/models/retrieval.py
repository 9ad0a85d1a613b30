"""Retrieval: is the model that stands for a thing, or one of the ten best, the right one?

Models scale, so another model may be as right as the true one. A hit is the true model itself, or
one whose surface lies within 2 cm of the true one (two-way Chamfer distance, mean of lengths)
after alignment. The placed model is compared where it stands, the true one in its true pose. Of
the other candidates no pose is known; they are compared in canonical pose: boxes centred, each in
the 24 rotations of the cube, each scaled alike along all axes so that its box fits the true one
best (least squares of the three sides).

Two centimetres are much for a chair and everything for a cup: almost any cup is a hit. So the same
shares are given a second time with a limit that goes with size, 2 % of the true model's diagonal
(2.2 cm for a chair, 3 mm for a cup).
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence

import numpy as np
from jaxtyping import Float
from scipy.spatial import KDTree

from ...geometry import CUBE_ROTATIONS
from ...library import CadLibrary, CadModel
from ...types import Candidate
from ..figures import mean
from .cad_cases import CadCase, PosedModel, model_named, same_model
from .chamfer import model_surface, surface_distance

HIT_M = 0.02
RELATIVE = 0.02
"""Of the true model's diagonal."""
TOP = 10
_COARSE = 128
"""Points a model by which the rotations are ranked."""
_TRIED = 3
"""Rotations compared exactly, after a ranking by distances between points, whose error, the spacing
of the points, is the same for all."""
_BOX_SLACK = 0.1
"""Rotations whose boxes fit worse than the best by more than this share of the diagonal are not
ranked: a shelf on its side is no shelf."""


def fitted_scale(true_size: Float[np.ndarray, "3"], size: Float[np.ndarray, "3"]) -> float:
    """The one factor s that brings a box nearest another: min_s |true - s size|^2."""
    return float(true_size @ size / (size @ size))


class FittedShapes:
    """Distances between models after the best fit; each pair is compared once."""

    def __init__(self) -> None:
        self._known: dict[tuple, float | None] = {}

    def distance_m(self, true: CadModel, scale: np.ndarray, other: CadModel) -> float | None:
        """Chamfer distance between ``true``, scaled by ``scale`` [3], and the fitted ``other``."""
        key = (true.content_hash, tuple(np.round(scale, 5).tolist()), other.content_hash)
        if key not in self._known:
            self._known[key] = fitted_distance_m(true, scale, other)
        return self._known[key]


def fitted_distance_m(
    true: CadModel, scale: Float[np.ndarray, "3"], other: CadModel
) -> float | None:
    """Two-way Chamfer distance after the best rotation and scale, metres; None without surface."""
    surface = model_surface(true, np.eye(4), scale)
    if len(surface.triangles) == 0 or len(other.samples.points) == 0:
        return None
    poses = _fitting_poses(np.asarray(true.size, np.float64) * scale, other)
    rough = _rough_distances(surface.points, other.samples.points, poses)
    found = []
    for k in np.argsort(rough, kind="stable")[:_TRIED]:
        R, s = poses[k]
        T = np.eye(4)
        T[:3, :3] = R
        each = surface_distance(surface, model_surface(other, T, np.full(3, s)))
        found += [] if each is None else [each.two_way_m]
    return min(found, default=None)


def _fitting_poses(size: np.ndarray, other: CadModel) -> list[tuple[np.ndarray, float]]:
    """The rotations of ``other``, each with its scale, whose boxes come near a box of ``size``."""
    turned = np.abs(CUBE_ROTATIONS.astype(np.float64)) @ np.asarray(other.size, np.float64)
    scales = np.array([fitted_scale(size, each) for each in turned])
    off = np.linalg.norm(scales[:, None] * turned - size, axis=1)
    near = np.flatnonzero(off <= off.min() + _BOX_SLACK * np.linalg.norm(size))
    return [(CUBE_ROTATIONS[k].astype(np.float64), float(scales[k])) for k in near.tolist()]


def _rough_distances(
    a: np.ndarray, b: np.ndarray, poses: Sequence[tuple[np.ndarray, float]]
) -> np.ndarray:
    """[poses] Chamfer distance between points ``a`` and the turned and scaled points ``b``."""
    of_a, of_b = KDTree(a), KDTree(b)
    some_a, some_b = (p[:: max(1, len(p) // _COARSE)] for p in (a, b))
    rough = []
    for R, s in poses:
        there, _ = of_a.query(s * some_b @ R.T)
        back, _ = of_b.query(some_a @ R / s)
        rough.append(np.mean(there) + s * np.mean(back))
    return np.array(rough)


@dataclasses.dataclass(frozen=True)
class RetrievalRow:
    """One true thing, and how near the retrieved models come to its own."""

    truth: str
    class_name: str
    true_id: str
    found: bool
    """Whether any entity stands for it."""
    id: str | None
    """The placed model."""
    same: bool
    """It is the true one."""
    placed_m: float | None
    """Chamfer distance of the placed model where it stands."""
    shape_m: float | None
    """Chamfer distance of the placed model after the best fit: its shape alone."""
    best_shape_m: float | None
    """The smallest of the ten best candidates."""
    rank: int | None
    """Place (from 1, in the order of the matching error, each model once) of the first hit."""
    rank_same: int | None
    """Place of the true model."""
    top1: bool
    """The placed model is a hit."""
    top1_shape: bool
    """The placed model is a hit if pose and scale are not asked for."""
    top10: bool
    """The placed model or one of the ten best is a hit."""
    top1_relative: bool
    """As ``top1``, within 2 % of the true model's diagonal."""
    top10_relative: bool


def _near(distance_m: float | None, limit_m: float = HIT_M) -> bool:
    return distance_m is not None and distance_m <= limit_m


@dataclasses.dataclass(frozen=True)
class RetrievalScores:
    """Shares of true models retrieved; those of missing things are missed."""

    top1: float | None
    """The placed model is the true one, or within 2 cm of it where it stands."""
    top1_same: float | None
    """The placed model is the true one."""
    top1_shape: float | None
    """As ``top1``, of the shape alone."""
    top1_matching: float | None
    """The model of the smallest matching error is a hit: before alignment and physics."""
    top10: float | None
    top10_same: float | None
    class_top1: float | None
    """``top1`` averaged over classes."""
    class_top10: float | None
    top1_of_found: float | None
    """``top1`` among the things for which an entity stands."""
    top10_of_found: float | None
    top1_relative: float | None
    """As ``top1``, within 2 % of the true model's diagonal."""
    top10_relative: float | None
    rows: tuple[RetrievalRow, ...]

    @staticmethod
    def over(rows: tuple[RetrievalRow, ...]) -> RetrievalScores:
        """Average the rows."""
        groups = [
            [r for r in rows if r.class_name == name]
            for name in sorted({r.class_name for r in rows})
        ]
        found = [r for r in rows if r.found]
        return RetrievalScores(
            top1=mean(r.top1 for r in rows),
            top1_same=mean(r.same for r in rows),
            top1_shape=mean(r.top1_shape for r in rows),
            top1_matching=mean(r.rank == 1 for r in rows),
            top10=mean(r.top10 for r in rows),
            top10_same=mean(r.same or r.rank_same is not None for r in rows),
            class_top1=mean(float(np.mean([r.top1 for r in g])) for g in groups),
            class_top10=mean(float(np.mean([r.top10 for r in g])) for g in groups),
            top1_of_found=mean(r.top1 for r in found),
            top10_of_found=mean(r.top10 for r in found),
            top1_relative=mean(r.top1_relative for r in rows),
            top10_relative=mean(r.top10_relative for r in rows),
            rows=rows,
        )


def score_retrieval(cases: Sequence[CadCase], library: CadLibrary) -> RetrievalScores:
    """Compare placed models and candidates with the true models.

    Args:
        cases: Every seen true thing with a model.
        library: The result's models.

    Raises:
        SceneError: a candidate is not in the library.
    """
    shapes = FittedShapes()
    return RetrievalScores.over(tuple(_row(case, library, shapes) for case in cases))


def best_candidates(candidates: Sequence[Candidate]) -> list[str]:
    """The `TOP` models of the smallest matching errors, each once (it may come in many turns)."""
    ordered = sorted(candidates, key=lambda c: c.matching_error)
    return list(dict.fromkeys(c.cad_id for c in ordered))[:TOP]


def _row(case: CadCase, library: CadLibrary, shapes: FittedShapes) -> RetrievalRow:
    true, placed = case.true_model, case.placed
    ids = [] if case.found is None else best_candidates(case.found.candidates)
    models = [model_named(id, library) for id in ids]
    same = [same_model(model, true.model) for model in models]
    fits = [
        0.0 if is_true else shapes.distance_m(true.model, true.scale, model)
        for model, is_true in zip(models, same, strict=True)
    ]
    rank = next((k for k, f in enumerate(fits, 1) if _near(f)), None)
    is_same = placed is not None and same_model(placed.model, true.model)
    placed_m = None if case.distance is None else case.distance.two_way_m
    shape_m = None if placed is None else _shape_m(true, placed.model, shapes)
    top1 = is_same or _near(placed_m)
    limit_m = RELATIVE * float(np.linalg.norm(true.size))
    relative = is_same or _near(placed_m, limit_m)
    return RetrievalRow(
        truth=case.true.name,
        class_name=case.true.class_name,
        true_id=true.model.id,
        found=case.found is not None,
        id=None if placed is None else placed.model.id,
        same=is_same,
        placed_m=placed_m,
        shape_m=shape_m,
        best_shape_m=min((f for f in fits if f is not None), default=None),
        rank=rank,
        rank_same=same.index(True) + 1 if True in same else None,
        top1=top1,
        top1_shape=is_same or _near(shape_m),
        top10=top1 or rank is not None,
        top1_relative=relative,
        top10_relative=relative or any(_near(f, limit_m) for f in fits),
    )


def _shape_m(true: PosedModel, model: CadModel, shapes: FittedShapes) -> float | None:
    if same_model(model, true.model):
        return 0.0
    return shapes.distance_m(true.model, true.scale, model)
