"""Planes of a model: true rectangles, within its box, on its surface, and some that carry."""

from __future__ import annotations

import numpy as np

from ...borders.raycast import RayScene
from ...library import CadModel
from .settings import CheckSettings
from .static import shortened

CARRYING_CLASSES = frozenset(
    {
        *("chair", "stool", "bench", "sofa", "bed"),
        *("table", "desk", "counter", "nightstand"),
        *("wardrobe", "cabinet", "wall_cabinet", "drawer_unit", "bookshelf"),
        *("fridge", "microwave", "oven", "dishwasher", "box"),
    }
)
"""Things are put on or into these."""
_RAYS = 2048
"""Cast at each plane's rectangle: frames around openings are a few per cent of theirs."""
_EXACT_M = 1e-4
"""How far corners may be from their own plane."""


def plane_faults(model: CadModel, settings: CheckSettings) -> list[str]:
    """Reasons why planes are wrong; none where they are sound."""
    planes = model.planes
    found = []
    if len(planes.offset) == 0:
        return ["no planes: nothing could be matched"]
    for k in range(len(planes.offset)):
        wrong = _rectangle_problem(model, k)
        found += [f"plane {k} of {model.plane_link[k]} {wrong}"] if wrong else []
    if not found:
        found += _surface_problems(model, settings)
    if model.class_name in CARRYING_CLASSES and not model.plane_supporting.any():
        found.append(f"no plane of this {model.class_name} can carry anything")
    for k in np.flatnonzero(model.plane_supporting):
        if planes.normal[k][2] < 0.9:
            found.append(f"plane {k} is said to carry, but does not face up")
    return shortened(found)


def _rectangle_problem(model: CadModel, k: int) -> str:
    normal = np.asarray(model.planes.normal[k], np.float64)
    corners = np.asarray(model.planes.corners[k], np.float64)
    if abs(np.linalg.norm(normal) - 1) > 1e-5:
        return f"has a normal of length {np.linalg.norm(normal):.4f}"
    off = float(np.abs(corners @ normal + float(model.planes.offset[k])).max())
    if off > _EXACT_M:
        return f"has corners {1000 * off:.2f} mm beside it"
    u, v = corners[1] - corners[0], corners[3] - corners[0]
    if np.abs(corners[2] - corners[0] - u - v).max() > _EXACT_M or abs(u @ v) > _EXACT_M:
        return "has corners that are no rectangle"
    full = float(np.linalg.norm(np.cross(u, v)))
    if np.cross(u, v) @ normal <= 0:
        return "has corners that run clockwise"
    if not 0 < float(model.planes.area_m2[k]) <= full * (1 + 1e-3):
        return f"has an area of {float(model.planes.area_m2[k]):.4f} of {full:.4f} m^2"
    beyond = float((np.abs(corners) - model.size / 2).max())
    return f"reaches {1000 * beyond:.1f} mm out of the box" if beyond > _EXACT_M else ""


def _surface_problems(model: CadModel, settings: CheckSettings) -> list[str]:
    """Planes that rays from just above do not find, by the share of the rectangle they find."""
    scene, near = RayScene([model.mesh], [1]), settings.plane_m
    s, t = _even_points(_RAYS)
    found = []
    for k, normal in enumerate(np.asarray(model.planes.normal, np.float64)):
        corners = np.asarray(model.planes.corners[k], np.float64)
        u, v = corners[1] - corners[0], corners[3] - corners[0]
        origins = corners[0] + s * u + t * v + near * normal
        hits = scene.cast(origins, np.tile(-normal, (len(origins), 1)))
        share = float(np.mean((hits.instance > 0) & (hits.distance <= 2 * near)))
        stated = float(model.planes.area_m2[k]) / float(np.linalg.norm(np.cross(u, v)))
        if share < settings.plane_share * stated:
            at = f"plane {k} of {model.plane_link[k]} (normal {np.round(normal, 2).tolist()})"
            found.append(f"{at}: {100 * share:.0f} % of it is surface, stated {100 * stated:.0f} %")
    return found


def _even_points(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Two columns [count, 1] in 0..1 spread evenly without rows that a thin part could miss."""
    i = np.arange(count)[:, None]
    root = 1.32471795724474602596  # of x^3 = x + 1: the plane's counterpart of the golden ratio
    return (0.5 + i / root) % 1.0, (0.5 + i / root**2) % 1.0
