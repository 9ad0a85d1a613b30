"""``python -m isr_jax.cad [OUT_DIR]``: build the kit; by default into ``cad_db``."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from ..errors import IsrError
from .library import build_library


def main(arguments: list[str] | None = None) -> int:
    """Build and say what was built; 2 where that failed."""
    parser = argparse.ArgumentParser(prog="python -m isr_jax.cad", description=__doc__)
    parser.add_argument("out_dir", nargs="?", type=Path, default=Path("cad_db"))
    out_dir = parser.parse_args(arguments).out_dir
    try:
        library = build_library(out_dir)
    except IsrError as error:
        print(error, file=sys.stderr)
        return 2
    print(f"{len(library)} models in {out_dir}, content {library.content_hash[:16]}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
