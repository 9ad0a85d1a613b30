"""Rows in batches: buckets, blocks of one size, the same rows of every array."""

from __future__ import annotations

import numpy as np
import pytest

from isr_jax.runtime.batches import bucket, in_blocks, take_rows


@pytest.mark.parametrize(
    ("count", "least", "size"),
    [(0, 1, 1), (1, 1, 1), (2, 1, 2), (3, 1, 4), (64, 64, 64), (65, 64, 128), (9, 16, 16)],
)
def test_buckets_are_the_next_power_of_two(count, least, size):
    assert bucket(count, least) == size


@pytest.mark.parametrize("count", [1, 4, 5, 11])
def test_blocks_have_one_size_and_give_every_row_once(count):
    table, sizes = np.arange(11.0) ** 2, []

    def kernel(values):
        sizes.append(len(values))
        return {"twice": 2 * values, "same": values}

    found = in_blocks(kernel, lambda rows: (table[rows],), count, 4)
    assert set(sizes) == {4}
    np.testing.assert_array_equal(found["twice"], 2 * table[:count])
    np.testing.assert_array_equal(found["same"], table[:count])


def test_the_same_rows_of_every_array():
    tree = {"a": np.arange(5), "b": np.arange(10).reshape(5, 2)}
    taken = take_rows(tree, np.array([3, 1]))
    assert taken["a"].tolist() == [3, 1] and taken["b"].tolist() == [[6, 7], [2, 3]]
