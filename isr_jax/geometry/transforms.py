"""Rigid transforms. ``T_a_b`` maps points of frame b to frame a."""

from __future__ import annotations

import jax.numpy as jnp
import numpy as np
from jaxtyping import Float

from ..types import Array


def rot_z(angle: Float[Array, "*batch"]) -> Float[Array, "*batch 3 3"]:
    """Rotation about +z by ``angle`` radians."""
    c, s = jnp.cos(angle), jnp.sin(angle)
    zero, one = jnp.zeros_like(c), jnp.ones_like(c)
    rows = [jnp.stack(r, -1) for r in ((c, -s, zero), (s, c, zero), (zero, zero, one))]
    return jnp.stack(rows, -2)


def make_T(
    rotation: Float[Array, "*batch 3 3"], translation: Float[Array, "*batch 3"]
) -> Float[Array, "*batch 4 4"]:
    """Homogeneous transform from a rotation and a translation (metres)."""
    upper = jnp.concatenate([rotation, translation[..., None]], -1)
    last = jnp.broadcast_to(jnp.array([0.0, 0.0, 0.0, 1.0], upper.dtype), (*upper.shape[:-2], 1, 4))
    return jnp.concatenate([upper, last], -2)


def invert_T(T_a_b: Float[Array, "*batch 4 4"]) -> Float[Array, "*batch 4 4"]:
    """``T_b_a`` of a rigid ``T_a_b``."""
    rotation = jnp.swapaxes(T_a_b[..., :3, :3], -1, -2)
    return make_T(rotation, -(rotation @ T_a_b[..., :3, 3:])[..., 0])


def wrap_angle(angle: Float[Array, "*batch"]) -> Float[Array, "*batch"]:
    """The same angle in [-pi, pi)."""
    return jnp.mod(angle + jnp.pi, 2 * jnp.pi) - jnp.pi


def smallest_rotation(
    source: Float[np.ndarray, "3"], target: Float[np.ndarray, "3"]
) -> Float[np.ndarray, "3 3"]:
    """The rotation by the least angle that brings one unit vector to another (Rodrigues; host)."""
    axis, cosine = np.cross(source, target), float(source @ target)
    if cosine < -1 + 1e-9:  # any half turn about a perpendicular axis is smallest
        normal = np.cross(source, np.eye(3)[np.argmin(np.abs(source))])
        normal /= np.linalg.norm(normal)
        return 2 * np.outer(normal, normal) - np.eye(3)
    x, y, z = axis
    skew = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + skew + skew @ skew / (1 + cosine)


def nearest_rotation(matrix: Float[np.ndarray, "3 3"]) -> Float[np.ndarray, "3 3"]:
    """The rotation nearest to a matrix that is almost one: float32 leaves it a little off (host).

    By singular values: U V^T. Of a mirrored matrix it is the nearest reflection.
    """
    u, _, vt = np.linalg.svd(matrix)
    return u @ vt
