"""The library of the split ``held-out``: furniture that the reconstruction does not know."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from pathlib import Path

from rich.console import Console

from isr_jax.errors import LibraryError
from isr_jax.runtime.caches import user_cache_dir
from isr_jax.runtime.console import ConsoleReporter
from isr_jax.runtime.reporter import Reporter

from .plan import HELD_OUT

PACKAGE = Path("/usr/share/sweethome3d/furniture")
"""Where the package sweethome3d-furniture of Debian and Ubuntu puts its catalogues."""
HOW_TO_GET_IT = (
    "apt install sweethome3d-furniture, or any models of yours: "
    "`isr cad add MODELS --library my_models`, then --held-out-library my_models"
)
_COMPLETE = "complete"


def split_libraries(
    splits: tuple[str, ...], given: Path | None, console: Console
) -> dict[str, Path | None]:
    """What furnishes each split, None for the kit; without those that there is nothing for.

    A line on the console says which split is skipped.

    Args:
        splits: Of `SPLITS`.
        given: As in `held_out_library`.
        console: Also shows the progress of an import, which takes minutes.
    """
    found: dict[str, Path | None] = dict.fromkeys(splits)
    if HELD_OUT in found:
        with ConsoleReporter(console) as reporter:
            found[HELD_OUT] = held_out_library(given, reporter)
        if found[HELD_OUT] is None:
            console.print(f"split {HELD_OUT} skipped, no library for it: {HOW_TO_GET_IT}")
            del found[HELD_OUT]
    return found


def held_out_library(given: Path | None, reporter: Reporter) -> Path | None:
    """The folder of the library; None where nothing is given and the package is not there.

    A folder that holds no models of ours is imported into the user's cache first, once.

    Args:
        given: A library, or a folder or archive of furniture to import; None: `PACKAGE`.
        reporter: Receives progress.

    Raises:
        LibraryError: there is no such folder, or nothing in it could be used.
    """
    source = given or PACKAGE
    if given is not None and not given.exists():
        raise LibraryError(f"no held-out library at {given}", HOW_TO_GET_IT)
    if not source.exists():
        return None
    if next(source.glob("*/*/model.json"), None) is not None:
        return source
    return _imported(source, reporter)


def _imported(source: Path, reporter: Reporter) -> Path:
    from isr_jax.cad import VERSION
    from isr_jax.cad.importing.add import add_models

    digest = hashlib.blake2b(f"{VERSION} {_listing(source)}".encode(), digest_size=8).hexdigest()
    library = user_cache_dir() / "held_out" / f"{source.stem}-{digest}"
    if (library / _COMPLETE).is_file():
        return library
    reporter.note(f"importing {source} into {library}, once; this takes minutes")
    report = add_models(source, library, progress=_progress(reporter))
    if not report.accepted:
        raise LibraryError(f"{source}: no model could be used", f"see {library}/import_report.json")
    (library / _COMPLETE).touch()
    return library


def _listing(source: Path) -> str:
    """Names and sizes of the files: what a newer package changes."""
    files = [source] if source.is_file() else sorted(p for p in source.rglob("*") if p.is_file())
    return " ".join(f"{file.name}:{file.stat().st_size}" for file in files)


def _progress(reporter: Reporter) -> Callable[[int, int], None]:
    return lambda done, total: reporter.progress("import", done, total)
