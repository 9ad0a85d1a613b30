"""Planes pi = [n, d], n . v + d = 0, n a unit vector."""

from __future__ import annotations

import jax.numpy as jnp
from jaxtyping import Float

from ..types import Array


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
