"""The built-in demonstration: a furnished room, filmed, reconstructed and scored."""

from __future__ import annotations

import dataclasses
import json
import shutil
from pathlib import Path
from typing import Any

from . import evaluation, pipeline, synthetic
from .cad import default_library
from .cad_types import CadLibrary
from .config import Settings
from .errors import OutputError
from .reporter import LogReporter, Reporter

DEMO_SEGMENTER = "simulated:strong"
_STAMP = "film.json"
"""Says which film a folder holds."""


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
    sequence_dir = film_room(
        out_dir / "sequence", seed=seed, frames=frames, library=library, reporter=reporter
    )
    result = pipeline.run(
        sequence_dir, out_dir, segmenter=segmenter, settings=settings, reporter=reporter
    )
    report = evaluation.evaluate(
        out_dir,
        sequence_dir / "truth",
        symmetry={model.id: model.symmetry for model in library.models},
        model_size={model.id: model.size.tolist() for model in library.models},
        unrefined={entity.name: entity.box for entity in result.scene.entities},
    )
    report.write(out_dir / "evaluation.json")
    return DemoResult(result, report)


def film_room(
    out_dir: str | Path,
    *,
    seed: int | None = None,
    frames: int = 150,
    width: int = 640,
    height: int = 480,
    library: CadLibrary | None = None,
    reporter: Reporter | None = None,
) -> Path:
    """Film a furnished room with a simulated camera; returns the folder of the sequence.

    The very same film that lies there already is kept; another one is replaced.

    Args:
        out_dir: Receives frames, true masks and ``truth/``.
        seed: Another room; None is the built-in one.
        frames: Length of the walk.
        width: Of the images, pixels.
        height: Of the images, pixels.
        library: What the room is furnished with; by default the package's own models.
        reporter: Receives progress.

    Raises:
        OutputError: the folder holds something else.
    """
    out_dir, reporter = Path(out_dir), reporter or LogReporter()
    library = library or default_library()
    wanted = {
        "synthetic": synthetic.VERSION,
        "seed": seed,
        "frames": frames,
        "size": [width, height],
        "library": library.content_hash,
    }
    kept = _same_film(out_dir, wanted)
    reporter.stage("synthetic", kept)
    if kept:
        return out_dir
    room = synthetic.builtin_room(library) if seed is None else synthetic.make_room(seed, library)
    synthetic.render_sequence(
        room,
        out_dir,
        frames=frames,
        width=width,
        height=height,
        progress=lambda done, total: reporter.progress("synthetic", done, total),
    )
    (out_dir / _STAMP).write_text(json.dumps(wanted), "utf-8")
    return out_dir


def _same_film(out_dir: Path, wanted: dict[str, Any]) -> bool:
    """Whether this film is there; else the folder is emptied of another one, or of half a film."""
    stamp = out_dir / _STAMP
    try:
        if stamp.exists():
            if json.loads(stamp.read_text("utf-8")) == wanted:
                return True
            # Frames of a longer film would be read as part of a shorter one.
            shutil.rmtree(out_dir)
        elif out_dir.exists() and any(out_dir.iterdir()):
            raise OutputError(f"{out_dir} holds something else", "give a new folder for the film")
        out_dir.mkdir(parents=True, exist_ok=True)
        stamp.write_text("{}", "utf-8")  # marks the folder as a film that is not finished
    except OSError as error:
        raise OutputError(
            f"cannot write to {out_dir}: {error.strerror}", "give another --out"
        ) from None
    return False
