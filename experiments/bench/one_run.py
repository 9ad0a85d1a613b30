"""One run: a film becomes a scene, the scene becomes rows of the table."""

from __future__ import annotations

import hashlib
import json
import shutil
import time
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from isr_jax import (
    alignment,
    contact_graph,
    datasets,
    entities,
    evaluation,
    export,
    mapping,
    matching,
    physical_check,
    pipeline,
    segmentation,
    stability,
)
from isr_jax.config import Settings, settings_to_dict
from isr_jax.library import CadLibrary
from isr_jax.pipeline import RunResult
from isr_jax.runtime.reporter import Reporter
from isr_jax.runtime.run_folder import RunFolder, versions
from isr_jax.runtime.stage_runner import StageRunner
from isr_jax.runtime.store import StageStore

from .cost import CostMeter
from .keeping import keep, kept, with_trace
from .oracle import MASKS, NONE, TRUE_MODELS, TruthRunner, truth_of_stages
from .plan import Plan, RoomSpec, Run
from .rows import Row, Value, flatten
from .truth_folder import read_true_scene

_VERSION = 1
"""Of what is kept of a run."""
_ROWS, TRACEBACK = "rows.json", "traceback.txt"
COST, RUN = "cost", "run"
"""Stages of the table: what a run costs, and whether it ended."""
FAILED = "failed"
_STAGES = (
    segmentation,
    mapping,
    entities,
    contact_graph,
    matching,
    alignment,
    physical_check,
    export,
    stability,
    evaluation,
)


class Libraries:
    """The kit, and what furnishes the rooms, each opened once."""

    def __init__(self, plan: Plan) -> None:
        from isr_jax.cad import default_library, open_library

        self.kit: CadLibrary = default_library()
        self._rooms = {
            split: self.kit if path is None else open_library(path)
            for split, path in plan.libraries
        }

    def of_room(self, room: RoomSpec) -> CadLibrary:
        """That furnishes the room."""
        return self._rooms[room.split]

    def of_run(self, run: Run) -> CadLibrary:
        """That reconstructs it: the kit, but where the true models are given."""
        return self.of_room(run.room) if run.truth_up_to in TRUE_MODELS else self.kit


def run_key(plan: Plan, run: Run, libraries: Libraries) -> str:
    """Digest of everything that the values of a run depend on."""
    parts = {
        "bench": _VERSION,
        "settings": settings_to_dict(plan.settings_of(run)),
        "level": run.level,
        "truth_up_to": run.truth_up_to,
        "film": plan.film_plan(run.room).stamp(libraries.of_room(run.room)),
        "library": libraries.of_run(run).content_hash,
        "stages": {stage.__name__: stage.VERSION for stage in _STAGES},
        "versions": versions(),
    }
    text = json.dumps(parts, sort_keys=True)
    return hashlib.blake2b(text.encode(), digest_size=16).hexdigest()


def kept_rows(folder: Path, key: str) -> list[Row] | None:
    """Rows of a finished run of this key, or None."""
    data = kept(folder / _ROWS)
    return None if data is None or data["key"] != key else [Row(**row) for row in data["rows"]]


def finish_run(plan: Plan, run: Run, libraries: Libraries, reporter: Reporter) -> str | None:
    """Do a run and keep its rows; what went wrong, or None. Never raises but on Ctrl-C."""

    def compute() -> dict[str, Any]:
        rows = rows_of(run, _values(plan, run, libraries, reporter))
        return {"key": run_key(plan, run, libraries), "rows": [vars(row) for row in rows]}

    folder = plan.run_dir(run)
    return keep(folder / _ROWS, folder / TRACEBACK, compute)


def rows_of(run: Run, values: Iterable[Value]) -> list[Row]:
    """Rows of a run that ended."""
    ended = Value(RUN, FAILED, "", 0.0)
    return [
        _row(run, value.stage, value.metric, value.class_name, value.value)
        for value in (*values, ended)
    ]


def failed_row(plan: Plan, run: Run, problem: str) -> Row:
    """The row of a run that did not end."""
    return _row(run, RUN, FAILED, "", 1.0, with_trace(problem, plan.run_dir(run) / TRACEBACK))


def _row(run: Run, stage: str, metric: str, class_name: str, value: float, note: str = "") -> Row:
    room = run.room
    about = (room.name, room.kind, room.split, room.seed, run.preset, run.level, run.truth_up_to)
    return Row(*about, stage, metric, class_name, value, note)


def _values(plan: Plan, run: Run, libraries: Libraries, reporter: Reporter) -> list[Value]:
    meter, folder = CostMeter(reporter), plan.run_dir(run)
    library, settings = libraries.of_run(run), plan.settings_of(run)
    with RunFolder(folder, settings):
        result = _reconstruct(plan, run, library, settings, meter)
        meter.stage("evaluation", False)
        report = evaluation.evaluate(
            folder,
            plan.film_dir(run.room) / "truth",
            library=result.scene.library,
            truth_library=libraries.of_room(run.room),
        )
        report.write(folder / "evaluation.json")
    _drop_bulk(folder)
    costs = [Value(COST, name, "", value) for name, value in meter.costs().items()]
    return [*flatten(report, result.stability), *costs]


def _drop_bulk(folder: Path) -> None:
    """Delete what is scored and large: stored stages and the map, 200 MB per run."""
    for name in ("stages", "map"):
        shutil.rmtree(folder / name, ignore_errors=True)


def _reconstruct(
    plan: Plan, run: Run, library: CadLibrary, settings: Settings, reporter: Reporter
) -> RunResult:
    started, film, folder = time.perf_counter(), plan.film_dir(run.room), plan.run_dir(run)
    sequence = datasets.open_sequence(film, settings.input)
    masks = segmentation.open_segmenter(
        f"simulated:{run.level or 'perfect'}", film, settings=settings.segmentation
    )
    if run.truth_up_to in (NONE, MASKS):
        runner = StageRunner(StageStore(folder / "stages"), reporter)
    else:
        runner = TruthRunner(_given(film, run, library, settings, len(sequence)), reporter)
    scene = pipeline.reconstruct(
        sequence, library=library, segmenter=masks, settings=settings, runner=runner
    )
    return pipeline.finish(scene, folder, reporter, started)


def _given(
    film: Path, run: Run, library: CadLibrary, settings: Settings, frames: int
) -> dict[str, Any]:
    truth = read_true_scene(film / "truth", settings.mapping.voxel_size_m)
    return truth_of_stages(truth, library, run.truth_up_to, frames)
