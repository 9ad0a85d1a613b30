"""Gravity-aligned boxes: corners, footprints, overlaps. Kernels are unbatched or say so."""

from __future__ import annotations

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Float

from ..types import Array, Box
from .transforms import rot_z

_SIGNS = np.array([[x, y, z] for z in (-1, 1) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))])
_CLIP_VERTICES = 8
"""Two quadrilaterals meet in at most 8 corners."""


def canonical_box(center: np.ndarray, yaw: float, size: np.ndarray) -> Box:
    """A `Box` with its yaw brought into [-pi/4, pi/4) by whole quarter turns (host)."""
    quarters = int(np.floor((yaw + np.pi / 4) / (np.pi / 2)))
    size = np.asarray(size, np.float32)
    if quarters % 2:
        size = size[[1, 0, 2]]
    yaw32 = np.float32(yaw - quarters * np.pi / 2)
    return Box(np.asarray(center, np.float32), np.asarray(yaw32, np.float32), size)


def box_at(boxes: Box, index: int) -> Box:
    """One box of a batch, on the host."""
    center, yaw, size = (np.asarray(leaf) for leaf in (boxes.center, boxes.yaw, boxes.size))
    return Box(center[index], np.asarray(yaw[index]), size[index])


def stack_boxes(boxes: list[Box]) -> Box:
    """Boxes as one batch, on the host; none give an empty one."""
    center = np.array([box.center for box in boxes], np.float32).reshape(-1, 3)
    yaw = np.array([box.yaw for box in boxes], np.float32)
    return Box(center, yaw, np.array([box.size for box in boxes], np.float32).reshape(-1, 3))


def box_corners(box: Box) -> Float[Array, "8 3"]:
    """Corners, world frame: the bottom four counter-clockwise, then the top four."""
    local = jnp.asarray(_SIGNS, jnp.float32) * box.size / 2
    return local @ rot_z(box.yaw).T + box.center


def footprint_corners(box: Box) -> Float[Array, "4 2"]:
    """Corners of the box seen from above, counter-clockwise."""
    return box_corners(box)[:4, :2]


def points_in_box_frame(box: Box, points: Float[Array, "points 3"]) -> Float[Array, "points 3"]:
    """World points in the box's own frame: centred, axes along its sides."""
    return (points - box.center) @ rot_z(box.yaw)


def _clip_half_plane(polygon, count, origin, direction):
    """Sutherland-Hodgman step: keep what lies left of the line; fixed storage, finite padding."""
    index = jnp.arange(_CLIP_VERTICES)
    following = polygon[jnp.where(index + 1 < count, index + 1, 0)]
    cross = direction[0] * (polygon[:, 1] - origin[1]) - direction[1] * (polygon[:, 0] - origin[0])
    cross_next = direction[0] * (following[:, 1] - origin[1]) - direction[1] * (
        following[:, 0] - origin[0]
    )
    live = index < count
    inside, inside_next = cross >= 0, cross_next >= 0
    span = cross - cross_next
    t = cross / jnp.where(jnp.abs(span) > 1e-12, span, 1.0)
    crossing = polygon + t[:, None] * (following - polygon)
    keep = live & inside
    cut = live & (inside != inside_next)
    before = jnp.cumsum(keep.astype(jnp.int32) + cut.astype(jnp.int32)) - keep - cut
    far = _CLIP_VERTICES  # out of range: dropped by the scatter
    out = jnp.zeros_like(polygon)
    out = out.at[jnp.where(keep, before, far)].set(polygon, mode="drop")
    out = out.at[jnp.where(cut, before + keep, far)].set(crossing, mode="drop")
    return out, jnp.minimum(jnp.sum(keep) + jnp.sum(cut), _CLIP_VERTICES)


def convex_overlap_area(a: Float[Array, "4 2"], b: Float[Array, "4 2"]) -> Float[Array, ""]:
    """Area common to two convex, counter-clockwise quadrilaterals, square metres."""
    anchor = a[0]  # coordinates near 0 keep float32 exact enough for small boxes far out
    polygon = jnp.zeros((_CLIP_VERTICES, 2), jnp.float32).at[:4].set(a - anchor)
    edges_from = b - anchor
    edges = jnp.roll(edges_from, -1, axis=0) - edges_from

    def step(carry, edge):
        polygon, count = carry
        return _clip_half_plane(polygon, count, edge[0], edge[1]), None

    start = (polygon, jnp.asarray(4, jnp.int32))
    (polygon, count), _ = jax.lax.scan(step, start, (edges_from, edges))
    index = jnp.arange(_CLIP_VERTICES)
    nxt = polygon[jnp.where(index + 1 < count, index + 1, 0)]
    twice = jnp.where(index < count, polygon[:, 0] * nxt[:, 1] - polygon[:, 1] * nxt[:, 0], 0.0)
    return jnp.maximum(jnp.sum(twice) / 2, 0.0)


def footprint_overlap_area(a: Box, b: Box) -> Float[Array, ""]:
    """Area common to two boxes seen from above, square metres."""
    return convex_overlap_area(footprint_corners(a), footprint_corners(b))


def _height_overlap(a: Box, b: Box):
    top = jnp.minimum(a.center[2] + a.size[2] / 2, b.center[2] + b.size[2] / 2)
    bottom = jnp.maximum(a.center[2] - a.size[2] / 2, b.center[2] - b.size[2] / 2)
    return top - bottom


def box_iou(a: Box, b: Box) -> Float[Array, ""]:
    """Intersection over union of two gravity-aligned oriented boxes."""
    common = footprint_overlap_area(a, b) * jnp.maximum(_height_overlap(a, b), 0.0)
    union = jnp.prod(a.size) + jnp.prod(b.size) - common
    return common / jnp.maximum(union, 1e-12)


def box_overlap_depth(a: Box, b: Box) -> Float[Array, ""]:
    """Least move that separates two boxes (separating axes), metres; negative when apart."""
    axes = jnp.concatenate([rot_z(a.yaw)[:, :2].T, rot_z(b.yaw)[:, :2].T])[:, :2]

    def along(axis):
        def extent(box):
            projected = footprint_corners(box) @ axis
            return jnp.min(projected), jnp.max(projected)

        (a0, a1), (b0, b1) = extent(a), extent(b)
        return jnp.minimum(a1 - b0, b1 - a0)

    upright = (a.size[2] + b.size[2]) / 2 - jnp.abs(a.center[2] - b.center[2])
    return jnp.minimum(jnp.min(jax.vmap(along)(axes)), upright)
