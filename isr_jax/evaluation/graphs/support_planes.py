"""Heights of supporting planes: how deep the plane lies on which a thing is said to stand."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping

import numpy as np
from jaxtyping import Float

from ...geometry import plane_heights
from ...scene_file import ROOM_NAME, EntityRecord, PlaneRecord, SceneFile
from ..figures import Headline, median, millimetres, percent, share
from ..matches import Match
from ..result_files import Result, Truth

NEAR_M = 0.02
_LEAST_SLOPE = 0.5
"""Planes steeper than 60 degrees have no height to stand on."""


@dataclasses.dataclass(frozen=True)
class SupportPlaneRow:
    """One found thing that a plane truly carries."""

    truth: str
    error_m: float | None
    """|Height of the predicted supporting plane - height of the true one|, both at the centre of
    the true thing's box; None where the result names no plane."""
    same_parent: bool
    """Whether the planes are of the same entity (of layout: of the same class)."""


@dataclasses.dataclass(frozen=True)
class SupportPlaneScores:
    """Errors of the heights of supporting planes."""

    median_m: float | None
    """Over things with a predicted plane, of the right parent or not."""
    near_share: float | None
    """Share within 2 cm of all found things that a plane truly carries; without one is wrong."""
    rows: tuple[SupportPlaneRow, ...]

    @staticmethod
    def over(rows: tuple[SupportPlaneRow, ...]) -> SupportPlaneScores:
        """Summarise the rows."""
        errors = [r.error_m for r in rows if r.error_m is not None]
        near = sum(error <= NEAR_M for error in errors)
        return SupportPlaneScores(median(errors), share(near, len(rows)), rows)

    def headline(self) -> Headline:
        return (
            ("supporting plane's height, median error", millimetres(self.median_m)),
            ("supporting plane within 2 cm", percent(self.near_share)),
        )


def score_support_planes(
    truth: Truth, result: Result, matches: tuple[Match, ...]
) -> SupportPlaneScores:
    """Compare the planes that carry each found thing."""
    true_of = {m.predicted: m.truth for m in matches if m.predicted is not None}
    rows = []
    for match in matches:
        child = truth.scene.entity(match.truth)
        true = _carrier(truth.scene, child)
        if match.predicted is None or true is None:
            continue
        at = np.asarray(child.box.center, np.float64)
        height = height_of_plane(true[1], at, np.eye(4))
        if height is None:
            continue
        guess = _carrier(result.scene, result.scene.entity(match.predicted))
        if guess is None:
            rows.append(SupportPlaneRow(match.truth, None, False))
            continue
        other = height_of_plane(guess[1], at, result.T_truth_result)
        error_m = None if other is None else abs(other - height)
        rows.append(SupportPlaneRow(match.truth, error_m, _same(true[0], guess[0], true_of)))
    return SupportPlaneScores.over(tuple(rows))


def _carrier(scene: SceneFile, child: EntityRecord) -> tuple[EntityRecord, PlaneRecord] | None:
    """The parent and its plane that carries; None where no plane is named."""
    if child.parent is None or child.parent == ROOM_NAME or child.support_plane is None:
        return None
    parent = scene.entity(child.parent)
    if child.support_plane >= len(parent.planes):
        return None
    return parent, parent.planes[child.support_plane]


def _same(true: EntityRecord, guess: EntityRecord, true_of: Mapping[str, str]) -> bool:
    if true.type == "layout":
        return guess.type == "layout" and guess.class_name == true.class_name
    return true_of.get(guess.name) == true.name


def height_of_plane(
    plane: PlaneRecord, at: Float[np.ndarray, "3"], T: Float[np.ndarray, "4 4"]
) -> float | None:
    """z of a plane, brought to another world by ``T``, above the x and y of ``at``, metres.

    None for planes steeper than 60 degrees.
    """
    normal = T[:3, :3] @ np.asarray(plane.normal, np.float64)
    if abs(normal[2]) < _LEAST_SLOPE:
        return None
    offset = np.asarray(plane.offset - normal @ T[:3, 3])
    return float(plane_heights(normal, offset, at[:2]))
