"""What a run says while it works. The command line shows it; the library is silent by default."""

from __future__ import annotations

import logging
from typing import Protocol, runtime_checkable

LOGGER = logging.getLogger("isr_jax")


@runtime_checkable
class Reporter(Protocol):
    """Receives what happens in a run."""

    def stage(self, name: str, reused: bool) -> None:
        """A stage begins, or its stored result is taken."""
        ...

    def progress(self, name: str, done: int, total: int) -> None:
        """``done`` of ``total`` steps of a stage are finished."""
        ...

    def note(self, text: str) -> None:
        """Something the user should know: a fallback, a skipped frame."""
        ...


class LogReporter:
    """Writes stages and notes to the package's logger."""

    def stage(self, name: str, reused: bool) -> None:
        LOGGER.info("%s%s", name, " (stored result reused)" if reused else "")

    def progress(self, name: str, done: int, total: int) -> None:
        LOGGER.debug("%s %d/%d", name, done, total)

    def note(self, text: str) -> None:
        LOGGER.warning("%s", text)


class LoggedReporter:
    """Passes everything on to a reporter, and to the package's logger."""

    def __init__(self, reporter: Reporter) -> None:
        self._both = (LogReporter(), reporter)

    def stage(self, name: str, reused: bool) -> None:
        for reporter in self._both:
            reporter.stage(name, reused)

    def progress(self, name: str, done: int, total: int) -> None:
        for reporter in self._both:
            reporter.progress(name, done, total)

    def note(self, text: str) -> None:
        for reporter in self._both:
            reporter.note(text)


def logged(reporter: Reporter | None) -> Reporter:
    """A reporter whose stages and notes are also in the log, so that run.log has them."""
    if reporter is None or isinstance(reporter, (LogReporter, LoggedReporter)):
        return reporter or LogReporter()
    return LoggedReporter(reporter)
