"""Work on foreign files in processes of their own: one that dies or hangs costs one item."""

from __future__ import annotations

import dataclasses
import os
import pickle
import queue
import signal
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator, Sequence
from typing import Any, BinaryIO, cast

from ...errors import IsrError
from ..hulls.worker import read_message, write_message

_START_S = 300.0  # a process's imports, on a machine under load
_POLL_S = 0.2


@dataclasses.dataclass(frozen=True)
class Failure:
    """A task that gave no result."""

    problem: str
    hint: str = ""


def run_isolated(
    work: Callable[[Any], Any], tasks: Sequence[Any], workers: int, time_limit_s: float
) -> Iterator[tuple[int, Any]]:
    """Position and result of each task as it is done; a `Failure` where there is no result.

    Args:
        work: A function of a module, so that another process finds it.
        tasks: What it is called with; they and their results can be pickled.
        workers: Processes; 0 works here, without protection.
        time_limit_s: For one task; its process is ended then.
    """
    if workers == 0:
        for position, task in enumerate(tasks):
            yield position, _attempt(work, task)
        return
    waiting: queue.SimpleQueue[int] = queue.SimpleQueue()
    done: queue.SimpleQueue[tuple[int, Any]] = queue.SimpleQueue()
    for position in range(len(tasks)):
        waiting.put(position)
    crew = [_Worker(work, time_limit_s) for _ in range(min(workers, len(tasks)))]
    for worker in crew:
        threading.Thread(target=worker.run, args=(tasks, waiting, done), daemon=True).start()
    try:
        left = len(tasks)
        while left:
            try:
                outcome = done.get(timeout=_POLL_S)  # so that Ctrl-C is heard on every system
            except queue.Empty:
                continue
            yield outcome
            left -= 1
    finally:
        for worker in crew:
            worker.close()


class _Worker:
    """One process, started when there is a task for it, and again after it ended."""

    def __init__(self, work: Callable[[Any], Any], time_limit_s: float) -> None:
        self._work, self._time_limit_s = work, time_limit_s
        self._process: subprocess.Popen | None = None
        self._closed = False
        self._lock = threading.Lock()

    def run(
        self, tasks: Sequence[Any], waiting: queue.SimpleQueue, done: queue.SimpleQueue
    ) -> None:
        """Do tasks until none is left; the body of a thread."""
        while not self._closed:
            try:
                position = waiting.get_nowait()
            except queue.Empty:
                break
            done.put((position, self._ask(tasks[position])))
        self._end()

    def close(self) -> None:
        """End the process, whatever it does."""
        with self._lock:
            self._closed = True
            if self._process is not None:
                self._process.kill()

    def _ask(self, task: Any) -> Any:
        with self._lock:
            if self._closed:
                return Failure("broken off")
            if self._process is None:
                self._process = _started()
        answer, late = self._exchange(pickle.dumps((self._work, task)))
        if answer is not None:
            return pickle.loads(answer)
        code = self._end()
        if late:
            hint = "simplify the model, or raise time_limit_s"
            return Failure(f"not done after {self._time_limit_s:g} s", hint)
        return Failure(f"reading it ended its process (exit {code})")

    def _exchange(self, message: bytes) -> tuple[bytes | None, bool]:
        """The answer, and whether its time ran out; the clock starts when imports are done."""
        process, late = self._process, threading.Event()
        assert process is not None
        tasks, answers = cast(BinaryIO, process.stdin), cast(BinaryIO, process.stdout)
        try:
            write_message(tasks, message)
            for limit_s in (_START_S, self._time_limit_s):
                timer = threading.Timer(limit_s, lambda: (late.set(), process.kill()))
                timer.start()
                answer = read_message(answers)
                timer.cancel()
                if answer is None:
                    return None, late.is_set()
            return answer, False
        except OSError:
            return None, late.is_set()

    def _end(self) -> int | None:
        """End the process; its exit status."""
        with self._lock:
            process, self._process = self._process, None
        if process is None:
            return None
        # One that ended by itself has its own status; one that waits ends with its input.
        process.communicate()
        return process.returncode


def _started() -> subprocess.Popen:
    """A process that runs `serve`; unlike `multiprocessing` it runs no main module twice."""
    paths = os.pathsep.join(path for path in sys.path if path)
    return subprocess.Popen(
        [sys.executable, "-c", f"from {__name__} import serve; serve()"],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        env={**os.environ, "PYTHONPATH": paths, "JAX_PLATFORMS": "cpu"},
        start_new_session=True,  # Ctrl-C is this process's to handle
    )


def serve() -> None:
    """Body of a worker: tasks from its input, results to its output, until the input ends."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    # Libraries that print must not write into the answers.
    answers = os.fdopen(os.dup(sys.stdout.fileno()), "wb")
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())
    while (message := read_message(sys.stdin.buffer)) is not None:
        work, task = pickle.loads(message)
        write_message(answers, b"started")
        write_message(answers, pickle.dumps(_attempt(work, task)))


def _attempt(work: Callable[[Any], Any], task: Any) -> Any:
    try:
        return work(task)
    except IsrError as error:
        return Failure(error.problem, error.hint)
    except RecursionError:
        return Failure("it nests too deep")
    except MemoryError:
        return Failure("it needs more memory than there is", "simplify the model")
    # A foreign file may make any library fail in any way: that is this item's fault alone.
    except Exception as error:
        said = " ".join(f"{type(error).__name__}: {error}".split())[:200]
        return Failure(f"reading it failed ({said})")
