"""The one height at which a thing is carried (host)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float, Int

from ..types import Box, Entity


def support_heights(
    entities: Sequence[Entity],
    parent: Int[np.ndarray, " entities"],
    support_plane: Int[np.ndarray, " entities"],
    box: Box,
) -> Float[np.ndarray, " entities"]:
    """d^s: height of the plane that carries each entity, at the centre of its box, metres.

    Where nothing carries it, or the carrying plane was not seen, it is the bottom of the box.

    Args:
        entities: Of one scene.
        parent: Position of what carries each, negative where nothing does.
        support_plane: Plane of the parent, -1 where none was seen.
        box: [entities], world frame.
    """
    center = np.asarray(box.center, np.float64)
    height = center[:, 2] - np.asarray(box.size, np.float64)[:, 2] / 2
    for i in np.flatnonzero((np.asarray(parent) >= 0) & (np.asarray(support_plane) >= 0)).tolist():
        planes, k = entities[int(parent[i])].planes, int(support_plane[i])
        normal, offset = np.asarray(planes.normal[k], np.float64), float(planes.offset[k])
        height[i] = -(offset + normal[:2] @ center[i, :2]) / normal[2]
    return height.astype(np.float32)
