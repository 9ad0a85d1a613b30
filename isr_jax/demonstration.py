"""The built-in demonstration: a furnished room, filmed, reconstructed and scored."""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path

from . import evaluation, pipeline, synthetic
from .cad import default_library
from .config import Settings
from .reporter import LogReporter, Reporter

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
    """
    out_dir, reporter = Path(out_dir), reporter or LogReporter()
    library = default_library()
    sequence_dir = out_dir / "sequence"
    room = synthetic.builtin_room(library) if seed is None else synthetic.make_room(seed, library)
    _film(room, sequence_dir, frames, library.content_hash, reporter)
    result = pipeline.run(
        sequence_dir, out_dir, segmenter=segmenter, settings=settings, reporter=reporter
    )
    report = evaluation.evaluate(
        out_dir,
        sequence_dir / "truth",
        symmetry={model.id: model.symmetry for model in library.models},
        model_size={model.id: model.size for model in library.models},
        unrefined={entity.name: entity.box for entity in result.scene.entities},
    )
    report.write(out_dir / "evaluation.json")
    return DemoResult(result, report)


def _film(
    room: synthetic.Room, sequence_dir: Path, frames: int, library_hash: str, reporter: Reporter
) -> None:
    """Render the room unless the very same film lies there already."""
    stamp = sequence_dir / "film.json"
    wanted = {
        "synthetic": synthetic.VERSION,
        "seed": room.seed,
        "frames": frames,
        "library": library_hash,
    }
    if stamp.exists() and json.loads(stamp.read_text("utf-8")) == wanted:
        reporter.stage("synthetic", True)
        return
    reporter.stage("synthetic", False)
    synthetic.render_sequence(
        room,
        sequence_dir,
        frames=frames,
        progress=lambda done, total: reporter.progress("synthetic", done, total),
    )
    stamp.write_text(json.dumps(wanted), "utf-8")
