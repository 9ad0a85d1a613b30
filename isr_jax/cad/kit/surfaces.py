"""Planes of a model from the faces of its convex solids: what is free, seen, and can carry."""

from __future__ import annotations

import dataclasses
import functools

import numpy as np
from scipy import ndimage

from ..planes import (
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
from .solids import area_vector, plane_axes
from .space import PROBE_M, Piece, Space

MIN_OTHER_PLANES = 8
"""The largest ones that carry nothing stay, however many shelves there are: its outer sides."""
MIN_PLANES = 2
"""A model without so many of that size (a plant) keeps its largest smaller ones."""
_OUTSIDE_M = 0.05
"""An outer side has nothing of the model further out than this."""
_GAP_M = 0.006
TIE = 1e-9
"""Added before rounding: products of round dimensions end in an exact half, which the noise of the
last bits would round up on one machine and down on another."""


def model_planes(pieces: list[Piece], size: np.ndarray) -> list[Plane]:
    """All supporting planes and the largest others that are seen from outside, joints closed.

    Of the others, outer sides come before what is further in. At most `MAX_PLANES`, or all
    supporting ones and `MIN_OTHER_PLANES`.

    Coplanar faces of a link are one plane; supporting surfaces are split where something stands
    between them, so that each rectangle is free.
    """
    space = Space.of(pieces)
    x, y, z = size
    least = MIN_AREA_SHARE * (x * y + y * z + x * z)
    sheets = _sheets(pieces)
    found = [p for sheet in sheets for p in _planes_of(sheet, space, least)]
    if len(found) < MIN_PLANES:
        found = _largest(sheets, space)
    points = np.concatenate(space.vertices)

    def rank(plane: Plane) -> tuple[bool, bool, float, list[float]]:
        beyond = ((points - plane.corners[0]) @ plane.normal).max()
        place = np.round(plane.corners.mean(0) + TIE, 4).tolist()
        area = round(plane.area_m2 + TIE, 6)
        return not plane.supporting, bool(beyond > _OUTSIDE_M), -area, place

    found.sort(key=rank)
    carrying = sum(p.supporting for p in found)
    return found[: max(MAX_PLANES, carrying + MIN_OTHER_PLANES)]


@dataclasses.dataclass(frozen=True, eq=False)
class _Sheet:
    """Coplanar faces of one link."""

    link: str
    normal: np.ndarray
    offset: float
    polygons: list[np.ndarray]
    carries: bool
    """It faces up, and things may stand on it."""

    @functools.cached_property
    def areas_m2(self) -> list[float]:
        return [float(np.linalg.norm(area_vector(polygon))) for polygon in self.polygons]


def _sheets(pieces: list[Piece]) -> list[_Sheet]:
    sheets: dict[tuple, _Sheet] = {}
    for piece in pieces:
        solid = piece.solid
        for i, (face, plane) in enumerate(zip(solid.faces, solid.planes)):
            if i in solid.hidden or i in solid.curved:
                continue
            carries = piece.carries and bool(plane[2] > LEVEL_COSINE)
            place = (*np.round(plane[:3], 3) + 0.0, round(plane[3], 4) + 0.0)
            key = (piece.link, carries, *place)
            if key not in sheets:
                sheets[key] = _Sheet(piece.link, plane[:3], plane[3], [], carries)
            sheets[key].polygons.append(solid.vertices[list(face)])
    return list(sheets.values())


@dataclasses.dataclass(frozen=True, eq=False)
class _Grid:
    """A sheet cut into cells along all edges on it and near above it."""

    sheet: _Sheet
    axes: np.ndarray
    """[2, 3]: u, v with u x v = normal."""
    u: np.ndarray
    v: np.ndarray
    owner: np.ndarray
    """[u cells, v cells]: polygon that covers the cell, -1 = none."""

    @functools.cached_property
    def centers(self) -> np.ndarray:
        """[u cells, v cells, 3] on the plane."""
        cu, cv = (self.u[1:] + self.u[:-1]) / 2, (self.v[1:] + self.v[:-1]) / 2
        flat = cu[:, None, None] * self.axes[0] + cv[None, :, None] * self.axes[1]
        return flat - self.sheet.offset * self.sheet.normal

    @functools.cached_property
    def cell_area(self) -> np.ndarray:
        return np.outer(np.diff(self.u), np.diff(self.v))

    def rectangle(self, cells: np.ndarray) -> np.ndarray:
        """Corners of the rectangle that spans the marked cells and wholly marked polygons."""
        i, j = np.flatnonzero(cells.any(1)), np.flatnonzero(cells.any(0))
        spans = [np.array([[self.u[i[0]], self.v[j[0]]], [self.u[i[-1] + 1], self.v[j[-1] + 1]]])]
        # The slanted ends of a polygon cut cells whose centres lie outside it.
        spans += [self.sheet.polygons[k] @ self.axes.T for k in self._whole(cells)]
        ends = np.concatenate(spans)
        normal, offset = self.sheet.normal, self.sheet.offset
        return rectangle_corners(self.axes, normal, offset, ends.min(0), ends.max(0))

    def area(self, cells: np.ndarray) -> float:
        """Area of the marked cells; exact where whole polygons are marked."""
        whole = self._whole(cells)
        rest = cells & ~np.isin(self.owner, whole)
        return sum(self.sheet.areas_m2[k] for k in whole) + float(self.cell_area[rest].sum())

    def _whole(self, cells: np.ndarray) -> list[int]:
        """Polygons all of whose cells are marked."""
        marked = np.unique(self.owner[cells & (self.owner >= 0)])
        cut = np.unique(self.owner[~cells & (self.owner >= 0)])
        return [int(k) for k in np.setdiff1d(marked, cut)]


def _grid(sheet: _Sheet, near_vertices: tuple[np.ndarray, ...]) -> _Grid:
    axes = plane_axes(sheet.normal)
    flat = [p @ axes.T for p in sheet.polygons]
    own = np.concatenate(flat)
    low, high = own.min(0), own.max(0)
    lines = np.concatenate([own] + [np.clip(v @ axes.T, low, high) for v in near_vertices])
    lines = np.round(lines, 5)
    u, v = (_spaced(np.unique(lines[:, k])) for k in (0, 1))
    cu, cv = np.meshgrid((u[1:] + u[:-1]) / 2, (v[1:] + v[:-1]) / 2, indexing="ij")
    owner = np.full(cu.shape, -1)
    for k, polygon in enumerate(flat):
        owner[_inside_polygon(polygon, cu, cv) & (owner < 0)] = k
    return _Grid(sheet, axes, u, v, owner)


def _spaced(lines: np.ndarray) -> np.ndarray:
    """Lines at least 0.1 mm apart, first and last kept."""
    keep = np.append(np.diff(lines) > 1e-4, True)
    keep[0] = True
    return lines[keep]


def _inside_polygon(polygon: np.ndarray, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    inside = np.ones(x.shape, bool)
    for (ax, ay), (bx, by) in zip(polygon, np.roll(polygon, -1, 0)):
        inside &= (bx - ax) * (y - ay) - (by - ay) * (x - ax) >= -1e-7
    return inside


def _planes_of(sheet: _Sheet, space: Space, least_m2: float) -> list[Plane]:
    least_useful = min(least_m2, MIN_SUPPORT_AREA_M2) if sheet.carries else least_m2
    if sum(sheet.areas_m2) < least_useful:
        return []
    near = space.above(sheet.normal, sheet.offset, CLEARANCE_M)
    grid = _grid(sheet, near.vertices)
    bare = grid.owner >= 0
    probes = grid.centers[bare] + PROBE_M * sheet.normal
    bare[bare] = ~near.blocked(probes, sheet.normal, PROBE_M)
    if sheet.carries:
        carrying = _supporting(grid, near, bare)
        if carrying:
            return carrying
    if not bare.any() or grid.area(bare) < least_m2:
        return []
    if not _is_seen(grid, space.above(sheet.normal, sheet.offset), bare):
        return []
    return [_plane(grid, bare, supporting=False)]


def _largest(sheets: list[_Sheet], space: Space) -> list[Plane]:
    """The first sheets that are half free, whatever their size, from the largest down."""
    found: list[Plane] = []
    for sheet in sorted(sheets, key=lambda s: -round(sum(s.areas_m2) + TIE, 6)):
        found += _planes_of(sheet, space, sum(sheet.areas_m2) / 2)
        if len(found) >= MIN_PLANES:
            break
    return found


def _plane(grid: _Grid, cells: np.ndarray, *, supporting: bool) -> Plane:
    sheet = grid.sheet
    return Plane(sheet.normal, grid.rectangle(cells), grid.area(cells), sheet.link, supporting)


def _supporting(grid: _Grid, near: Space, bare: np.ndarray) -> list[Plane]:
    free = bare.copy()
    above = grid.centers[free] + PROBE_M * grid.sheet.normal
    free[free] = ~near.blocked(above, np.array([0.0, 0, 1]), CLEARANCE_M)
    narrow = np.minimum.outer(np.diff(grid.u), np.diff(grid.v)) < _GAP_M
    gap = (grid.owner < 0) & narrow
    probes = grid.centers[gap] + PROBE_M * grid.sheet.normal
    gap[gap] = ~near.blocked(probes, np.array([0.0, 0, 1]), CLEARANCE_M)
    regions = _regions(grid, free, gap)
    return [_plane(grid, r, supporting=True) for r in regions if _is_useful(grid, r)]


def _regions(grid: _Grid, free: np.ndarray, gap: np.ndarray) -> list[np.ndarray]:
    """Free cells in one piece each, narrow joints bridged, L-shapes cut where polygons meet."""
    labels, regions = np.zeros(free.shape, np.int32), []
    ndimage.label(free | gap, output=labels)
    for k in range(1, int(labels.max()) + 1):
        region = (labels == k) & free
        if not region.any():
            continue
        corners, owners = grid.rectangle(region), np.unique(grid.owner[region])
        full = np.linalg.norm(corners[1] - corners[0]) * np.linalg.norm(corners[3] - corners[0])
        if grid.area(region) < 0.7 * full and len(owners) > 1:
            regions += [region & (grid.owner == owner) for owner in owners]
        else:
            regions.append(region)
    return regions


def _is_useful(grid: _Grid, cells: np.ndarray) -> bool:
    corners = grid.rectangle(cells)
    sides = np.linalg.norm(corners[[1, 3]] - corners[0], axis=1)
    return can_carry(sides, grid.area(cells))


def _is_seen(grid: _Grid, space: Space, cells: np.ndarray) -> bool:
    """Whether enough of the cells have a clear line of sight to far outside."""
    if not space.vertices:
        return True
    ends = np.cumsum(grid.cell_area[cells])
    spread = np.searchsorted(ends, (np.arange(SIGHT_POINTS) + 0.5) / SIGHT_POINTS * ends[-1])
    points = grid.centers[cells][spread] + PROBE_M * grid.sheet.normal
    heights, needed = space.heights(points), SEEN_SHARE * len(points)
    for direction in _directions_from(grid.sheet.normal):
        blocked = space.blocked_from(heights, direction, 10.0)
        needed -= np.count_nonzero(~blocked)
        if needed < 0:
            return True
        heights = heights[blocked]
    return False


def _directions_from(normal: np.ndarray) -> np.ndarray:
    """Directions that leave a surface, the steepest first."""
    steep = np.round(sphere_directions() @ normal, 9)
    order = np.argsort(-steep, kind="stable")
    return sphere_directions()[order[steep[order] > LEAST_SIGHT_COSINE]]
