"""How alike two models look: the colour difference of their mean colours."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float

from ...types import Mesh

_XYZ_OF_RGB = np.array(
    [
        [0.4124564, 0.3575761, 0.1804375],
        [0.2126729, 0.7151522, 0.0721750],
        [0.0193339, 0.1191920, 0.9503041],
    ]
)
"""Linear sRGB to CIE XYZ (IEC 61966-2-1, white D65)."""
_CUBE = (6 / 29) ** 3


def lab_of_srgb(rgb: Float[np.ndarray, "*n 3"]) -> Float[np.ndarray, "*n 3"]:
    """CIE L*a*b* (1976, white D65) of sRGB colours in 0..1."""
    linear = np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)
    xyz = linear @ (_XYZ_OF_RGB / _XYZ_OF_RGB.sum(1, keepdims=True)).T
    root = np.where(xyz > _CUBE, np.cbrt(xyz), xyz / (3 * (6 / 29) ** 2) + 4 / 29)
    fx, fy, fz = np.moveaxis(root, -1, 0)
    return np.stack([116 * fy - 16, 500 * (fx - fy), 200 * (fy - fz)], -1)


def mean_lab(mesh: Mesh) -> Float[np.ndarray, "3"] | None:
    """Mean colour of a coloured mesh, each triangle by its area; None without colours or area."""
    if mesh.colors is None or len(mesh.faces) == 0:
        return None
    a, b, c = np.moveaxis(mesh.vertices[mesh.faces].astype(np.float64), 1, 0)
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    if not area.sum() > 0:
        return None
    color = mesh.colors[mesh.faces].astype(np.float64).mean(1) / 255
    return area @ lab_of_srgb(color) / area.sum()


def delta_e(a: Float[np.ndarray, "3"], b: Float[np.ndarray, "3"]) -> float:
    """Colour difference CIEDE2000 of two L*a*b* colours (Luo, Cui and Rigg 2001; the formulae in
    the order of Sharma, Wu and Dalal 2005, Eqs. 2-22). About 1 is just seen; black to white is
    100."""
    chroma = (np.hypot(a[1], a[2]) + np.hypot(b[1], b[2])) / 2
    g = 0.5 * (1 - np.sqrt(chroma**7 / (chroma**7 + 25.0**7)))
    (c1, h1), (c2, h2) = (_chroma_hue((1 + g) * lab[1], lab[2]) for lab in (a, b))
    d_hue = _hue_difference(c1, h1, c2, h2)
    d_light, d_chroma = b[0] - a[0], c2 - c1
    d_tint = 2 * np.sqrt(c1 * c2) * np.sin(d_hue / 2)
    light, mean_c = (a[0] + b[0]) / 2, (c1 + c2) / 2
    hue = h1 + d_hue / 2 if c1 * c2 else h1 + h2
    t = (
        1
        - 0.17 * np.cos(hue - np.deg2rad(30))
        + 0.24 * np.cos(2 * hue)
        + 0.32 * np.cos(3 * hue + np.deg2rad(6))
        - 0.20 * np.cos(4 * hue - np.deg2rad(63))
    )
    s_light = 1 + 0.015 * (light - 50) ** 2 / np.sqrt(20 + (light - 50) ** 2)
    s_chroma, s_tint = 1 + 0.045 * mean_c, 1 + 0.015 * mean_c * t
    turn = np.deg2rad(30) * np.exp(-((((np.rad2deg(hue) % 360) - 275) / 25) ** 2))
    spin = -2 * np.sqrt(mean_c**7 / (mean_c**7 + 25.0**7)) * np.sin(2 * turn)
    parts = d_light / s_light, d_chroma / s_chroma, d_tint / s_tint
    return float(np.sqrt(sum(p * p for p in parts) + spin * parts[1] * parts[2]))


def _chroma_hue(a: float, b: float) -> tuple[float, float]:
    return float(np.hypot(a, b)), float(np.arctan2(b, a) % (2 * np.pi))


def _hue_difference(c1: float, h1: float, c2: float, h2: float) -> float:
    """From the first hue to the second the short way round, radians; 0 where a colour is grey."""
    return 0.0 if c1 * c2 == 0 else float((h2 - h1 + np.pi) % (2 * np.pi) - np.pi)
