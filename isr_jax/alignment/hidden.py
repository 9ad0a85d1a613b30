"""Models of half-seen entities: tried flush with the sides of the box that was seen (host)."""

from __future__ import annotations

import dataclasses
import itertools
from collections.abc import Sequence

import jax
import numpy as np
from jaxtyping import Float

from ..geometry import rot_z
from .error import alignment_errors
from .problem import AlignmentProblem, AlignmentSolution

_POINTS = 256
"""Of an entity, to compare places by."""
_TALL = 0.5
"""Height over the longest side from which the height of a box tells the scale."""
_CLEARLY = 0.8
"""AE falls at least to this share where a model is moved: the solution is the better guess."""


def spread(vertices: np.ndarray, max_points: int) -> np.ndarray:
    """At most ``max_points`` vertices, evenly spread over their order."""
    if len(vertices) <= max_points:
        return vertices
    return vertices[np.linspace(0, len(vertices) - 1, max_points).astype(int)]


def slide_hidden(
    problem: AlignmentProblem,
    solution: AlignmentSolution,
    points: Sequence[np.ndarray],
    triangles: Sequence[np.ndarray],
    slack_m: float,
    scale_bounds: tuple[float, float],
) -> AlignmentSolution:
    """Solutions, moved flush with the box where that makes AE clearly smaller.

    Of a chair under a table the back alone may be seen. Its box is thin, the model sticks out of
    it, and neither box nor planes say to which side. So wherever the model is longer than the box
    by more than ``slack_m``, the places flush with either side of the box are tried as well.
    """
    places = _places(problem, solution, slack_m, scale_bounds)
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
    scale, yaw, T = (
        np.array(field) for field in (solution.scale, solution.yaw, solution.T_world_cad)
    )
    for row in np.unique(rows):
        tried = np.flatnonzero(rows == row)
        best = tried[np.argmin(errors[tried])]
        if errors[best] < _CLEARLY * errors[tried[0]]:
            scale[row], yaw[row], T[row] = places[best].scale, places[best].yaw, poses[best]
    return dataclasses.replace(
        solution, scale=scale, yaw=yaw, translation=T[:, :3, 3], T_world_cad=T
    )


@dataclasses.dataclass(frozen=True, eq=False)
class _Place:
    """Where a model may be instead."""

    row: int
    scale: float
    yaw: float
    T_world_cad: Float[np.ndarray, "4 4"]


def _places(
    problem: AlignmentProblem,
    solution: AlignmentSolution,
    slack_m: float,
    scale_bounds: tuple[float, float],
) -> list[_Place]:
    """The places to try; the first of each pair is where it is.

    Of a half-seen thing planes are few, one wrong partner turns a model, and the thin box shrinks
    it: so the yaw of the box and the scale of equal heights are tried.
    """
    found = []
    turns = np.asarray(jax.vmap(rot_z)(problem.box.yaw))
    for i, turn in enumerate(turns[: len(solution.scale)]):
        size = np.abs(problem.rotation[i]) @ problem.model_size[i]
        box = np.asarray(problem.box.size[i])
        scale = float(solution.scale[i])
        if box[2] >= _TALL * box.max():
            scale = float(np.clip(box[2] / size[2], *scale_bounds))
        ways = [(0.0, e / 2, -e / 2) if e > slack_m else (0.0,)
                for e in (scale * size - box)[:2].tolist()]  # fmt: skip
        if max(map(len, ways)) == 1:
            continue
        T_found = np.asarray(solution.T_world_cad[i])
        here = float(solution.scale[i]), float(solution.yaw[i]), T_found
        found.append(_Place(i, *here))
        for x, y in itertools.product(*ways):
            T = np.eye(4)
            T[:3, :3] = turn @ problem.rotation[i]
            T[:3, 3] = problem.box.center[i] + turn @ np.array([x, y, 0.0])
            T[2, 3] = problem.support_height_m[i] + scale * size[2] / 2
            found.append(_Place(i, scale, float(problem.box.yaw[i]), T))
    return found
