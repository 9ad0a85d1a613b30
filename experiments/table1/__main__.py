"""The command: ``python -m experiments.table1``."""

from __future__ import annotations

import dataclasses
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

import tyro
from rich.console import Console

from isr_jax.config import Settings, preset, with_overrides
from isr_jax.errors import IsrError, SequenceError
from isr_jax.evaluation.maps.released_code import (
    MIN_VERTICES,
    ReleasedCodeScores,
    ReleasedCounts,
    pooled,
)
from isr_jax.runtime.caches import enable_compilation_cache
from isr_jax.runtime.console import ConsoleReporter
from isr_jax.runtime.reporter import LOGGER, LogReporter, Reporter

from ..published import POOLED, PublishedFigure, read_published
from .one_sequence import SequenceScores, score_sequence
from .printing import table
from .rows import (
    ALL,
    RELEASED_WAY,
    THEIRS,
    Failure,
    exact_rows,
    released_rows,
    source_name,
    write_rows,
)

CSV = "table1.csv"
HOW_TO_GET_IT = (
    "SceneNN is at https://github.com/hkust-vgd/scenenn (for research; the paper's sequences are "
    "061, 086, 096, 223, 225, 231, 249 and 322). Extract each .oni file with its playback tool to "
    "DIR/061/image and DIR/061/depth, put trajectory.log, 061.ply and 061.xml beside them, and "
    "masks as COCO panoptic (panoptic.json, panoptic/00001.png) or name ONNX models with "
    "--segmenter; then python -m experiments.table1 --scenenn DIR"
)


@dataclasses.dataclass(frozen=True)
class Table1:
    """Table I of the paper: our figures on SceneNN beside the published ones.

    Without --scenenn the published figures are printed alone.
    """

    scenenn: Path | None = None
    """Holds one folder per sequence, or is one."""
    sequences: tuple[str, ...] = ()
    """All that are there, if left out."""
    segmenter: str = "masks"
    """Where masks come from, as in `isr run`."""
    preset: tuple[str, ...] = ("default", "paper", "voxblox++")
    out: Path = Path("out/table1")
    """Receives table1.csv, and one folder per sequence and preset with the map."""
    set: tuple[str, ...] = ()
    """Changes to every preset: mapping.voxel_size_m=0.02"""
    min_vertices: int = MIN_VERTICES
    """Of the released counting: smaller predictions are dropped."""


def run_table1(
    options: Table1, reporter: Reporter | None = None
) -> tuple[list[PublishedFigure], list[Failure]]:
    """Score the sequences and write the CSV; published figures come with ours."""
    figures, failures = list(read_published()), []
    if options.scenenn is not None:
        folders = sequence_folders(options.scenenn, options.sequences)
        settings = {n: with_overrides(preset(n), list(options.set)) for n in options.preset}
        for name, of_preset in settings.items():
            ours, lost = _one_preset(options, name, of_preset, folders, reporter or LogReporter())
            figures += ours
            failures += lost
    write_rows(options.out / CSV, figures, failures)
    return figures, failures


def _one_preset(
    options: Table1,
    name: str,
    settings: Settings,
    folders: Mapping[str, Path],
    reporter: Reporter,
) -> tuple[list[PublishedFigure], list[Failure]]:
    figures: list[PublishedFigure] = []
    failures: list[Failure] = []
    counts: list[tuple[dict[str, ReleasedCounts], dict[str, ReleasedCounts]]] = []
    for sequence, folder in folders.items():
        reporter.stage(f"{name}, sequence {sequence}", False)
        out_dir = options.out / sequence / name.replace("+", "p")
        try:
            scores = score_sequence(
                folder,
                out_dir,
                settings,
                options.segmenter,
                reporter,
                min_vertices=options.min_vertices,
            )
        except Exception as error:  # one sequence must not cost hours of the others
            if not isinstance(error, IsrError):
                LOGGER.exception("%s, sequence %s", name, sequence)
            problem = f"{type(error).__name__}: {getattr(error, 'problem', error)}"
            failures.append(Failure(source_name(name, ALL), sequence, problem))
            reporter.note(f"{name}: sequence {sequence} failed: {problem}")
            continue
        figures += _rows(name, sequence, scores)
        counts.append((scores.released, scores.released_refined))
    if counts:
        together = [ReleasedCodeScores.over(pooled(c)) for c in zip(*counts, strict=True)]
        figures += released_rows(name, POOLED, "text", *together)
    return figures, failures


def _rows(name: str, sequence: str, scores: SequenceScores) -> list[PublishedFigure]:
    released = ReleasedCodeScores.over(scores.released)
    refined = ReleasedCodeScores.over(scores.released_refined)
    return [
        *exact_rows(name, sequence, scores.annotation, scores.exact),
        *released_rows(name, sequence, "text", released, refined),
    ]


def sequence_folders(path: Path, wanted: tuple[str, ...]) -> dict[str, Path]:
    """Folders of sequences by name, in order.

    Raises:
        SequenceError: there is none, or not the wanted ones.
    """
    if not path.is_dir():
        raise SequenceError(f"{path} is no folder", HOW_TO_GET_IT)
    here = [path] if _is_sequence(path) else sorted(p for p in path.iterdir() if _is_sequence(p))
    found = {p.resolve().name: p for p in here}
    if not found:
        raise SequenceError(f"{path} holds no SceneNN sequence", HOW_TO_GET_IT)
    missing = [name for name in wanted if name not in found]
    if missing:
        raise SequenceError(
            f"{path} has no sequence {', '.join(missing)}", f"it has: {', '.join(found)}"
        )
    return {name: found[name] for name in wanted} if wanted else found


def _is_sequence(path: Path) -> bool:
    return path.is_dir() and any(path.glob("*trajectory.log"))


def _shown(options: Table1) -> list[str] | None:
    """The sequences that were asked for; None without data: all that was published."""
    if options.scenenn is None:
        return list(options.sequences) or None
    return list(sequence_folders(options.scenenn, options.sequences))


def main(args: Sequence[str] | None = None) -> None:
    """Print the table and what failed; the exit code is 1 then."""
    options, console = tyro.cli(Table1, args=args), Console()
    enable_compilation_cache()
    try:
        with ConsoleReporter(Console(stderr=True)) as reporter:
            figures, failures = run_table1(options, reporter)
    except IsrError as error:
        print(error, file=sys.stderr)
        raise SystemExit(2) from None
    names = options.preset if options.scenenn is not None else ()
    ours = [source_name(n, counting) for n in names for counting in (ALL, THEIRS, RELEASED_WAY)]
    console.print(table(figures, ours, _shown(options)))
    for failure in failures:
        console.print(f"{failure.source}, {failure.sequence}: {failure.problem}", markup=False)
    console.print(f"all figures, by class too: {options.out / CSV}", markup=False)
    if options.scenenn is None:
        console.print(f"These are published figures alone. {HOW_TO_GET_IT}", markup=False)
    raise SystemExit(1 if failures else 0)


if __name__ == "__main__":
    main()
