"""What the benchmark prints: presets, their differences, what each stage loses."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from .headline import HEADLINE, Figure
from .intervals import mean_interval, paired_difference
from .oracle import NONE, TRUTH_UP_TO
from .plan import SPLITS
from .rows import Row
from .sheets import ByRoom, Sheet, cell

MARKDOWN = "bench.md"
_Key = tuple[str, str, str, str]
"""Split, preset, level, truth."""


def means_of(rows: Iterable[Row]) -> ByRoom[_Key]:
    """The values of each run over its rooms."""
    return ByRoom(rows, lambda row: (row.split, row.preset, row.level, row.truth_up_to))


def sheets(rows: Sequence[Row]) -> list[Sheet]:
    """All that is printed: presets, their differences, truths, and runs that failed."""
    means = means_of(rows)
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


def _preset_sheet(means: ByRoom[_Key], keys: list[_Key]) -> Sheet:
    lines = [
        (figure.heading, *(cell(figure, mean_interval(list(v.values()))) for v in values))
        for figure in HEADLINE
        if any(values := [means.of(key, figure) for key in keys])
    ]
    return Sheet(_title(means, keys), ("mean over rooms", *(key[1] for key in keys)), tuple(lines))


def _difference_sheet(means: ByRoom[_Key], keys: list[_Key]) -> Sheet:
    """Paired over rooms: an interval without 0 is a difference."""
    ours, others = keys[0], keys[1:]
    lines = [
        (
            figure.heading,
            *(
                cell(figure, paired_difference(means.of(k, figure), means.of(ours, figure)), True)
                for k in others
            ),
        )
        for figure in HEADLINE
        if means.of(ours, figure)
    ]
    headings = ("mean of differences", *(f"{key[1]} - {ours[1]}" for key in others))
    return Sheet(_title(means, keys), headings, tuple(lines))


def _truth_sheets(means: ByRoom[_Key], whole: _Key) -> list[Sheet]:
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


def _title(means: ByRoom[_Key], keys: list[_Key]) -> str:
    rooms = {room for key in keys for figure in HEADLINE for room in means.of(key, figure)}
    return f"{keys[0][0]}, masks {keys[0][2]}, {len(rooms)} rooms"


def _mean(figure: Figure, values: dict[str, float]) -> str:
    interval = mean_interval(list(values.values()))
    return figure.shown(None if interval is None else interval.mean)
