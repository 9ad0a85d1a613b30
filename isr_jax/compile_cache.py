"""JAX's persistent compilation cache: a second run starts without compiling."""

from __future__ import annotations

import os

import jax

from .user_cache import user_cache_dir


def enable_compilation_cache() -> None:
    """Keep compiled kernels in the user's cache, unless ``$JAX_COMPILATION_CACHE_DIR`` says where.

    Called by the command line and the tests, never on import: a library leaves its host's JAX
    configuration alone.
    """
    if "JAX_COMPILATION_CACHE_DIR" not in os.environ:
        jax.config.update("jax_compilation_cache_dir", str(user_cache_dir() / "xla"))
    jax.config.update("jax_persistent_cache_min_compile_time_secs", 0.2)
