"""What the ablation prints: variants a group, their differences, mask levels, kinds of loss."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Sequence

from experiments.bench.headline import Figure
from experiments.bench.intervals import mean_interval, paired_difference
from experiments.bench.one_run import COST
from experiments.bench.sheets import ByRoom, Sheet, cell

from .diagnose import KINDS
from .map_run import LOSS, MapRow
from .variants import GROUPS, PRESET_GROUP, Variant, chosen, variant

MARKDOWN = "ablation.md"
FIGURES = (
    Figure("PQ", "mapping", "panoptic.pq"),
    Figure("SQ", "mapping", "panoptic.sq"),
    Figure("RQ", "mapping", "panoptic.rq"),
    Figure("PQ things", "mapping", "panoptic.pq_things"),
    Figure("PQ stuff", "mapping", "panoptic.pq_stuff"),
    Figure("AP@0.5", "mapping", "instances.map50"),
    Figure("box mAP", "entities", "observed_boxes.map50"),
    Figure("mAP_re", "contact_graph", "boxes.map50"),
    Figure("seconds", COST, "seconds", 1.0, "s", False),
)
_LOSSES = tuple(Figure(kind, LOSS, f"{kind}.pq") for kind in KINDS)
_Key = tuple[str, str]
"""Variant, level of the masks."""
_Means = ByRoom[_Key]


def sheets(rows: Sequence[MapRow]) -> list[Sheet]:
    """All that is printed of a table."""
    means: _Means = ByRoom(rows, lambda row: (row.variant, row.level))
    keys = means.runs()
    found: list[Sheet] = []
    for level in dict.fromkeys(level for _, level in keys):
        named = [name for name, of in keys if of == level]
        for group in GROUPS:
            own = [v for v in chosen((group,)) if v.name in named]
            if own and (group != PRESET_GROUP or not _only_presets(keys, level)):
                found += _group_sheets(means, level, group, own)
    if len({level for _, level in keys}) > 1:
        found.append(_levels_sheet(means))
    if keys:
        found.append(_loss_sheet(means))
    return [*found, *_failed_sheet(rows)]


def _only_presets(keys: list[_Key], level: str) -> bool:
    """Whether `_levels_sheet` has all of a level."""
    levels = {of for _, of in keys}
    named = {name for name, of in keys if of == level}
    return len(levels) > 1 and named <= {v.name for v in chosen((PRESET_GROUP,))}


def _group_sheets(means: _Means, level: str, group: str, own: list[Variant]) -> list[Sheet]:
    names = dict.fromkeys([*(v.base for v in own), *(v.name for v in own)])
    shown = [variant(name) for name in names if (name, level) in means.runs()]
    rooms = {room for v in shown for room in means.of((v.name, level), FIGURES[0])}
    title = f"{GROUPS[group]}; masks {level}, {len(rooms)} rooms"
    lines = [(v.name, *_means(means, (v.name, level), FIGURES), v.shows) for v in shown]
    headings = (*(figure.heading for figure in FIGURES), "what it shows")
    found = [Sheet(title, ("mean over rooms", *headings), tuple(lines))]
    pairs = _pairs(group, own)
    told = [
        (f"{a} minus {b}", *_differences(means, (a, level), (b, level)))
        for a, b in pairs
        if {(a, level), (b, level)} <= set(means.runs())
    ]
    if told:
        found.append(Sheet(title, ("mean of differences", *headings[:-1]), tuple(told)))
    return found


def _pairs(group: str, own: list[Variant]) -> list[tuple[str, str]]:
    """Who is compared with whom."""
    if group == PRESET_GROUP:
        names = [v.name for v in own]
        return list(itertools.pairwise(names))
    return [(v.name, v.base) for v in own]


def _levels_sheet(means: _Means) -> Sheet:
    presets = {v.name for v in chosen((PRESET_GROUP,))}
    keys = [key for key in means.runs() if key[0] in presets]
    lines = [(f"{name}, {level}", *_means(means, (name, level), FIGURES)) for name, level in keys]
    headings = ("mean over rooms", *(figure.heading for figure in FIGURES))
    return Sheet("the presets and how wrong the masks are", headings, tuple(lines))


def _loss_sheet(means: _Means) -> Sheet:
    """PQ that the true segments of each kind cost, by `Loss.pq_lost`: 0 where there are none."""
    lines = []
    for key in means.runs():
        rooms = means.of(key, FIGURES[0])
        cells = []
        for figure in _LOSSES:
            values = means.of(key, figure)
            interval = mean_interval([values.get(room, 0.0) for room in rooms])
            cells.append(figure.shown(None if interval is None else interval.mean))
        lines.append((", ".join(key), *cells))
    title = "PQ lost, by what became of the true segments (each as if it alone were mended)"
    return Sheet(title, ("mean over rooms, %", *KINDS), tuple(lines))


def _means(means: _Means, key: _Key, figures: Iterable[Figure]) -> list[str]:
    return [cell(f, mean_interval(list(means.of(key, f).values()))) for f in figures]


def _differences(means: _Means, ours: _Key, theirs: _Key) -> list[str]:
    """Paired over rooms: an interval without 0 is a difference."""
    return [
        cell(f, paired_difference(means.of(ours, f), means.of(theirs, f)), True) for f in FIGURES
    ]


def _failed_sheet(rows: Sequence[MapRow]) -> list[Sheet]:
    lines = [(r.room, r.variant, r.level, r.note) for r in rows if r.note]
    return [Sheet("runs that failed", ("room", "variant", "masks", "why"), tuple(lines))] * bool(
        lines
    )
