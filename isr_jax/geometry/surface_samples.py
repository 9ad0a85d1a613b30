"""Points spread evenly over a triangle mesh: the same bytes on every machine (host)."""

from __future__ import annotations

import dataclasses

import numpy as np
from jaxtyping import Float

_PLASTIC = 1.324717957244746
"""Root of x^3 = x + 1: its inverse powers give the R2 sequence, evenly spread in the square."""


@dataclasses.dataclass(frozen=True, eq=False)
class SurfaceSamples:
    """Points of a surface, each for the same share of its area."""

    points: Float[np.ndarray, "samples 3"]
    """Metres, frame of the mesh."""
    normals: Float[np.ndarray, "samples 3"]
    """Of the face, as its corners turn; of numbers that half precision holds."""


def surface_samples(
    vertices: Float[np.ndarray, "vertices 3"], faces: np.ndarray, count: int = 512
) -> SurfaceSamples:
    """``count`` points, stratified by area over the faces in their order.

    Sample i lies at the (i + 1/2)/count quantile of the summed area; where in its triangle, the
    R2 low-discrepancy sequence says. Only elementwise float64 arithmetic, whose results IEEE 754
    fixes: no matrix products, no library random numbers.
    """
    a, b, c = np.moveaxis(np.asarray(vertices, np.float64)[faces], 1, 0)
    normal = _cross(b - a, c - a)
    doubled = np.sqrt(normal[:, 0] ** 2 + normal[:, 1] ** 2 + normal[:, 2] ** 2)
    reached = np.cumsum(doubled)
    if len(reached) == 0 or not reached[-1] > 0:
        return SurfaceSamples(*np.zeros((2, 0, 3), np.float32))
    step = np.arange(count) + 0.5
    face = np.searchsorted(reached, step / count * reached[-1], side="right")
    u, v = (step / _PLASTIC) % 1.0, (step / _PLASTIC / _PLASTIC) % 1.0
    root = np.sqrt(u)  # uniform in the triangle: 1 - sqrt(u), sqrt(u)(1 - v), sqrt(u) v
    weights = np.stack([1 - root, root * (1 - v), root * v])[..., None]
    points = weights[0] * a[face] + weights[1] * b[face] + weights[2] * c[face]
    normals = (normal[face] / doubled[face, None]).astype(np.float16)
    return SurfaceSamples(points.astype(np.float32), normals.astype(np.float32))


def _cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    x, y, z = ((1, 2), (2, 0), (0, 1))
    return np.stack([a[:, i] * b[:, j] - a[:, j] * b[:, i] for i, j in (x, y, z)], 1)
