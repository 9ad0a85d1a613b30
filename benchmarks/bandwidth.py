"""What the memory of this machine moves: the bound of everything that touches each byte once."""

from __future__ import annotations

import functools
import time

import jax
import jax.numpy as jnp

_BYTES = 1 << 28
"""Far beyond any cache."""


def copy_bytes_per_s(repeats: int = 15) -> float:
    """Bytes read and written per second by a kernel that updates an array in place; best run."""
    touch = functools.partial(jax.jit, donate_argnums=0)(lambda x: x + 1)
    values = jax.block_until_ready(touch(jnp.zeros(_BYTES // 4, jnp.int32)))
    best = float("inf")
    for _ in range(repeats):
        start = time.perf_counter()
        values = jax.block_until_ready(touch(values))
        best = min(best, time.perf_counter() - start)
    return 2 * _BYTES / best
