"""Order of a model's rotational symmetry about the vertical, from samples of its surface."""

from __future__ import annotations

import numpy as np
from scipy.spatial import KDTree

from .skin import Skin

_SAMPLES = 4000
_PROBES = 700
_QUANTILE = 0.98
_ROUND_TURNS_RAD = np.radians([90.0, 37.0, 61.0])
"""No regular polygon of few corners is the same under all of these."""


def symmetry_order(skin: Skin, share: float) -> int:
    """0 = round, 4, 2 or 1: the finest order under which the surface stays the same.

    Args:
        share: Of the diagonal of the footprint: how far it may deviate.
    """
    points = skin.samples(_SAMPLES)
    center = (skin.vertices.min(0) + skin.vertices.max(0)) / 2
    points = points - center
    tree = KDTree(points)
    spacing = float(np.sqrt(skin.area.sum() / _SAMPLES))
    bound = max(share * float(np.linalg.norm(skin.size[:2])), 1.2 * spacing)
    probes = points[:: _SAMPLES // _PROBES]

    def same(angle: float) -> bool:
        c, s = np.cos(angle), np.sin(angle)
        turned = probes @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]])
        return bool(np.quantile(tree.query(turned)[0], _QUANTILE) <= bound)

    if all(same(angle) for angle in _ROUND_TURNS_RAD):
        return 0
    if same(np.pi / 2):
        return 4
    return 2 if same(np.pi) else 1
