"""Faces of a mesh that lie in one plane, and are no facets of something curved."""

from __future__ import annotations

import dataclasses

import numpy as np
from jaxtyping import Bool, Float

from ...adjacency import adjacency
from .skin import Skin

_SMOOTH_COSINE = float(np.cos(np.radians(25)))
"""Faces that meet flatter than this belong to one smooth patch."""
_FLAT_SHARE = 0.1
"""A facet with less of its smooth patch's area is part of something curved."""
_NORMAL_STEPS = 12
_OFFSET_STEP_M = 0.006
_SPLIT = 4
"""Bins may cut a plane into so many parts; together they are found again."""
_MAX_TRIES = 300


@dataclasses.dataclass(frozen=True, eq=False)
class Sheet:
    """Coplanar faces of one link, connected or not."""

    link: int
    normal: Float[np.ndarray, "3"]
    """Unit, outward."""
    offset: float
    corners: Float[np.ndarray, "faces 3 3"]
    area_m2: float


@dataclasses.dataclass(frozen=True, eq=False)
class _Faces:
    """Faces and, of two-sided ones, their reverse."""

    corners: np.ndarray
    normal: np.ndarray
    area: np.ndarray
    link: np.ndarray
    patch: np.ndarray


def find_sheets(
    skin: Skin,
    two_sided: Bool[np.ndarray, " faces"],
    *,
    least_m2: float,
    least_level_m2: float,
    angle_rad: float,
    gap_m: float,
) -> list[Sheet]:
    """Sheets of at least ``least_m2`` (``least_level_m2`` if they face up), largest bins first.

    Args:
        angle_rad, gap_m: How far a face may turn, and its corners lie, off the plane.
    """
    patch, patch_area = _smooth_patches(skin)
    faces = _both_sides(skin, two_sided, patch)
    near = np.flatnonzero(_bin_areas(faces) >= min(least_m2, least_level_m2) / _SPLIT)
    order = near[np.argsort(-faces.area[near], kind="stable")]
    free = np.ones(len(faces.area), bool)
    sheets: list[Sheet] = []
    for seed in _seeds(faces, order, free):
        rows = _inliers(faces, seed, free, angle_rad, gap_m)
        free[rows] = False
        least = least_level_m2 if faces.normal[seed, 2] > 0.9 else least_m2
        area = float(faces.area[rows].sum())
        if area < least or _is_curved(faces, rows, patch_area, area):
            continue
        normal, offset = _fit(faces, rows)
        sheets.append(Sheet(int(faces.link[seed]), normal, offset, faces.corners[rows], area))
    return sheets


def _seeds(faces: _Faces, order: np.ndarray, free: np.ndarray):
    """Largest face that is still free, again and again."""
    position = 0
    for _ in range(_MAX_TRIES):
        while position < len(order) and not free[order[position]]:
            position += 1
        if position == len(order):
            return
        yield int(order[position])


def _smooth_patches(skin: Skin) -> tuple[np.ndarray, np.ndarray]:
    """Smooth patch of each face, and the area of each patch."""
    shared = adjacency(skin.faces)
    a, b = shared.pairs.T
    cosine = np.einsum("pc,pc->p", skin.normal[a], skin.normal[b])
    patch = shared.components(len(skin.faces), cosine > _SMOOTH_COSINE)
    return patch, np.bincount(patch, skin.area)


def _both_sides(skin: Skin, two_sided: np.ndarray, patch: np.ndarray) -> _Faces:
    def twice(values: np.ndarray, back: np.ndarray) -> np.ndarray:
        return np.concatenate([values, back[two_sided]])

    return _Faces(
        twice(skin.corners, skin.corners[:, ::-1]),
        twice(skin.normal, -skin.normal),
        twice(skin.area, skin.area),
        twice(skin.link, skin.link),
        twice(patch, patch),
    )


def _bin_areas(faces: _Faces) -> np.ndarray:
    """For each face the area of all faces with nearly its normal and offset, in coarse bins."""
    offset = np.einsum("fc,fc->f", faces.normal, faces.corners.mean(1))
    keys = np.concatenate(
        [
            np.round(faces.normal * _NORMAL_STEPS),
            np.round(offset / _OFFSET_STEP_M)[:, None],
            faces.link[:, None],
        ],
        axis=1,
    ).astype(np.int64)
    keys -= keys.min(0)
    one = np.zeros(len(keys), np.int64)
    for column, width in zip(keys.T, keys.max(0) + 1):
        one = one * width + column
    _, inverse = np.unique(one, return_inverse=True)
    return np.bincount(inverse, faces.area)[inverse]


def _inliers(
    faces: _Faces, seed: int, free: np.ndarray, angle_rad: float, gap_m: float
) -> np.ndarray:
    """Free faces of the seed's link in its plane, the plane fitted twice."""
    rows = np.array([seed])
    candidates = np.flatnonzero(free & (faces.link == faces.link[seed]))
    # Wider than the bound: the seed's own normal may be off by as much the other way.
    aligned = faces.normal[candidates] @ faces.normal[seed] > np.cos(2 * angle_rad)
    candidates = candidates[aligned]
    for _ in range(2):
        normal, offset = _fit(faces, rows)
        flat = faces.normal[candidates] @ normal > np.cos(angle_rad)
        distance = np.abs(faces.corners[candidates] @ normal + offset).max(1)
        rows = candidates[flat & (distance <= gap_m)]
        if not len(rows):
            return np.array([seed])
    return rows if seed in rows else np.append(rows, seed)


def _fit(faces: _Faces, rows: np.ndarray) -> tuple[np.ndarray, float]:
    """Mean plane of faces, weighted by area."""
    weight = faces.area[rows]
    normal = weight @ faces.normal[rows]
    normal /= np.linalg.norm(normal)
    normal[np.abs(normal) < 1e-6] = 0.0
    normal /= np.linalg.norm(normal)
    middle = weight @ faces.corners[rows].mean(1) / weight.sum()
    return normal, float(-normal @ middle)


def _is_curved(faces: _Faces, rows: np.ndarray, patch_area: np.ndarray, area_m2: float) -> bool:
    """Whether the faces are a small part of the smooth patches that they belong to."""
    patches = np.unique(faces.patch[rows])
    own = np.bincount(np.searchsorted(patches, faces.patch[rows]), faces.area[rows])
    flat = own >= _FLAT_SHARE * patch_area[patches]
    return bool(own[flat].sum() < 0.5 * area_m2)
