"""Border: coacd and vhacdx. One mesh as convex pieces, the same every time."""

from __future__ import annotations

import coacd
import fast_simplification
import numpy as np
import vhacdx
from jaxtyping import Float, Int

_MAX_FACES = 6000
_COACD_RANGE = (0.03, 0.3)
"""Concavity in half the mesh's largest side: finer takes minutes, coarser is one hull."""
_SEED = 0

Pieces = list[np.ndarray]
"""Points [n, 3] of each convex piece."""


def coacd_pieces(
    vertices: Float[np.ndarray, "vertices 3"],
    faces: Int[np.ndarray, "faces 3"],
    concavity_m: float,
    max_pieces: int,
) -> Pieces:
    """Approximate convex decomposition by Monte Carlo tree search (Wei et al., 2022).

    Open and self-intersecting meshes are first remeshed to a closed one.
    """
    coacd.set_log_level("error")
    vertices, faces = _simplified(vertices, faces)
    half = float(np.ptp(vertices, axis=0).max()) / 2
    parts = coacd.run_coacd(
        coacd.Mesh(np.asarray(vertices, np.float64), np.asarray(faces, np.int32)),
        threshold=float(np.clip(concavity_m / half, *_COACD_RANGE)),
        max_convex_hull=max_pieces,
        preprocess_mode="auto",
        preprocess_resolution=40,
        resolution=1000,
        mcts_nodes=12,
        mcts_iterations=60,
        mcts_max_depth=2,
        seed=_SEED,
    )
    return [np.asarray(points, np.float64) for points, _ in parts]


def vhacd_pieces(
    vertices: Float[np.ndarray, "vertices 3"],
    faces: Int[np.ndarray, "faces 3"],
    resolution: int,
    max_pieces: int,
) -> Pieces:
    """Voxel-based decomposition: fast, coarser."""
    vertices, faces = _simplified(vertices, faces)
    parts = vhacdx.compute_vhacd(
        np.asarray(vertices, np.float64),
        np.asarray(faces, np.uint32),
        maxConvexHulls=max_pieces,
        resolution=resolution,
        maxNumVerticesPerCH=64,
        asyncACD=False,
    )
    return [np.asarray(points, np.float64) for points, _ in parts]


def _simplified(vertices: np.ndarray, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    if len(faces) <= _MAX_FACES:
        return vertices, faces
    points, rows = fast_simplification.simplify(
        np.asarray(vertices, np.float64), np.asarray(faces, np.int32), target_count=_MAX_FACES
    )[:2]
    return points, rows
