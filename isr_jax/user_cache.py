"""Where things are kept that can be made again."""

from __future__ import annotations

import os
import sys
from pathlib import Path


def user_cache_dir() -> Path:
    """Where the platform keeps what can be made again."""
    if os.environ.get("XDG_CACHE_HOME"):
        return Path(os.environ["XDG_CACHE_HOME"]) / "isr_jax"
    if sys.platform == "darwin":
        return Path.home() / "Library" / "Caches" / "isr_jax"
    if sys.platform == "win32" and os.environ.get("LOCALAPPDATA"):
        return Path(os.environ["LOCALAPPDATA"]) / "isr_jax"
    return Path.home() / ".cache" / "isr_jax"
