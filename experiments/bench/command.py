"""What the commands of the experiments share: how they are called, and how they print."""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Protocol

import tyro
from rich.console import Console

from isr_jax.errors import IsrError, OutputError, SettingError
from isr_jax.runtime.caches import enable_compilation_cache
from isr_jax.runtime.cores import usable_cores

from .plan import SPLITS
from .sheets import Sheet, write_markdown
from .table import TidyTable
from .workers import Ended

FILE_WIDTH = 220
"""Columns of tables that go into a file."""


class Command(Protocol):
    """A dataclass of options, which `tyro` fills."""

    def run(self, console: Console) -> None: ...


def call(
    prog: str,
    default: type[Command],
    named: Mapping[str, type[Command]],
    arguments: list[str] | None = None,
) -> None:
    """Run the command that the arguments name, else the default one.

    A user's error is one message and exit status 2.

    Args:
        prog: How it is called, for ``--help``.
        default: Is run if the first argument names no other.
        named: The others.
        arguments: Those of the process if left out.
    """
    arguments = sys.argv[1:] if arguments is None else arguments
    enable_compilation_cache()
    chosen = named.get(arguments[0]) if arguments else None
    options = tyro.cli(
        chosen or default,
        args=arguments[1:] if chosen else arguments,
        prog=f"{prog} {arguments[0]}" if chosen else prog,
    )
    try:
        options.run(Console(width=None if sys.stdout.isatty() else FILE_WIDTH))
    except IsrError as error:
        Console(stderr=True).print(f"[red]error:[/] {error}", highlight=False)
        sys.exit(2)
    except KeyboardInterrupt:
        Console(stderr=True).print("stopped; what is finished is kept and in the table")
        sys.exit(130)


def refuse_unknown_splits(splits: Sequence[str]) -> None:
    """Raise `SettingError` for splits that there are not."""
    unknown = [split for split in splits if split not in SPLITS]
    if unknown:
        raise SettingError(f"unknown splits {unknown}", f"use some of: {', '.join(SPLITS)}")


def make_out_dir(path: Path) -> None:
    """Raise `OutputError` where it cannot be."""
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OutputError(f"{path}: {error.strerror}", "give another --out") from None


def jobs_or_default(jobs: int | None) -> int:
    """Rooms at a time; one for every two cores if left out."""
    return max(1, usable_cores() // 2) if jobs is None else jobs


def say_ended(console: Console, ended: Ended, done: int, total: int) -> None:
    """A line of progress."""
    what = f"{ended.room.name}: {'film' if ended.run is None else ended.run.name}"
    if ended.problem is None:
        console.print(
            f"[{done}/{total}] {what}, {ended.seconds:.0f} s", highlight=False, markup=False
        )
    else:
        console.print(f"[{done}/{total}] {what} failed: {ended.problem}", style="red", markup=False)


def print_sheets(
    console: Console, found: Sequence[Sheet], rows: Sequence[Any], table: TidyTable, markdown: Path
) -> None:
    """Print them, write them as Markdown, and say where the values are."""
    for sheet in found:
        console.print(sheet.table())
    write_markdown(found, markdown)
    files = f"{markdown.parent / table.parquet}, {markdown.parent / table.csv}"
    console.print(f"{len(rows)} values: {files}; tables: {markdown}")
