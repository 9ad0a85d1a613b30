"""Printed tables of means over rooms, for a terminal and as Markdown."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Hashable, Iterable, Sequence
from pathlib import Path
from typing import Generic, Protocol, TypeVar

from rich.table import Table

from .headline import Figure
from .intervals import CONFIDENCE, RESAMPLES, Interval

KeyT = TypeVar("KeyT", bound=Hashable)


@dataclasses.dataclass(frozen=True)
class Sheet:
    """A table, whatever it is printed on."""

    title: str
    headings: tuple[str, ...]
    lines: tuple[tuple[str, ...], ...]

    def table(self) -> Table:
        """For a rich console."""
        table = Table(title=self.title, title_justify="left")
        for k, heading in enumerate(self.headings):
            table.add_column(heading, justify="left" if k == 0 else "right", no_wrap=k == 0)
        for line in self.lines:
            table.add_row(*line)
        return table

    def markdown(self) -> str:
        """A GitHub table below a heading."""
        rows = [self.headings, ("---", *("---:" for _ in self.headings[1:])), *self.lines]
        return "\n".join([f"### {self.title}", "", *("| " + " | ".join(r) + " |" for r in rows)])


class Measured(Protocol):
    """What a row of any tidy table says."""

    @property
    def room(self) -> str: ...
    @property
    def stage(self) -> str: ...
    @property
    def metric(self) -> str: ...
    @property
    def class_name(self) -> str: ...
    @property
    def value(self) -> float | None: ...


RowT = TypeVar("RowT", bound=Measured)


class ByRoom(Generic[KeyT]):
    """Values over all classes, by what they are of and by room.

    Args:
        rows: Of a tidy table.
        key: What the row is of: all that is not averaged.
    """

    def __init__(self, rows: Iterable[RowT], key: Callable[[RowT], KeyT]) -> None:
        self._values: dict[KeyT, dict[tuple[str, str], dict[str, float]]] = {}
        for row in rows:
            if row.class_name or row.value is None:
                continue
            metrics = self._values.setdefault(key(row), {})
            metrics.setdefault((row.stage, row.metric), {})[row.room] = row.value

    def runs(self) -> list[KeyT]:
        """In the order in which they came."""
        return list(self._values)

    def of(self, key: KeyT, figure: Figure) -> dict[str, float]:
        """Value by room."""
        return self._values.get(key, {}).get((figure.stage, figure.metric), {})


def cell(figure: Figure, interval: Interval | None, signed: bool = False) -> str:
    """A mean with its interval; a dash where it is undefined."""
    if interval is None:
        return "-"
    mean = figure.shown(interval.mean)
    mean = f"+{mean}" if signed and interval.mean > 0 else mean
    if interval.low is None:
        return mean
    return f"{mean} [{figure.shown(interval.low)}, {figure.shown(interval.high)}]"


def write_markdown(found: Sequence[Sheet], path: Path) -> None:
    """All sheets in one file."""
    note = (
        f"In brackets: {CONFIDENCE:.0%} percentile bootstrap intervals of the mean over rooms, "
        f"{RESAMPLES} resamples. A dash: undefined."
    )
    path.write_text("\n\n".join([note, *(s.markdown() for s in found)]) + "\n", "utf-8")
