"""Which way faces look: repaired where a file wound them inside out.

Faces of one connected part are first made to agree with each other; then rays from outside tell
which side of the part is seen. A part that is not seen keeps its own majority, or encloses a
positive volume where the file as a whole cannot be trusted.
"""

from __future__ import annotations

import dataclasses

import numpy as np
from jaxtyping import Bool
from scipy import sparse
from scipy.sparse.csgraph import breadth_first_order

from ...adjacency import Adjacency, adjacency
from ...planes import sphere_directions
from .skin import Skin

_RAYS = 6000
_MIN_VOTES = 3
_MAX_HIDDEN = 3000
_MIXED_SHARE = 0.25
"""Both sides of a part are seen by at least this share of the rays: a sheet."""
_TRUSTED_SHARE = 0.9


@dataclasses.dataclass(frozen=True, eq=False)
class Winding:
    """What was found about the faces of a surface."""

    flip: Bool[np.ndarray, " faces"]
    """Wound the wrong way in the file."""
    sheet: Bool[np.ndarray, " faces"]
    """Both sides face outwards."""


def find_winding(skin: Skin) -> Winding:
    """Which faces have to be flipped for all normals to point out of the object."""
    shared = adjacency(skin.faces)
    part = shared.components(len(skin.faces))
    against = _against_root(shared, len(skin.faces))
    front, back = _seen_sides(skin)
    count = int(part.max()) + 1
    hidden = (np.bincount(part, front + back, count) < _MIN_VOTES)[part]
    more_front, more_back = _open_sides(skin, np.flatnonzero(hidden))
    front, back = front + more_front, back + more_back

    def total(values: np.ndarray) -> np.ndarray:
        return np.bincount(part, values, count)

    # In the direction of each part's root face.
    agree = np.where(against, back, front)
    oppose = np.where(against, front, back)
    votes_for, votes_against = total(agree), total(oppose)
    seen = votes_for + votes_against
    trusted = front.sum() >= _TRUSTED_SHARE * max(front.sum() + back.sum(), 1)
    volume = total(np.where(against, -1.0, 1.0) * _signed_volume(skin, part))
    whole = total(~shared.closed) == 0
    file_for = total(np.where(against, -1.0, 1.0) * skin.area)
    turn = np.where(whole & (not trusted), volume < 0, file_for < 0)
    turn = np.where(seen >= _MIN_VOTES, votes_against > votes_for, turn)
    sheet = ~whole & (seen >= _MIN_VOTES)
    sheet &= np.minimum(votes_for, votes_against) >= _MIXED_SHARE * seen
    # A sheet's sides are equal: it stays as the file has it.
    turn = np.where(sheet, file_for < 0, turn)
    return Winding(against ^ turn[part], sheet[part] | (skin.doubled & ~whole[part]))


def _against_root(shared: Adjacency, count: int) -> np.ndarray:
    """Whether each face is wound against the root face of its part.

    Parities along the edges of a spanning tree add up by pointer doubling.
    """
    part = shared.components(count)
    roots = np.full(int(part.max()) + 1, -1)
    roots[part[::-1]] = np.arange(count)[::-1]
    # One more node joins all roots, so that one search spans every part.
    a, b = shared.pairs.T
    rows = np.concatenate([a, np.full(len(roots), count)])
    columns = np.concatenate([b, roots])
    weight = np.concatenate([np.where(shared.turned, 2, 1), np.ones(len(roots), int)])
    # Two faces may share two edges; either tells the same of sound meshes.
    _, first = np.unique(rows.astype(np.int64) * (count + 1) + columns, return_index=True)
    entries = (weight[first], (rows[first], columns[first]))
    graph = sparse.coo_matrix(entries, shape=(count + 1, count + 1)).tocsr()
    graph = graph.maximum(graph.T).tocsr()
    _, parent = breadth_first_order(graph, count, directed=False)
    parent = parent.copy()
    parent[count] = count
    step = np.asarray(graph[np.arange(count), parent[:count]]).ravel()
    parity = np.append(step == 2, False)
    for _ in range(int(np.ceil(np.log2(count + 2)))):
        parity = parity ^ parity[parent]
        parent = parent[parent]
    return parity[:count]


def _seen_sides(skin: Skin) -> tuple[np.ndarray, np.ndarray]:
    """How many rays from outside hit the front and the back of each face."""
    rng = np.random.default_rng(0)
    directions = rng.normal(size=(_RAYS, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    low, high = skin.vertices.min(0), skin.vertices.max(0)
    targets = np.concatenate(
        [skin.samples(_RAYS // 2), rng.uniform(low, high, size=(_RAYS - _RAYS // 2, 3))]
    )
    reach = float(np.linalg.norm(high - low))
    hits = skin.rays.cast(targets - 2 * reach * directions, directions)
    hit = hits.triangle >= 0
    facing = np.einsum("rc,rc->r", hits.normal, directions) < 0
    count = len(skin.faces)
    front = np.bincount(hits.triangle[hit & facing], minlength=count)
    return front, np.bincount(hits.triangle[hit & ~facing], minlength=count)


def _open_sides(skin: Skin, rows: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """How many rays get away from each side of the given faces, of the largest if many."""
    rows = rows[np.argsort(-skin.area[rows], kind="stable")][:_MAX_HIDDEN]
    middle, normal = skin.corners[rows].mean(1), skin.normal[rows]
    step = 1e-4 * float(np.linalg.norm(skin.size))
    directions = sphere_directions()[::2]
    counts = []
    for sign in (1.0, -1.0):
        origins = np.repeat(middle + sign * step * normal, len(directions), 0)
        along = np.tile(directions, (len(rows), 1))
        away = np.einsum("rc,rc->r", along, np.repeat(sign * normal, len(directions), 0)) > 0.1
        free = away & (skin.rays.cast(origins, along).triangle < 0)
        total = np.zeros(len(skin.faces))
        total[rows] = free.reshape(len(rows), len(directions)).sum(1)
        counts.append(total)
    return counts[0], counts[1]


def _signed_volume(skin: Skin, part: np.ndarray) -> np.ndarray:
    """Volume between each face and the middle of its part's corners."""
    count = int(part.max()) + 1
    size = np.maximum(np.bincount(part, minlength=count), 1)
    middle = np.stack(
        [np.bincount(part, skin.corners.mean(1)[:, k], count) / size for k in range(3)], 1
    )
    return np.linalg.det(skin.corners - middle[part][:, None]) / 6.0
