"""`isr cad check`: every model of a library, over worker processes."""

from __future__ import annotations

import contextlib
import multiprocessing
import time
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from pathlib import Path

from ...config import HullMethod, HullsToCheck
from ...errors import IsrError, LibraryError
from ...library import CadLibrary, CadModel
from ..collision import with_hulls
from ..model_files import load_model
from .model import check_model, unread
from .report import CheckReport, ModelCheck
from .settings import CheckSettings

Progress = Callable[[int, int], None]


def check_library(
    library: CadLibrary | Path | str,
    *,
    workers: int = 2,
    progress: Progress | None = None,
    only: Iterable[str] = (),
    hulls: HullsToCheck = "stored",
    settings: CheckSettings | None = None,
) -> CheckReport:
    """Check every model.

    Args:
        library: A library, or its folder; of a folder, a model that cannot be read is a fault of
            that model and stops nothing.
        workers: Processes; 1 = this one.
        progress: Told (done, total).
        only: Classes or ids; all models by default.
        hulls: For imported models without collision hulls: ``stored`` skips what needs them,
            ``vhacd`` or ``coacd`` makes them first.
        settings: Bounds.

    Raises:
        LibraryError: The folder holds no models, or none that is asked for.
    """
    began, settings = time.perf_counter(), settings or CheckSettings()
    source, jobs = _jobs(library, tuple(only))
    if hulls != "stored":
        jobs = _hulled(jobs, hulls, workers)
    found = []
    for result in _mapped(partial(_check, settings=settings), jobs, workers):
        found.append(result)
        if progress is not None:
            progress(len(found), len(jobs))
    return CheckReport(source, tuple(found), settings, time.perf_counter() - began)


_Job = CadModel | tuple[Path, Path]


def _jobs(library: CadLibrary | Path | str, only: tuple[str, ...]) -> tuple[str, list[_Job]]:
    """Models, or (folder, root) of models that a worker reads itself."""
    jobs: dict[str, _Job] = {}
    if isinstance(library, CadLibrary):
        source = library.source
        jobs = {model.id: model for model in library.models}
    else:
        root, source = Path(library), str(library)
        for file in sorted(root.glob("*/*/model.json")):
            jobs[file.parent.relative_to(root).as_posix()] = (file.parent, root)
    if not jobs:
        hint = "give a folder of <class>/<name>/model.json, or build one with `isr cad build`"
        raise LibraryError(f"no CAD models in {source}", hint)
    chosen = [job for cad_id, job in jobs.items() if not only or _asked(cad_id, only)]
    if not chosen:
        hint = f"its classes: {', '.join(sorted({cad_id.split('/')[0] for cad_id in jobs}))}"
        raise LibraryError(f"{source} holds no model {', '.join(only)}", hint)
    return source, chosen


def _hulled(jobs: list[_Job], method: HullMethod, workers: int) -> list[_Job]:
    """Models with hulls; of what cannot be read, still the folder, so that the check says why."""
    loaded: dict[int, CadModel] = {}
    for i, job in enumerate(jobs):
        with contextlib.suppress(IsrError):
            loaded[i] = job if isinstance(job, CadModel) else load_model(*job)
    made = with_hulls(list(loaded.values()), method, workers=workers)
    hulled = dict(zip(loaded, made, strict=True))
    return [hulled.get(i, job) for i, job in enumerate(jobs)]


def _asked(cad_id: str, only: tuple[str, ...]) -> bool:
    return cad_id in only or cad_id.split("/")[0] in only


def _check(job: _Job, settings: CheckSettings) -> ModelCheck:
    if isinstance(job, CadModel):
        return check_model(job, settings)
    folder, root = job
    try:
        return check_model(load_model(folder, root), settings)
    except IsrError as error:
        return unread(folder.relative_to(root).as_posix(), error.problem)


def _mapped(check: Callable, jobs: list[_Job], workers: int) -> Iterator[ModelCheck]:
    if workers <= 1 or len(jobs) == 1:
        yield from map(check, jobs)
        return
    # Forking a process in which JAX runs threads may lock up.
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(min(workers, len(jobs)), mp_context=context) as pool:
        yield from pool.map(check, jobs, chunksize=4)
