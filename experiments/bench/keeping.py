"""What a finished run leaves on disk, whole or not at all; one that fails leaves a traceback."""

from __future__ import annotations

import json
import traceback
from collections.abc import Callable
from pathlib import Path
from typing import Any


def keep(path: Path, trace: Path, compute: Callable[[], dict[str, Any]]) -> str | None:
    """Compute plain data and keep it as JSON; what went wrong, or None.

    Never raises but on Ctrl-C, or where the disk is full.

    Args:
        path: Receives the data; what was there goes first.
        trace: Receives the traceback of a failure; what was there goes first.
        compute: May raise anything.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    for old in (path, trace):
        old.unlink(missing_ok=True)
    try:
        data = compute()
    except Exception as error:  # one run of many: its row says what it died of
        trace.write_text(traceback.format_exc(), "utf-8")
        return one_line(error)
    fresh = path.with_name(f"{path.name}.new")
    fresh.write_text(json.dumps(data, allow_nan=False), "utf-8")
    fresh.replace(path)
    return None


def kept(path: Path) -> dict[str, Any] | None:
    """What `keep` left, or None."""
    return json.loads(path.read_text("utf-8")) if path.exists() else None


def one_line(error: Exception) -> str:
    """An error for a cell of the table."""
    return " ".join(f"{type(error).__name__}: {error}".split())


def with_trace(problem: str, trace: Path) -> str:
    """What went wrong, and where the traceback lies if there is one."""
    return f"{problem} (see {trace})" if trace.exists() else problem
