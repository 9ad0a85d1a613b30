"""The way through, in the paper's order: map, entities, contact graph, CAD models, a scene."""

from __future__ import annotations

import dataclasses
import functools
import time
from collections.abc import Sequence
from pathlib import Path

from . import (
    alignment,
    contact_graph,
    datasets,
    entities,
    mapping,
    matching,
    physical_check,
    segmentation,
    stability,
)
from .borders import drawing
from .cad import default_library, open_library
from .cad.collision import making_hulls
from .config import Settings, preset
from .library import CadLibrary
from .map_runs.frames import integrate_sequence
from .runtime.reporter import LOGGER, Reporter, logged
from .runtime.run_folder import RunFolder
from .runtime.stage_runner import STAGES, StageRunner
from .runtime.store import StageStore
from .scene import Scene
from .scene_file import SceneFile
from .types import (
    Entities,
    MappingResult,
    RgbdSequence,
)


def reconstruct(
    sequence: RgbdSequence,
    *,
    library: CadLibrary | None = None,
    segmenter: segmentation.Segmenter | None = None,
    settings: Settings | None = None,
    runner: StageRunner | None = None,
) -> Scene:
    """Turn a posed RGB-D sequence into a scene of CAD models that carry each other.

    Args:
        sequence: From `open_sequence`; frames in the world frame.
        library: CAD models; by default the package's own.
        segmenter: From `open_segmenter`; by default the masks that lie beside the frames.
        settings: From `preset`; by default ``default``.
        runner: Where stage results are kept and reused; by default nowhere.

    Raises:
        IsrError: frames, masks or models that cannot be used.
    """
    settings, runner = settings or preset("default"), runner or StageRunner()
    segmenter = segmenter or segmentation.open_segmenter("masks", sequence.source)
    mapped = map_sequence(sequence, segmenter, settings, runner)
    frames_to_world = sequence.T_world_dataset
    (found,) = runner.run(
        settings, entities.STAGE, entities.extract_scenes, [mapped.surface], [frames_to_world]
    )
    (scene,) = furnish_scenes([found], library, settings, runner=runner)
    return dataclasses.replace(scene, mapping=mapped)


def map_sequence(
    sequence: RgbdSequence,
    segmenter: segmentation.Segmenter,
    settings: Settings,
    runner: StageRunner,
) -> MappingResult:
    """Integrate all frames into one panoptic map (Sec. IV); the runner keeps it."""

    def integrate(sequences: list, segmenters: list, segmentation_version: str, *_) -> list:
        return [
            integrate_sequence(*of_one, settings, runner) for of_one in zip(sequences, segmenters)
        ]

    (mapped,) = runner.run(
        settings, mapping.STAGE, integrate, [sequence], [segmenter], str(segmentation.VERSION)
    )
    return mapped


def furnish_scenes(
    scenes: Sequence[Entities],
    library: CadLibrary | None = None,
    settings: Settings | None = None,
    *,
    runner: StageRunner | None = None,
) -> list[Scene]:
    """Work out what carries what, and replace each functional entity by a model that fits.

    Each stage takes the entities of all scenes at once, so that a sweep over many scenes is one
    call: contact graph (Sec. III), matching (Sec. V-B), alignment (Sec. V-C), physical check
    (Sec. V-D).

    Args:
        scenes: The entities of each scene.
        library: CAD models; by default the package's own.
        settings: From `preset`; by default ``default``.
        runner: Where stage results are kept and reused, one store per scene; by default nowhere.

    Returns:
        One scene for each of ``scenes``, in their order.
    """
    library = default_library() if library is None else library
    settings, runner = settings or preset("default"), runner or StageRunner()
    library = making_hulls(library, runner.reporter)
    run, found = functools.partial(runner.run, settings), list(scenes)
    graphs = run(contact_graph.STAGE, contact_graph.build_contact_graphs, found)
    shortlists = run(matching.STAGE, matching.match, found, graphs, library)
    aligned = run(alignment.STAGE, alignment.align_shortlists, found, graphs, shortlists, library)
    placements = run(
        physical_check.STAGE,
        physical_check.check_scenes,
        found,
        graphs,
        shortlists,
        aligned,
        library,
    )
    chosen = [library.position(p.cad_id) for ps in placements for p in ps if p.cad_id is not None]
    library = library.with_hulls(chosen, settings.cad.chosen_hulls)
    parts = zip(found, graphs, shortlists, aligned, placements, strict=True)
    return [Scene(*of_one, library, settings) for of_one in parts]


def replace_with_cad(
    found: Entities,
    library: CadLibrary | None = None,
    settings: Settings | None = None,
    *,
    runner: StageRunner | None = None,
) -> Scene:
    """`furnish_scenes` of one scene."""
    return furnish_scenes([found], library, settings, runner=runner)[0]


@dataclasses.dataclass(frozen=True, eq=False)
class RunResult:
    """What a run wrote."""

    scene: Scene
    scene_file: SceneFile
    stability: stability.StabilityReport
    out_dir: Path
    seconds: float


def run(
    sequence_dir: str | Path,
    out_dir: str | Path,
    *,
    segmenter: str = "masks",
    library: str | Path | None = None,
    settings: Settings | None = None,
    start_from: str | None = None,
    reporter: Reporter | None = None,
) -> RunResult:
    """The main job: a sequence on disk becomes a folder with a scene that stands in MuJoCo.

    Everything that can be wrong with the input is checked before the first frame is integrated.
    What is finished is kept: a second run reuses it, a killed one resumes.

    Args:
        sequence_dir: A folder in a layout that `open_sequence` knows.
        out_dir: Where results go; created.
        segmenter: As in `open_segmenter`.
        library: A folder of CAD models, or several joined by ``+``; by default the package's own.
        settings: By default the preset ``default``.
        start_from: Compute this stage (`stage_runner.STAGES`) and all after it anew.
        reporter: Receives progress.

    Raises:
        IsrError: whatever is wrong, with the file and the way out.
    """
    started = time.perf_counter()
    settings = settings or preset("default")
    out_dir = Path(out_dir)
    reporter = logged(reporter)
    with RunFolder(out_dir, settings):
        models = default_library() if library is None else open_library(library)
        sequence = datasets.open_sequence(Path(sequence_dir), settings.input)
        masks = segmentation.open_segmenter(
            segmenter, Path(sequence_dir), settings=settings.segmentation
        )
        for note in (*sequence.notes, f"masks: {masks.describe()}"):
            reporter.note(note)
        runner = StageRunner(StageStore(out_dir / "stages"), reporter, start_from)
        scene = reconstruct(
            sequence, library=models, segmenter=masks, settings=settings, runner=runner
        )
        return finish(scene, out_dir, reporter, started)


def finish(scene: Scene, out_dir: Path, reporter: Reporter, started: float) -> RunResult:
    """Write the scene, settle it in MuJoCo, keep the verdict beside it."""
    reporter.stage("export", False)
    scene_file = scene.save(out_dir)
    _draw(scene, out_dir)
    reporter.stage("stability", False)
    report = stability.settle(out_dir / "scene.xml", scene.settings.stability)
    report.write(out_dir / "stability.json")
    seconds = time.perf_counter() - started
    LOGGER.info("finished in %.1f s: %s", seconds, out_dir)
    return RunResult(scene, scene_file, report, out_dir, seconds)


def _draw(scene: Scene, out_dir: Path) -> None:
    """Pictures of the scene, and of the map coloured by instance."""
    drawing.draw_scene(out_dir / "scene.xml", out_dir / "scene.png")
    if scene.mapping is not None:
        surface = scene.mapping.surface
        colors = drawing.instance_colors(surface.instance)
        painted = dataclasses.replace(surface.mesh, colors=colors)
        drawing.draw_mesh(painted, out_dir / "map" / "panoptic.png")


__all__ = [
    "STAGES",
    "RunResult",
    "Scene",
    "finish",
    "furnish_scenes",
    "map_sequence",
    "reconstruct",
    "replace_with_cad",
    "run",
]
