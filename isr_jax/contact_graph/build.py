"""From entities to contact graphs, many scenes at once (host)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float

from ..config import DEFAULT_SUPPORT, ContactGraphSettings, SupportSettings
from ..geometry import support_heights
from ..runtime.batches import take_rows
from ..types import Attachment, Box, ContactGraph, Entities
from .attachment import attachments
from .flat import FlatEntities, flatten
from .parents import Parents, choose_parents
from .proximal import ClosePairs, close_pairs
from .scoring import score_triples
from .triples import candidate_triples


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
    parents = choose_parents(flat, triples, scored, settings, support.min_contact)
    height = support_heights(flat.items, parents.parent, parents.plane, flat.box)
    refined = refine_boxes(flat, parents, height)
    close = close_pairs(flat, refined, settings.attach_distance_m)
    held = attachments(flat, triples, scored, parents.parent, close, settings, support.up_cosine)
    return [
        _graph_of(flat, scene, parents, height, refined, held, close)
        for scene in range(len(scenes))
    ]


def refine_boxes(
    flat: FlatEntities, parents: Parents, height_m: Float[np.ndarray, " entities"]
) -> Box:
    """Boxes with their bottoms at the heights that carry them, tops fixed (the boxes of mAP_re).

    Planes do not move, so no order has to be kept. A thing so flat that its top is not above
    the plane (a book, by noise) keeps its height, or one voxel if it is more, and is set upon it.

    Args:
        flat: The entities.
        parents: What carries them.
        height_m: d^s of every entity.
    """
    carried = np.flatnonzero((parents.parent >= 0) & (parents.plane >= 0))
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
    parents: Parents,
    height_m: Float[np.ndarray, " entities"],
    refined: Box,
    held: list[Attachment],
    close: ClosePairs,
) -> ContactGraph:
    rows = flat.slice(scene)
    span, first = slice(rows.start, rows.stop), rows.start
    own, all_parents = parents[span], parents.parent
    i, j = close.pairs.T
    supports = (all_parents[i] == j) | (all_parents[j] == i)
    near = close[(flat.scene[i] == scene) & (close.depth_m > 0) & ~supports]
    return ContactGraph(
        parent=np.where(own.parent >= 0, own.parent - first, own.parent).astype(np.int32),
        support_plane=own.plane,
        score=own.score,
        attachment=tuple(held[span]),
        refined_box=take_rows(refined, span),
        support_height_m=height_m[span],
        proximal=(near.pairs - first).astype(np.int32),
        proximal_depth_m=near.depth_m,
    )
