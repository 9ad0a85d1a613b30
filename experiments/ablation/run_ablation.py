"""Map what is missing of a plan, gather the table."""

from __future__ import annotations

import dataclasses
import time
from collections.abc import Iterator

from experiments.bench.plan import RoomSpec
from experiments.bench.room_work import film_problem
from experiments.bench.workers import NO_FILM, Ended, Said, run_works
from isr_jax.cad import default_library, open_library
from isr_jax.demonstration.film import is_filmed
from isr_jax.library import CadLibrary

from .map_run import TABLE, MapRow, failed_row, finish_run, kept_values, rows_of
from .plan import AblationPlan, MapRun


@dataclasses.dataclass(frozen=True)
class MapWork:
    """A room, and the runs of it that are missing."""

    plan: AblationPlan
    room: RoomSpec
    runs: tuple[MapRun, ...]

    def through(self) -> Iterator[Ended]:
        """The film, then each run."""
        started = time.perf_counter()
        problem = self._film()
        yield Ended(self.room, None, time.perf_counter() - started, problem)
        for run in self.runs:
            if problem is not None:
                yield Ended(self.room, run, 0.0, f"{NO_FILM}: {problem}")
                continue
            started, failure = time.perf_counter(), None
            if kept_values(self.plan, run) is None:  # another one with its settings has run
                failure = finish_run(self.plan, run)
            yield Ended(self.room, run, time.perf_counter() - started, failure)

    def _film(self) -> str | None:
        plan, room = self.plan, self.room
        if plan.given_film(room) is not None:
            return None
        return film_problem(plan.film_dir(room), plan.film_plan(room), _library(plan, room))


def run_plan(plan: AblationPlan, jobs: int, said: Said) -> list[MapRow]:
    """Do the runs that are not kept, and write the table of all that are done.

    The table is also written when the ablation is broken off; the next call goes on from there.
    """

    def gather(problems: dict[MapRun, str]) -> list[MapRow]:
        rows = _gathered(plan, problems)
        TABLE.write(rows, plan.out_dir)
        return rows

    return run_works(missing(plan), jobs, said, gather)


def missing(plan: AblationPlan) -> list[MapWork]:
    """The runs that are not kept, by room."""
    found = []
    for room in plan.rooms:
        filmed = _is_filmed(plan, room)
        runs = tuple(run for run in plan.runs(room) if not filmed or kept_values(plan, run) is None)
        if runs:
            found.append(MapWork(plan, room, runs))
    return found


def _is_filmed(plan: AblationPlan, room: RoomSpec) -> bool:
    if plan.given_film(room) is not None:
        return True
    return is_filmed(plan.film_dir(room), plan.film_plan(room), _library(plan, room))


def _library(plan: AblationPlan, room: RoomSpec) -> CadLibrary:
    """What furnishes a room that is filmed here."""
    path = dict(plan.libraries)[room.split]
    return default_library() if path is None else open_library(path)


def _gathered(plan: AblationPlan, problems: dict[MapRun, str]) -> list[MapRow]:
    rows: list[MapRow] = []
    for room in plan.rooms:
        filmed = _is_filmed(plan, room)
        for run in plan.runs(room):
            if run in problems:
                rows.append(failed_row(plan, run, problems[run]))
            elif filmed and (values := kept_values(plan, run)) is not None:
                rows += rows_of(run, values)
    return rows
