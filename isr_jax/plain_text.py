"""Tables as text, for ``print`` and notebooks."""

from __future__ import annotations

import io

from rich.console import Console, RenderableType

_WIDTH = 110


def plain_text(shown: RenderableType) -> str:
    """What a terminal without colours would show."""
    text = io.StringIO()
    Console(file=text, width=_WIDTH, color_system=None, highlight=False).print(shown)
    return "\n".join(line.rstrip() for line in text.getvalue().splitlines())
