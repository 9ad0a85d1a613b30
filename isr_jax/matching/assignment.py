"""Exact assignment of few rows to few columns: values only, many problems at once."""

from __future__ import annotations

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Float

from ..types import Array


def assignment_cost(
    cost: Float[Array, "rows columns batch"], unmatched: Float[Array, "rows batch"]
) -> Float[Array, " batch"]:
    """Least total cost of giving every row its own column, or none at that row's price.

    A dynamic programme over the 2^rows sets of settled rows, one column at a time:

        best(S) <- min(best(S), min over i in S of best(S - i) + cost[i, column])

    which starts from best(S) = what it costs to leave all of S unmatched. The problems lie along
    the last axis, since the programme is the same for each: every step is one elementwise pass.

    Args:
        cost: inf where a pair is forbidden.
        unmatched: inf where a row must find a partner; inf comes back where it cannot. Rows of
            padding cost 0 unmatched and inf in every column.
    """
    rows = cost.shape[0]
    best = jnp.zeros((1, cost.shape[-1]), cost.dtype)
    for i in range(rows):  # bit i of a set's number says whether row i is in it
        best = jnp.concatenate([best, best + unmatched[i]])

    def offer(best, column):
        return _with_column(best, column), None

    best, _ = jax.lax.scan(offer, best, jnp.moveaxis(cost, 1, 0))
    return best[-1]


def _with_column(
    best: Float[Array, "sets batch"], column: Float[Array, "rows batch"]
) -> Float[Array, "sets batch"]:
    """One more column offered to every set of rows."""
    sets = np.arange(best.shape[0])
    improved = best
    for i in range(column.shape[0]):
        without = sets & ~(1 << i)
        taken = jnp.where((sets != without)[:, None], best[without] + column[i], jnp.inf)
        improved = jnp.minimum(improved, taken)
    return improved
