"""Slow twin of `isr_jax.matching`: loops over models and rotations, scipy, float64."""

from __future__ import annotations

import itertools

import numpy as np
from scipy.optimize import linear_sum_assignment

from isr_jax.geometry import CUBE_ROTATIONS

from .geometry_reference import rotation_z

FORBIDDEN = 1e9


def assignment_by_trial(cost: np.ndarray, unmatched: np.ndarray) -> float:
    """Least cost over every way of giving each row its own column or none."""
    rows, columns = cost.shape
    best = np.inf
    for choice in itertools.product(range(-1, columns), repeat=rows):
        taken = [c for c in choice if c >= 0]
        if len(taken) == len(set(taken)):
            prices = [unmatched[i] if c < 0 else cost[i, c] for i, c in enumerate(choice)]
            best = min(best, sum(prices))
    return best


def assignment(cost: np.ndarray, unmatched: np.ndarray) -> float:
    """The same by scipy, with one more column per row for "none"."""
    alone = np.full((len(cost), len(cost)), FORBIDDEN)
    np.fill_diagonal(alone, np.minimum(unmatched, FORBIDDEN))
    full = np.concatenate([np.minimum(cost, FORBIDDEN), alone], 1)
    total = full[linear_sum_assignment(full)].sum()
    return total if total < FORBIDDEN else np.inf


def plane_costs(box, planes, rows, model, columns, rotation, up_cosine) -> np.ndarray:
    """A summand of d_pi for each pair of planes, inf where they may not be paired."""
    size_x, size_y = np.asarray(box.size, float), np.abs(rotation) @ np.asarray(model.size, float)
    turn = rotation_z(float(box.yaw))
    cost = np.full((len(rows), len(columns)), np.inf)
    for a, i in enumerate(rows):
        normal = np.asarray(planes.normal[i], float)
        seen = turn.T @ normal
        offset = float(planes.offset[i]) + normal @ np.asarray(box.center, float)
        for b, j in enumerate(columns):
            other = rotation @ np.asarray(model.planes.normal[j], float)
            if seen[2] >= up_cosine and not other[2] >= up_cosine:
                continue
            d_y = float(model.planes.offset[j]) / np.linalg.norm(size_y)
            cost[a, b] = abs(offset / np.linalg.norm(size_x) - d_y) + 1 - seen @ other
    return cost


def matching_error(
    box, planes, rows, carrying, model, columns, rotation, settings, up_cosine, wall=None
):
    """D(x, y) for one rotation of one model; inf where it is rejected."""
    size_x, size_y = np.asarray(box.size, float), np.abs(rotation) @ np.asarray(model.size, float)
    d_s = np.linalg.norm(size_x / np.linalg.norm(size_x) - size_y / np.linalg.norm(size_y))
    cost = plane_costs(box, planes, rows, model, columns, rotation, up_cosine)
    free = [np.inf if i in carrying else settings.unmatched_cost for i in rows]
    d_pi = assignment(cost, np.array(free)) if len(rows) else 0.0
    if not np.isfinite(d_pi):
        return np.inf
    gravity, up = np.array([0.0, 0, -1]), rotation @ np.array([0.0, 0, 1])
    d_b = 1 + gravity @ up
    d_w = 0.0
    if wall is not None:
        front = rotation_z(float(box.yaw)) @ rotation @ np.array([0.0, -1, 0])
        d_w = 1 - wall @ front
    return (
        settings.weight_size * d_s
        + settings.weight_planes * d_pi
        + settings.weight_upright * d_b
        + settings.weight_wall * d_w
    )


def all_errors(
    box, planes, rows, carrying, models, columns, settings, up_cosine, wall=None
) -> np.ndarray:
    """[models, 24]."""
    table = np.zeros((len(models), 24))
    for m, model in enumerate(models):
        for r, rotation in enumerate(CUBE_ROTATIONS.astype(float)):
            table[m, r] = matching_error(
                box, planes, rows, carrying, model, columns[m], rotation, settings, up_cosine, wall
            )
    return table
