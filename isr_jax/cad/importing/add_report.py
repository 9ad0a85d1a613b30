"""What came of adding models: which came in, and why the others did not."""

from __future__ import annotations

import dataclasses
import json
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
from rich.table import Table

from ...errors import OutputError

REPORT_NAME = "import_report.json"
_SCHEMA_VERSION = "1.0"


@dataclasses.dataclass(frozen=True)
class Added:
    """A model that is in the library now."""

    id: str
    class_name: str
    source: str
    notes: tuple[str, ...]
    """What was guessed or repaired."""
    already: bool = False
    """It had been there before, with the same content."""
    seconds: float = 0.0
    """Reading to writing; of a document of several models, its share."""
    size_bytes: int = 0
    """Of its files."""


@dataclasses.dataclass(frozen=True)
class Rejected:
    """A model that did not come in."""

    source: str
    reason: str
    hint: str = ""


@dataclasses.dataclass(frozen=True)
class AddReport:
    """All models of one call, in the order of their sources."""

    accepted: tuple[Added, ...]
    rejected: tuple[Rejected, ...]

    @property
    def accepted_share(self) -> float:
        """Of all models that were found; 1 where there were none."""
        return len(self.accepted) / max(len(self.accepted) + len(self.rejected), 1)


def report_tables(report: AddReport) -> tuple[Table, ...]:
    """Models per class, and the reason of every rejection."""
    tables = [_class_table(report)]
    if report.rejected:
        table = Table(title=f"{len(report.rejected)} rejected", title_justify="left")
        table.add_column("source")
        table.add_column("reason")
        for item in report.rejected:
            table.add_row(item.source, item.reason)
        tables.append(table)
    return tuple(tables)


def _class_table(report: AddReport) -> Table:
    already = sum(item.already for item in report.accepted)
    known = f", {already} of them there before" if already else ""
    table = Table(title=f"{len(report.accepted)} models added{known}", title_justify="left")
    for heading in ("class", "models", "median time", "median size"):
        table.add_column(heading, justify="left" if heading == "class" else "right")
    counts = Counter(item.class_name for item in report.accepted)
    for class_name, count in sorted(counts.items(), key=lambda pair: (-pair[1], pair[0])):
        items = [item for item in report.accepted if item.class_name == class_name]
        seconds = np.median([item.seconds for item in items])
        size = np.median([item.size_bytes for item in items])
        table.add_row(class_name, str(count), f"{seconds:.2f} s", f"{size / 1e3:.0f} kB")
    return table


def write_report(report: AddReport, library_dir: Path) -> Path:
    """Write ``import_report.json``: this call's models, and those of earlier calls.

    Raises:
        OutputError: The file cannot be written.
    """
    path = library_dir / REPORT_NAME
    known = _read(path)
    fresh = {item.source for item in (*report.accepted, *report.rejected)}
    content: dict[str, Any] = {"schema_version": _SCHEMA_VERSION}
    for key, items in (("accepted", report.accepted), ("rejected", report.rejected)):
        earlier = [row for row in known.get(key, []) if row.get("source") not in fresh]
        rows = earlier + [_row(item) for item in items]
        content[key] = sorted(rows, key=lambda row: (row["source"], row.get("id", "")))
    try:
        path.write_text(json.dumps(content, indent=1) + "\n", "utf-8", newline="\n")
    except OSError as error:
        hint = "give a library folder that can be written"
        raise OutputError(f"{path}: {error.strerror}", hint) from None
    return path


def _row(item: Added | Rejected) -> dict:
    """Without what differs from run to run."""
    row = dataclasses.asdict(item)
    for key in ("already", "seconds", "size_bytes"):
        row.pop(key, None)
    return row


def _read(path: Path) -> dict:
    try:
        content = json.loads(path.read_text("utf-8"))
    except FileNotFoundError:
        return {}
    except (OSError, ValueError):
        hint = "delete it; models that are in the library stay there"
        raise OutputError(f"{path} is no report of an import", hint) from None
    return content if isinstance(content, dict) else {}
