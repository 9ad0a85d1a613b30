"""Faces of a mesh that share edges, and the parts that hang together by them."""

from __future__ import annotations

import dataclasses

import numpy as np
from jaxtyping import Bool, Int
from scipy import sparse
from scipy.sparse.csgraph import connected_components


@dataclasses.dataclass(frozen=True, eq=False)
class Adjacency:
    """Pairs of faces that share an edge which no third face has."""

    pairs: Int[np.ndarray, "pairs 2"]
    """Rows of faces."""
    turned: Bool[np.ndarray, " pairs"]
    """Whether the two are wound against each other."""
    closed: Bool[np.ndarray, " faces"]
    """Whether all three edges of a face are such edges."""

    def components(self, count: int, keep: Bool[np.ndarray, " pairs"] | None = None) -> np.ndarray:
        """Number of the connected part of each of ``count`` faces, over the kept pairs."""
        pairs = self.pairs if keep is None else self.pairs[keep]
        graph = sparse.coo_matrix(
            (np.ones(len(pairs), bool), (pairs[:, 0], pairs[:, 1])), shape=(count, count)
        )
        return connected_components(graph, directed=False)[1]


def adjacency(faces: Int[np.ndarray, "faces 3"]) -> Adjacency:
    """Who shares an edge with whom."""
    count = len(faces)
    a, b = faces.ravel(), faces[:, [1, 2, 0]].ravel()
    key = (np.minimum(a, b).astype(np.int64) << 32) | np.maximum(a, b)
    order = np.argsort(key, kind="stable")
    ordered = key[order]
    starts = np.flatnonzero(np.append(True, ordered[1:] != ordered[:-1]))
    lengths = np.diff(np.append(starts, len(ordered)))
    pair = starts[lengths == 2]
    first, second = order[pair], order[pair + 1]
    shared = np.bincount(np.concatenate([first, second]) // 3, minlength=count)
    pairs = np.stack([first // 3, second // 3], 1)
    return Adjacency(pairs, a[first] == a[second], shared == 3)
