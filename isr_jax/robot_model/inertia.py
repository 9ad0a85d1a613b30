"""Mass, centre of mass and inertia of closed meshes, by exact integration (host)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float

from ..types import Mesh

_COVARIANCE_OF_UNIT_TETRAHEDRON = (np.ones((3, 3)) + np.eye(3)) / 120.0


def solid_properties(
    mesh: Mesh, density_kg_m3: float
) -> tuple[float, Float[np.ndarray, "3"], Float[np.ndarray, "3 3"]]:
    """Mass, centre of mass and inertia about it of a closed mesh filled evenly.

    Sums the signed tetrahedra between the origin and every face, whose second moments are
    det(A) A C A^T with A the three corners as columns and C that of the unit tetrahedron.
    """
    triangles = mesh.vertices.astype(np.float64)[mesh.faces]
    det = np.linalg.det(triangles)
    volume = det.sum() / 6.0
    com = np.einsum("f,fc->c", det, triangles.sum(1)) / (24.0 * volume)
    second = np.einsum(
        "f,fia,ij,fjb->ab", det, triangles, _COVARIANCE_OF_UNIT_TETRAHEDRON, triangles
    )
    second -= volume * np.outer(com, com)
    inertia = density_kg_m3 * (np.trace(second) * np.eye(3) - second)
    return float(density_kg_m3 * volume), com, (inertia + inertia.T) / 2


def combined_properties(
    parts: Sequence[tuple[float, Float[np.ndarray, "3"], Float[np.ndarray, "3 3"]]],
) -> tuple[float, Float[np.ndarray, "3"], Float[np.ndarray, "3 3"]]:
    """Mass, centre of mass and inertia about it of bodies that are one (parallel axes)."""
    mass = sum(m for m, _, _ in parts)
    com = sum((m * c for m, c, _ in parts), np.zeros(3)) / mass
    inertia = np.zeros((3, 3))
    for m, c, about_own in parts:
        r = c - com
        inertia += about_own + m * (r @ r * np.eye(3) - np.outer(r, r))
    return float(mass), com, inertia
