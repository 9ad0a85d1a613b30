"""Where in a room a hand-held camera can be, and the ways between such places."""

from __future__ import annotations

import dataclasses

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.sparse import csgraph, csr_matrix

from ...errors import SceneError
from ..room import Room

CLEAR_M = 0.2
"""Nearer to the box of an item no eye is, on any way."""
_EYE_CLEAR_M = 0.35
_WAY_CLEAR_M = 0.3
"""Of places and of the middles between them; half a step is less than what is left to `CLEAR_M`."""
_WALL_M = 0.4
"""Of places, from walls, floor and ceiling."""
_STEP_M = 0.4
_HEIGHTS_M = (1.15, 1.45, 1.75)
_SAMPLE_M = 0.05
"""Between points at which a straight way is checked."""


@dataclasses.dataclass(frozen=True, eq=False)
class FreeSpace:
    """Places that hang together."""

    eyes: Float[np.ndarray, "eyes 3"]
    """World frame, metres."""
    previous: Int[np.ndarray, "eyes eyes"]
    """``previous[a, b]``: the place before b on the shortest way from a."""
    length_m: Float[np.ndarray, "eyes eyes"]
    """Of that way."""


def free_space(room: Room, seed: int) -> FreeSpace:
    """Eye positions on a grid, at the heights of hands and heads, clear of everything.

    Raises:
        SceneError: no place in the room is clear.
    """
    T = np.asarray(room.T_world_room, np.float64)
    grid = _grid(np.asarray(room.size, np.float64), np.random.default_rng([seed, 3]))
    eyes = grid @ T[:3, :3].T + T[:3, 3]
    for share in (1.0, 0.75, 0.6):
        free = eyes[clearance_m(room, eyes) > share * _EYE_CLEAR_M]
        if len(free):
            ways = _ways(room, free, max(share * _WAY_CLEAR_M, CLEAR_M))
            _, group = csgraph.connected_components(ways, directed=False)
            largest = np.flatnonzero(group == np.argmax(np.bincount(group)))
            ways = ways[largest][:, largest]
            length, previous = csgraph.shortest_path(ways, return_predecessors=True)
            return FreeSpace(free[largest], previous, length)
    raise SceneError(
        f"{room.name}: no place in it is {0.6 * _EYE_CLEAR_M:.2f} m clear of things at the "
        f"heights {_HEIGHTS_M} m",
        "use another seed",
    )


def clearance_m(room: Room, points: Float[np.ndarray, "points 3"]) -> Float[np.ndarray, " points"]:
    """Distance to the nearest item's box, world frame; 0 inside one."""
    gap = np.full(len(points), np.inf)
    for item in room.items:
        local = (points - item.center) @ np.asarray(item.T_world_cad[:3, :3], np.float64)
        outside = np.abs(local) - item.scale * np.asarray(item.model.size, np.float64) / 2
        gap = np.minimum(gap, np.linalg.norm(np.maximum(outside, 0), axis=1))
    return gap


def inside_room(
    room: Room, points: Float[np.ndarray, "points 3"], margin_m: float
) -> Bool[np.ndarray, " points"]:
    """Whether points are so far from walls, floor and the ceiling's height, world frame."""
    T = np.asarray(room.T_world_room, np.float64)
    local = (points - T[:3, 3]) @ T[:3, :3]
    size = np.asarray(room.size, np.float64)
    level = np.all(np.abs(local[:, :2]) <= size[:2] / 2 - margin_m, axis=1)
    return level & (local[:, 2] >= margin_m) & (local[:, 2] <= size[2] - margin_m)


def straight(room: Room, start: np.ndarray, end: np.ndarray, clear_m: float) -> bool:
    """Whether the straight way between two points stays clear."""
    count = 2 + int(np.linalg.norm(end - start) / _SAMPLE_M)
    points = start + np.linspace(0, 1, count)[:, None] * (end - start)
    return bool(clearance_m(room, points).min() > clear_m)


def route(room: Room, space: FreeSpace, start: int, end: int) -> Float[np.ndarray, "points 3"]:
    """Way points from one place to another, both included; corners that need not be are cut."""
    chain = [end]
    while chain[-1] != start:
        chain.append(int(space.previous[start, chain[-1]]))
    points = space.eyes[chain[::-1]]
    kept, at = [0], 0
    while at < len(points) - 1:
        ahead = range(len(points) - 1, at, -1)
        clear = (i for i in ahead if straight(room, points[at], points[i], 1.15 * CLEAR_M))
        at = next(clear, at + 1)
        kept.append(at)
    return points[kept]


def _grid(size: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Room frame; the grid lies anywhere."""
    axes = []
    for side in size[:2]:
        half = max(side / 2 - _WALL_M, 0.0)
        axes.append(np.arange(-half + rng.uniform(0, min(_STEP_M, half + 1e-9)), half, _STEP_M))
    heights = [z for z in _HEIGHTS_M if z <= size[2] - _WALL_M] or [size[2] / 2]
    return np.stack(np.meshgrid(*axes, heights, indexing="ij"), -1).reshape(-1, 3)


def _ways(room: Room, eyes: np.ndarray, clear_m: float) -> csr_matrix:
    """Lengths of straight ways between neighbours whose middle is clear too."""
    gap = np.linalg.norm(eyes[:, None] - eyes[None], axis=2)
    a, b = np.nonzero(np.triu(gap < 1.8 * _STEP_M, 1))
    clear = clearance_m(room, (eyes[a] + eyes[b]) / 2) > clear_m
    a, b = a[clear], b[clear]
    return csr_matrix((gap[a, b], (a, b)), shape=(len(eyes), len(eyes))) + csr_matrix(
        (gap[a, b], (b, a)), shape=(len(eyes), len(eyes))
    )
