"""Strips along a bent line, slanted plates and spikes: handles, arms, straps, flaps, leaves."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import Literal

import numpy as np

from ....robot_model.primitives import BOX_QUADS
from ..solids import Solid, area_vector, prism

Point2 = tuple[float, float]
_END, _START = 1, 3
"""Sides of a strip's piece that touch the next and the one before."""


def upright_prism(
    outline: Sequence[Point2], across: Literal["x", "y"], bounds: tuple[float, float]
) -> Solid:
    """A convex outline in an upright plane, in any sense of rotation, drawn out level.

    The outline is of points (y, z) for bounds along x, and of (x, z) for bounds along y.
    """
    flat = np.array(outline, np.float64)
    if across == "y":
        flat = flat[:, ::-1]
    return prism(_counter_clockwise(flat), across, bounds)


def _counter_clockwise(flat: np.ndarray) -> np.ndarray:
    lifted = np.column_stack([flat, np.zeros(len(flat))])
    return flat if area_vector(lifted)[2] > 0 else flat[::-1]


def strip(
    path: Sequence[Point2],
    thickness: float,
    across: Literal["x", "y"],
    bounds: tuple[float, float],
    cut: Point2 | None = None,
) -> tuple[Solid, ...]:
    """A strip of even thickness about a bent line in an upright plane, mitred at the bends.

    Args:
        path: Points of its middle, (y, z) or (x, z) as for `upright_prism`.
        thickness: In the plane of the path.
        across: The axis along which it is wide.
        bounds: Of its width.
        cut: Direction of the line that both ends are cut along, where they meet a face; by
            default they are cut square.
    """
    points = np.array(path, np.float64)
    steps = np.diff(points, axis=0)
    steps /= np.linalg.norm(steps, axis=1, keepdims=True)
    normals = np.stack([-steps[:, 1], steps[:, 0]], 1)
    before, after = np.concatenate([normals[:1], normals]), np.concatenate([normals, normals[-1:]])
    middle = before + after
    if cut is not None:
        middle[[0, -1]] = cut
    offset = middle / np.sum(middle * after, 1, keepdims=True) * thickness / 2
    pieces, last = [], len(steps) - 1
    for k in range(last + 1):
        low, high = points[k : k + 2] - offset[k : k + 2], points[k : k + 2] + offset[k : k + 2]
        outline = [(float(p[0]), float(p[1])) for p in (*low, *high[::-1])]
        piece = upright_prism(outline, across, bounds)
        touching = ({_START} if k else set()) | ({_END} if k < last else set())
        pieces.append(dataclasses.replace(piece, hidden=frozenset(touching)))
    return tuple(pieces)


def raised(outline: np.ndarray, thickness: float) -> Solid:
    """A convex outline [corners, 3], counter-clockwise seen from above, with a copy above it."""
    flat = np.asarray(outline, np.float64)
    count = len(flat)
    sides = [(i, (i + 1) % count, (i + 1) % count + count, i + count) for i in range(count)]
    caps = [tuple(range(count - 1, -1, -1)), tuple(range(count, 2 * count))]
    above = flat + np.array([0.0, 0.0, thickness])
    return Solid(np.concatenate([flat, above]), (*sides, *caps))


def spike(
    foot, foot_half: Point2, tip, tip_half: Point2, turn_rad: float, hidden: tuple[int, ...] = ()
) -> Solid:
    """A six-sided piece between level rectangles about two points, both turned about z.

    The halves are of the sides along the turned x and y axis. Faces 0 and 1 are foot and tip.
    """
    c, s = np.cos(turn_rad), np.sin(turn_rad)
    corners = [
        np.array([at[0] + c * u * a - s * v * b, at[1] + s * u * a + c * v * b, at[2]])
        for at, (a, b) in ((foot, foot_half), (tip, tip_half))
        for u, v in ((-1, -1), (1, -1), (1, 1), (-1, 1))
    ]
    return Solid(np.array(corners), BOX_QUADS, frozenset(hidden))
