"""Round and hollow shapes: bowls and tubs in layers, lying discs and rings, plates with a hole."""

from __future__ import annotations

import dataclasses
import itertools
from collections.abc import Sequence

import numpy as np

from ....robot_model.primitives import BOX_QUADS
from ..solids import ROUND_SIDES, Axis, Solid, box, circle, frustum, tube

_BOTTOM, _TOP = 0, 1
"""Quads of a stave (`tube`) that face down and up."""


@dataclasses.dataclass(frozen=True)
class Level:
    """A section of a shell: both outlines scaled about one centre."""

    z: float
    outer: float
    """Scale of the outer outline."""
    inner: float
    """Scale of the inner outline."""
    center: tuple[float, float] = (0.0, 0.0)


def squircle(
    half_x: float, half_y: float, power: float = 4.0, sides: int = ROUND_SIDES
) -> np.ndarray:
    """Corners [sides, 2] of |x/half_x|^power + |y/half_y|^power = 1.

    Power 2 is an ellipse, 4 a rounded rectangle, infinity a rectangle. Corner i lies on the same
    ray for every power, so that shells may go from one to another.
    """
    unit = circle(1.0, sides)
    size = np.abs(unit)
    norm = size.max(1) if np.isinf(power) else (size**power).sum(1) ** (1 / power)
    return unit / norm[:, None] * np.array([half_x, half_y])


def layered_wall(
    outer: np.ndarray, inner: np.ndarray, levels: Sequence[Level], *, is_round: bool = True
) -> tuple[Solid, ...]:
    """A wall around a hollow, in layers between consecutive levels.

    Args:
        outer: [corners, 2] outline at scale 1, convex, counter-clockwise about the origin.
        inner: [corners, 2] likewise, corner by corner on the same rays.
        levels: From the bottom up.
        is_round: The outlines stand for round ones.
    """
    staves = []
    for k, (low, high) in enumerate(itertools.pairwise(levels)):
        rims = [
            np.stack([np.asarray(v.center) + getattr(v, side) * outline for v in (low, high)])
            for side, outline in (("outer", outer), ("inner", inner))
        ]
        between = {_BOTTOM} if k else set()
        between |= {_TOP} if k < len(levels) - 2 else set()
        staves += [
            dataclasses.replace(s, hidden=s.hidden | between)
            for s in tube(rims[0], rims[1], (low.z, high.z), is_round=is_round)
        ]
    return tuple(staves)


def loft(bottom: np.ndarray, top: np.ndarray, z: tuple[float, float]) -> Solid:
    """A solid between two level outlines [corners, 2], one a scaled and moved copy of the other."""
    count = len(bottom)
    ends = [np.column_stack([o, np.full(count, h)]) for o, h in zip((bottom, top), z)]
    sides = [(i, (i + 1) % count, (i + 1) % count + count, i + count) for i in range(count)]
    caps = [tuple(range(count - 1, -1, -1)), tuple(range(count, 2 * count))]
    return Solid(np.concatenate(ends), (*sides, *caps), curved=frozenset(range(count)))


def slanted_box(
    bottom: tuple[tuple[float, float], tuple[float, float]],
    top: tuple[tuple[float, float], tuple[float, float]],
    z: tuple[float, float],
) -> Solid:
    """Six faces between two level rectangles ((x0, x1), (y0, y1)) that share at least one width."""
    rows = [
        (x, y, h)
        for (xs, ys), h in zip((bottom, top), z)
        for x, y in ((xs[0], ys[0]), (xs[1], ys[0]), (xs[1], ys[1]), (xs[0], ys[1]))
    ]
    return Solid(np.array(rows, np.float64), BOX_QUADS)


def lying(solid: Solid) -> Solid:
    """An upright piece laid on its back: its y becomes up, its z points to the front."""
    x, y, z = solid.vertices.T
    return dataclasses.replace(solid, vertices=np.column_stack([x, -z, y]))


def lying_disc(
    radii: tuple[float, float],
    y: tuple[float, float],
    center: tuple[float, float],
    sides: int = ROUND_SIDES,
) -> Solid:
    """A round piece about a line along y: ``radii`` in front and behind, ``center`` (x, z)."""
    return lying(frustum((radii[1], radii[0]), (-y[1], -y[0]), center, sides))


def lying_ring(
    outer: np.ndarray,
    inner: np.ndarray,
    y: tuple[float, float],
    center: tuple[float, float],
    *,
    is_round: bool = True,
) -> tuple[Solid, ...]:
    """A wall about a line along y between two outlines [corners, 2] of (x, z) about ``center``."""
    rims = [np.stack([np.asarray(center) + outline] * 2) for outline in (outer, inner)]
    return tuple(lying(s) for s in tube(rims[0], rims[1], (-y[1], -y[0]), is_round=is_round))


def plate_with_hole(
    plan: tuple[tuple[float, float], tuple[float, float]],
    z: tuple[float, float],
    center: tuple[float, float],
    radius: float,
    sides: int = ROUND_SIDES,
) -> tuple[Solid, ...]:
    """A rectangle ((x0, x1), (y0, y1)) around a round hole through it, upright."""
    (x0, x1), (y0, y1) = plan
    cx, cy = center
    half = min(cx - x0, x1 - cx, cy - y0, y1 - cy)
    square, hole = squircle(half, half, np.inf, sides), circle(radius, sides)
    rims = [np.stack([np.asarray(center) + outline] * 2) for outline in (square, hole)]
    pieces = list(tube(rims[0], rims[1], z))
    inner = (cy - half, cy + half)
    spots = [((x0, cx - half), inner), ((cx + half, x1), inner)]
    spots += [((x0, x1), (y0, cy - half)), ((x0, x1), (cy + half, y1))]
    pieces += [box(*s, z) for s in spots if min(s[0][1] - s[0][0], s[1][1] - s[1][0]) > 1e-6]
    return tuple(pieces)


def turned(solid: Solid, axis: Axis, angle_rad: float, about: tuple[float, float, float]) -> Solid:
    """The solid turned about a line through ``about`` along ``axis``, counter-clockwise."""
    i, k = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[axis]
    cos, sin = np.cos(angle_rad), np.sin(angle_rad)
    v = solid.vertices - np.asarray(about)
    out = v.copy()
    out[:, i], out[:, k] = cos * v[:, i] - sin * v[:, k], sin * v[:, i] + cos * v[:, k]
    return dataclasses.replace(solid, vertices=out + np.asarray(about))


def arch(
    center: tuple[float, float],
    radii: tuple[float, float],
    angles_rad: tuple[float, float],
    width: tuple[float, float],
    pieces: int = 6,
) -> tuple[Solid, ...]:
    """A bent bar in an upright plane along y.

    Args:
        center: (y, z) of the bend.
        radii: Inner and outer.
        angles_rad: Start and end, from -y (0) over up (pi/2) to +y (pi).
        width: Bounds along x.
        pieces: Straight pieces that stand for the bend.
    """
    angles = np.linspace(*angles_rad, pieces + 1)
    rays = np.stack([-np.cos(angles), np.sin(angles)], 1)
    rims = [np.asarray(center) + r * rays for r in radii]
    solids = []
    for i in range(pieces):
        corners = [rims[0][i], rims[0][i + 1], rims[1][i + 1], rims[1][i]]
        rows = [np.column_stack([np.full(4, x), np.array(corners)]) for x in width]
        # Quads 3 and 5 are the cuts to the neighbour pieces, as in `tube`.
        ends = {5} if i == 0 else set()
        ends |= {3} if i == pieces - 1 else set()
        solids.append(Solid(np.concatenate(rows), BOX_QUADS, frozenset({3, 5} - ends)))
    return tuple(solids)


def d_outline(
    half: float, front: float, rear: float, rear_half: float, sides: int = ROUND_SIDES
) -> np.ndarray:
    """Corners [n, 2] of a D: half an ellipse towards -y, straight sides to a flat edge at +y.

    Args:
        half: Half of the width, at y = 0.
        front: Depth of the round part.
        rear: Depth of the straight part.
        rear_half: Half of the width of the flat edge.
        sides: Of a full circle.
    """
    angle = np.pi + np.pi * np.arange(sides // 2 + 1) / (sides // 2)
    bow = np.stack([half * np.cos(angle), front * np.sin(angle)], 1)
    # Exactly level ends, so that the outline is the same on either side.
    bow[[0, -1], 1] = 0.0
    return np.concatenate([bow, [(rear_half, rear), (-rear_half, rear)]])
