"""How much of a child a candidate's planes carry: one kernel, all (plane, child) pairs at once."""

from __future__ import annotations

import functools

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Float

from ..geometry import convex_overlap_area
from ..runtime.batches import bucket
from ..types import Array

_MIN_PAIRS = 16


def contact_ratio(
    plane_corners: Float[Array, "4 2"], footprint: Float[Array, "4 2"], area_m2: Float[Array, ""]
) -> Float[Array, ""]:
    """A(v_p, v_c) = A(v_p cap v_c) / A(v_c)  (Eq. 2), of a CAD plane's rectangle.

    Args:
        plane_corners: The plane's rectangle from above, counter-clockwise.
        footprint: The child's, likewise.
        area_m2: Of the footprint.
    """
    return convex_overlap_area(plane_corners, footprint) / jnp.maximum(area_m2, 1e-9)


_batched = jax.jit(jax.vmap(contact_ratio))


def contact_ratios(planes: np.ndarray, footprints: np.ndarray) -> np.ndarray:
    """`contact_ratio` of pairs [pairs, 4, 2], padded to a power of two."""
    count = len(planes)
    if count == 0:
        return np.zeros(0, np.float32)
    extra = bucket(count, _MIN_PAIRS) - count
    pad = functools.partial(np.pad, pad_width=((0, extra), (0, 0), (0, 0)))
    planes, footprints = pad(planes.astype(np.float32)), pad(footprints.astype(np.float32))
    return np.asarray(_batched(planes, footprints, _quad_area(footprints)))[:count]


def _quad_area(quads: np.ndarray) -> np.ndarray:
    a, b = quads[:, 2] - quads[:, 0], quads[:, 3] - quads[:, 1]
    return 0.5 * (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
