"""The way through, in the paper's order: map, entities, contact graph, CAD models, a scene."""

from __future__ import annotations

import dataclasses
import time
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from . import (
    alignment,
    contact_graph,
    datasets,
    entities,
    export,
    mapping,
    matching,
    physical_check,
    segmentation,
    stability,
)
from .borders import drawing
from .cad import default_library, open_library
from .cad.collision import with_hulls
from .config import Settings, preset, settings_to_dict
from .library import CadLibrary
from .map_runs.frames import fuse
from .runtime.reporter import LOGGER, Reporter, logged
from .runtime.run_folder import RunFolder, versions
from .runtime.stage_runner import STAGES, StageRunner
from .runtime.store import StageStore
from .scene_file import SceneFile
from .types import (
    Alignments,
    ContactGraph,
    Entities,
    MappingResult,
    Placement,
    RgbdSequence,
    Shortlist,
)


@dataclasses.dataclass(frozen=True, eq=False)
class Scene:
    """A reconstructed scene: what is there, what carries it, and which model stands for it."""

    entities: Entities
    graph: ContactGraph
    placements: tuple[Placement, ...]
    library: CadLibrary
    settings: Settings
    mapping: MappingResult | None = None
    """None when the entities did not come from frames."""

    def save(self, out_dir: str | Path) -> SceneFile:
        """Write scene.json, scene.xml, the URDF package and the GLB; each is read back and checked.

        Raises:
            OutputError: the folder cannot be written, or an export differs from the scene.
        """
        return export.export_scene(
            self.entities,
            self.graph,
            self.placements,
            self.library,
            Path(out_dir),
            self.settings.export,
            metrics=self._metrics(),
            all_settings=settings_to_dict(self.settings),
            versions=versions(),
            surface=self.mapping.surface if self.mapping else None,
        )

    def _metrics(self) -> dict[str, Any]:
        if self.mapping is None:
            return {}
        skipped = list(self.mapping.skipped)
        return {"frames_used": self.mapping.frames_used, "frames_skipped": skipped}


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
    """
    settings = settings or preset("default")
    runner = runner or StageRunner()
    library = library or default_library()
    segmenter = segmenter or segmentation.open_segmenter("masks", sequence.source)
    mapped = map_sequence(sequence, segmenter, settings, runner)
    found = runner.run(
        "entities",
        entities.VERSION,
        settings.entities,
        {"map": mapped},
        Entities,
        lambda: entities.extract_entities(
            mapped.surface, sequence.T_world_dataset, settings.entities
        ),
    )
    return dataclasses.replace(furnish(found, library, settings, runner), mapping=mapped)


def map_sequence(
    sequence: RgbdSequence,
    segmenter: segmentation.Segmenter,
    settings: Settings,
    runner: StageRunner,
) -> MappingResult:
    """Fuse all frames into one panoptic map; the runner keeps it."""
    return runner.run(
        "mapping",
        mapping.VERSION,
        {
            name: dataclasses.asdict(getattr(settings, name))
            for name in ("input", "segmentation", "mapping")
        },
        {
            "sequence": sequence.content_hash(),
            "segmenter": segmenter.content_hash(),
            "segmentation_version": str(segmentation.VERSION),
        },
        MappingResult,
        lambda: fuse(sequence, segmenter, settings, runner),
    )


def furnish(
    found: Entities,
    library: CadLibrary,
    settings: Settings,
    runner: StageRunner | None = None,
) -> Scene:
    """Work out what carries what and replace each functional entity by a model that fits."""
    runner = runner or StageRunner()
    models = library.content_hash
    graph = runner.run(
        "contact_graph",
        contact_graph.VERSION,
        settings.contact_graph,
        {"entities": found},
        ContactGraph,
        lambda: contact_graph.build_contact_graphs(
            [found], settings.contact_graph, settings.support
        )[0],
    )
    shortlist = runner.run(
        "matching",
        matching.VERSION,
        settings.matching,
        {"entities": found, "graph": graph, "library": models},
        Shortlist,
        lambda: matching.match(
            [found],
            [graph],
            library,
            settings.matching,
            settings.support,
        )[0],
    )
    aligned = runner.run(
        "alignment",
        alignment.VERSION,
        settings.alignment,
        {"entities": found, "graph": graph, "shortlist": shortlist, "library": models},
        Alignments,
        lambda: alignment.align_shortlists(
            [found], [graph], [shortlist], library, settings.alignment
        )[0],
    )
    hulls = settings.cad.candidate_hulls
    tried = with_hulls_at(library, shortlist.model.tolist(), hulls, runner.reporter)
    placements = runner.run(
        "physical_check",
        physical_check.VERSION,
        settings.physical_check,
        {
            "entities": found,
            "graph": graph,
            "shortlist": shortlist,
            "alignments": aligned,
            "library": models,
            "hulls": hulls,
        },
        tuple,
        lambda: physical_check.check(
            found, graph, shortlist, aligned, tried, settings.physical_check, settings.support
        ),
    )
    chosen = [tried.position(p.cad_id) for p in placements if p.cad_id is not None]
    final = with_hulls_at(tried, chosen, settings.cad.chosen_hulls, runner.reporter)
    return Scene(found, graph, placements, final, settings)


def with_hulls_at(
    library: CadLibrary, positions: Iterable[int], method: str, reporter: Reporter
) -> CadLibrary:
    """The library, its imported models at these positions with collision hulls."""
    wanted = sorted({int(i) for i in positions})
    models = [library[i] for i in wanted]
    ready = with_hulls(models, method, progress=lambda d, t: reporter.progress("hulls", d, t))
    for old, new in zip(models, ready):
        if new is not old:
            reporter.note(
                f"{new.id}: collision hulls by {new.collision}, which reach "
                f"{1000 * new.swelling_m:.1f} mm beyond its surface at most"
            )
    return library.replaced(dict(zip(wanted, ready)))


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

    Everything that can be wrong with the input is checked before the first frame is fused. What
    is finished is kept: a second run reuses it, a killed one resumes.

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
        models = open_library(library) if library else default_library()
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
    "furnish",
    "map_sequence",
    "reconstruct",
    "run",
]
