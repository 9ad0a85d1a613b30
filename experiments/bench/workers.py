"""Rooms in processes of their own: one that dies costs one run, and Ctrl-C keeps what is done."""

from __future__ import annotations

import contextlib
import dataclasses
import multiprocessing
import multiprocessing.connection
import os
import signal
from collections.abc import Callable, Iterator, Sequence
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from typing import Any, Protocol, TypeVar

from isr_jax.runtime.caches import enable_compilation_cache
from isr_jax.runtime.cores import usable_cores

from .plan import RoomSpec

_THREADS = ("NPROC", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "OPENCV_FOR_THREADS_NUM")
"""How XLA, OpenMP, OpenBLAS and OpenCV are told how many threads to use."""
NO_FILM = "the room was not filmed"

T = TypeVar("T")


@dataclasses.dataclass(frozen=True)
class Ended:
    """A film or a run that ended, one way or the other."""

    room: RoomSpec
    run: Any | None
    """One of `Work.runs`; None: the film."""
    seconds: float
    problem: str | None
    """None: all is well."""


class Work(Protocol):
    """What one process does: film a room, and do runs of it. A frozen dataclass."""

    @property
    def room(self) -> RoomSpec: ...

    @property
    def runs(self) -> tuple[Any, ...]:
        """Hashable, in the order in which they are done."""
        ...

    def through(self) -> Iterator[Ended]:
        """Do it: the film comes first, then one run at a time."""
        ...


Said = Callable[[Ended, int, int], None]
"""Told what ended, how many runs have, and how many there are."""


def run_works(
    works: Sequence[Work], jobs: int, said: Said, gather: Callable[[dict[Any, str]], T]
) -> T:
    """Do it all, then gather the results, also where it is broken off.

    Args:
        works: One a room.
        jobs: As in `work_through`.
        said: Hears what ends.
        gather: Given what went wrong by run, makes the result.
    """
    problems: dict[Any, str] = {}
    total, done = sum(len(work.runs) for work in works), 0
    try:
        for ended in work_through(works, jobs):
            done += ended.run is not None
            if ended.run is not None and ended.problem is not None:
                problems[ended.run] = ended.problem
            said(ended, done, total)
    finally:
        gathered = gather(problems)
    return gathered


def work_through(works: Sequence[Work], jobs: int) -> Iterator[Ended]:
    """Do it all, ``jobs`` rooms at a time, each with its share of the cores.

    Args:
        works: One a room.
        jobs: Processes; 0 works here, without protection against a process that dies.
    """
    if jobs == 0:
        for work in works:
            yield from work.through()
        return
    with _few_threads(max(1, usable_cores() // jobs)):
        yield from _apart(list(works), jobs)


@contextlib.contextmanager
def _few_threads(count: int) -> Iterator[None]:
    """Processes that start within have so many threads per library, unless the user said else."""
    added = {name: str(count) for name in _THREADS if name not in os.environ}
    os.environ.update(added)
    try:
        yield
    finally:
        for name in added:
            del os.environ[name]


@dataclasses.dataclass
class _Busy:
    process: BaseProcess
    inbox: Connection
    work: Work
    filmed: bool = False
    done: int = 0
    """Runs that ended."""


def _apart(waiting: list[Work], jobs: int) -> Iterator[Ended]:
    crew: list[_Busy] = []
    try:
        while waiting or crew:
            while waiting and len(crew) < jobs:
                crew.append(_started(waiting.pop(0)))
            for ready in multiprocessing.connection.wait([busy.inbox for busy in crew]):
                busy = next(b for b in crew if b.inbox is ready)
                try:
                    ended: Ended = busy.inbox.recv()
                except EOFError:
                    crew.remove(busy)
                    lost, rest = _left_behind(busy)
                    yield from lost
                    waiting[:0] = rest
                    continue
                busy.filmed |= ended.run is None
                busy.done += ended.run is not None
                yield ended
    finally:
        for busy in crew:
            busy.process.kill()
            busy.process.join()


def _started(work: Work) -> _Busy:
    context = multiprocessing.get_context("spawn")
    inbox, outbox = context.Pipe(duplex=False)
    process = context.Process(target=_serve, args=(work, outbox))
    process.start()
    outbox.close()  # so that the end of the process is the end of what comes
    return _Busy(process, inbox, work)


def _serve(work: Work, outbox: Connection) -> None:
    """Body of a process."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the process that started this one
    enable_compilation_cache()
    for ended in work.through():
        outbox.send(ended)
    outbox.close()


def _left_behind(busy: _Busy) -> tuple[list[Ended], list[Work]]:
    """What a process that ended did not do: the run it died in, and work for another one.

    One that died while it filmed takes all runs of its room with it.
    """
    busy.process.join()
    left = busy.work.runs[busy.done :]
    problem = f"its process ended (exit {busy.process.exitcode})"
    if not busy.filmed:
        return [Ended(busy.work.room, run, 0.0, f"{NO_FILM}: {problem}") for run in left], []
    rest = [dataclasses.replace(busy.work, runs=left[1:])] if left[1:] else []  # type: ignore[type-var]
    return [Ended(busy.work.room, run, 0.0, problem) for run in left[:1]], rest
