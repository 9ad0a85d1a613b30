"""All (child, entity, plane) triples that can carry at all, and their scores (host + kernels)."""

from __future__ import annotations

import dataclasses

import jax
import numpy as np
from jaxtyping import Float, Int

from ..config import ContactGraphSettings
from .flat import FlatEntities, in_blocks, take
from .support import Support, polygon_contact, support_score, vertex_contact
from .surface_points import points_near_plane

_BLOCK = 64
"""Triples a call."""
_LEAST_POINTS = 256
_CULL_SLACK = 1.01
"""Culling on the host keeps a little more than the kernel counts, whatever the rounding."""
_GAP_SLACK_M = 1e-3
_DIAGONAL = 2**0.5
"""A margin along a box's own axes reaches at most so much farther along the world's."""


@dataclasses.dataclass(frozen=True, eq=False)
class Triples:
    """(child, entity, plane) on one flat axis, by position in the flat entities."""

    child: Int[np.ndarray, " triples"]
    parent: Int[np.ndarray, " triples"]
    plane: Int[np.ndarray, " triples"]

    def __len__(self) -> int:
        return len(self.child)


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
    over = np.sum(normal[:, :2] * flat.box.center[child, :2], -1)
    return flat.bottom[child] + (offset + over) / normal[:, 2]


def _reach(
    flat: FlatEntities, settings: ContactGraphSettings
) -> tuple[Float[np.ndarray, "entities 2"], Float[np.ndarray, "entities 2"]]:
    """Rectangle in world axes that holds an entity's footprint, vertices and layout polygons."""
    low = np.zeros((len(flat.items), 2), np.float32)
    high = np.zeros_like(low)
    for row, entity in enumerate(flat.items):
        points = [entity.mesh.vertices[:, :2], _footprint(entity.box)]
        margin = settings.rim_voxels * flat.voxel_m[row] * _CULL_SLACK
        if entity.is_layout:
            points.append(np.asarray(entity.planes.corners).reshape(-1, 3)[:, :2])
            margin += settings.layout_margin_m * _DIAGONAL
        stacked = np.concatenate(points)
        low[row], high[row] = stacked.min(0) - margin, stacked.max(0) + margin
    return low, high


def _footprint(box) -> np.ndarray:
    c, s = np.cos(float(box.yaw)), np.sin(float(box.yaw))
    half = np.abs([[c, -s], [s, c]]) @ (np.asarray(box.size)[:2] / 2)
    return np.stack([box.center[:2] - half, box.center[:2] + half])


def score_triples(flat: FlatEntities, triples: Triples, settings: ContactGraphSettings) -> Support:
    """D, A and S of every triple."""
    contact = np.zeros(len(triples), np.float32)
    polygon = flat.is_layout[triples.parent] & settings.layout_whole_polygon
    contact[polygon] = polygon_contacts(flat, pick(triples, polygon), settings.layout_margin_m)
    contact[~polygon] = _vertex_contacts(flat, pick(triples, ~polygon), settings)
    if not len(triples):
        return Support(contact, contact, contact)

    def arguments(rows):
        at = (triples.parent[rows], triples.plane[rows])
        planes = flat.planes
        return (
            take(flat.box, triples.child[rows]),
            planes.normal[at],
            planes.offset[at],
            contact[rows],
        )

    return in_blocks(_scores, arguments, len(triples), _BLOCK)


_scores = jax.jit(jax.vmap(support_score))
_polygons = jax.jit(jax.vmap(polygon_contact, (0, 0, None)))
_vertices = jax.jit(jax.vmap(vertex_contact))


def pick(triples: Triples, which: np.ndarray) -> Triples:
    """Some of the triples, by mask or rows."""
    return Triples(triples.child[which], triples.parent[which], triples.plane[which])


def polygon_contacts(
    flat: FlatEntities, triples: Triples, margin_m: float
) -> Float[np.ndarray, " triples"]:
    """Share of the child's bottom that lies over the plane's rectangle, grown by a margin."""
    margin = np.asarray(margin_m, np.float32)

    def arguments(rows):
        corners = flat.planes.corners[triples.parent[rows], triples.plane[rows]]
        return take(flat.box, triples.child[rows]), corners, margin

    if not len(triples):
        return np.zeros(0, np.float32)
    return in_blocks(_polygons, arguments, len(triples), _BLOCK)


def _vertex_contacts(
    flat: FlatEntities, triples: Triples, settings: ContactGraphSettings
) -> Float[np.ndarray, " triples"]:
    """Triples sorted by their number of points, so that a block pads to its own largest."""
    clouds = _near_points(flat, triples, settings)
    order = np.argsort([len(cloud) for cloud in clouds], kind="stable")
    contact = np.zeros(len(triples), np.float32)

    def arguments(rows):
        picked = order[rows]
        points, valid = _pad([clouds[i] for i in picked])
        child, at = triples.child[picked], (triples.parent[picked], triples.plane[picked])
        normal, offset = flat.planes.normal[at], flat.planes.offset[at]
        near = flat.voxel_m[child] * np.float32(settings.near_voxels)
        rim = flat.voxel_m[child] * np.float32(settings.rim_voxels)
        return take(flat.box, child), normal, offset, points, valid, near, rim

    if len(triples):
        contact[order] = in_blocks(_vertices, arguments, len(triples), _BLOCK)
    return contact


def _pad(clouds: list[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Point sets as one block; its width steps by four, so that few widths are compiled."""
    width = _LEAST_POINTS
    while width < max(len(cloud) for cloud in clouds):
        width *= 4
    points = np.zeros((len(clouds), width, 3), np.float32)
    valid = np.zeros((len(clouds), width), bool)
    for row, cloud in enumerate(clouds):
        points[row, : len(cloud)] = cloud
        valid[row, : len(cloud)] = True
    return points, valid


def _near_points(
    flat: FlatEntities, triples: Triples, settings: ContactGraphSettings
) -> list[np.ndarray]:
    """For each triple the carrier's vertices near the plane and around the child."""
    near: dict[tuple[int, int], np.ndarray] = {}
    clouds = []
    for child, parent, k in zip(triples.child, triples.parent, triples.plane, strict=True):
        if (parent, k) not in near:
            normal = np.asarray(flat.planes.normal[parent, k])
            offset = float(flat.planes.offset[parent, k])
            voxel = float(flat.voxel_m[parent])
            reach = settings.near_voxels * voxel * _CULL_SLACK
            near[parent, k] = points_near_plane(
                flat.items[parent].mesh, normal, offset, reach, voxel
            )
        points, low_high = near[parent, k], _footprint(flat.items[child].box)
        grow = settings.rim_voxels * _DIAGONAL * flat.voxel_m[child] * _CULL_SLACK
        inside = (points[:, :2] >= low_high[0] - grow) & (points[:, :2] <= low_high[1] + grow)
        clouds.append(points[inside.all(-1)].astype(np.float32))
    return clouds
