"""How well one plane carries one child: kernels for a single (child, entity, plane) triple."""

from __future__ import annotations

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Bool, Float

from ..geometry import (
    convex_overlap_area,
    footprint_corners,
    plane_height_at,
    points_in_box_frame,
)
from ..types import Array, Box

_MIN_AREA_M2 = 1e-8
"""Keeps the ratio finite for a box without extent."""


class Support(eqx.Module):
    """Terms of the support score of a (child, entity, plane) triple."""

    gap_m: Float[Array, "*batch"]
    """D (Eq. 1): height of the child's bottom above the plane, at the child's centre."""
    contact: Float[Array, "*batch"]
    """A (Eq. 2): contact area over the area of the child's bottom, in [0, 1]."""
    score: Float[Array, "*batch"]
    """S (Eq. 3), in [0, 1]."""


def vertex_contact(
    child: Box,
    normal: Float[Array, "3"],
    offset: Float[Array, ""],
    points: Float[Array, "points 3"],
    valid: Bool[Array, " points"],
    near_m: Float[Array, ""],
    rim_m: Float[Array, ""],
) -> Float[Array, ""]:
    """A (Eq. 2): the rectangle of the carrier's vertices below the child, over its bottom.

    The paper takes the vertices inside the child's box. There are none when the child hovers
    over the plane, and under a solid child the carrier was never seen: hence all vertices within
    ``near_m`` of the plane whose place is in the child's footprint grown by ``rim_m``; the
    rectangle lies along the child's sides and is cut back to the footprint.

    Args:
        child: World frame.
        normal, offset: The plane, world frame.
        points: Vertices of the carrier, world frame; at least those near the plane.
        valid: False for padding.
        near_m: Vertices so near count as on the plane.
        rim_m: Reaches the rim of the hole that the child leaves in the carrier. Since what lies
            outside the footprint is moved onto its border, a wide rim adds no area of its own.
    """
    half = child.size[:2] / 2
    place = points_in_box_frame(child, points)[:, :2]
    on_plane = jnp.abs(points @ normal + offset) <= near_m
    counts = valid & on_plane & jnp.all(jnp.abs(place) <= half + rim_m, axis=-1)
    cut = jnp.clip(place, -half, half)
    low = jnp.min(jnp.where(counts[:, None], cut, half), axis=0)
    high = jnp.max(jnp.where(counts[:, None], cut, -half), axis=0)
    area = jnp.prod(jnp.maximum(high - low, 0.0))
    return area / jnp.maximum(jnp.prod(child.size[:2]), _MIN_AREA_M2)


def polygon_contact(
    child: Box, corners: Float[Array, "4 3"], margin_m: Float[Array, ""]
) -> Float[Array, ""]:
    """A (Eq. 2) of layout: the whole rectangle of the plane counts, not what was seen of it.

    Floor is rarely seen under furniture, nor between furniture and wall, so the rectangle is
    grown by ``margin_m`` on every side. A departure from the paper.

    Args:
        child: World frame, metres.
        corners: Of the plane's rectangle, world frame, metres.
        margin_m: 0 for the rectangle itself.
    """
    along = jnp.stack([corners[1] - corners[0], corners[3] - corners[0]])
    length = jnp.maximum(jnp.linalg.norm(along, axis=-1, keepdims=True), 1e-6)
    reach = jnp.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]], corners.dtype)
    grown = corners + margin_m * reach @ (along / length)
    area = convex_overlap_area(grown[:, :2], footprint_corners(child))
    ratio = area / jnp.maximum(jnp.prod(child.size[:2]), _MIN_AREA_M2)
    return jnp.minimum(ratio, 1.0)


def support_score(
    child: Box,
    normal: Float[Array, "3"],
    offset: Float[Array, ""],
    contact: Float[Array, ""],
) -> Support:
    """Score how well a plane carries ``child``; 1 is perfect, 0 is none.

    S = (1 - min(1, |D|)) * A  (Eq. 3),   D = bottom(c) - h(plane k)  (Eq. 1)

    D is taken at the child's centre, since an observed plane may tilt a little.

    Args:
        child: World frame, metres.
        normal, offset: Plane of the carrier, facing up.
        contact: A.
    """
    bottom = child.center[2] - child.size[2] / 2
    gap = bottom - plane_height_at(normal, offset, child.center[:2])
    return Support(gap, contact, (1.0 - jnp.minimum(1.0, jnp.abs(gap))) * contact)
