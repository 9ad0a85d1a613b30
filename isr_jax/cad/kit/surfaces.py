"""Planes of a model from the faces of its convex solids: what is free, seen, and can carry."""

from __future__ import annotations

import dataclasses
import functools

import numpy as np
from scipy import ndimage

from .solids import Solid, area_vector

MAX_PLANES = 16
MIN_AREA_SHARE = 0.03
"""Of the three box faces' sum: smaller planes are neither found in a scan nor kept."""
MIN_SUPPORT_SIDE_M = 0.07
MIN_SUPPORT_AREA_M2 = 0.008
MIN_SUPPORT_SHARE = 0.4
"""Of the rectangle: less is a rim around something else."""
CLEARANCE_M = 0.08
"""What stands on a surface needs at least this height above it."""
_GAP_M = 0.006
_PROBE_M = 0.0001
_SEEN_SHARE = 0.3
_SIGHT_POINTS = 32


@dataclasses.dataclass(frozen=True, eq=False)
class Piece:
    """A solid and the link that it belongs to."""

    solid: Solid
    link: str
    carries: bool = True
    """False: nobody puts things on it, flat as it may be (the foot plate of a table)."""


@dataclasses.dataclass(frozen=True, eq=False)
class Plane:
    """One plane with its rectangle, frame of the solids."""

    normal: np.ndarray
    corners: np.ndarray
    """[4, 3], counter-clockwise seen against the normal."""
    area_m2: float
    link: str
    supporting: bool


def model_planes(pieces: list[Piece], size: np.ndarray) -> list[Plane]:
    """All supporting planes and the largest others that are seen from outside, joints closed.

    Coplanar faces of a link are one plane; supporting surfaces are split where something stands
    between them, so that each rectangle is free.
    """
    space = _Space.of(pieces)
    x, y, z = size
    least = MIN_AREA_SHARE * (x * y + y * z + x * z)
    found = [p for sheet in _sheets(pieces) for p in _planes_of(sheet, space, least)]
    found.sort(key=lambda p: (not p.supporting, -round(p.area_m2, 6)))
    carrying = sum(p.supporting for p in found)
    return found[: max(MAX_PLANES, carrying)]


@dataclasses.dataclass(frozen=True, eq=False)
class _Space:
    """Half-spaces [solids, faces, 4] of all solids, padded with ones that hold everywhere."""

    planes: np.ndarray
    vertices: list[np.ndarray]

    @staticmethod
    def of(pieces: list[Piece]) -> _Space:
        rows = [piece.solid.planes for piece in pieces]
        planes = np.zeros((len(rows), max(map(len, rows)), 4))
        planes[..., 3] = -1.0
        for i, row in enumerate(rows):
            planes[i, : len(row)] = row
        return _Space(planes, [piece.solid.vertices for piece in pieces])

    def blocked(self, points: np.ndarray, direction: np.ndarray, length: float) -> np.ndarray:
        """Whether the segments from ``points`` [n, 3] along ``direction`` meet any solid."""
        normal, offset = self.planes[..., :3], self.planes[..., 3]
        start = np.einsum("sfc,nc->nsf", normal, points) + offset
        slope = normal @ direction
        safe = np.where(np.abs(slope) > 1e-9, slope, 1.0)
        crossing = -start / safe
        enter = np.where(slope < -1e-9, crossing, 0.0).max(-1)
        leave = np.where(slope > 1e-9, crossing, length).min(-1)
        outside = ((np.abs(slope) <= 1e-9) & (start > 0)).any(-1)
        return (~outside & (np.maximum(enter, 0.0) < np.minimum(leave, length) - 1e-7)).any(-1)


@dataclasses.dataclass(frozen=True, eq=False)
class _Sheet:
    """Coplanar faces of one link."""

    link: str
    normal: np.ndarray
    offset: float
    polygons: list[np.ndarray]
    carries: bool

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
            key = (
                piece.link,
                piece.carries,
                *np.round(plane[:3], 3) + 0.0,
                round(plane[3], 4) + 0.0,
            )
            if key not in sheets:
                sheets[key] = _Sheet(piece.link, plane[:3], plane[3], [], piece.carries)
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
        (u0, v0), (u1, v1) = np.concatenate(spans).min(0), np.concatenate(spans).max(0)
        flat = np.array([(u0, v0), (u1, v0), (u1, v1), (u0, v1)]) @ self.axes
        return flat - self.sheet.offset * self.sheet.normal

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


def _plane_axes(normal: np.ndarray) -> np.ndarray:
    """u level and v as steep as it gets; world x and y on level planes."""
    if abs(normal[2]) > 0.999:
        return np.array([[1.0, 0, 0], np.cross(normal, [1.0, 0, 0])])
    u = np.cross([0, 0, 1.0], normal)
    u /= np.linalg.norm(u)
    return np.stack([u, np.cross(normal, u)])


def _grid(sheet: _Sheet, space_vertices: list[np.ndarray]) -> _Grid:
    axes = _plane_axes(sheet.normal)
    flat = [p @ axes.T for p in sheet.polygons]
    own = np.concatenate(flat)
    low, high = own.min(0), own.max(0)
    near = [own] + [
        np.clip(vertices @ axes.T, low, high)
        for vertices in space_vertices
        if (vertices @ sheet.normal + sheet.offset).max() > _PROBE_M
        and (vertices @ sheet.normal + sheet.offset).min() < CLEARANCE_M
    ]
    lines = np.round(np.concatenate(near), 5)
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


def _planes_of(sheet: _Sheet, space: _Space, least_m2: float) -> list[Plane]:
    may_carry = sheet.carries and bool(sheet.normal[2] > 0.9)
    least_useful = min(least_m2, MIN_SUPPORT_AREA_M2) if may_carry else least_m2
    if sum(sheet.areas_m2) < least_useful:
        return []
    grid = _grid(sheet, space.vertices)
    bare = grid.owner >= 0
    probes = grid.centers[bare] + _PROBE_M * sheet.normal
    bare[bare] = ~space.blocked(probes, sheet.normal, _PROBE_M)
    if may_carry:
        carrying = _supporting(grid, space, bare)
        if carrying:
            return carrying
    if not bare.any() or grid.area(bare) < least_m2 or not _is_seen(grid, space, bare):
        return []
    return [_plane(grid, bare, supporting=False)]


def _plane(grid: _Grid, cells: np.ndarray, *, supporting: bool) -> Plane:
    sheet = grid.sheet
    return Plane(sheet.normal, grid.rectangle(cells), grid.area(cells), sheet.link, supporting)


def _supporting(grid: _Grid, space: _Space, bare: np.ndarray) -> list[Plane]:
    free = bare.copy()
    above = grid.centers[free] + _PROBE_M * grid.sheet.normal
    free[free] = ~space.blocked(above, np.array([0.0, 0, 1]), CLEARANCE_M)
    narrow = np.minimum.outer(np.diff(grid.u), np.diff(grid.v)) < _GAP_M
    gap = (grid.owner < 0) & narrow
    probes = grid.centers[gap] + _PROBE_M * grid.sheet.normal
    gap[gap] = ~space.blocked(probes, np.array([0.0, 0, 1]), CLEARANCE_M)
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
    least = max(MIN_SUPPORT_AREA_M2, MIN_SUPPORT_SHARE * sides.prod())
    return bool(sides.min() >= MIN_SUPPORT_SIDE_M and grid.area(cells) >= least)


@functools.cache
def _directions(count: int = 40) -> np.ndarray:
    """Directions spread evenly over the sphere (golden spiral)."""
    i = np.arange(count) + 0.5
    z, angle = 1 - 2 * i / count, np.pi * (1 + 5**0.5) * i
    ring = np.sqrt(1 - z * z)
    return np.stack([ring * np.cos(angle), ring * np.sin(angle), z], 1)


def _is_seen(grid: _Grid, space: _Space, cells: np.ndarray) -> bool:
    """Whether enough of the cells have a clear line of sight to far outside."""
    ends = np.cumsum(grid.cell_area[cells])
    spread = np.searchsorted(ends, (np.arange(_SIGHT_POINTS) + 0.5) / _SIGHT_POINTS * ends[-1])
    points = grid.centers[cells][spread] + _PROBE_M * grid.sheet.normal
    seen = np.zeros(len(points), bool)
    for direction in _directions():
        if direction @ grid.sheet.normal > 0.1 and not seen.all():
            seen[~seen] = ~space.blocked(points[~seen], direction, 10.0)
    return bool(seen.mean() > _SEEN_SHARE)
