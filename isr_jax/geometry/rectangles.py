"""A rectangle less holes: as the cells of a grid, and as few rectangles."""

from __future__ import annotations

import numpy as np
from jaxtyping import Bool, Float


def grid_less(
    size_m: tuple[float, float], holes: Float[np.ndarray, "holes 4"], spacing_m: float
) -> tuple[
    Float[np.ndarray, " columns_and_1"],
    Float[np.ndarray, " rows_and_1"],
    Bool[np.ndarray, "rows columns"],
]:
    """Grid lines along u and v through all sides of holes, and which cells are in none.

    Args:
        size_m: Of the rectangle from (0, 0), along u and v.
        holes: (u0, v0, u1, v1); they may reach past the rectangle and overlap.
        spacing_m: No cell is longer; infinite for the fewest cells.
    """
    holes = np.asarray(holes, np.float64)
    axes = []
    for side, length in enumerate(size_m):
        cuts = np.unique(np.clip([0.0, length, *holes[:, side::2].ravel()], 0, length))
        axes.append(divided(cuts, spacing_m))
    u, v = axes
    mu, mv = np.meshgrid((u[1:] + u[:-1]) / 2, (v[1:] + v[:-1]) / 2)
    solid = np.ones(mu.shape, bool)
    for u0, v0, u1, v1 in holes:
        solid &= ~((mu > u0) & (mu < u1) & (mv > v0) & (mv < v1))
    return u, v, solid


def divided(cuts: Float[np.ndarray, " cuts"], spacing_m: float) -> Float[np.ndarray, " lines"]:
    """The cuts with evenly spaced lines between them, none farther apart than ``spacing_m``."""
    steps = np.maximum(1, np.ceil(np.diff(cuts) / spacing_m - 1e-9)).astype(int)
    spans = zip(cuts[:-1], cuts[1:], steps, strict=True)
    return np.concatenate([*(np.linspace(a, b, n + 1)[:-1] for a, b, n in spans), cuts[-1:]])


def rectangles_less(
    size_m: tuple[float, float], holes: Float[np.ndarray, "holes 4"]
) -> Float[np.ndarray, "rectangles 4"]:
    """(u0, v0, u1, v1) of disjoint rectangles that make up what is in no hole; the largest first.

    The rectangle is cut along u at the sides of every hole; what is left of each strip along v is
    joined with the same of the strip before.
    """
    u, v, solid = grid_less(size_m, holes, np.inf)
    done: list[tuple[float, float, float, float]] = []
    growing: dict[tuple[float, float], float] = {}
    for i in range(len(u)):
        runs = _runs(solid[:, i], v) if i < len(u) - 1 else []
        for run in [run for run in growing if run not in runs]:
            done.append((growing.pop(run), run[0], float(u[i]), run[1]))
        for run in runs:
            growing.setdefault(run, float(u[i]))
    done.sort(key=lambda r: (-round((r[2] - r[0]) * (r[3] - r[1]), 6), r))
    return np.array(done, np.float32).reshape(-1, 4)


def _runs(solid: np.ndarray, v: np.ndarray) -> list[tuple[float, float]]:
    """Spans of v in which the cells of one strip are solid."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], solid.astype(int), [0]])))
    return [(float(v[a]), float(v[b])) for a, b in edges.reshape(-1, 2)]
