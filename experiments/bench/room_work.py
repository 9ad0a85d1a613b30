"""What one process of the benchmark does: film a room, and do runs of it."""

from __future__ import annotations

import dataclasses
import time
import traceback
from collections.abc import Iterator
from pathlib import Path

from isr_jax.demonstration.film import FilmPlan, film_room
from isr_jax.library import CadLibrary
from isr_jax.runtime.reporter import LogReporter

from .keeping import one_line
from .one_run import TRACEBACK, Libraries, finish_run
from .plan import Plan, RoomSpec, Run
from .workers import NO_FILM, Ended


@dataclasses.dataclass(frozen=True)
class RoomWork:
    """A room, and the runs of it that are missing."""

    plan: Plan
    room: RoomSpec
    runs: tuple[Run, ...]

    def through(self) -> Iterator[Ended]:
        """The film, then each run."""
        plan, room, started = self.plan, self.room, time.perf_counter()
        libraries = Libraries(plan)
        folder, library = plan.film_dir(room), libraries.of_room(room)
        problem = film_problem(folder, plan.film_plan(room), library)
        yield Ended(room, None, time.perf_counter() - started, problem)
        for run in self.runs:
            if problem is not None:
                yield Ended(room, run, 0.0, f"{NO_FILM}: {problem}")
                continue
            started = time.perf_counter()
            failure = finish_run(plan, run, libraries, LogReporter())
            yield Ended(room, run, time.perf_counter() - started, failure)


def film_problem(folder: Path, film: FilmPlan, library: CadLibrary) -> str | None:
    """Film a room, or keep its film; what went wrong, or None."""
    try:
        film_room(folder, library=library, **vars(film))
    except Exception as error:  # one room of many: its rows say what went wrong
        path = folder.parent / TRACEBACK
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(traceback.format_exc(), "utf-8")
        return f"{one_line(error)} (see {path})"
    return None
