"""Models of half-seen entities: tried flush with the sides of the box that was seen (host)."""

from __future__ import annotations

import dataclasses
import itertools
from collections.abc import Sequence

import jax
import numpy as np
from jaxtyping import Float

from ..config import AlignmentSettings
from ..geometry import rot_z
from ..types import AlignmentStatus
from .builders import spread
from .error import alignment_errors
from .problem import AlignmentProblem, AlignmentSolution, AlignmentWeights
from .solve import cost_at

_POINTS = 256
"""Of an entity, to compare places by."""
_TALL = 0.5
"""Height over the longest side from which the height of a box tells the scale."""
_CLEARLY = 0.8
"""AE falls at least to this share where a model is moved: the solution is the better guess."""


@dataclasses.dataclass(frozen=True, eq=False)
class _Place:
    """Where a model may be instead."""

    row: int
    scale: float
    yaw: float
    T_world_cad: Float[np.ndarray, "4 4"]


def slide_hidden(
    problem: AlignmentProblem,
    weights: AlignmentWeights,
    solution: AlignmentSolution,
    points: Sequence[np.ndarray],
    triangles: Sequence[np.ndarray],
    settings: AlignmentSettings,
) -> AlignmentSolution:
    """Solutions, moved flush with the box where that makes AE clearly smaller.

    Of a chair under a table the back alone may be seen. Its box is thin, the model sticks out of
    it, and neither box nor planes say to which side. So wherever the model is longer than the box
    by more than ``slide_hidden_m``, the places flush with either side of the box are tried as
    well. What is moved has the cost of its new place and says `AlignmentStatus.SLID`.

    Args:
        problem: What was solved.
        weights: As in the solve.
        solution: On the host.
        points: Vertices of the entity of each pair, without the padding, world frame.
        triangles: Of the model of each pair, canonical frame.
        settings: As in the solve.
    """
    places = _places(problem, solution, len(points), settings)
    if not places:
        return solution
    rows = np.array([place.row for place in places])
    poses = np.stack([place.T_world_cad for place in places]).astype(np.float32)
    errors = alignment_errors(
        poses,
        np.array([place.scale for place in places], np.float32),
        [spread(points[i], _POINTS) for i in rows],
        [triangles[i] for i in rows],
    )
    chosen = []
    for row in np.unique(rows):
        tried = np.flatnonzero(rows == row)
        best = tried[np.argmin(errors[tried])]
        if errors[best] < _CLEARLY * errors[tried[0]]:
            chosen.append(places[best])
    return _moved(problem, weights, solution, chosen, settings)


def _moved(
    problem: AlignmentProblem,
    weights: AlignmentWeights,
    solution: AlignmentSolution,
    places: list[_Place],
    settings: AlignmentSettings,
) -> AlignmentSolution:
    """The solution with some pairs at other places, and what holds of them there."""
    if not places:
        return solution
    scale, yaw, T, cost, status = (
        np.array(field)
        for field in (
            solution.scale,
            solution.yaw,
            solution.T_world_cad,
            solution.cost,
            solution.status,
        )
    )
    rows = [place.row for place in places]
    scale[rows] = [place.scale for place in places]
    yaw[rows] = [place.yaw for place in places]
    T[rows] = [place.T_world_cad for place in places]
    there = cost_at(problem, weights, scale, yaw, T[:, :3, 3], settings)
    cost[rows], status[rows] = np.asarray(there)[rows], AlignmentStatus.SLID
    return dataclasses.replace(
        solution,
        scale=scale,
        yaw=yaw,
        translation=T[:, :3, 3],
        T_world_cad=T,
        cost=cost,
        status=status,
    )


def _places(
    problem: AlignmentProblem, solution: AlignmentSolution, count: int, settings: AlignmentSettings
) -> list[_Place]:
    """The places to try for the first ``count`` pairs; the first of each pair is where it is.

    A pair that was not solved stays as it is: its status says that it is of no use.
    """
    turns = np.asarray(jax.vmap(rot_z)(problem.box.yaw))
    found = []
    for i in range(count):
        if not AlignmentStatus(int(solution.status[i])).usable:
            continue
        if flush := _flush_places(problem, solution, i, turns[i], settings):
            here = float(solution.scale[i]), float(solution.yaw[i])
            found += [_Place(i, *here, np.asarray(solution.T_world_cad[i])), *flush]
    return found


def _flush_places(
    problem: AlignmentProblem,
    solution: AlignmentSolution,
    i: int,
    turn: Float[np.ndarray, "3 3"],
    settings: AlignmentSettings,
) -> list[_Place]:
    """Places of pair ``i`` flush with its box; none where the model does not stick out of it.

    Of a half-seen thing planes are few, one wrong partner turns a model, and the thin box shrinks
    it: so the yaw of the box and the scale of equal heights are tried.
    """
    size = np.abs(problem.rotation[i]) @ problem.model_size[i]
    box = np.asarray(problem.box.size[i])
    scale = float(solution.scale[i])
    if box[2] >= _TALL * box.max():
        scale = float(np.clip(box[2] / size[2], settings.scale_min, settings.scale_max))
    beyond = (scale * size - box)[:2].tolist()
    if max(beyond) <= settings.slide_hidden_m:
        return []
    ways = [(0.0, e / 2, -e / 2) if e > settings.slide_hidden_m else (0.0,) for e in beyond]
    found = []
    for x, y in itertools.product(*ways):
        T = np.eye(4)
        T[:3, :3] = turn @ problem.rotation[i]
        T[:3, 3] = problem.box.center[i] + turn @ np.array([x, y, 0.0])
        T[2, 3] = problem.support_height_m[i] + scale * size[2] / 2
        found.append(_Place(i, scale, float(problem.box.yaw[i]), T))
    return found
