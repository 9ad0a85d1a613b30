"""The built-in demonstration: a furnished room, filmed, reconstructed and scored."""

from __future__ import annotations

import dataclasses
from pathlib import Path

from .. import evaluation, pipeline
from ..cad import default_library
from ..config import Settings
from ..runtime.reporter import LogReporter, Reporter
from .film import film_room

DEMO_SEGMENTER = "simulated:strong"


@dataclasses.dataclass(frozen=True, eq=False)
class DemoResult:
    """The run on the built-in room, and its scores against the truth."""

    run: pipeline.RunResult
    evaluation: evaluation.EvaluationReport


def demo(
    out_dir: str | Path,
    *,
    seed: int | None = None,
    frames: int = 150,
    segmenter: str = DEMO_SEGMENTER,
    settings: Settings | None = None,
    reporter: Reporter | None = None,
) -> DemoResult:
    """Film the built-in room with a simulated camera, reconstruct it, score it.

    Args:
        out_dir: Receives ``sequence/`` (frames and truth) and the results.
        seed: Another room; None is the built-in one.
        frames: Length of the walk.
        segmenter: How wrong the masks are; see `segmentation.SimulatedSegmenter`.
        settings: By default the preset ``default``.
        reporter: Receives progress.

    Raises:
        IsrError: as `film_room`, `pipeline.run` and `evaluate`.
    """
    out_dir, reporter = Path(out_dir), reporter or LogReporter()
    library = default_library()
    sequence_dir = film_room(
        out_dir / "sequence", seed=seed, frames=frames, library=library, reporter=reporter
    )
    result = pipeline.run(
        sequence_dir, out_dir, segmenter=segmenter, settings=settings, reporter=reporter
    )
    report = evaluation.evaluate(
        out_dir,
        sequence_dir / "truth",
        library=library,
    )
    report.write(out_dir / "evaluation.json")
    return DemoResult(result, report)
