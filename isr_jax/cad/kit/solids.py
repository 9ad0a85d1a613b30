"""Convex solids with polygonal faces: what every kit model is made of (host, metres)."""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Sequence
from typing import Literal

import numpy as np

from ...errors import SettingError
from ...robot_model.primitives import BOX_QUADS
from ...types import Mesh

ROUND_SIDES = 16
"""Sides of round things: a multiple of 4, so that they reach their full width."""
Axis = Literal["x", "y", "z"]
Radius = float | tuple[float, float]
"""Of a round thing, or half-widths along x and y of an oval one, metres."""
_GRID_M = 1e-6
"""Vertices lie on this grid, so that files are short and equal on every machine."""


@dataclasses.dataclass(frozen=True, eq=False)
class Solid:
    """A convex solid. Faces are polygons, counter-clockwise seen from outside."""

    vertices: np.ndarray
    """[vertices, 3], float64."""
    faces: tuple[tuple[int, ...], ...]
    hidden: frozenset[int] = frozenset()
    """Faces that touch a neighbour piece of the same body, left out of what is seen."""
    curved: frozenset[int] = frozenset()
    """Faces that stand for a round surface, and are no planes of the model."""

    def moved(self, offset: np.ndarray) -> Solid:
        return dataclasses.replace(self, vertices=self.vertices + offset)

    def shown(self, faces: set[int]) -> Solid:
        """The solid with some of its hidden faces in sight: the ends of an open wall."""
        return dataclasses.replace(self, hidden=self.hidden - faces)

    @functools.cached_property
    def _areas_and_centers(self) -> tuple[np.ndarray, np.ndarray]:
        """[faces, 3] normal times area, and the mean of the corners."""
        areas, centers = np.empty((2, len(self.faces), 3))
        sizes = [len(face) for face in self.faces]
        for size in dict.fromkeys(sizes):
            rows = [k for k, other in enumerate(sizes) if other == size]
            polygons = self.vertices[np.array([self.faces[k] for k in rows])]
            areas[rows], centers[rows] = area_vector(polygons), polygons.mean(1)
        return areas, centers

    @functools.cached_property
    def planes(self) -> np.ndarray:
        """[faces, 4] outward normal and offset; inside: n . v + d <= 0 for all."""
        areas, centers = self._areas_and_centers
        normals = areas / np.linalg.norm(areas, axis=1, keepdims=True)
        return np.column_stack([normals, -(normals * centers).sum(1)])

    @functools.cached_property
    def area_m2(self) -> float:
        """Of its faces, hidden ones left out."""
        areas = np.linalg.norm(self._areas_and_centers[0], axis=1)
        return float(sum(a for k, a in enumerate(areas) if k not in self.hidden))

    def mesh(self) -> Mesh:
        """Closed triangle mesh of the hull."""
        return Mesh(rounded(self.vertices), fan_triangles(self.faces))


def area_vector(polygon: np.ndarray) -> np.ndarray:
    """Normal times area of polygons [..., corners, 3], also when rounding bends them a little."""
    p, q = polygon, np.concatenate([polygon[..., 1:, :], polygon[..., :1, :]], -2)
    terms = p[..., (1, 2, 0)] * q[..., (2, 0, 1)] - p[..., (2, 0, 1)] * q[..., (1, 2, 0)]
    return terms.sum(-2) / 2


def plane_axes(normal: np.ndarray) -> np.ndarray:
    """[2, 3] u level and v as steep as it gets, u x v = normal; x and y on level planes."""
    a, b, c = normal.tolist()
    if abs(c) > 0.999:
        return np.array([[1.0, 0.0, 0.0], [0.0, c, -b]])
    level = (a * a + b * b) ** 0.5
    x, y = -b / level, a / level
    return np.array([[x, y, 0.0], [-c * y, c * x, a * y - b * x]])


def rounded(vertices: np.ndarray) -> np.ndarray:
    """Vertices on the micrometre grid, float32."""
    return (np.round(vertices / _GRID_M) * _GRID_M + 0.0).astype(np.float32)


def fan_triangles(faces: Sequence[Sequence[int]]) -> np.ndarray:
    """Triangles [n, 3] of convex polygons."""
    triangles = [(f[0], f[i], f[i + 1]) for f in faces for i in range(1, len(f) - 1)]
    return np.array(triangles, np.int32)


def between(a: float, b: float) -> tuple[float, float]:
    """Bounds from two ends in any order."""
    return (a, b) if a < b else (b, a)


def _refuse_empty(*bounds: tuple[float, float]) -> None:
    """Raise `SettingError` where a part would have no extent."""
    for low, high in bounds:
        if not low < high:
            problem = f"a part would reach from {low:.4g} m to {high:.4g} m"
            raise SettingError(problem, "ask for a larger model, or give its parts smaller sizes")


def split(low: float, high: float, count: int) -> list[float]:
    """Ends of ``count`` equal spans, those within on tenths of a millimetre."""
    inner = [round(low + (high - low) * k / count, 4) for k in range(1, count)]
    return [low, *inner, high]


def box(x: tuple[float, float], y: tuple[float, float], z: tuple[float, float]) -> Solid:
    """An axis-aligned box between the given bounds.

    Raises:
        SettingError: A lower bound is not below its upper one.
    """
    _refuse_empty(x, y, z)
    low, high = np.array([x[0], y[0], z[0]]), np.array([x[1], y[1], z[1]])
    corners = [[x, y, z] for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))]
    return Solid(np.where(corners, high, low).astype(np.float64), BOX_QUADS)


def prism(
    outline: Sequence[tuple[float, float]] | np.ndarray, axis: Axis, bounds: tuple[float, float]
) -> Solid:
    """A convex outline drawn out along an axis.

    The outline's two coordinates are (y, z) for x, (z, x) for y, (x, y) for z, counter-clockwise.
    """
    order = {"x": (2, 0, 1), "y": (1, 2, 0), "z": (0, 1, 2)}[axis]
    count, flat = len(outline), np.asarray(outline, np.float64)
    ends = [np.column_stack([flat, np.full(count, h)])[:, order] for h in bounds]
    sides = [(i, (i + 1) % count, (i + 1) % count + count, i + count) for i in range(count)]
    caps = [tuple(range(count - 1, -1, -1)), tuple(range(count, 2 * count))]
    return Solid(np.concatenate(ends), (*sides, *caps))


def circle(
    radius: Radius, sides: int = ROUND_SIDES, center: tuple[float, float] = (0.0, 0.0)
) -> np.ndarray:
    """Corners [sides, 2] of a polygon that reaches ``radius``, or half-widths, along both axes."""
    angle = 2 * np.pi * np.arange(sides) / sides
    unit = np.stack([np.cos(angle), np.sin(angle)], 1)
    return np.asarray(center) + np.asarray(radius, np.float64) * unit


def frustum(
    radii: tuple[Radius, Radius],
    z: tuple[float, float],
    center: tuple[float, float] = (0.0, 0.0),
    sides: int = ROUND_SIDES,
) -> Solid:
    """An upright round piece, its radius going from ``radii[0]`` at the bottom to ``radii[1]``.

    Either may be two half-widths (x, y); both ends have equal proportions then.

    Raises:
        SettingError: The lower height is not below the upper one.
    """
    _refuse_empty(z)
    ends = [
        np.column_stack([circle(r, sides, center), np.full(sides, h)]) for r, h in zip(radii, z)
    ]
    quads = [(i, (i + 1) % sides, (i + 1) % sides + sides, i + sides) for i in range(sides)]
    caps = [tuple(range(sides - 1, -1, -1)), tuple(range(sides, 2 * sides))]
    return Solid(np.concatenate(ends), (*quads, *caps), curved=frozenset(range(sides)))


def tapered_box(
    bottom: tuple[float, float, float, float],
    top: tuple[float, float, float, float],
    z: tuple[float, float],
) -> Solid:
    """A six-sided piece between two level rectangles (x0, x1, y0, y1) of equal proportions."""
    rows = [
        [(x0, y0, h), (x1, y0, h), (x1, y1, h), (x0, y1, h)]
        for (x0, x1, y0, y1), h in zip((bottom, top), z)
    ]
    return Solid(np.array(rows[0] + rows[1], np.float64), BOX_QUADS)


def tube(
    outer: np.ndarray, inner: np.ndarray, z: tuple[float, float], *, is_round: bool = False
) -> tuple[Solid, ...]:
    """An upright wall around a hollow, as convex staves.

    Args:
        outer: [2, sides, 2] outline at the bottom and at the top, counter-clockwise.
        inner: [2, sides, 2] likewise, within the outer one; corners on the same rays.
        z: Bottom and top.
        is_round: The outlines stand for round ones.
    """
    sides, staves = outer.shape[1], []
    curved = frozenset({2, 4}) if is_round else frozenset()
    for i in range(sides):
        k = (i + 1) % sides
        rows = [
            np.column_stack([np.stack([o[i], o[k], n[k], n[i]]), np.full(4, h)])
            for o, n, h in zip(outer, inner, z)
        ]
        # Quads 3 and 5 are the sides that touch the neighbour staves.
        staves.append(Solid(np.concatenate(rows), BOX_QUADS, frozenset({3, 5}), curved))
    return tuple(staves)
