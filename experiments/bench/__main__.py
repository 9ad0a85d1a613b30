"""The command: ``python -m experiments.bench``, and its ``tables`` and ``rooms``."""

from __future__ import annotations

import dataclasses
import os
import sys
from pathlib import Path

import tyro
from rich.console import Console

from isr_jax.compile_cache import enable_compilation_cache
from isr_jax.demonstration import FilmPlan, image_size
from isr_jax.errors import IsrError, LibraryError, OutputError, SettingError

from .held_out import HOW_TO_GET_IT, split_libraries
from .oracle import TRUTH_UP_TO
from .plan import SPLITS, Plan, room_specs
from .report import MARKDOWN, sheets
from .room_figures import room_sheet
from .run_bench import describe, run_plan
from .sheets import write_markdown
from .table import BENCH, refuse_without_pyarrow
from .workers import Ended

_FILE_WIDTH = 160
"""Columns of tables that go into a file."""


@dataclasses.dataclass(frozen=True)
class Bench:
    """Reconstruct furnished rooms whose truth is known, and score every stage.

    Example: python -m experiments.bench --rooms 10 --out out/bench

    What is finished is kept: the same command goes on where it was broken off, and runs nothing
    when all is done. `python -m experiments.bench tables --out DIR` prints the tables again,
    `python -m experiments.bench rooms --out DIR` what the rooms are like.
    """

    out: Path = Path("out/bench")
    """Receives films, results, bench.parquet, bench.csv and bench.md."""
    rooms: int = 10
    """In all: dealt to the splits in turn, and in each the kinds in turn."""
    presets: tuple[str, ...] = ("default", "paper", "voxblox++")
    """The differences are to the first one."""
    splits: tuple[str, ...] = SPLITS
    """in-library: rooms furnished from the kit that reconstructs them; held-out: from another
    library."""
    held_out_library: Path | None = None
    """A library, or furniture to import, for held-out; the sweethome3d-furniture package if left
    out."""
    segmenter_levels: tuple[str, ...] = ("medium",)
    """How wrong the simulated masks are: strong, medium, weak, perfect."""
    seeds_from: int = 100
    """Seed of the first room."""
    frames: int = 150
    """Length of each walk."""
    size: str = "640x480"
    """Of the images, pixels."""
    jobs: int | None = None
    """Rooms at a time, each in a process of its own; one for every two cores if left out."""
    oracle: bool = True
    """Also run the first preset from the truth of each stage."""
    set: tuple[str, ...] = ()
    """Changes to every preset: mapping.voxel_size_m=0.01"""

    def run(self, console: Console) -> None:
        refuse_without_pyarrow()
        plan = self._plan(console)
        try:
            plan.out_dir.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise OutputError(f"{self.out}: {error.strerror}", "give another --out") from None
        jobs = max(1, (os.cpu_count() or 1) // 2) if self.jobs is None else self.jobs
        rows = run_plan(plan, jobs, lambda ended, d, t: _say(console, ended, d, t))
        _print_tables(console, rows, plan.out_dir)

    def _plan(self, console: Console) -> Plan:
        width, height = image_size(self.size)
        unknown = [split for split in self.splits if split not in SPLITS]
        if unknown:
            raise SettingError(f"unknown splits {unknown}", f"use some of: {', '.join(SPLITS)}")
        plan = Plan(
            out_dir=self.out,
            rooms=room_specs(self.splits, self.rooms, self.seeds_from),
            presets=self.presets,
            levels=self.segmenter_levels,
            truths=TRUTH_UP_TO if self.oracle else (),
            libraries=(),
            film=FilmPlan(frames=self.frames, width=width, height=height),
            overrides=self.set,
        )
        # Last, since an import takes minutes.
        libraries = split_libraries(self.splits, self.held_out_library, console)
        if not libraries:
            raise LibraryError("no split is left to run", HOW_TO_GET_IT)
        rooms = tuple(room for room in plan.rooms if room.split in libraries)
        return dataclasses.replace(plan, rooms=rooms, libraries=tuple(libraries.items()))


@dataclasses.dataclass(frozen=True)
class Tables:
    """Print the tables of a finished benchmark again, without running anything.

    Example: python -m experiments.bench tables --out out/bench
    """

    out: Path = Path("out/bench")
    """That a benchmark wrote."""

    def run(self, console: Console) -> None:
        _print_tables(console, BENCH.read(self.out), self.out)


@dataclasses.dataclass(frozen=True)
class Rooms:
    """Print what the filmed rooms are like: objects, levels of support, occlusion, coverage.

    Example: python -m experiments.bench rooms --out out/bench
    """

    out: Path = Path("out/bench")
    """That a benchmark wrote."""

    def run(self, console: Console) -> None:
        console.print(room_sheet(self.out).table())


def _say(console: Console, ended: Ended, done: int, total: int) -> None:
    what = describe(ended.room, ended.run)
    if ended.problem is None:
        console.print(
            f"[{done}/{total}] {what}, {ended.seconds:.0f} s", highlight=False, markup=False
        )
    else:
        console.print(f"[{done}/{total}] {what} failed: {ended.problem}", style="red", markup=False)


def _print_tables(console: Console, rows: list, out_dir: Path) -> None:
    found = sheets(rows)
    for sheet in found:
        console.print(sheet.table())
    path = out_dir / MARKDOWN
    write_markdown(found, path)
    files = f"{out_dir / BENCH.parquet}, {out_dir / BENCH.csv}"
    console.print(f"{len(rows)} values: {files}; tables: {path}")


def main(arguments: list[str] | None = None) -> None:
    """Entry point; a user's error is one message and exit status 2."""
    arguments = sys.argv[1:] if arguments is None else arguments
    enable_compilation_cache()
    commands = {"tables": Tables, "rooms": Rooms}
    named = commands.get(arguments[0]) if arguments else None
    name = f" {arguments[0]}" if named else ""
    chosen = tyro.cli(
        named or Bench,
        args=arguments[1:] if named else arguments,
        prog=f"python -m experiments.bench{name}",
    )
    try:
        chosen.run(Console(width=None if sys.stdout.isatty() else _FILE_WIDTH))
    except IsrError as error:
        Console(stderr=True).print(f"[red]error:[/] {error}", highlight=False)
        sys.exit(2)
    except KeyboardInterrupt:
        Console(stderr=True).print("stopped; what is finished is kept and in the table")
        sys.exit(130)


if __name__ == "__main__":
    main()
