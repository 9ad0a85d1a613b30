"""Border: what a command writes where its user says."""

from __future__ import annotations

from pathlib import Path

from ..errors import OutputError


def write_text(path: Path, text: str) -> None:
    """Write a text file, its folder too.

    Raises:
        OutputError: the file cannot be written.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, "utf-8")
    except OSError as error:
        raise OutputError(f"{path}: {error.strerror}", "give a file that can be written") from None
