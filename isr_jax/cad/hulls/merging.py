"""Fewer hulls: those inside others go, neighbours that make one convex body become one."""

from __future__ import annotations

import numpy as np

from .solid import Hull, hull_of

_GROWTH = 1.5
_NEIGHBOURS = 12


def merged(hulls: list[Hull], tolerance_m: float, max_hulls: int) -> tuple[list[Hull], float]:
    """The hulls merged while unions swell by at most the tolerance; and the tolerance used.

    It grows by half until no more than ``max_hulls`` are left.
    """
    hulls = _without_contained(hulls, tolerance_m / 2)
    hulls = _merge_round(hulls, tolerance_m)
    while len(hulls) > max_hulls:
        tolerance_m *= _GROWTH
        hulls = _merge_round(hulls, tolerance_m)
    return hulls, tolerance_m


def _without_contained(hulls: list[Hull], slack_m: float) -> list[Hull]:
    """Hulls that do not lie inside a larger one, give or take the slack."""
    kept: list[Hull] = []
    for hull in sorted(hulls, key=lambda h: -h.volume):
        if not any(
            np.all(hull.low >= big.low - slack_m)
            and np.all(hull.high <= big.high + slack_m)
            and big.height(hull.points).max() <= slack_m
            for big in kept
        ):
            kept.append(hull)
    return kept


def _merge_round(hulls: list[Hull], tolerance_m: float) -> list[Hull]:
    """Merge near pairs, best first, until none fits."""
    alive: dict[int, Hull] = dict(enumerate(hulls))
    pairs = [c for i in alive for c in _candidates(i, alive, tolerance_m, later=True)]
    while pairs:
        pairs.sort(key=lambda p: p[0])
        _, i, j, union = pairs[0]
        new = max(alive) + 1
        del alive[i], alive[j]
        alive[new] = union
        pairs = [p for p in pairs if not {p[1], p[2]} & {i, j}]
        pairs += _candidates(new, alive, tolerance_m, later=False)
    return list(alive.values())


def _candidates(
    i: int, alive: dict[int, Hull], tolerance_m: float, *, later: bool
) -> list[tuple[float, int, int, Hull]]:
    """Unions of a hull with its nearest neighbours that swell little enough."""
    a, near = alive[i], []
    for j, b in alive.items():
        if j != i and (j > i or not later):
            gap = float(np.maximum(np.maximum(a.low - b.high, b.low - a.high), 0).max())
            if gap <= 2 * tolerance_m:
                near.append((gap, j))
    found = []
    for _, j in sorted(near)[: max(_NEIGHBOURS, 0)]:
        union = hull_of(np.concatenate([a.points, alive[j].points]))
        swell = union_swelling(union, a, alive[j])
        if swell <= tolerance_m:
            found.append((swell, min(i, j), max(i, j), union))
    return found


def union_swelling(union: Hull, a: Hull, b: Hull) -> float:
    """How far the union's faces lie above both hulls, a lower bound of the distance, metres."""
    corners = union.points[union.faces]
    points = np.concatenate(
        [corners.mean(1), (corners + np.roll(corners, 1, 1)).reshape(-1, 3) / 2]
    )
    return float(np.minimum(a.height(points), b.height(points)).max(initial=0.0))
