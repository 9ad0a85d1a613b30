"""One candidate per entity by min-conflicts (Minton et al. 1992), from the smallest errors."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

Depth = Callable[[int, int, int, int], float]
"""(variable i, option a, variable j, option b) -> depth of their overlap, 0 = none."""

_WALK = 0.1
"""Share of rounds that take any option: min-conflicts alone stays in local minima."""


def min_conflicts(
    errors: Sequence[np.ndarray],
    neighbours: Sequence[Sequence[int]],
    depth: Depth,
    *,
    tolerance_m: float,
    max_rounds: int,
    seed: int,
) -> list[int]:
    """Choose one option per variable so that as few pairs as possible are in conflict.

    Overlaps above the tolerance are conflicts; smaller ones can be moved apart, and such a move
    adds about its length to the error. Each round takes a variable in conflict at random and gives
    it the option with the least (conflicts, their depth, error and small overlaps). The best
    assignment met is then improved option by option. The same seed gives the same result.

    Args:
        errors: Alignment errors of each variable's options.
        neighbours: Variables that a variable may be in conflict with (symmetric).
        depth: Called for neighbours only; symmetric.
        tolerance_m: Of overlaps.
        max_rounds: Of the search.
        seed: Of the draws.
    """
    rng = np.random.default_rng(seed)
    chosen = [int(np.argmin(e)) for e in errors]

    def cost_of(i: int, a: int) -> tuple[int, float, float]:
        depths = [depth(i, a, j, chosen[j]) for j in neighbours[i]]
        hard = [d for d in depths if d > tolerance_m]
        return len(hard), float(sum(hard)), float(errors[i][a] + sum(depths) - sum(hard))

    def total() -> tuple[float, float, float]:
        costs = np.array([cost_of(i, chosen[i]) for i in range(len(errors))]).reshape(-1, 3)
        count, hard, error = costs.sum(0).tolist()
        return count / 2, hard / 2, error

    best, best_cost = list(chosen), total()
    for _ in range(max_rounds):
        troubled = [
            i for i in range(len(errors)) if len(errors[i]) > 1 and cost_of(i, chosen[i])[0]
        ]
        if not troubled:
            break
        i = troubled[rng.integers(len(troubled))]
        if rng.random() < _WALK:
            chosen[i] = int(rng.integers(len(errors[i])))
        else:
            chosen[i] = min(range(len(errors[i])), key=lambda a: cost_of(i, a))
        if (cost := total()) < best_cost:
            best, best_cost = list(chosen), cost
    chosen[:] = best
    return _polished(chosen, errors, cost_of)


def _polished(chosen, errors, cost_of) -> list[int]:
    """Each variable takes the better of its options until none changes; the cost only falls."""
    changed = True
    while changed:
        changed = False
        for i in range(len(errors)):
            now = cost_of(i, chosen[i])
            # Of conflicts, which are dear to find out, only those of possible gains are asked for.
            able = np.flatnonzero(errors[i] < now[2]) if now[0] == 0 else range(len(errors[i]))
            a = min(map(int, able), key=lambda a: cost_of(i, a), default=chosen[i])
            if cost_of(i, a) < now:
                chosen[i], changed = a, True
    return chosen
