"""What a run costs: seconds per stage, processor seconds, peak memory."""

from __future__ import annotations

import contextlib
import ctypes
import gc
import os
import sys
import time
from pathlib import Path

from isr_jax.runtime.reporter import Reporter

_STATUS, _CLEAR = Path("/proc/self/status"), Path("/proc/self/clear_refs")
_RESET_PEAK = "5"
"""proc(5): sets the peak of the resident set to what is resident now."""


class CostMeter:
    """A reporter that times the stages, and passes all on to another."""

    def __init__(self, reporter: Reporter) -> None:
        self._reporter = reporter
        self._stage: str | None = None
        self._seconds: dict[str, float] = {}
        self._started = self._since = time.perf_counter()
        self._cpu_s = _cpu_seconds()
        _reset_peak()

    def stage(self, name: str, reused: bool) -> None:
        self._turn_to(name)
        self._reporter.stage(name, reused)

    def progress(self, name: str, done: int, total: int) -> None:
        self._reporter.progress(name, done, total)

    def note(self, text: str) -> None:
        self._reporter.note(text)

    def costs(self) -> dict[str, float]:
        """Wall seconds (whole, and a stage), processor seconds with those of ended child
        processes, and the peak of this process's resident memory in bytes."""
        self._turn_to(None)
        return {
            "seconds": time.perf_counter() - self._started,
            "cpu_seconds": _cpu_seconds() - self._cpu_s,
            "peak_memory_bytes": float(_peak_bytes()),
            **{f"seconds.{name}": value for name, value in self._seconds.items()},
        }

    def _turn_to(self, name: str | None) -> None:
        now = time.perf_counter()
        if self._stage is not None:
            spent = now - self._since
            self._seconds[self._stage] = self._seconds.get(self._stage, 0.0) + spent
        self._stage, self._since = name, now


def _cpu_seconds() -> float:
    times = os.times()
    return times.user + times.system + times.children_user + times.children_system


def _reset_peak() -> None:
    """Give back what earlier runs left, so that the peak is this run's.

    Where the system does not let it, it is that of the process so far.
    """
    gc.collect()
    if sys.platform == "linux":
        with contextlib.suppress(OSError, AttributeError):  # AttributeError: a libc without trim
            ctypes.CDLL(None).malloc_trim(0)
            _CLEAR.write_text(_RESET_PEAK)


def _peak_bytes() -> int:
    if sys.platform == "linux":
        lines = _STATUS.read_text().splitlines()
        return 1024 * int(next(line for line in lines if line.startswith("VmHWM")).split()[1])
    import resource

    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss  # bytes on macOS
