"""The hulls of one link: each connected part by itself, decomposed only where it is not convex.

Furniture is mostly boards, tubes and cushions that touch: the convex hull of each is exact, takes
no time, and leaves the decomposition only what is really hollow or bent.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import get_args

import numpy as np
from jaxtyping import Float, Int
from scipy import sparse
from scipy.sparse.csgraph import connected_components
from scipy.spatial import QhullError

from ...config import HullMethod
from ..adjacency import adjacency
from .decompose import Pieces, coacd_pieces, vhacd_pieces
from .merging import merged
from .slicing import slices
from .solid import Hull, hull_of
from .swelling import Reference

METHODS: dict[str, HullMethod] = {method: method for method in get_args(HullMethod)}
"""By name, for settings and messages from outside."""
MAX_HULLS = 64
"""Of one link: more are merged."""
BOUND_SHARE = 0.02
"""Of the link's diagonal: how far hulls may reach beyond the surface ..."""
BOUND_M = (0.003, 0.025)
"""... but between these."""
_SMALL_SHARE = 0.015
"""Of the diagonal: screws and buttons that are smaller do not collide."""
_MAX_BENT_PARTS = 24
"""More bent parts than this are decomposed as one mesh."""
_MAX_COACD_PARTS = 8
"""A lamp of twenty bulbs would take minutes."""
_MAX_TOUCHING = 60
"""A part that falls into more pieces by its edges is a soup, not boards."""
_MERGE_SHARE = 0.5
"""Of the bound: what merging may add."""
_MAX_PIECES = 40
_VOXELS = 30_000
_ACCEPTED = 1.5
"""Times the bound: what swells less is not tried again."""


@dataclasses.dataclass(frozen=True, eq=False)
class LinkHulls:
    """What was made for one link."""

    hulls: list[Hull]
    swelling_m: float
    notes: tuple[str, ...]
    """What fell back to another method."""


def bound_m(size: Float[np.ndarray, "3"]) -> float:
    """How far the hulls of a link of this size should reach beyond it at most."""
    return float(np.clip(BOUND_SHARE * np.linalg.norm(size), *BOUND_M))


def link_hulls(
    vertices: Float[np.ndarray, "vertices 3"], faces: Int[np.ndarray, "faces 3"], method: HullMethod
) -> LinkHulls:
    """Convex hulls of a link's welded triangles.

    Raises:
        ValueError: there are no triangles.
    """
    if not len(faces):
        raise ValueError("no triangles")
    bound = bound_m(np.ptp(vertices[np.unique(faces)], axis=0))
    notes: list[str] = []
    convex, bent = _parted(vertices, faces, bound)
    hulls = list(convex)
    together = _together(vertices, bent)
    for k, part in enumerate(together):
        by: HullMethod = method if k < _MAX_COACD_PARTS else "vhacd"
        hulls += _decomposed(vertices, part, by, bound, notes)
    if method == "coacd" and len(together) > _MAX_COACD_PARTS:
        notes.append(f"coacd for the {_MAX_COACD_PARTS} largest bent parts, cuts for the others")
    hulls, used = merged(hulls, _MERGE_SHARE * bound, MAX_HULLS)
    if used > _MERGE_SHARE * bound:
        notes.append(f"merged to {len(hulls)} hulls, which adds up to {1000 * used:.0f} mm")
    reference = Reference(vertices[faces])
    heights = [float(reference.heights(hull, hulls).max()) for hull in hulls]
    return LinkHulls(hulls, max(heights), tuple(dict.fromkeys(notes)))


def _parted(
    vertices: np.ndarray, faces: np.ndarray, bound: float
) -> tuple[list[Hull], list[np.ndarray]]:
    """Hulls of the parts that are convex but for the bound, and the faces of the others."""
    parts = _connected(faces, len(vertices))
    diagonal = _extent(vertices, faces)
    sizes = [_extent(vertices, part) for part in parts]
    large = [p for p, size in zip(parts, sizes) if size >= _SMALL_SHARE * diagonal] or parts
    convex: list[Hull] = []
    bent: list[np.ndarray] = []
    for part in large:
        hull = _if_convex(vertices, part, bound)
        if hull is not None:
            convex.append(hull)
            continue
        # Boards that touch along an edge share it; by edges of two faces each they come apart.
        pieces = _by_edges(part)
        halves = [_if_convex(vertices, piece, bound) for piece in pieces]
        if 1 < len(pieces) <= _MAX_TOUCHING and any(half is not None for half in halves):
            convex += [half for half in halves if half is not None]
            bent += [piece for piece, half in zip(pieces, halves) if half is None]
        else:
            bent.append(part)
    return convex, bent


def _if_convex(vertices: np.ndarray, part: np.ndarray, bound: float) -> Hull | None:
    """The hull of a part, if it stays within the bound of its surface."""
    hull = hull_of(vertices[np.unique(part)])
    return hull if Reference(vertices[part]).heights(hull).max() <= bound else None


def _by_edges(faces: np.ndarray) -> list[np.ndarray]:
    """Faces of each part that hangs together by edges that two faces have."""
    label = adjacency(faces).components(len(faces))
    order = np.argsort(label, kind="stable")
    return np.split(faces[order], np.flatnonzero(np.diff(label[order])) + 1)


def _extent(vertices: np.ndarray, faces: np.ndarray) -> float:
    """Diagonal of the faces' box."""
    return float(np.linalg.norm(np.ptp(vertices[np.unique(faces)], axis=0)))


def _connected(faces: np.ndarray, count: int) -> list[np.ndarray]:
    """Faces of each part that hangs together by shared corners, largest first."""
    a, b = faces[:, [0, 1]].ravel(), faces[:, [1, 2]].ravel()
    graph = sparse.coo_matrix((np.ones(len(a), bool), (a, b)), shape=(count, count))
    label = connected_components(graph, directed=False)[1][faces[:, 0]]
    order = np.argsort(label, kind="stable")
    parts = np.split(faces[order], np.flatnonzero(np.diff(label[order])) + 1)
    return sorted(parts, key=lambda part: -len(part))


def _together(vertices: np.ndarray, bent: list[np.ndarray]) -> list[np.ndarray]:
    """The bent parts, largest first, the smallest of too many as one."""
    bent = sorted(bent, key=lambda part: -_extent(vertices, part))
    few, rest = bent[:_MAX_BENT_PARTS], bent[_MAX_BENT_PARTS:]
    return [*few, np.concatenate(rest)] if rest else few


def _decomposed(
    vertices: np.ndarray, faces: np.ndarray, method: HullMethod, bound: float, notes: list[str]
) -> list[Hull]:
    """Hulls of one bent part; finer once where they swell, by other means where that fails."""
    used, inverse = np.unique(faces, return_inverse=True)
    points, rows = vertices[used], inverse.reshape(faces.shape)
    reference = Reference(points[rows])
    best: tuple[float, list[Hull]] | None = None
    for name, attempt in _attempts(method, bound):
        hulls = _hulls(attempt, points, rows)
        if not hulls:
            notes.append(f"{name} failed on a part")
            continue
        swell = max(float(reference.heights(h, hulls).max()) for h in hulls)
        if best is None or swell < best[0]:
            best = swell, hulls
        if swell <= _ACCEPTED * bound:
            break
    if best is None:
        notes.append("a part has its convex hull")
        return [hull_of(points)]
    return best[1]


Attempt = Callable[[np.ndarray, np.ndarray], Pieces]
"""Pieces of welded vertices and faces."""


def _attempts(method: HullMethod, bound: float) -> list[tuple[str, Attempt]]:
    """What is tried first, and what is tried where that swells too much.

    The fast method cuts along the axes: measured on catalogue furniture, vhacd alone swelled five
    times as much, and by up to 0.9 m where it closed the room under a table.
    """
    if method == "coacd":
        return [
            ("coacd", lambda v, f: coacd_pieces(v, f, bound, _MAX_PIECES)),
            ("cutting", lambda v, f: slices(v[f], bound, _MAX_PIECES)),
        ]
    return [
        ("cutting", lambda v, f: slices(v[f], bound, _MAX_PIECES)),
        ("vhacd", lambda v, f: vhacd_pieces(v, f, _VOXELS, _MAX_PIECES)),
    ]


def _hulls(attempt: Attempt, points: np.ndarray, rows: np.ndarray) -> list[Hull]:
    """Hulls of an attempt's pieces; none where it fails."""
    try:
        return [hull_of(piece) for piece in attempt(points, rows) if len(piece) >= 4]
    except (RuntimeError, ValueError, QhullError):
        return []
