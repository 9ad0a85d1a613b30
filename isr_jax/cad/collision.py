"""Border: disk and processes. Collision hulls for models that came without, made when needed.

Kit models have theirs by construction; imported ones get theirs for the models that a scene uses,
in worker processes, kept under the content of the model.
"""

from __future__ import annotations

import concurrent.futures
import dataclasses
import functools
import os
import tempfile
import threading
from collections.abc import Callable, Sequence
from pathlib import Path

from ..config import HullMethod
from ..errors import SettingError
from ..library import CadLibrary, CadModel, held
from ..runtime.caches import user_cache_dir
from ..runtime.cores import usable_cores
from ..runtime.reporter import Reporter
from .hulls.link_hulls import METHODS
from .hulls.model_hulls import LinkShape, ModelHulls, link_shapes, model_hulls
from .hulls.packing import packed_hulls, packed_shapes, unpacked_hulls
from .hulls.solid import hull_of
from .hulls.worker import Worker

Progress = Callable[[int, int], None]

VERSION = "1"
"""Of what is made: another one leaves older hulls in the cache aside."""
_TIMEOUT_S = 600.0


def with_hulls(
    models: Sequence[CadModel],
    method: str,
    *,
    workers: int | None = None,
    progress: Progress | None = None,
    cache_dir: Path | None = None,
) -> list[CadModel]:
    """The models, those without collision hulls with hulls; the others as they are.

    Models that have hulls of the fast method get new ones when ``method`` is ``coacd``.

    Args:
        method: ``coacd``: a few seconds to a minute per model. ``vhacd``: the fast stand-in, parts
            cut along their axes and vhacd where those swell.
        workers: Processes at a time; by default half of the cores. 0: in this process.
        progress: Told (done, total) after each model that needed hulls.
        cache_dir: Where hulls are kept; by default in the user's cache.

    Raises:
        SettingError: an unknown method.
    """
    made_by = METHODS.get(method)
    if made_by is None:
        raise SettingError(f"collision method {method!r}", "use coacd or vhacd")
    wanted = [i for i, model in enumerate(models) if model.lacks_hulls(made_by)]
    store = _Store((cache_dir or user_cache_dir()) / "hulls", made_by)
    found = dict(zip(wanted, _all_hulls([models[i] for i in wanted], store, workers, progress)))
    return [_with(m, found[i], method) if i in found else m for i, m in enumerate(models)]


def making_hulls(library: CadLibrary, reporter: Reporter) -> CadLibrary:
    """The library; who asks it for hulls gets them by `with_hulls`, and the reporter is told."""
    return dataclasses.replace(library, make_hulls=functools.partial(_told, reporter))


def _told(reporter: Reporter, models: Sequence[CadModel], method: HullMethod) -> list[CadModel]:
    made = with_hulls(models, method, progress=lambda d, t: reporter.progress("hulls", d, t))
    for model in made:
        reporter.note(
            f"{model.id}: collision hulls by {model.collision}, which reach "
            f"{1000 * model.swelling_m:.1f} mm beyond its surface at most"
        )
    return made


def _with(model: CadModel, hulls: ModelHulls, method: str) -> CadModel:
    robot = model.robot
    links = tuple(
        dataclasses.replace(link, hulls=own) for link, own in zip(robot.links, hulls.links)
    )
    return dataclasses.replace(
        model,
        load_robot=held(dataclasses.replace(robot, links=links)),
        collision=method,
        swelling_m=hulls.swelling_m,
        notes=(*model.notes, *(note for note in hulls.notes if note not in model.notes)),
    )


@dataclasses.dataclass(frozen=True)
class _Store:
    """Hulls on disk, by the models' content."""

    folder: Path
    method: HullMethod

    def _path(self, model: CadModel) -> Path:
        return self.folder / f"{model.content_hash}_{self.method}_{VERSION}.npz"

    def get(self, model: CadModel) -> ModelHulls | None:
        if not model.content_hash:
            return None
        try:
            return unpacked_hulls(self._path(model).read_bytes())
        except (OSError, ValueError, KeyError):
            return None

    def put(self, model: CadModel, hulls: ModelHulls) -> None:
        """Written beside and moved, so that nobody reads half of it; a full disk loses nothing."""
        if not model.content_hash:
            return
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
            with tempfile.NamedTemporaryFile(dir=self.folder, delete=False) as file:
                file.write(packed_hulls(hulls))
            os.replace(file.name, self._path(model))
        except OSError:
            return


def _all_hulls(
    models: list[CadModel], store: _Store, workers: int | None, progress: Progress | None
) -> list[ModelHulls]:
    """Hulls of each model, from the store or made."""
    done, lock = 0, threading.Lock()
    count = max(1, usable_cores() // 2) if workers is None else workers
    crew = threading.local()
    started: list[Worker] = []

    def make(model: CadModel) -> ModelHulls:
        nonlocal done
        hulls = store.get(model)
        if hulls is None:
            hulls = _made(model, store.method, worker() if count else None)
            store.put(model, hulls)
        with lock:
            done += 1
            if progress is not None:
                progress(done, len(models))
        return hulls

    def worker() -> Worker:
        if not hasattr(crew, "worker"):
            crew.worker = Worker(_TIMEOUT_S)
            started.append(crew.worker)
        return crew.worker

    try:
        if not count:
            return [make(model) for model in models]
        with concurrent.futures.ThreadPoolExecutor(count) as pool:
            return list(pool.map(make, models))
    finally:
        for one in started:
            one.close()


def _made(model: CadModel, method: HullMethod, worker: Worker | None) -> ModelHulls:
    """Hulls by the method, else by the other, else one convex hull per link."""
    shapes = link_shapes(model.robot)
    if worker is None:
        return model_hulls(shapes, method)
    other = "vhacd" if method == "coacd" else "coacd"
    for name in (method, other):
        answer = worker.ask(packed_shapes(shapes, name))
        if answer is not None:
            hulls = unpacked_hulls(answer)
            said = () if name == method else (f"{method} crashed or hung: {name} taken",)
            return dataclasses.replace(hulls, notes=(*said, *hulls.notes))
    return _convex_hulls(shapes)


def _convex_hulls(shapes: tuple[LinkShape, ...]) -> ModelHulls:
    links = tuple((hull_of(shape.vertices).mesh(),) if len(shape.faces) else () for shape in shapes)
    reach = max(float(max(s.vertices.max(0) - s.vertices.min(0))) for s in shapes if len(s.faces))
    return ModelHulls(links, reach, ("no decomposition worked: one convex hull per link",))
