"""``isr settings``: every number of the pipeline, and what it means."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import tyro

from ..config import settings_page, settings_section
from .files import write_text

_Section = Annotated[str | None, tyro.conf.arg(metavar="[SECTION]", help_behavior_hint="")]
_File = Annotated[Path | None, tyro.conf.arg(metavar="FILE", help_behavior_hint="")]


def settings(section: tyro.conf.Positional[_Section] = None, out: _File = None) -> None:
    """List the settings as Markdown: unit, default, value per preset, bounds, meaning.

    Example: isr settings mapping

    `--set SECTION.NAME=VALUE` of `isr run`, `isr map` and `isr demo` changes one.

    Args:
        section: input, segmentation, mapping, entities, support, contact_graph, cad, matching,
            alignment, physical_check, export or stability; all of them if left out.
        out: Write to this file (docs/settings.md is the page of all) instead of printing.
    """
    text = settings_page() if section is None else settings_section(section)
    if out is not None:
        write_text(out, text)
    else:
        print(text, end="")
