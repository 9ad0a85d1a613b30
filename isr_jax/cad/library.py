"""Border: a folder of CAD models, ``<root>/<class>/<name>/``, read and written."""

from __future__ import annotations

import hashlib
import logging
from collections.abc import Iterable
from pathlib import Path

from ..errors import LibraryError
from ..library import CadLibrary, CadModel
from ..runtime.caches import user_cache_dir
from .collision import with_hulls
from .index import Progress, models_below
from .kit.catalogue import KIT, make
from .model_files import save_model

_LOG = logging.getLogger(__name__)
_REPOSITORY_LIBRARY = Path(__file__).resolve().parents[2] / "cad_db"


def library_of(models: Iterable[CadModel], source: str) -> CadLibrary:
    """A library of the given models; its hash is that of their contents."""
    ordered = tuple(sorted(models, key=lambda model: model.id))
    digest = hashlib.sha256()
    for model in ordered:
        digest.update(f"{model.id}\0{model.content_hash}\0".encode())
    return CadLibrary(ordered, source, digest.hexdigest(), with_hulls)


def load_library(
    path: Path | str, *more: Path | str, progress: Progress | None = None
) -> CadLibrary:
    """Every model below one folder or several; their geometry is read when it is used.

    What is said of the models is kept in the user's cache: only those that are new or changed are
    read again.

    Args:
        path: Holds ``<class>/<name>/model.json``.
        more: Further folders; no model may have the id of another.
        progress: Told (done, total) while new models are read.

    Raises:
        LibraryError: No such folder, no model in it, a model that cannot be used (its file, what
            is wrong with it and what would do), or two models of one id.
    """
    roots = [Path(path), *(Path(p) for p in more)]
    owner: dict[str, Path] = {}
    models: list[CadModel] = []
    for root in roots:
        found = _models_of(root, progress)
        twice = next((model.id for model in found if model.id in owner), None)
        if twice is not None:
            problem = f"CAD model {twice} is both in {owner[twice]} and in {root}"
            raise LibraryError(problem, "rename the folder of one of them")
        owner.update((model.id, root) for model in found)
        models += found
    return library_of(models, "+".join(map(str, roots)))


def open_library(spec: Path | str, progress: Progress | None = None) -> CadLibrary:
    """The library of one folder, or of several joined by ``+``: ``cad_db+my_models``."""
    if Path(spec).is_dir():  # also one with a + in its name
        return load_library(spec, progress=progress)
    first, *more = [part.strip() for part in str(spec).split("+")]
    return load_library(first, *more, progress=progress)


def _models_of(root: Path, progress: Progress | None) -> tuple[CadModel, ...]:
    if not root.is_dir():
        hint = "give a folder of <class>/<name>/model.json, or build one with `isr cad build`"
        raise LibraryError(f"no CAD library at {root}", hint)
    found = models_below(root, progress)
    if not found:
        stray = sorted(p.parent for p in root.rglob("model.json"))[:1]
        where = f" (the first model.json is in {stray[0]})" if stray else ""
        hint = "give the folder that holds <class>/<name>/model.json"
        raise LibraryError(f"CAD library {root} holds no models{where}", hint)
    return found


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
        return load_library(_REPOSITORY_LIBRARY, progress=progress)
    root = user_cache_dir() / "cad_db" / _kit_hash()[:16]
    done = root / "complete"
    if not done.is_file():
        _LOG.warning("no cad_db beside the package: building %d CAD models in %s", len(KIT), root)
        library = build_library(root, progress)
        done.write_text(library.content_hash, "utf-8")
        return library
    _LOG.info("CAD library from the cache: %s", root)
    return load_library(root, progress=progress)


def _kit_hash() -> str:
    """Digest of the code that makes and writes the models: another kit, another cache folder."""
    cad = Path(__file__).resolve().parent
    robots = (cad.parent / "robot_model").glob("*.py")
    own = (cad / f"{name}.py" for name in ("model_files", "planes", "records"))
    paths = [*own, *(cad / "kit").rglob("*.py"), *robots]
    digest = hashlib.sha256()
    for path in sorted(paths):
        digest.update(path.read_bytes())
    return digest.hexdigest()
