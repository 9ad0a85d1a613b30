"""One run: a film is mapped and scored, its numbers are kept under a key of all they depend on."""

from __future__ import annotations

import dataclasses
from collections import Counter, defaultdict
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from experiments.bench.keeping import keep, kept, with_trace
from experiments.bench.one_run import COST, FAILED, RUN
from experiments.bench.rows import Value, scored
from experiments.bench.table import TidyTable
from isr_jax.runtime.run_folder import versions

from .code_digest import WHOLE, code_digest
from .diagnose import Loss, losses
from .map_film import digest, map_film
from .plan import AblationPlan, MapRun
from .scores import judge, truth_of

LOSS = "loss"
"""Stage of the table: what became of the true segments, by kind of loss."""
_SECTIONS = ("input", "segmentation", "mapping", "entities", "contact_graph")
"""Settings that a map and its scores depend on."""


@dataclasses.dataclass(frozen=True)
class MapRow:
    """One value of one run."""

    room: str
    kind: str
    split: str
    seed: int
    variant: str
    level: str
    """Of the simulated masks."""
    stage: str
    metric: str
    class_name: str
    """Empty where the value is over all classes."""
    value: float
    note: str = ""
    """Of a failed run: what went wrong, and the file with the traceback."""


TABLE = TidyTable(MapRow, "ablation", "python -m experiments.ablation --out DIR")


def run_key(plan: AblationPlan, run: MapRun) -> str:
    """Digest of everything that the values of a run depend on, its code included."""
    settings = plan.settings(run)
    parts = {
        "settings": {name: vars(getattr(settings, name)) for name in _SECTIONS},
        "level": run.level,
        "film": plan.masked_film(run).stamp,
        "code": code_digest(WHOLE),
        "versions": versions(),
    }
    return digest(parts)


def kept_values(plan: AblationPlan, run: MapRun) -> list[Value] | None:
    """Values of a finished run, or None. Runs with the same settings share them."""
    data = kept(_path(plan, run))
    return None if data is None else [Value(*value) for value in data["values"]]


def finish_run(plan: AblationPlan, run: MapRun) -> str | None:
    """Do a run and keep its values; what went wrong, or None. Never raises but on Ctrl-C."""

    def compute() -> dict[str, Any]:
        values = [dataclasses.astuple(value) for value in _values(plan, run)]
        return {"run": run.name, "values": values}

    return keep(_path(plan, run), _trace(plan, run), compute)


def rows_of(run: MapRun, values: Iterable[Value]) -> list[MapRow]:
    """Rows of a run that ended."""
    ended = Value(RUN, FAILED, "", 0.0)
    return [_row(run, value) for value in (*values, ended)]


def failed_row(plan: AblationPlan, run: MapRun, problem: str) -> MapRow:
    """The row of a run that did not end."""
    note = with_trace(problem, _trace(plan, run))
    return dataclasses.replace(_row(run, Value(RUN, FAILED, "", 1.0)), note=note)


def _row(run: MapRun, value: Value) -> MapRow:
    room = run.room
    about = (room.name, room.kind, room.split, room.seed, run.variant, run.level)
    return MapRow(*about, *dataclasses.astuple(value))


def _path(plan: AblationPlan, run: MapRun) -> Path:
    return plan.room_dir(run.room) / "runs" / f"{run_key(plan, run)}.json"


def _trace(plan: AblationPlan, run: MapRun) -> Path:
    name = run.name.replace(" ", "").replace(",", "-")
    return plan.room_dir(run.room) / "runs" / f"{name}.traceback.txt"


def _values(plan: AblationPlan, run: MapRun) -> list[Value]:
    film = plan.masked_film(run)
    mapped = map_film(film, plan.settings(run))
    judged = judge(mapped, truth_of(film.folder))
    seconds = {k: v for k, v in mapped.seconds.items() if k != "segmentation"}
    costs = [Value(COST, f"seconds.{name}", "", value) for name, value in seconds.items()]
    return [
        *scored(judged.scores),
        *_lost(losses(judged)),
        Value(COST, "seconds", "", sum(seconds.values())),
        *costs,
    ]


def _lost(found: list[Loss]) -> list[Value]:
    """How many true segments were lost in each way, and what that cost."""
    counts: Counter[str] = Counter()
    cost: defaultdict[str, float] = defaultdict(float)
    for loss in found:
        counts[loss.kind] += 1
        cost[loss.kind] += loss.pq_lost
    return [
        *(Value(LOSS, f"{kind}.count", "", float(n)) for kind, n in sorted(counts.items())),
        *(Value(LOSS, f"{kind}.pq", "", value) for kind, value in sorted(cost.items())),
    ]
