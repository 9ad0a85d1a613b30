"""Tables of means over rooms, for a terminal and as Markdown."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable, Sequence
from pathlib import Path

from rich.table import Table

from .headline import HEADLINE, Figure
from .intervals import CONFIDENCE, RESAMPLES, Interval, mean_interval, paired_difference
from .oracle import NONE, TRUTH_UP_TO
from .plan import SPLITS
from .rows import Row

MARKDOWN = "bench.md"
_Key = tuple[str, str, str, str]
"""Split, preset, level, truth."""


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


class Means:
    """Values over all classes, by what they are of."""

    def __init__(self, rows: Iterable[Row]) -> None:
        self._values: dict[_Key, dict[tuple[str, str], dict[str, float]]] = {}
        for row in rows:
            if row.class_name or row.value is None:
                continue
            key = (row.split, row.preset, row.level, row.truth_up_to)
            metrics = self._values.setdefault(key, {})
            metrics.setdefault((row.stage, row.metric), {})[row.room] = row.value

    def runs(self) -> list[_Key]:
        """In the order in which they came."""
        return list(self._values)

    def of(self, key: _Key, figure: Figure) -> dict[str, float]:
        """Value by room."""
        return self._values[key].get((figure.stage, figure.metric), {})


def sheets(rows: Sequence[Row]) -> list[Sheet]:
    """All that is printed: presets, their differences, truths, and runs that failed."""
    means = Means(rows)
    found: list[Sheet] = []
    for split in SPLITS:
        whole = [key for key in means.runs() if key[0] == split and key[3] == NONE]
        for level in dict.fromkeys(key[2] for key in whole):
            keys = [key for key in whole if key[2] == level]
            found.append(_preset_sheet(means, keys))
            if len(keys) > 1:
                found.append(_difference_sheet(means, keys))
            found += _truth_sheets(means, keys[0])
    return [*found, *_failed_sheet(rows)]


def _preset_sheet(means: Means, keys: list[_Key]) -> Sheet:
    lines = [
        (figure.heading, *(_cell(figure, mean_interval(list(v.values()))) for v in values))
        for figure in HEADLINE
        if any(values := [means.of(key, figure) for key in keys])
    ]
    return Sheet(_title(means, keys), ("mean over rooms", *(key[1] for key in keys)), tuple(lines))


def _difference_sheet(means: Means, keys: list[_Key]) -> Sheet:
    """Paired over rooms: an interval without 0 is a difference."""
    ours, others = keys[0], keys[1:]
    lines = [
        (
            figure.heading,
            *(
                _cell(figure, paired_difference(means.of(k, figure), means.of(ours, figure)), True)
                for k in others
            ),
        )
        for figure in HEADLINE
        if means.of(ours, figure)
    ]
    headings = ("mean of differences", *(f"{key[1]} - {ours[1]}" for key in others))
    return Sheet(_title(means, keys), headings, tuple(lines))


def _truth_sheets(means: Means, whole: _Key) -> list[Sheet]:
    """Each figure end to end, and with the truth up to each stage: a step shows that stage."""
    split, preset, level, _ = whole
    by_truth = {key[3]: key for key in means.runs() if key[:2] == (split, preset)}
    truths = [truth for truth in TRUTH_UP_TO if truth in by_truth]
    if not truths:
        return []
    columns = [whole, *(by_truth[truth] for truth in truths)]
    lines = [
        (figure.heading, *(_mean(figure, means.of(key, figure)) for key in columns))
        for figure in HEADLINE
        if any(means.of(key, figure) for key in columns)
    ]
    title = f"{split}, {preset}: what each stage loses (truth up to a stage, means over rooms)"
    headings = ("", f"end to end, {level}", *truths)
    return [Sheet(title, headings, tuple(lines))]


def _failed_sheet(rows: Sequence[Row]) -> list[Sheet]:
    lines = [(r.room, r.preset, r.level or r.truth_up_to, r.note) for r in rows if r.note]
    return [Sheet("runs that failed", ("room", "preset", "masks", "why"), tuple(lines))] * bool(
        lines
    )


def _title(means: Means, keys: list[_Key]) -> str:
    rooms = {room for key in keys for figure in HEADLINE for room in means.of(key, figure)}
    return f"{keys[0][0]}, masks {keys[0][2]}, {len(rooms)} rooms"


def _cell(figure: Figure, interval: Interval | None, signed: bool = False) -> str:
    if interval is None:
        return "-"
    mean = figure.shown(interval.mean)
    mean = f"+{mean}" if signed and interval.mean > 0 else mean
    if interval.low is None:
        return mean
    return f"{mean} [{figure.shown(interval.low)}, {figure.shown(interval.high)}]"


def _mean(figure: Figure, values: dict[str, float]) -> str:
    interval = mean_interval(list(values.values()))
    return figure.shown(None if interval is None else interval.mean)


def write_markdown(found: Sequence[Sheet], out_dir: Path) -> Path:
    """``bench.md`` with all sheets."""
    path = out_dir / MARKDOWN
    note = (
        f"In brackets: {CONFIDENCE:.0%} percentile bootstrap intervals of the mean over rooms, "
        f"{RESAMPLES} resamples. A dash: undefined."
    )
    path.write_text("\n\n".join([note, *(s.markdown() for s in found)]) + "\n", "utf-8")
    return path
