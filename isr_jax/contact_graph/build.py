"""From entities to contact graphs, many scenes at once (host)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from jaxtyping import Bool, Float, Int

from ..config import DEFAULT_SUPPORT, ContactGraphSettings, SupportSettings
from ..geometry import support_heights
from ..types import ROOM, UNSUPPORTED, Box, ContactGraph, Entities
from .attachment import attachments
from .flat import FlatEntities, flatten, take
from .inside import put_inside
from .proximal import close_pairs
from .support import Support
from .triples import Triples, candidate_triples, pick, polygon_contacts, score_triples


def build_contact_graphs(
    scenes: Sequence[Entities],
    settings: ContactGraphSettings,
    support: SupportSettings = DEFAULT_SUPPORT,
) -> list[ContactGraph]:
    """Support tree, refined boxes and proximal pairs of every scene.

    The root is the room: layout hangs from it, and what nothing carries is `UNSUPPORTED`. Top
    down, a child's bottom then moves onto its supporting plane, its top stays.
    """
    flat = flatten(scenes)
    triples = candidate_triples(flat, settings, support.up_cosine)
    scored = score_triples(flat, triples, settings)
    admissible = _admissible(flat, triples, scored, settings, support.min_contact)
    parent, plane, score = _choose_parents(flat, triples, scored, admissible)
    if settings.inside_furniture:
        parent = put_inside(flat, parent)
    height = support_heights(flat.items, parent, plane, flat.box)
    refined = refine_boxes(flat, np.flatnonzero((parent >= 0) & (plane >= 0)), height)
    pairs, depth = close_pairs(flat, refined, settings.attach_distance_m)
    attached = attachments(flat, triples, scored, parent, (pairs, depth), settings)
    return [
        _graph_of(flat, scene, (parent, plane, score, height), refined, attached, (pairs, depth))
        for scene in range(len(scenes))
    ]


def _choose_parents(
    flat: FlatEntities, triples: Triples, support: Support, admissible: Bool[np.ndarray, " triples"]
) -> tuple[Int[np.ndarray, " n"], Int[np.ndarray, " n"], Float[np.ndarray, " n"]]:
    """The parent of largest S for each child (ties by position), and the plane that carries it."""
    parent = np.where(flat.is_layout, ROOM, UNSUPPORTED).astype(np.int32)
    plane = np.full(len(parent), -1, np.int32)
    score = np.zeros(len(parent), np.float32)
    s = np.asarray(support.score)
    rows = np.flatnonzero(admissible)
    best = _first_of_each_child(triples, rows, (triples.parent[rows], -s[rows]))
    child = triples.child[best]
    parent[child], score[child] = triples.parent[best], s[best]
    child = triples.child[rows]
    level = triples.parent[rows] == parent[child]
    level &= s[rows] >= score[child] - _SAME_SCORE
    rows = rows[level]
    share = polygon_contacts(flat, pick(triples, rows), 0.0)
    best = _first_of_each_child(triples, rows, (-s[rows], -np.round(share, 3)))
    child = triples.child[best]
    plane[child], score[child] = triples.plane[best], s[best]
    return parent, plane, score


_SAME_SCORE = 0.02
"""Boards side by side at one height share their vertices, so S cannot tell them apart: among
planes of one parent whose S differ by less, that below most of the child carries it."""


def _first_of_each_child(
    triples: Triples, rows: np.ndarray, keys: tuple[np.ndarray, ...]
) -> np.ndarray:
    """For each child its row with the least keys (the last key counts most), then least plane."""
    order = rows[np.lexsort((triples.plane[rows], *keys))]
    return order[np.unique(triples.child[order], return_index=True)[1]]


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


def refine_boxes(
    flat: FlatEntities, carried: Int[np.ndarray, " carried"], height_m: Float[np.ndarray, " n"]
) -> Box:
    """Boxes with their bottoms at the heights that carry them, tops fixed (the boxes of mAP_re).

    Planes do not move, so no order has to be kept. A thing so flat that its top is not above
    the plane (a book, by noise) keeps its height, or one voxel if it is more, and is set upon it.

    Args:
        flat: The entities.
        carried: Positions of those with a supporting plane.
        height_m: d^s of every entity.
    """
    center, size = np.array(flat.box.center), np.array(flat.box.size)
    level = height_m[carried]
    top = center[carried, 2] + size[carried, 2] / 2
    least = np.minimum(size[carried, 2], flat.voxel_m[carried])
    size[carried, 2] = np.maximum(top - level, least)
    center[carried, 2] = level + size[carried, 2] / 2
    return Box(center, np.asarray(flat.box.yaw), size)


def _graph_of(
    flat: FlatEntities,
    scene: int,
    chosen: tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray],
    refined: Box,
    attached: list[str],
    close: tuple[np.ndarray, np.ndarray],
) -> ContactGraph:
    rows = flat.slice(scene)
    span, first = slice(rows.start, rows.stop), rows.start
    parent, plane, score, height = (column[span] for column in chosen)
    pairs, depth = close
    direct = (chosen[0][pairs[:, 0]] == pairs[:, 1]) | (chosen[0][pairs[:, 1]] == pairs[:, 0])
    ours = (flat.scene[pairs[:, 0]] == scene) & (depth > 0) & ~direct
    return ContactGraph(
        parent=np.where(parent >= 0, parent - first, parent).astype(np.int32),
        support_plane=plane,
        score=score,
        attachment=tuple(attached[span]),
        refined_box=take(refined, span),
        support_height_m=height,
        proximal=(pairs[ours] - first).astype(np.int32),
        proximal_depth_m=depth[ours],
    )
