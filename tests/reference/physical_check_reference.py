"""Slow twins of the physical check: Minkowski hulls, exhaustive choice, areas by counting."""

from __future__ import annotations

import itertools

import numpy as np
from scipy.spatial import ConvexHull


def penetration(a, b):
    """Distance from the origin to the boundary of the hull of all differences; 0 when outside."""
    hull = ConvexHull((a[:, None] - b[None]).reshape(-1, 3))
    return max(0.0, float(-hull.equations[:, 3].max()))


def best_choice(errors, neighbours, conflict):
    """Fewest conflicts that any choice has."""
    best = None
    for choice in itertools.product(*(range(len(e)) for e in errors)):
        count = sum(
            conflict(i, choice[i], j, choice[j]) > 0
            for i in range(len(errors))
            for j in neighbours[i]
            if i < j
        )
        best = count if best is None else min(best, count)
    return best


def inside(quad, points):
    """Which points lie in a counter-clockwise convex quadrilateral."""
    keep = np.ones(len(points), bool)
    for a, b in zip(quad, np.roll(quad, -1, axis=0), strict=True):
        along, off = b - a, points - a
        keep &= along[0] * off[:, 1] - along[1] * off[:, 0] >= 0
    return keep


def contact_ratio(plane, footprint, steps=400):
    """Share of a grid over the footprint that the plane covers."""
    u = (np.arange(steps) + 0.5) / steps
    a, b = footprint[1] - footprint[0], footprint[3] - footprint[0]
    points = footprint[0] + u[:, None, None] * a + u[None, :, None] * b
    return inside(plane, points.reshape(-1, 2)).mean()
