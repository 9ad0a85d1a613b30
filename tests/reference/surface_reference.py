"""Slow twin of the surface extraction: cell by cell, edge by edge, on a dictionary of voxels."""

from __future__ import annotations

import collections
import itertools

import numpy as np

CORNERS = list(itertools.product((0, 1), repeat=3))
EDGES = [
    (a, tuple(np.add(a, step)))
    for a in CORNERS
    for step in np.eye(3, dtype=int)
    if tuple(np.add(a, step)) in CORNERS
]


def surface_nets(sdf_m: dict, max_jump_m: float, voxel_m: float):
    """Vertices by cell, and faces as cycles of four cells, of observed voxels {place: distance}."""
    vertices = {}
    for cell in sdf_m:
        values = {c: sdf_m.get(tuple(np.add(cell, c))) for c in CORNERS}
        if any(v is None for v in values.values()):
            continue
        low, high = min(values.values()), max(values.values())
        if not low < 0 <= high or high - low >= max_jump_m:
            continue
        crossings = []
        for a, b in EDGES:
            u, v = float(values[a]), float(values[b])
            if (u < 0) != (v < 0):
                crossings.append(np.add(a, np.subtract(b, a) * u / (u - v)))
        vertices[cell] = (np.add(cell, 0.5) + np.mean(crossings, 0)) * voxel_m
    quads = []
    for cell in vertices:
        for axis in range(3):
            step = np.eye(3, dtype=int)
            starts_inside = sdf_m[cell] < 0
            if starts_inside == (sdf_m[tuple(np.add(cell, step[axis]))] < 0):
                continue
            b, c = step[(axis + 1) % 3], step[(axis + 2) % 3]
            around = [tuple(np.subtract(cell, s)) for s in (0 * b, b, b + c, c)]
            if all(a in vertices for a in around):
                quads.append(around if starts_inside else around[::-1])
    return vertices, quads


def cell_label(cell, leading: dict) -> int:
    """The label that a cell's corners counted most, or the first, of {place: (label, count)}."""
    votes = collections.Counter()
    for corner in CORNERS:
        label, count = leading[tuple(np.add(cell, corner))]
        votes[label] += count
    return max(votes, key=votes.__getitem__)
