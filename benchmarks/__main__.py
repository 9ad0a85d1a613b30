"""``python -m benchmarks NAME``: one benchmark; ``--help`` lists them."""

from __future__ import annotations

import tyro

from .mapping import mapping
from .render import render

app = tyro.extras.SubcommandApp()
app.command(mapping)
app.command(render)

if __name__ == "__main__":
    app.cli(prog="python -m benchmarks")
