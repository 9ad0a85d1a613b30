"""Planes of an imported mesh: coplanar connected faces, what is free, seen, and can carry.

The same planes as the kit's, by the same limits; but where the kit knows solids, here rays tell
what is covered: a ray that first meets a face from behind started inside something.
"""

from __future__ import annotations

import dataclasses
import functools

import numpy as np
from jaxtyping import Bool
from scipy import ndimage

from ....borders.raycast import RayScene
from ....types import Mesh
from ...kit.solids import plane_axes
from ...planes import (
    CLEARANCE_M,
    LEAST_SIGHT_COSINE,
    LEVEL_COSINE,
    MAX_PLANES,
    MIN_AREA_SHARE,
    MIN_SUPPORT_AREA_M2,
    SEEN_SHARE,
    SIGHT_POINTS,
    Plane,
    can_carry,
    rectangle_corners,
    sphere_directions,
)
from .coplanar import Sheet, find_sheets
from .settings import ConvertSettings
from .skin import Skin

_CELLS = 1200
_MIN_CELL_M = 0.004
_MAX_CELL_M = 0.03
_PROBE_M = 0.001
_SOFT_ANGLE_RAD = 0.35
_SOFT_GAP_M = 0.025
_SEAT_SHARE = 0.2
"""Of the footprint: with less that is level, the seat itself is not."""
_MAX_SOFT = 3
_MAX_SUPPORTING = 2 * MAX_PLANES


def find_planes(
    skin: Skin,
    sheet: Bool[np.ndarray, " faces"],
    body: Bool[np.ndarray, " faces"],
    link_names: tuple[str, ...],
    settings: ConvertSettings,
) -> list[Plane]:
    """Supporting planes, largest first, then the largest others that are seen from outside.

    Args:
        skin: Canonical frame, joints closed, faces wound outwards.
        sheet: Faces both sides of which count.
        body: Faces that may give planes; the others are only in the way.
    """
    x, y, z = np.ptp(skin.corners[body].reshape(-1, 3), axis=0)
    least = float(MIN_AREA_SHARE * (x * y + y * z + x * z))
    space = _Space(skin, sheet)
    sheets = find_sheets(
        skin.only(body),
        sheet[body],
        least_m2=least,
        least_level_m2=min(least, MIN_SUPPORT_AREA_M2),
        angle_rad=settings.plane_angle_rad,
        gap_m=settings.plane_gap_m,
    )
    found = [
        plane
        for s in sheets
        for plane in _planes_of(s, space, link_names, least, settings.plane_gap_m)
    ]
    carrying = sorted((p for p in found if p.supporting), key=_largest)[:_MAX_SUPPORTING]
    others = sorted((p for p in found if not p.supporting), key=_largest)
    return carrying + others[: max(0, MAX_PLANES - len(carrying))]


def needs_seat(planes: list[Plane], skin: Skin) -> bool:
    """Whether what is level carries on too little of the footprint to be a seat."""
    seat_m2 = max((plane.area_m2 for plane in planes if plane.supporting), default=0.0)
    return bool(seat_m2 < _SEAT_SHARE * skin.size[0] * skin.size[1])


def soft_seats(
    skin: Skin, sheet: Bool[np.ndarray, " faces"], link_names: tuple[str, ...]
) -> list[Plane]:
    """Supporting planes through what is level but for some centimetres, the largest first."""
    level = skin.normal[:, 2] > np.cos(_SOFT_ANGLE_RAD)
    if not level.any():
        return []
    sheets = find_sheets(
        skin.only(level),
        np.zeros(int(level.sum()), bool),
        least_m2=np.inf,
        least_level_m2=MIN_SUPPORT_AREA_M2,
        angle_rad=_SOFT_ANGLE_RAD,
        gap_m=_SOFT_GAP_M,
    )
    space = _Space(skin, sheet)
    found = [
        plane
        for s in sheets
        for plane in _planes_of(s, space, link_names, np.inf, _SOFT_GAP_M, _SOFT_GAP_M)
    ]
    return sorted((p for p in found if p.supporting), key=_largest)[:_MAX_SOFT]


def _largest(plane: Plane) -> float:
    return -round(plane.area_m2, 6)


@dataclasses.dataclass(frozen=True, eq=False)
class _Space:
    """What rays meet."""

    skin: Skin
    sheet: np.ndarray

    def free(self, points: np.ndarray, direction: np.ndarray, length: float) -> np.ndarray:
        """Whether each point is outside of everything and sees ``length`` far."""
        hits = self.skin.rays.cast(points, np.tile(direction, (len(points), 1)))
        hit = hits.triangle >= 0
        inside = hit & (hits.normal @ direction > 0) & ~self.sheet[hits.triangle]
        return ~inside & ~(hit & (hits.distance < length))

    def seen(self, points: np.ndarray, normal: np.ndarray) -> float:
        """Part of the points with a clear line of sight to far outside."""
        directions = sphere_directions()
        directions = directions[directions @ normal > LEAST_SIGHT_COSINE]
        origins = np.repeat(points, len(directions), 0)
        hits = self.skin.rays.cast(origins, np.tile(directions, (len(points), 1)))
        return float((hits.triangle < 0).reshape(len(points), -1).any(1).mean())


@dataclasses.dataclass(frozen=True, eq=False)
class _Grid:
    """A sheet cut into even cells."""

    sheet: Sheet
    axes: np.ndarray
    """[2, 3]: u, v with u x v = normal."""
    flat: np.ndarray
    """[faces, 3, 2]: corners of its faces along the axes."""
    low: np.ndarray
    step: np.ndarray
    """[2]: side of a cell."""
    covered: np.ndarray
    """[u, v]: cells whose middle lies on a face."""

    @staticmethod
    def of(sheet: Sheet) -> _Grid:
        axes = _axes(sheet.normal)
        flat = sheet.corners @ axes.T
        low, high = flat.min((0, 1)), flat.max((0, 1))
        size = np.maximum(high - low, 1e-6)
        side = np.clip(np.sqrt(size.prod() / _CELLS), _MIN_CELL_M, _MAX_CELL_M)
        count = np.clip(np.ceil(size / side), 1, 200).astype(int)
        grid = _Grid(sheet, axes, flat, low, size / count, np.zeros(count, bool))
        return dataclasses.replace(grid, covered=grid._cover())

    def _middles(self) -> np.ndarray:
        u, v = np.indices(self.covered.shape)
        return np.stack([u + 0.5, v + 0.5], -1) * self.step + self.low

    def _cover(self) -> np.ndarray:
        corners = np.concatenate([self.flat, np.zeros((*self.flat.shape[:2], 1))], -1)
        mesh = Mesh(
            corners.reshape(-1, 3).astype(np.float32),
            np.arange(3 * len(corners), dtype=np.int32).reshape(-1, 3),
        )
        middles = self._middles().reshape(-1, 2)
        origins = np.concatenate([middles, np.ones((len(middles), 1))], 1)
        hits = RayScene([mesh], [1]).cast(origins, np.tile([0.0, 0, -1], (len(middles), 1)))
        return (hits.triangle >= 0).reshape(self.covered.shape)

    @functools.cached_property
    def points(self) -> np.ndarray:
        """[u, v, 3]: middles of the cells, on the plane."""
        return self._middles() @ self.axes - self.sheet.offset * self.sheet.normal

    def area(self, cells: np.ndarray) -> float:
        """True area of the faces, shared by cells; overlapping faces count once."""
        whole = float(self.covered.sum() * self.step.prod())
        factor = min(self.sheet.area_m2 / whole, 1.0) if whole > 0 else 0.0
        return float(cells.sum() * self.step.prod() * factor)

    def bounds(self, cells: np.ndarray) -> np.ndarray:
        """[2, 2]: low and high of the cells, moved to the nearest corners of faces."""
        spans = []
        for k in range(2):
            at = np.flatnonzero(cells.any(1 - k))
            low, high = at[0], at[-1] + 1
            values = self.flat[..., k].ravel()
            edges = self.low[k] + self.step[k] * np.array([low, high])
            near = [values[np.argmin(np.abs(values - edge))] for edge in edges]
            spans.append(np.where(np.abs(near - edges) <= 1.2 * self.step[k], near, edges))
        return np.array(spans).T

    def corners(self, cells: np.ndarray) -> np.ndarray:
        """[4, 3]: the rectangle around the cells."""
        low, high = self.bounds(cells)
        return rectangle_corners(self.axes, self.sheet.normal, self.sheet.offset, low, high)


def _axes(normal: np.ndarray) -> np.ndarray:
    """[2, 3]: u along x on what is nearly level, u level on all else; u x v = normal."""
    if abs(normal[2]) <= LEVEL_COSINE:
        return plane_axes(normal)
    u = np.array([1.0, 0, 0]) - normal[0] * normal
    u /= np.linalg.norm(u)
    return np.stack([u, np.cross(normal, u)])


def _planes_of(
    sheet: Sheet,
    space: _Space,
    link_names: tuple[str, ...],
    least_m2: float,
    gap_m: float,
    probe_m: float = _PROBE_M,
) -> list[Plane]:
    """Planes of one sheet that is flat to ``gap_m``; ``probe_m``: so far above it things begin."""
    grid, normal = _Grid.of(sheet), sheet.normal
    bare = grid.covered.copy()
    bare[bare] = space.free(grid.points[bare] + probe_m * normal, normal, _PROBE_M)
    up = np.array([0.0, 0, 1])
    planes = []
    if normal[2] > LEVEL_COSINE and bare.any():
        free = bare.copy()
        above = grid.points[free] + (gap_m + _PROBE_M) * normal
        free[free] = space.free(above, up, CLEARANCE_M)
        useful = [r for r in _regions(free) if _is_useful(grid, r)]
        planes = [_plane(grid, r, link_names, supporting=True) for r in useful]
    if planes:
        return planes
    large = [r for r in _regions(bare) if grid.area(r) >= least_m2 and _is_seen(grid, r, space)]
    return [_plane(grid, r, link_names, supporting=False) for r in large]


def _plane(
    grid: _Grid, cells: np.ndarray, link_names: tuple[str, ...], *, supporting: bool
) -> Plane:
    sheet = grid.sheet
    corners, (low, high) = grid.corners(cells), grid.bounds(cells)
    area = min(grid.area(cells), float((high - low).prod()))
    return Plane(sheet.normal, corners, area, link_names[sheet.link], supporting)


def _regions(cells: np.ndarray) -> list[np.ndarray]:
    """The cells in one piece each."""
    labels = np.zeros(cells.shape, np.int32)
    count = ndimage.label(cells, np.ones((3, 3)), output=labels)
    return [labels == k for k in range(1, int(count) + 1)]  # pyright: ignore[reportArgumentType]


def _is_useful(grid: _Grid, cells: np.ndarray) -> bool:
    low, high = grid.bounds(cells)
    return can_carry(high - low, grid.area(cells))


def _is_seen(grid: _Grid, cells: np.ndarray, space: _Space) -> bool:
    points = grid.points[cells]
    spread = np.linspace(0, len(points) - 1, min(SIGHT_POINTS, len(points))).astype(int)
    normal = grid.sheet.normal
    return space.seen(points[spread] + _PROBE_M * normal, normal) > SEEN_SHARE
