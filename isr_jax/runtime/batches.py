"""Rows in batches of few sizes, so that a kernel is compiled for few shapes (host)."""

from __future__ import annotations

from collections.abc import Callable

import jax
import numpy as np


def bucket(count: int, least: int = 1) -> int:
    """The smallest power of two that holds ``count``, at least ``least``."""
    return max(least, 1 << max(count - 1, 0).bit_length())


def take_rows(tree, rows: np.ndarray | slice):
    """The same rows of every array of a tree, as NumPy arrays."""
    return jax.tree.map(lambda leaf: np.asarray(leaf)[rows], tree)


def in_blocks(kernel: Callable, arguments_of: Callable, count: int, block: int):
    """Run a batched ``kernel`` over ``count`` rows, exactly ``block`` at a time; join the results.

    The last block repeats its first row, so that every call has the same shape and a second scene
    compiles nothing new.

    Args:
        kernel: From arrays [block, ...] to a tree of arrays [block, ...].
        arguments_of: From the numbers of ``block`` rows to the kernel's arguments.
        count: At least 1.
        block: Rows per call.
    """
    parts = []
    for first in range(0, count, block):
        rows = np.arange(first, first + block)
        rows[rows >= count] = first
        result = kernel(*arguments_of(rows))
        parts.append(take_rows(result, slice(0, min(block, count - first))))
    return jax.tree.map(lambda *leaves: np.concatenate(leaves), *parts)
