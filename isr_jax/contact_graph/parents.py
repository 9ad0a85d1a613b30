"""The parent of each child: the best admissible one, or the furniture around it (host)."""

from __future__ import annotations

import dataclasses

import numpy as np
from jaxtyping import Bool, Float, Int

from ..classes import class_named
from ..config import ContactGraphSettings
from ..geometry import box_at, convex_overlap_area, footprint_corners
from ..types import ROOM, UNSUPPORTED
from .flat import FlatEntities
from .scoring import polygon_contacts
from .support import Support
from .triples import Triples

_SAME_SCORE = 0.02
"""Boards side by side at one height share their vertices, so S cannot tell them apart: among
planes of one parent whose S differ by less, that below most of the child carries it."""
_LEAST_SHARE = 0.5
"""Of a thing's footprint that lies in the furniture's."""


@dataclasses.dataclass(frozen=True, eq=False)
class Parents:
    """What carries each entity, by position in the flat entities."""

    parent: Int[np.ndarray, " entities"]
    """Position of the parent, or `ROOM`, or `UNSUPPORTED`."""
    plane: Int[np.ndarray, " entities"]
    """Plane of the parent that carries it; -1 where there is none, or none was seen."""
    score: Float[np.ndarray, " entities"]
    """S of the parent; 0 where there is none."""

    def __getitem__(self, span: slice) -> Parents:
        """Those of some entities, still by position in the flat entities."""
        return Parents(self.parent[span], self.plane[span], self.score[span])


def choose_parents(
    flat: FlatEntities,
    triples: Triples,
    support: Support,
    settings: ContactGraphSettings,
    min_contact: float,
) -> Parents:
    """The parent of largest S for each child (ties by position), and the plane that carries it."""
    rows = np.flatnonzero(_admissible(flat, triples, support, settings, min_contact))
    found = _best_parents(flat, triples, rows, np.asarray(support.score))
    if not settings.inside_furniture:
        return found
    return dataclasses.replace(found, parent=_put_inside(flat, found.parent))


def _admissible(
    flat: FlatEntities,
    triples: Triples,
    support: Support,
    settings: ContactGraphSettings,
    min_contact: float,
) -> Bool[np.ndarray, " triples"]:
    """Which triples are supports: enough contact, and a gap that occlusion can explain.

    S ranks, but says little about what is possible: a gap of 0.4 m under a chair means legs that
    were not seen, under a wall cabinet it means a wall cabinet. So the gap is bounded by what
    stands there. A standing thing over layout may hover as far as S allows; anything else over
    another thing by ``max_gap_m``, what hangs on walls by ``max_gap_mounted_m``. A bottom seen
    well below a plane is not carried by it (a chair pushed under a table), except by layout,
    below which nothing is.
    """
    child, gap = triples.child, np.asarray(support.gap_m)
    over_layout = flat.is_layout[triples.parent]
    stands = flat.mount[child] == "floor"
    mounted = np.isin(flat.mount[child], ("wall", "opening"))
    limit = np.where(stands & over_layout, 1.0, settings.max_gap_m)
    limit = np.where(mounted, settings.max_gap_mounted_m, limit)
    sinks = (gap < -settings.max_sink_m) & ~over_layout
    enough = np.asarray(support.contact) >= min_contact
    enough &= np.asarray(support.score) >= settings.min_score
    return enough & (gap <= limit) & ~sinks


def _best_parents(
    flat: FlatEntities,
    triples: Triples,
    rows: Int[np.ndarray, " rows"],
    s: Float[np.ndarray, " triples"],
) -> Parents:
    """Of the admissible triples in ``rows`` the parent with the largest S, then its plane."""
    parent = np.where(flat.is_layout, ROOM, UNSUPPORTED).astype(np.int32)
    plane = np.full(len(parent), -1, np.int32)
    score = np.zeros(len(parent), np.float32)
    best = _first_of_each_child(triples, rows, (triples.parent[rows], -s[rows]))
    child = triples.child[best]
    parent[child], score[child] = triples.parent[best], s[best]
    child = triples.child[rows]
    level = triples.parent[rows] == parent[child]
    level &= s[rows] >= score[child] - _SAME_SCORE
    rows = rows[level]
    share = polygon_contacts(flat, triples[rows], 0.0)
    best = _first_of_each_child(triples, rows, (-s[rows], -np.round(share, 3)))
    child = triples.child[best]
    plane[child], score[child] = triples.plane[best], s[best]
    return Parents(parent, plane, score)


def _first_of_each_child(
    triples: Triples, rows: np.ndarray, keys: tuple[np.ndarray, ...]
) -> np.ndarray:
    """For each child its row with the least keys (the last key counts most), then least plane."""
    order = rows[np.lexsort((triples.plane[rows], *keys))]
    return order[np.unique(triples.child[order], return_index=True)[1]]


def _put_inside(flat: FlatEntities, parent: Int[np.ndarray, " n"]) -> Int[np.ndarray, " n"]:
    """Parents, with the least furniture around each movable thing that nothing carries.

    Such a thing has a parent but no supporting plane: it stands on a board that was not seen.
    """
    parent = parent.copy()
    infos = [class_named(item.class_name) for item in flat.items]
    for row in np.flatnonzero(parent == UNSUPPORTED).tolist():
        if not infos[row].movable:
            continue
        around = [
            other
            for other in flat.slice(int(flat.scene[row]))
            if infos[other].kind == "thing"
            and not infos[other].movable
            and infos[other].mount == "floor"
            and _holds(flat, other, row)
        ]
        volume = [float(np.prod(flat.box.size[other])) for other in around]
        if around:
            parent[row] = around[int(np.argmin(volume))]
    return parent


def _holds(flat: FlatEntities, other: int, row: int) -> bool:
    """Whether a thing's bottom and half of its footprint lie in the box of another.

    The order of bottoms, ties by id, is that of supports: so no cycle can close.
    """
    top = float(flat.box.center[other, 2] + flat.box.size[other, 2] / 2)
    if not (flat.rank[other] < flat.rank[row] and flat.bottom[row] <= top):
        return False
    own = box_at(flat.box, row)
    shared = convex_overlap_area(footprint_corners(own), footprint_corners(box_at(flat.box, other)))
    return float(shared) >= _LEAST_SHARE * float(np.prod(np.asarray(own.size)[:2]))
