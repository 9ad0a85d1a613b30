"""Tables as text, for ``print`` and notebooks."""

from __future__ import annotations

import io

from rich.console import Console, RenderableType

_WIDTH = 110


def render_text(shown: RenderableType) -> str:
    """What a terminal without colours would show."""
    text = io.StringIO()
    # In a notebook rich would write to the page instead.
    console = Console(file=text, width=_WIDTH, color_system=None, force_jupyter=False)
    console.print(shown, highlight=False)
    return "\n".join(line.rstrip() for line in text.getvalue().splitlines())
