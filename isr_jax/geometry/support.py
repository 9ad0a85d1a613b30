"""The one height at which a thing is carried (host)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float, Int

from ..types import Box, Entity
from .planes import plane_heights

LEVEL_COSINE = 0.98
"""Layout whose |n . up| is larger is made exactly level when it is written, at the mean height of
its corners: the world frame says that floors are level."""


def support_heights(
    entities: Sequence[Entity],
    parent: Int[np.ndarray, " entities"],
    support_plane: Int[np.ndarray, " entities"],
    box: Box,
) -> Float[np.ndarray, " entities"]:
    """d^s: height at which each entity is carried, metres.

    On layout that is written level (`LEVEL_COSINE`) it is the mean height of the plane's corners;
    on any other plane the plane's height at the centre of the entity's box. Where nothing carries
    it, or the carrying plane was not seen, it is the bottom of the box.

    Args:
        entities: Of one scene or more, end to end.
        parent: Position of what carries each, negative where nothing does.
        support_plane: Plane of the parent, -1 where none was seen.
        box: [entities], world frame.
    """
    center = np.asarray(box.center, np.float64)
    height = center[:, 2] - np.asarray(box.size, np.float64)[:, 2] / 2
    for i in np.flatnonzero((np.asarray(parent) >= 0) & (np.asarray(support_plane) >= 0)).tolist():
        carrier, k = entities[int(parent[i])], int(support_plane[i])
        height[i] = _plane_height(carrier, k, center[i, :2])
    return height.astype(np.float32)


def _plane_height(carrier: Entity, k: int, xy: Float[np.ndarray, "2"]) -> float:
    normal = np.asarray(carrier.planes.normal[k], np.float64)
    if carrier.is_layout and abs(normal[2]) > LEVEL_COSINE:
        return float(np.asarray(carrier.planes.corners[k], np.float64)[:, 2].mean())
    offset = np.asarray(carrier.planes.offset[k], np.float64)
    return float(plane_heights(normal, offset, xy))
