"""Border: a folder of CAD models, ``<root>/<class>/<name>/``, read and written."""

from __future__ import annotations

import hashlib
import logging
from collections.abc import Callable, Iterable
from pathlib import Path

from ..cad_types import CadLibrary, CadModel
from ..errors import LibraryError
from ..user_cache import user_cache_dir
from .kit.catalogue import KIT, make
from .model_files import load_model, save_model

Progress = Callable[[int, int], None]
_LOG = logging.getLogger(__name__)
_REPOSITORY_LIBRARY = Path(__file__).resolve().parents[2] / "cad_db"


def library_of(models: Iterable[CadModel], source: str) -> CadLibrary:
    """A library of the given models; its hash is that of their contents."""
    ordered = tuple(sorted(models, key=lambda model: model.id))
    digest = hashlib.sha256()
    for model in ordered:
        digest.update(f"{model.id}\0{model.content_hash}\0".encode())
    return CadLibrary(ordered, source, digest.hexdigest())


def load_library(path: Path | str) -> CadLibrary:
    """Read every model below a folder.

    Raises:
        LibraryError: No such folder, no model in it, or a model that cannot be used: its file,
            what is wrong with it and what would do.
    """
    root = Path(path)
    if not root.is_dir():
        hint = "give a folder of <class>/<name>/model.json, or build one with `isr cad build`"
        raise LibraryError(f"no CAD library at {root}", hint)
    folders = sorted(file.parent for file in root.glob("*/*/model.json"))
    if not folders:
        stray = sorted(p.parent for p in root.rglob("model.json"))[:1]
        where = f" (the first model.json is in {stray[0]})" if stray else ""
        hint = "give the folder that holds <class>/<name>/model.json"
        raise LibraryError(f"CAD library {root} holds no models{where}", hint)
    return library_of((load_model(folder, root) for folder in folders), str(root))


def build_library(
    out_dir: Path | str,
    progress: Progress | None = None,
    *,
    ids: Iterable[str] | None = None,
) -> CadLibrary:
    """Build the kit into a folder: the same bytes every time.

    Args:
        out_dir: Root of the library.
        progress: Told (done, total) after each model.
        ids: Only these models; all of `KIT` by default.
    """
    root, models = Path(out_dir), []
    chosen = sorted(KIT if ids is None else ids)
    for done, cad_id in enumerate(chosen):
        models.append(make(cad_id))
        save_model(models[-1], root)
        if progress is not None:
            progress(done + 1, len(chosen))
    return library_of(models, str(root))


def default_library(progress: Progress | None = None) -> CadLibrary:
    """The library that comes along: ``cad_db`` of the repository, else one in the user's cache.

    Where it had to be built or was taken from the cache, the log says so.
    """
    if _REPOSITORY_LIBRARY.is_dir():
        return load_library(_REPOSITORY_LIBRARY)
    root = user_cache_dir() / "cad_db" / _kit_hash()[:16]
    done = root / "complete"
    if not done.is_file():
        _LOG.warning("no cad_db beside the package: building %d CAD models in %s", len(KIT), root)
        library = build_library(root, progress)
        done.write_text(library.content_hash, "utf-8")
        return library
    _LOG.info("CAD library from the cache: %s", root)
    return load_library(root)


def _kit_hash() -> str:
    """Digest of the code that makes the models: another kit, another cache folder."""
    digest = hashlib.sha256()
    package = Path(__file__).resolve().parent
    for path in sorted(package.rglob("*.py")):
        digest.update(path.read_bytes())
    return digest.hexdigest()
