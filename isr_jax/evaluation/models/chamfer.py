"""Distances between surfaces: from points spread over one to the nearest place on the other.

Every distance is exact but for float32 (0.1 mm in a room): points are measured against triangles,
never against other points, whose spacing of some centimetres would pass for an error. The mean
over the 512 points of a model, each for the same share of its area, has a standard error of 1/22
of the spread of the distances: below 1 mm where surfaces lie 2 cm apart.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence

import jax
import numpy as np
from jaxtyping import Float

from ...geometry import points_to_triangles_distance_sq
from ...library import CadModel
from ..figures import mean, median

_POINTS = 512
_FACES = (256, 2048)
"""Of a tile: for models of boards, and for those of many curved parts."""
_FAR_M = 1e4
"""Where padding triangles lie."""


@dataclasses.dataclass(frozen=True, eq=False)
class Surface:
    """A surface twice: as points, each for the same share of its area, and as triangles."""

    points: Float[np.ndarray, "points 3"]
    triangles: Float[np.ndarray, "triangles 3 3"]


def model_surface(
    model: CadModel, T_world_cad: Float[np.ndarray, "4 4"], scale: Float[np.ndarray, "3"]
) -> Surface:
    """A model where it stands: p_world = T_world_cad diag(scale) p_cad, joints closed."""
    T = np.asarray(T_world_cad, np.float64)

    def moved(points: np.ndarray) -> np.ndarray:
        return (points * scale @ T[:3, :3].T + T[:3, 3]).astype(np.float32)

    mesh = model.mesh
    return Surface(moved(model.samples.points), moved(mesh.vertices)[mesh.faces])


def surface_distances(
    points: Float[np.ndarray, "points 3"], triangles: Float[np.ndarray, "triangles 3 3"]
) -> Float[np.ndarray, " points"]:
    """Distance from each point to the nearest triangle, metres; inf where there is none.

    Tiles of two shapes, so that it compiles twice. Coordinates are taken from the middle of the
    triangles: float32 has its precision there.
    """
    nearest = np.full(len(points), np.inf, np.float32)
    if len(points) == 0 or len(triangles) == 0:
        return nearest
    middle = triangles.reshape(-1, 3).astype(np.float64).mean(0)
    near = (triangles - middle).astype(np.float32)
    seen = (points - middle).astype(np.float32)
    faces = _FACES[len(near) > 2 * _FACES[0]]
    for p in range(0, len(points), _POINTS):
        at = np.zeros((_POINTS, 3), np.float32)
        part = seen[p : p + _POINTS]
        at[: len(part)] = part
        best = nearest[p : p + _POINTS]
        for f in range(0, len(near), faces):
            on = np.full((faces, 3, 3), _FAR_M, np.float32)
            tile = near[f : f + faces]
            on[: len(tile)] = tile
            np.minimum(best, np.asarray(_tile_distances_sq(at, on))[: len(part)], out=best)
    return np.sqrt(nearest)


@jax.jit
def _tile_distances_sq(points, triangles):
    return points_to_triangles_distance_sq(points, triangles, batch_size=64)


def mean_distance_m(points: Float[np.ndarray, "points 3"], surface: Surface) -> float | None:
    """Mean distance from the points to the surface; None without either."""
    if len(points) == 0 or len(surface.triangles) == 0:
        return None
    return float(surface_distances(points, surface.triangles).mean())


@dataclasses.dataclass(frozen=True)
class SurfaceDistance:
    """Mean distances between two surfaces, metres."""

    forward_m: float
    """From the first to the second: what of the first the second lacks."""
    backward_m: float
    """From the second to the first: what the second has too much."""

    @property
    def two_way_m(self) -> float:
        """Chamfer distance: the mean of both ways, of lengths, not of squares."""
        return (self.forward_m + self.backward_m) / 2


def surface_distance(a: Surface, b: Surface) -> SurfaceDistance | None:
    """Both ways between two surfaces; None where one of them is empty."""
    forward, backward = mean_distance_m(a.points, b), mean_distance_m(b.points, a)
    return None if forward is None or backward is None else SurfaceDistance(forward, backward)


@dataclasses.dataclass(frozen=True)
class ChamferRow:
    """One placed model against the true one."""

    truth: str
    class_name: str
    id: str
    alignment_error_m: float | None
    """AE, RMS from the entity's vertices to the placed model, as the result states it."""
    seen_to_placed_m: float | None
    """One way: mean distance from the true surface that the camera saw to the placed model."""
    true_to_placed_m: float
    placed_to_true_m: float
    two_way_m: float
    """Chamfer distance between the whole true and the placed model, each in its pose."""


@dataclasses.dataclass(frozen=True)
class ClassDistances:
    """Medians of the placed models of one class, metres."""

    models: int
    alignment_error_m: float | None
    seen_to_placed_m: float | None
    two_way_m: float | None


@dataclasses.dataclass(frozen=True)
class ChamferScores:
    """How far placed models lie from the truth, over those that stand; medians, metres."""

    alignment_error_median_m: float | None
    seen_to_placed_median_m: float | None
    true_to_placed_median_m: float | None
    two_way_median_m: float | None
    class_two_way_m: float | None
    """Mean over the classes of their medians."""
    by_class: dict[str, ClassDistances]
    rows: tuple[ChamferRow, ...]

    @staticmethod
    def over(rows: tuple[ChamferRow, ...]) -> ChamferScores:
        """Medians of the rows."""
        names = sorted({r.class_name for r in rows})
        by_class = {n: _medians([r for r in rows if r.class_name == n]) for n in names}
        whole = _medians(rows)
        return ChamferScores(
            whole.alignment_error_m,
            whole.seen_to_placed_m,
            median(r.true_to_placed_m for r in rows),
            whole.two_way_m,
            mean(c.two_way_m for c in by_class.values() if c.two_way_m is not None),
            by_class,
            rows,
        )


def _medians(rows: Sequence[ChamferRow]) -> ClassDistances:
    return ClassDistances(
        len(rows),
        median(r.alignment_error_m for r in rows if r.alignment_error_m is not None),
        median(r.seen_to_placed_m for r in rows if r.seen_to_placed_m is not None),
        median(r.two_way_m for r in rows),
    )
