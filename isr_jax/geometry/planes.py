"""Planes pi = [n, d], n . v + d = 0, n a unit vector."""

from __future__ import annotations

from collections.abc import Sequence

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Float

from ..types import Array, PlaneSet

WALL_COSINE = 0.3
"""A layout plane with a smaller |n . up| is a wall."""


def transform_planes(
    scale: Float[Array, ""],
    rotation: Float[Array, "3 3"],
    translation: Float[Array, "3"],
    normal: Float[Array, "planes 3"],
    offset: Float[Array, " planes"],
) -> tuple[Float[Array, "planes 3"], Float[Array, " planes"]]:
    """Planes under T = [scale R, p], made unit again: n' = R n, d' = scale d - n' . p.

    The raw product T^-T pi has a normal of length 1 / scale; an alignment on it converges to a
    wrong scale.
    """
    moved = normal @ rotation.T
    return moved, scale * offset - moved @ translation


def plane_height_at(
    normal: Float[Array, "3"], offset: Float[Array, ""], xy: Float[Array, "2"]
) -> Float[Array, ""]:
    """Height z of an up-facing plane at a horizontal position, metres."""
    safe = jnp.where(jnp.abs(normal[2]) > 1e-6, normal[2], 1.0)
    return -(offset + jnp.dot(normal[:2], xy)) / safe


def plane_heights(
    normal: Float[Array, "*planes 3"],
    offset: Float[Array, "*planes"],
    xy: Float[Array, "*planes 2"],
) -> Float[np.ndarray, "*planes"]:
    """`plane_height_at` of planes that are not upright, in their own precision (host)."""
    normal, offset = np.asarray(normal), np.asarray(offset)
    return np.asarray(-(offset + np.sum(normal[..., :2] * xy, -1)) / normal[..., 2])


def stack_planes(sets: Sequence[PlaneSet], width: int = 1) -> PlaneSet:
    """[sets, planes]: padded to the most planes that any set has, at least ``width`` (host)."""
    shape = (len(sets), max([width, *(len(planes.offset) for planes in sets)]))
    stacked = PlaneSet(
        normal=np.tile(np.array([0, 0, 1], np.float32), (*shape, 1)),
        offset=np.zeros(shape, np.float32),
        corners=np.zeros((*shape, 4, 3), np.float32),
        area_m2=np.zeros(shape, np.float32),
        valid=np.zeros(shape, bool),
    )
    for row, planes in enumerate(sets):
        for padded, leaf in zip(jax.tree.leaves(stacked), jax.tree.leaves(planes), strict=True):
            padded[row, : len(leaf)] = leaf
    return stacked


def beside_wall(
    corners: Float[Array, "corners 3"],
    normal: Float[Array, "3"],
    extent: Float[Array, "_ 3"],
    slack_m: float = 0.0,
) -> bool:
    """Whether a box lies beside the length of a wall, its height left aside (host).

    Heights are not compared, since the upper part of a wall is often not seen.

    Args:
        corners: Of the box, world frame.
        normal: Of the wall.
        extent: Corners of the wall's rectangles, world frame.
        slack_m: Past its ends the wall counts for so much more.
    """
    along = np.array([-normal[1], normal[0], 0.0])
    place, reach = np.asarray(corners) @ along, np.asarray(extent) @ along
    return bool(place.min() <= reach.max() + slack_m and reach.min() <= place.max() + slack_m)
