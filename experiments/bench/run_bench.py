"""Run what is missing of a plan, gather the table."""

from __future__ import annotations

from isr_jax.demonstration.film import is_filmed

from .one_run import Libraries, failed_row, kept_rows, run_key
from .plan import Plan, Run
from .room_work import RoomWork
from .rows import Row
from .table import BENCH
from .workers import Said, run_works


def run_plan(plan: Plan, jobs: int, said: Said) -> list[Row]:
    """Do the runs that are not kept, and write the table of all that are done.

    The table is also written when the bench is broken off: what is finished is in it, and the
    next call goes on from there.
    """
    libraries = Libraries(plan)

    def gather(problems: dict[Run, str]) -> list[Row]:
        rows = _gathered(plan, libraries, problems)
        BENCH.write(rows, plan.out_dir)
        return rows

    return run_works(missing(plan, libraries), jobs, said, gather)


def missing(plan: Plan, libraries: Libraries) -> list[RoomWork]:
    """The runs that are not kept, by room."""
    found = []
    for room in plan.rooms:
        filmed = is_filmed(plan.film_dir(room), plan.film_plan(room), libraries.of_room(room))
        runs = tuple(
            run for run in plan.runs(room) if not filmed or _kept(plan, run, libraries) is None
        )
        if runs:
            found.append(RoomWork(plan, room, runs))
    return found


def _kept(plan: Plan, run: Run, libraries: Libraries) -> list[Row] | None:
    return kept_rows(plan.run_dir(run), run_key(plan, run, libraries))


def _gathered(plan: Plan, libraries: Libraries, problems: dict[Run, str]) -> list[Row]:
    rows: list[Row] = []
    for room in plan.rooms:
        for run in plan.runs(room):
            if run in problems:
                rows.append(failed_row(plan, run, problems[run]))
            else:
                rows += _kept(plan, run, libraries) or []
    return rows
