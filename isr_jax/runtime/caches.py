"""Where what can be made again is kept, and JAX's persistent compilation cache in it."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import jax


def user_cache_dir() -> Path:
    """Where the platform keeps what can be made again."""
    if os.environ.get("XDG_CACHE_HOME"):
        return Path(os.environ["XDG_CACHE_HOME"]) / "isr_jax"
    if sys.platform == "darwin":
        return Path.home() / "Library" / "Caches" / "isr_jax"
    if sys.platform == "win32" and os.environ.get("LOCALAPPDATA"):
        return Path(os.environ["LOCALAPPDATA"]) / "isr_jax"
    return Path.home() / ".cache" / "isr_jax"


def enable_compilation_cache() -> None:
    """Keep compiled kernels in the user's cache, unless ``$JAX_COMPILATION_CACHE_DIR`` says where.

    Called by the command line and the tests, never on import: a library leaves its host's JAX
    configuration alone.
    """
    if "JAX_COMPILATION_CACHE_DIR" not in os.environ:
        jax.config.update("jax_compilation_cache_dir", str(user_cache_dir() / "xla"))
    jax.config.update("jax_persistent_cache_min_compile_time_secs", 0.2)
