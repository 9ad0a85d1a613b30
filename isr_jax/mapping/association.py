"""One-to-one assignment by counts: greedy, as the released code, or of the greatest sum."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from scipy.optimize import linear_sum_assignment


def one_to_one(counts: Mapping[tuple[int, int], int], how: str) -> dict[int, int]:
    """A column for each row, no column twice, where ``counts`` knows the pair.

    Args:
        counts: (row, column) -> count, above 0.
        how: ``greedy`` takes the largest count first, ties to the lower row, then column;
            ``optimal`` maximises the sum of counts (Kuhn 1955).
    """
    if how == "greedy":
        return _greedy(counts)
    rows = sorted({row for row, _ in counts})
    columns = sorted({column for _, column in counts})
    table = np.zeros((len(rows), len(columns)), np.int64)
    for (row, column), count in counts.items():
        table[rows.index(row), columns.index(column)] = count
    chosen = zip(*linear_sum_assignment(table, maximize=True), strict=True)
    return {rows[i]: columns[j] for i, j in chosen if table[i, j] > 0}


def _greedy(counts: Mapping[tuple[int, int], int]) -> dict[int, int]:
    found: dict[int, int] = {}
    taken: set[int] = set()
    for row, column in sorted(counts, key=lambda pair: (-counts[pair], pair)):
        if row not in found and column not in taken:
            found[row] = column
            taken.add(column)
    return found
