"""``isr classes``: what labels of other data sets are to us."""

from __future__ import annotations

from typing import Annotated

import tyro
from rich.console import Console
from rich.table import Table

from ..classes import classes as all_classes
from ..classes import label_table
from ..classes.label_lists import LABEL_SETS, label_list

_Set = Annotated[str | None, tyro.conf.arg(metavar="LABEL_SET", help_behavior_hint="")]


def classes(label_set: tyro.conf.Positional[_Set] = None) -> None:
    """List our classes, or what each label of a data set is to us.

    Example: isr classes coco_panoptic

    Args:
        label_set: coco80, coco_panoptic, ade20k, ade32, nyu40, scannet, scannet200 or scenenn;
            our own classes if left out.
    """
    console = Console()
    console.print(_own_table() if label_set is None else _label_table(label_set))


def _own_table() -> Table:
    table = Table(title="classes")
    for column in ("id", "name", "kind", "CAD", "mount", "labels that mean it"):
        table.add_column(column, justify="right" if column == "id" else "left")
    for info in all_classes()[1:]:
        known = [f"{s} {len(info.labels[s])}" for s in LABEL_SETS if info.labels[s]]
        cad = "articulated" if info.articulated else "rigid"
        table.add_row(
            str(info.id),
            info.name,
            info.kind,
            cad if info.functional else "-",
            info.mount,
            ", ".join(known),
        )
    return table


def _label_table(label_set: str) -> Table:
    ours, labels = label_table(label_set), label_list(label_set)
    mapped = sum(ours[label.id] > 0 for label in labels)
    table = Table(title=f"{label_set}: {len(labels)} labels, {mapped} of them one of our classes")
    for column in ("id", "label", "thing", "class", "kind"):
        table.add_column(column, justify="right" if column == "id" else "left")
    for label in labels:
        info = all_classes()[ours[label.id]]
        name, kind = (info.name, info.kind) if info.id else ("-", "-")
        table.add_row(str(label.id), label.name, "thing" if label.is_thing else "stuff", name, kind)
    return table
