"""The command ``python -m experiments.ablation``; ``tables``, ``variants`` and ``diagnose``."""

from __future__ import annotations

import dataclasses
from functools import partial
from pathlib import Path

from rich.console import Console

from experiments.bench.command import (
    call,
    jobs_or_default,
    make_out_dir,
    print_sheets,
    refuse_unknown_splits,
    say_ended,
)
from experiments.bench.held_out import split_libraries
from experiments.bench.plan import SPLITS, room_specs
from experiments.bench.sheets import Sheet
from experiments.bench.table import refuse_without_pyarrow
from isr_jax.demonstration.film import FilmPlan, image_size
from isr_jax.errors import LibraryError

from .diagnosis_sheets import diagnosis_sheets
from .map_film import MaskedFilm, map_film
from .map_run import TABLE
from .plan import AblationPlan
from .report import MARKDOWN, sheets
from .run_ablation import run_plan
from .scores import judge, truth_of
from .variants import GROUPS, VARIANTS, variant


@dataclasses.dataclass(frozen=True)
class Ablation:
    """Map films of rooms whose truth is known, with one idea more or less at a time.

    Example: python -m experiments.ablation --films out/bench --out out/ablation

    What is finished is kept: the same command goes on where it was broken off, and maps nothing
    when all is done. `tables --out DIR` prints the tables again, `variants` lists what is
    compared, `diagnose --film DIR` says of one room where its panoptic quality is lost.
    """

    out: Path = Path("out/ablation")
    """Receives results, ablation.parquet, ablation.csv and ablation.md, and films that are made."""
    films: Path | None = None
    """A folder of experiments.bench: its films are used, and nothing is written there."""
    variants: tuple[str, ...] = tuple(GROUPS)
    """Names of variants, or groups of them: presets, steps, paper-minus, default-minus,
    options."""
    level: str = "medium"
    """How wrong the simulated masks are: strong, medium, weak, perfect."""
    levels: tuple[str, ...] = ()
    """Also map the presets with masks of these levels."""
    rooms: int = 10
    """In all: the first of the benchmark's."""
    splits: tuple[str, ...] = SPLITS
    """in-library, held-out; as in the benchmark."""
    held_out_library: Path | None = None
    """As in the benchmark, for held-out rooms that are filmed here."""
    seeds_from: int = 100
    """Seed of the first room."""
    frames: int = 150
    """Length of each walk."""
    size: str = "640x480"
    """Of the images, pixels."""
    jobs: int | None = None
    """Rooms at a time, each in a process of its own; one for every two cores if left out."""
    set: tuple[str, ...] = ()
    """Changes to the base of every variant: mapping.voxel_size_m=0.02"""

    def run(self, console: Console) -> None:
        refuse_without_pyarrow()
        plan = self._plan(console)
        make_out_dir(plan.out_dir)
        run_plan(plan, jobs_or_default(self.jobs), partial(say_ended, console))
        _print_tables(console, self.out)

    def _plan(self, console: Console) -> AblationPlan:
        width, height = image_size(self.size)
        refuse_unknown_splits(self.splits)
        plan = AblationPlan(
            out_dir=self.out,
            rooms=room_specs(self.splits, self.rooms, self.seeds_from),
            variants=self.variants,
            level=self.level,
            preset_levels=self.levels,
            film=FilmPlan(frames=self.frames, width=width, height=height),
            films=self.films,
            overrides=self.set,
        )
        to_film = {room.split for room in plan.rooms if plan.given_film(room) is None}
        libraries = split_libraries(
            tuple(s for s in self.splits if s in to_film), self.held_out_library, console
        )
        rooms = tuple(r for r in plan.rooms if r.split in libraries or plan.given_film(r))
        if not rooms:
            raise LibraryError("no room is left to map", "give --films or --held-out-library")
        return dataclasses.replace(plan, rooms=rooms, libraries=tuple(libraries.items()))


@dataclasses.dataclass(frozen=True)
class Tables:
    """Print the tables of a finished ablation again, without mapping anything.

    Example: python -m experiments.ablation tables --out out/ablation
    """

    out: Path = Path("out/ablation")
    """That an ablation wrote."""

    def run(self, console: Console) -> None:
        _print_tables(console, self.out)


@dataclasses.dataclass(frozen=True)
class Variants:
    """List the variants: what each is compared with, and which settings differ.

    Example: python -m experiments.ablation variants
    """

    def run(self, console: Console) -> None:
        lines = tuple(
            (v.name, v.group, v.base, v.source, ", ".join(v.changes), v.shows) for v in VARIANTS
        )
        headings = ("variant", "group", "base", "values of", "settings", "what it shows")
        console.print(Sheet("variants", headings, lines).table())


@dataclasses.dataclass(frozen=True)
class Diagnose:
    """Say of one room where its panoptic quality is lost: what became of every true segment.

    Example: python -m experiments.ablation diagnose --film out/bench/rooms/ROOM/film
    """

    film: Path
    """A folder that the benchmark or `isr synth` filmed."""
    variant: str = "default"
    """Of `variants`."""
    level: str = "medium"
    """How wrong the simulated masks are."""
    out: Path = Path("out/ablation")
    """Keeps the segments of the film."""
    set: tuple[str, ...] = ()
    """Changes to its base: mapping.merge_min_frames=2"""

    def run(self, console: Console) -> None:
        folder = self.film.resolve()
        kept = self.out / "rooms" / folder.parent.name / "segments"
        settings = variant(self.variant).settings(self.set)
        mapped = map_film(MaskedFilm(folder, self.level, kept), settings)
        for sheet in diagnosis_sheets(judge(mapped, truth_of(folder))):
            console.print(sheet.table())


def _print_tables(console: Console, out_dir: Path) -> None:
    rows = TABLE.read(out_dir)
    print_sheets(console, sheets(rows), rows, TABLE, out_dir / MARKDOWN)


def main(arguments: list[str] | None = None) -> None:
    """Entry point."""
    named = {"tables": Tables, "variants": Variants, "diagnose": Diagnose}
    call("python -m experiments.ablation", Ablation, named, arguments)


if __name__ == "__main__":
    main()
