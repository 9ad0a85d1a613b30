"""D, A and S of all triples: kernels in blocks, and the vertices that they count (host)."""

from __future__ import annotations

import jax
import numpy as np
from jaxtyping import Float

from ..config import ContactGraphSettings
from ..runtime.batches import in_blocks, take_rows
from ..types import Mesh
from .flat import FlatEntities
from .support import Support, polygon_contact, support_score, vertex_contact
from .triples import CULL_SLACK, DIAGONAL, Triples, footprint_bounds

_BLOCK = 64
"""Triples per call."""
_LEAST_POINTS = 256


def score_triples(flat: FlatEntities, triples: Triples, settings: ContactGraphSettings) -> Support:
    """D, A and S of every triple."""
    contact = np.zeros(len(triples), np.float32)
    polygon = flat.is_layout[triples.parent] & settings.layout_whole_polygon
    contact[polygon] = polygon_contacts(flat, triples[polygon], settings.layout_margin_m)
    contact[~polygon] = _vertex_contacts(flat, triples[~polygon], settings)
    if not len(triples):
        return Support(contact, contact, contact)

    def arguments(rows):
        at = (triples.parent[rows], triples.plane[rows])
        planes = flat.planes
        return (
            take_rows(flat.box, triples.child[rows]),
            planes.normal[at],
            planes.offset[at],
            contact[rows],
        )

    return in_blocks(_scores, arguments, len(triples), _BLOCK)


_scores = jax.jit(jax.vmap(support_score))
_polygons = jax.jit(jax.vmap(polygon_contact, (0, 0, None)))
_vertices = jax.jit(jax.vmap(vertex_contact))


def polygon_contacts(
    flat: FlatEntities, triples: Triples, margin_m: float
) -> Float[np.ndarray, " triples"]:
    """Share of the child's bottom that lies over the plane's rectangle, grown by a margin."""
    margin = np.asarray(margin_m, np.float32)

    def arguments(rows):
        corners = flat.planes.corners[triples.parent[rows], triples.plane[rows]]
        return take_rows(flat.box, triples.child[rows]), corners, margin

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
        return take_rows(flat.box, child), normal, offset, points, valid, near, rim

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
            reach = settings.near_voxels * voxel * CULL_SLACK
            near[parent, k] = points_near_plane(
                flat.items[parent].mesh, normal, offset, reach, voxel
            )
        points, low_high = near[parent, k], footprint_bounds(flat.items[child].box)
        grow = settings.rim_voxels * DIAGONAL * flat.voxel_m[child] * CULL_SLACK
        inside = (points[:, :2] >= low_high[0] - grow) & (points[:, :2] <= low_high[1] + grow)
        clouds.append(points[inside.all(-1)].astype(np.float32))
    return clouds


def points_near_plane(
    mesh: Mesh, normal: Float[np.ndarray, "3"], offset: float, near_m: float, spacing_m: float
) -> Float[np.ndarray, "points 3"]:
    """Vertices within ``near_m`` of a plane, and points on the coarse faces that lie there.

    A scan has a vertex every voxel. A modelled table top may be two triangles; it carries all
    the same, so faces with a side longer than ``2 spacing_m`` are filled with points.
    """
    vertices = np.asarray(mesh.vertices, np.float32)
    near = np.abs(vertices @ normal + np.float32(offset)) <= near_m
    corners = vertices[mesh.faces[near[mesh.faces].all(-1)]]
    sides = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=-1)
    longest = sides.max(-1, initial=0.0)
    coarse = longest > 2 * spacing_m
    doublings = np.ceil(np.log2(longest[coarse] / spacing_m)).astype(int)
    filled = [
        _lattice(1 << int(level)) @ corners[coarse][doublings == level]
        for level in np.unique(doublings)
    ]
    points = [vertices[near], *(block.reshape(-1, 3) for block in filled)]
    return np.concatenate(points).astype(np.float32)


def _lattice(steps: int) -> Float[np.ndarray, "points 3"]:
    """Weights of the corners at the nodes that cut each side of a triangle into ``steps``."""
    i, j = np.indices((steps + 1, steps + 1))
    inside = i + j <= steps
    a, b = i[inside] / steps, j[inside] / steps
    return np.stack([1 - a - b, a, b], -1)
