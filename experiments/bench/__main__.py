"""The command: ``python -m experiments.bench``, and its ``tables`` and ``rooms``."""

from __future__ import annotations

import dataclasses
from functools import partial
from pathlib import Path

from rich.console import Console

from isr_jax.demonstration.film import FilmPlan, image_size
from isr_jax.errors import LibraryError

from .command import (
    call,
    jobs_or_default,
    make_out_dir,
    print_sheets,
    refuse_unknown_splits,
    say_ended,
)
from .held_out import HOW_TO_GET_IT, split_libraries
from .oracle import TRUTH_UP_TO
from .plan import SPLITS, Plan, room_specs
from .report import MARKDOWN, sheets
from .room_figures import room_sheet
from .rows import Row
from .run_bench import run_plan
from .table import BENCH, refuse_without_pyarrow


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
        make_out_dir(plan.out_dir)
        rows = run_plan(plan, jobs_or_default(self.jobs), partial(say_ended, console))
        _print_tables(console, rows, plan.out_dir)

    def _plan(self, console: Console) -> Plan:
        width, height = image_size(self.size)
        refuse_unknown_splits(self.splits)
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


def _print_tables(console: Console, rows: list[Row], out_dir: Path) -> None:
    print_sheets(console, sheets(rows), rows, BENCH, out_dir / MARKDOWN)


def main(arguments: list[str] | None = None) -> None:
    """Entry point."""
    call("python -m experiments.bench", Bench, {"tables": Tables, "rooms": Rooms}, arguments)


if __name__ == "__main__":
    main()
