"""The 24 rotations of the cube, the orientations that matching tries."""

from __future__ import annotations

import itertools

import jax.numpy as jnp
import numpy as np
from jaxtyping import Float

from ..types import Array


def _cube_rotations() -> np.ndarray:
    found = []
    for order in itertools.permutations(range(3)):
        for signs in itertools.product((1.0, -1.0), repeat=3):
            matrix = np.zeros((3, 3), np.float32)
            matrix[range(3), order] = signs
            if np.linalg.det(matrix) > 0:
                found.append(matrix)
    # Upright ones first, by their turn about z, so that ties go to the plainest orientation.
    upright = [m for m in found if m[2, 2] == 1]
    upright.sort(key=lambda m: np.arctan2(m[1, 0], m[0, 0]) % (2 * np.pi))
    tilted = [m for m in found if m[2, 2] != 1]
    return np.stack(upright + tilted)


CUBE_ROTATIONS: np.ndarray = _cube_rotations()
"""[24, 3, 3]; rows 0-3 are upright, turned by 0, 90, 180 and 270 degrees about z."""


def rotated_size(
    rotation: Float[Array, "*batch 3 3"], size: Float[Array, "*batch 3"]
) -> Float[Array, "*batch 3"]:
    """Extent of a box of ``size`` after one of `CUBE_ROTATIONS`."""
    return (jnp.abs(rotation) @ size[..., None])[..., 0]
