"""Any surface, open or closed, as convex pieces: cut along its axes where that saves most volume.

The hull of what lies on one side of a cut needs no inside, so single sheets and soups of triangles
work as well as closed bodies. Cuts go where level and upright faces are, which is where boards,
legs and cushions begin.
"""

from __future__ import annotations

import dataclasses

import numpy as np
from jaxtyping import Float
from scipy.spatial import ConvexHull, QhullError

from .solid import Hull, hull_of
from .swelling import Reference

_FACE_POSITIONS = 6
_EVEN_POSITIONS = 3
_EDGE_SHARE = 0.02
"""Of the piece: cuts nearer to its end than this part nothing off."""
_OFFSET_SHARE = 1e-4
_FEW_POINTS = 1500
"""Points that the volume of a possible half is estimated from."""
_FLAT = 0.98


@dataclasses.dataclass(frozen=True, eq=False)
class _Piece:
    corners: np.ndarray
    hull: Hull
    swelling_m: float


def slices(
    corners: Float[np.ndarray, "faces 3 3"], bound_m: float, max_pieces: int
) -> list[np.ndarray]:
    """Points [n, 3] of convex pieces, cut until none swells by more than the bound.

    Args:
        corners: Of the triangles, metres.
        max_pieces: Cutting stops here; the worst piece is always cut first.
    """
    reference = Reference(corners)
    pieces = [_piece(corners, reference)]
    while len(pieces) < max_pieces:
        worst = max(range(len(pieces)), key=lambda i: pieces[i].swelling_m)
        if pieces[worst].swelling_m <= bound_m:
            break
        halves = _best_cut(pieces[worst].corners)
        if halves is None:
            pieces[worst] = dataclasses.replace(pieces[worst], swelling_m=0.0)
            continue
        pieces[worst : worst + 1] = [_piece(half, reference) for half in halves]
    return [piece.corners.reshape(-1, 3) for piece in pieces]


def _piece(corners: np.ndarray, reference: Reference) -> _Piece:
    hull = hull_of(corners.reshape(-1, 3))
    return _Piece(corners, hull, float(reference.heights(hull).max()))


def _best_cut(corners: np.ndarray) -> tuple[np.ndarray, np.ndarray] | None:
    """Both sides of the cut whose hulls together have the least volume."""
    options = [
        (_volume(sides[0]) + _volume(sides[1]), axis, position)
        for axis in range(3)
        for position in _positions(corners, axis)
        if all(map(len, sides := _few(clipped(corners, axis, position))))
    ]
    if not options:
        return None
    _, axis, position = min(options)
    return clipped(corners, axis, position)


def _few(sides: tuple[np.ndarray, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    def thinned(points: np.ndarray) -> np.ndarray:
        return points[:: max(1, len(points) // _FEW_POINTS)]

    return thinned(sides[0].reshape(-1, 3)), thinned(sides[1].reshape(-1, 3))


def _volume(points: np.ndarray) -> float:
    try:
        return float(ConvexHull(points).volume)
    except (QhullError, ValueError):  # flat: as thick as a hull at least
        return hull_of(points).volume


def _positions(corners: np.ndarray, axis: int) -> np.ndarray:
    """Where to cut: beside the largest faces across the axis, and evenly."""
    values = corners[..., axis]
    low, high = float(values.min()), float(values.max())
    size = high - low
    if size <= 0:
        return np.zeros(0)
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(cross, axis=1)
    across = np.abs(cross[:, axis]) > _FLAT * length
    weight = np.bincount(
        np.round((values[across].mean(1) - low) / size * 200).astype(int), length[across], 201
    )
    top = np.argsort(-weight, kind="stable")[:_FACE_POSITIONS]
    faces = low + top[weight[top] > 0] / 200 * size
    # Just beyond the faces on either side, so that a board stays whole.
    step = size / 200
    near = _exact(values[across].mean(1), faces, step)
    offset = _OFFSET_SHARE * size
    even = low + size * (np.arange(_EVEN_POSITIONS) + 1) / (_EVEN_POSITIONS + 1)
    found = np.concatenate([near - offset, near + offset, even])
    inside = (found > low + _EDGE_SHARE * size) & (found < high - _EDGE_SHARE * size)
    return np.unique(np.round(found[inside], 7))


def _exact(values: np.ndarray, wanted: np.ndarray, step: float) -> np.ndarray:
    """For each wanted position the mean of the values within a step of it."""
    close = np.abs(values[:, None] - wanted) <= step
    return (values[:, None] * close).sum(0) / np.maximum(close.sum(0), 1)


def clipped(
    corners: Float[np.ndarray, "faces 3 3"], axis: int, position: float
) -> tuple[np.ndarray, np.ndarray]:
    """The triangles below and above a plane across an axis, cut where they cross it."""
    above = corners[..., axis] > position
    count = above.sum(1)
    below, over = [corners[count == 0]], [corners[count == 3]]
    for lone_above in (True, False):
        rows = count == (1 if lone_above else 2)
        lone = np.argmax(above[rows] == lone_above, axis=1)
        turned = np.take_along_axis(
            corners[rows], ((lone[:, None] + np.arange(3)) % 3)[..., None], axis=1
        )
        a, b, c = np.moveaxis(turned, 1, 0)
        ab, ac = _crossing(a, b, axis, position), _crossing(a, c, axis, position)
        tip = np.stack([a, ab, ac], 1)
        rest = np.concatenate([np.stack([ab, b, c], 1), np.stack([ab, c, ac], 1)])
        (over if lone_above else below).append(tip)
        (below if lone_above else over).append(rest)
    return np.concatenate(below), np.concatenate(over)


def _crossing(a: np.ndarray, b: np.ndarray, axis: int, position: float) -> np.ndarray:
    share = (position - a[:, axis]) / (b[:, axis] - a[:, axis])
    return a + share[:, None] * (b - a)
