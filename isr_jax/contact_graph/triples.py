"""All (child, entity, plane) triples in which the plane may carry the child (host)."""

from __future__ import annotations

import dataclasses

import numpy as np
from jaxtyping import Float, Int

from ..config import ContactGraphSettings
from ..geometry import plane_heights
from ..types import Box
from .flat import FlatEntities

CULL_SLACK = 1.01
"""Culling on the host keeps a little more than the kernel counts, whatever the rounding."""
_GAP_SLACK_M = 1e-3
DIAGONAL = 2**0.5
"""A margin along a box's own axes reaches at most so much farther along the world's."""


@dataclasses.dataclass(frozen=True, eq=False)
class Triples:
    """(child, entity, plane) on one flat axis, by position in the flat entities."""

    child: Int[np.ndarray, " triples"]
    parent: Int[np.ndarray, " triples"]
    plane: Int[np.ndarray, " triples"]

    def __len__(self) -> int:
        return len(self.child)

    def __getitem__(self, which: np.ndarray) -> Triples:
        """Some of the triples, by mask or rows."""
        return Triples(self.child[which], self.parent[which], self.plane[which])


def candidate_triples(
    flat: FlatEntities, settings: ContactGraphSettings, up_cosine: float
) -> Triples:
    """Triples within a scene whose plane faces up and may lie below the child.

    Layout is never a child. A thing carries only things whose bottom lies higher than its own
    (ties by id), so no cycle can close; layout, which nothing carries, needs no such order.
    Pairs whose bounding rectangles (world axes) do not meet have A = 0 and are left out, and so
    are planes more than a metre below the child (S = 0) or too far above its bottom.
    """
    facing = np.asarray(flat.planes.valid) & (flat.planes.normal[..., 2] >= up_cosine)
    low, high = _reach(flat, settings)
    sink = max(settings.max_sink_m, settings.attach_distance_m)
    found = []
    for scene in range(len(flat.start) - 1):
        span = np.arange(*flat.start[scene : scene + 2])
        child, parent = span[:, None], span[None, :]
        pair = ~flat.is_layout[child] & (child != parent)
        pair &= flat.is_layout[parent] | (flat.rank[parent] < flat.rank[child])
        pair &= np.all((low[child] <= high[parent]) & (low[parent] <= high[child]), axis=-1)
        c, p, k = np.nonzero(pair[:, :, None] & facing[span][None])
        c, p = span[c], span[p]
        gap = _gaps(flat, c, p, k)
        near = (gap < 1.0) & (flat.is_layout[p] | (gap > -sink - _GAP_SLACK_M))
        found.append((c[near], p[near], k[near]))
    columns = zip(*found, strict=True) if found else [[np.zeros(0, np.int32)]] * 3
    return Triples(*(np.concatenate(column).astype(np.int32) for column in columns))


def _gaps(
    flat: FlatEntities, child: np.ndarray, parent: np.ndarray, plane: np.ndarray
) -> Float[np.ndarray, " triples"]:
    """D of every triple, for culling."""
    normal, offset = flat.planes.normal[parent, plane], flat.planes.offset[parent, plane]
    return flat.bottom[child] - plane_heights(normal, offset, flat.box.center[child, :2])


def _reach(
    flat: FlatEntities, settings: ContactGraphSettings
) -> tuple[Float[np.ndarray, "entities 2"], Float[np.ndarray, "entities 2"]]:
    """Rectangle in world axes that holds an entity's footprint, vertices and layout polygons."""
    low = np.zeros((len(flat.items), 2), np.float32)
    high = np.zeros_like(low)
    for row, entity in enumerate(flat.items):
        points = [entity.mesh.vertices[:, :2], footprint_bounds(entity.box)]
        margin = settings.rim_voxels * flat.voxel_m[row] * CULL_SLACK
        if entity.is_layout:
            points.append(np.asarray(entity.planes.corners).reshape(-1, 3)[:, :2])
            margin += settings.layout_margin_m * DIAGONAL
        stacked = np.concatenate(points)
        low[row], high[row] = stacked.min(0) - margin, stacked.max(0) + margin
    return low, high


def footprint_bounds(box: Box) -> Float[np.ndarray, "2 2"]:
    """Low and high of a box's footprint in world axes."""
    c, s = np.cos(float(box.yaw)), np.sin(float(box.yaw))
    half = np.abs([[c, -s], [s, c]]) @ (np.asarray(box.size)[:2] / 2)
    return np.stack([box.center[:2] - half, box.center[:2] + half])
