"""Fixtures that all tests share."""

from __future__ import annotations

import os
from pathlib import Path

# Several test processes share one accelerator: none may take its memory for itself.
os.environ.setdefault("XLA_PYTHON_CLIENT_PREALLOCATE", "false")

import jax
import pytest

REPOSITORY = Path(__file__).resolve().parent.parent


def pytest_sessionstart() -> None:
    """Imported here, not above: the shape-checking import hook must come before the package."""
    from isr_jax.runtime.caches import enable_compilation_cache

    enable_compilation_cache()


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """The notebook, one test of more than a minute, comes first: last, it would run alone."""
    items.sort(key=lambda item: item.path.name != "test_notebook.py")


@pytest.fixture(scope="session")
def shared_data() -> Path:
    """The folder of real development data; skips, visibly, where it is absent."""
    default = REPOSITORY.parent / "shared" / "data"
    path = Path(os.environ.get("ISR_SHARED_DATA", default))
    if not path.is_dir():
        pytest.skip(f"no development data at {path} (set ISR_SHARED_DATA)")
    return path


@pytest.fixture(scope="session")
def gpu() -> jax.Device:
    """The first accelerator; skips, visibly, without one."""
    try:
        return jax.devices("gpu")[0]
    except RuntimeError:
        pytest.skip("no GPU on this machine")
