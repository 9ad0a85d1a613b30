"""Hulls of different links parted, so that no part of a model presses on another."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float

from ...geometry import convex_part, penetration
from .solid import Hull, cut

GAP_M = 0.001
"""Left between hulls that were cut."""
MAX_SWEPT_OVERLAP_M = 0.015
"""Deeper overlaps away from rest are no fault of the hulls: something is in the way there."""
_TOLERANCE_M = 1e-4
_ROUNDS = 3


def parted(
    links: list[list[Hull]], poses: Float[np.ndarray, "poses links 4 4"]
) -> tuple[list[list[Hull]], float]:
    """The hulls of each link, cut where they reach into another's; the deepest overlap at rest.

    Each pair is cut by the plane that parts it with the least loss, the thicker of the two more.
    A hull of which nothing would be left goes.

    Args:
        links: Hulls of each link, its own frame.
        poses: ``T_model_link``: first at rest, where all overlaps go, then with joints opened,
            where those go that are not deep.
    """
    hulls: list[list[Hull | None]] = [list(own) for own in links]
    deepest = 0.0
    for _ in range(_ROUNDS):
        depth = _part_at(hulls, poses[0], np.inf)
        deepest = max(deepest, depth)
        if depth == 0.0:
            break
    for opened in poses[1:]:
        _part_at(hulls, opened, MAX_SWEPT_OVERLAP_M)
    return [[h for h in own if h is not None] for own in hulls], deepest


def _part_at(hulls: list[list[Hull | None]], poses: np.ndarray, most_m: float) -> float:
    """Cut all pairs of different links apart in one pose; the deepest overlap found."""
    owners = [(i, k) for i, own in enumerate(hulls) for k, hull in enumerate(own) if hull]
    if not owners:
        return 0.0
    link = np.array([i for i, _ in owners])
    low, high = np.array([_bounds(hulls[i][k], poses[i]) for i, k in owners]).transpose(1, 0, 2)
    near = np.all((low[:, None] <= high) & (low <= high[:, None]), axis=2)
    near &= link[:, None] < link
    deepest = 0.0
    for a, b in np.argwhere(near).tolist():
        (i, k), (j, m) = owners[a], owners[b]
        one, two = hulls[i][k], hulls[j][m]
        if one is not None and two is not None:
            T = np.linalg.inv(poses[i]) @ poses[j]
            depth, hulls[i][k], hulls[j][m] = _part_pair(one, two, T, most_m)
            deepest = max(deepest, depth)
    return deepest


def _bounds(hull: Hull | None, T: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    assert hull is not None
    points = hull.points @ T[:3, :3].T + T[:3, 3]
    return points.min(0), points.max(0)


def _part_pair(
    a: Hull, b: Hull, T_a_b: np.ndarray, most_m: float
) -> tuple[float, Hull | None, Hull | None]:
    """Both hulls cut apart; the depth to which they overlapped, 0 where they are left."""
    points_b = b.points @ T_a_b[:3, :3].T + T_a_b[:3, 3]
    depth, away = penetration(convex_part(a.points), convex_part(points_b))
    if not _TOLERANCE_M < depth <= most_m:
        return 0.0, a, b
    reach_a, reach_b = np.ptp(a.points @ away), np.ptp(points_b @ away)
    share = reach_a / (reach_a + reach_b)
    # a keeps what lies beyond the plane along ``away``, b what lies before it.
    place = float((a.points @ away).min()) + share * depth
    left_a = cut(a, -away, -(place + GAP_M / 2))
    offset_b = place - GAP_M / 2 - float(away @ T_a_b[:3, 3])
    return depth, left_a, cut(b, T_a_b[:3, :3].T @ away, offset_b)
