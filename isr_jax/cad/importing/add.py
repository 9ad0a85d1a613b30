"""Border: anyone's models into a library folder, each read and converted in a worker process."""

from __future__ import annotations

import contextlib
import dataclasses
import json
import os
import shutil
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

from ...classes import class_named
from ...errors import LibraryError, OutputError, SettingError
from ...runtime.cores import usable_cores
from ..model_files import save_model
from .add_report import Added, AddReport, Rejected, write_report
from .converting.convert import convert
from .converting.settings import ConvertSettings
from .found import FoundModel
from .isolation import Failure, run_isolated
from .names import slug
from .reading.limits import ReadLimits
from .reading.sources import Item, find_models

Progress = Callable[[int, int], None]
_STAGING = ".incoming"
_Direction = tuple[float, float, float]


@dataclasses.dataclass(frozen=True)
class AddOptions:
    """What the caller knows better than the files, and bounds.

    Raises:
        ClassError: There is no class of that name.
        SettingError: A direction has no length, `up` and `front` are one line, or a unit is not
            positive.
    """

    class_name: str | None = None
    """Of all models; None: from the file, or guessed."""
    up: _Direction | None = None
    """File frame."""
    front: _Direction | None = None
    """File frame: where the model faces."""
    unit_m: float | None = None
    """Metres per unit of length; goes over a stated size, too."""
    licence: str | None = None
    creator: str | None = None
    limits: ReadLimits = dataclasses.field(default_factory=ReadLimits)
    settings: ConvertSettings = dataclasses.field(default_factory=ConvertSettings)

    def __post_init__(self) -> None:
        if self.class_name is not None:
            class_named(self.class_name)
        for name in ("up", "front"):
            direction = getattr(self, name)
            if direction is not None and not 0 < np.linalg.norm(direction) < np.inf:
                raise SettingError(f"{name} = {direction}", "give a direction, like 0 0 1")
        up, front = self.up, self.front
        if up is not None and front is not None and abs(_unit(up) @ _unit(front)) > 0.99:
            raise SettingError(f"up {up} and front {front} are one line", "turn one of them")
        if self.unit_m is not None and not 0 < self.unit_m < np.inf:
            raise SettingError(f"unit_m = {self.unit_m}", "give metres per unit, like 0.01")


@dataclasses.dataclass(frozen=True)
class _Task:
    item: Item
    options: AddOptions
    staging: Path


@dataclasses.dataclass(frozen=True)
class _Staged:
    """A model written aside, ready to be moved into the library."""

    folder: Path
    class_name: str
    name: str
    content_hash: str
    source: str
    notes: tuple[str, ...]
    seconds: float
    size_bytes: int


def add_models(
    path: Path | str,
    library_dir: Path | str,
    *,
    options: AddOptions | None = None,
    progress: Progress | None = None,
    workers: int | None = None,
) -> AddReport:
    """Read every model below a path and write it into ``library_dir/<class>/<name>/``.

    Models come in one by one, in the order of their sources; what is in stays when the rest is
    broken off. A model that is there already, with the same content, is left alone; one of the
    same name but other content gets a name with its content's hash. ``import_report.json`` in
    the library says what came in and what did not.

    Args:
        path: A folder, an archive (``.sh3f``, ``.zip``) or one file.
        library_dir: Made if it is not there.
        options: What goes over the files' own statements, and bounds.
        progress: Told (done, total) after each item.
        workers: Processes; as many as processors by default, 0 works in this one.

    Raises:
        LibraryError: No such path, or nothing in it that could be a model.
        OutputError: The library folder cannot be written.
        SettingError: `workers` is negative.
    """
    options, library = options or AddOptions(), Path(library_dir)
    if workers is not None and workers < 0:
        raise SettingError(f"workers = {workers}", "give 0 or more processes")
    items = find_models(path, options.limits)
    with _staging_folder(library) as staging:
        tasks = [_Task(item, options, staging / str(i)) for i, item in enumerate(items)]
        count = usable_cores() if workers is None else workers
        return _added(tasks, library, count, progress)


def _added(tasks: list[_Task], library: Path, workers: int, progress: Progress | None) -> AddReport:
    accepted: list[Added] = []
    rejected: list[Rejected] = []
    waiting: dict[int, list[_Staged | Rejected] | Failure] = {}
    turn = 0
    limit_s = tasks[0].options.limits.time_limit_s
    try:
        for position, outcome in run_isolated(_work, tasks, workers, limit_s):
            waiting[position] = outcome
            # In order, so that of two models of one name it is always the same that keeps it.
            while turn in waiting:
                _take(waiting.pop(turn), tasks[turn].item, library, accepted, rejected)
                turn += 1
            if progress is not None:
                progress(turn + len(waiting), len(tasks))
    finally:
        for position in sorted(waiting):
            _take(waiting[position], tasks[position].item, library, accepted, rejected)
        report = AddReport(tuple(accepted), tuple(rejected))
        write_report(report, library)
    return report


def _take(
    outcome: list[_Staged | Rejected] | Failure,
    item: Item,
    library: Path,
    accepted: list[Added],
    rejected: list[Rejected],
) -> None:
    if isinstance(outcome, Failure):
        rejected.append(Rejected(item.source, outcome.problem, outcome.hint))
        return
    for entry in outcome:
        if isinstance(entry, Rejected):
            rejected.append(entry)
        else:
            accepted.append(_moved_in(entry, library))


@contextlib.contextmanager
def _staging_folder(library: Path):
    """A folder on the library's own disk, so that models are moved in whole; gone afterwards."""
    parent = library / _STAGING
    try:
        parent.mkdir(parents=True, exist_ok=True)
        folder = Path(tempfile.mkdtemp(dir=parent))
    except OSError as error:
        hint = "give a library folder that can be written"
        raise OutputError(f"{library}: {error.strerror}", hint) from None
    try:
        yield folder
    finally:
        shutil.rmtree(folder, ignore_errors=True)
        with contextlib.suppress(OSError):  # another import is at work in it
            parent.rmdir()


def _work(task: _Task) -> list[_Staged | Rejected]:
    """Read, convert and write aside one item; each of its models may fail by itself."""
    started = time.monotonic()
    found = task.item.read(task.options.limits)
    done: list[_Staged | Rejected] = []
    for i, model in enumerate(found):
        try:
            done.append(_staged(_overridden(model, task.options), task, i))
        except LibraryError as error:
            done.append(Rejected(model.source, error.problem, error.hint))
    share = (time.monotonic() - started) / max(len(done), 1)
    return [dataclasses.replace(d, seconds=share) if isinstance(d, _Staged) else d for d in done]


def _staged(found: FoundModel, task: _Task, position: int) -> _Staged:
    model = convert(found, task.options.settings)
    class_name, _, name = model.id.partition("/")
    folder = save_model(model, task.staging / str(position))
    return _Staged(
        folder=folder,
        class_name=class_name,
        name=slug(name),
        content_hash=_stored_hash(folder) or model.content_hash,
        source=found.source,
        notes=model.notes,
        seconds=0.0,
        size_bytes=sum(file.stat().st_size for file in folder.rglob("*") if file.is_file()),
    )


def _overridden(found: FoundModel, options: AddOptions) -> FoundModel:
    """The model with what the caller knows in place of what its file says."""
    change: dict = {}
    if options.class_name is not None:
        change["class_name"] = options.class_name
    if options.up is not None:
        change["up"] = _unit(options.up)
        along = found.front is not None and abs(found.front @ change["up"]) > 0.99
        if along and options.front is None:
            change["front"] = None
    if options.front is not None:
        change["front"] = _unit(options.front)
    if options.unit_m is not None:
        change |= {"unit_m": options.unit_m, "size_m": None}
    change |= {} if options.licence is None else {"licence": options.licence}
    change |= {} if options.creator is None else {"creator": options.creator}
    return dataclasses.replace(found, **change)


def _unit(direction: _Direction) -> np.ndarray:
    vector = np.asarray(direction, np.float64)
    return vector / np.linalg.norm(vector)


def _moved_in(staged: _Staged, library: Path) -> Added:
    """Move a staged model to its place, unless the same is there."""
    plain = library / staged.class_name / staged.name
    suffixed = plain.with_name(f"{staged.name}_{staged.content_hash[:8]}")
    target = plain if _is_free_for(plain, staged) else suffixed
    already = _stored_hash(target) == staged.content_hash
    if not already:
        _move(staged.folder, target)
    cad_id = f"{staged.class_name}/{target.name}"
    notes = staged.notes
    if target is suffixed:
        notes = (*notes, f"another model is called {staged.name}: this one {target.name}")
    return Added(
        cad_id, staged.class_name, staged.source, notes, already, staged.seconds, staged.size_bytes
    )


def _is_free_for(folder: Path, staged: _Staged) -> bool:
    return not (folder / "model.json").exists() or _stored_hash(folder) == staged.content_hash


def _stored_hash(folder: Path) -> str | None:
    try:
        return json.loads((folder / "model.json").read_text("utf-8")).get("content_hash")
    except (OSError, ValueError, AttributeError):
        return None


def _move(folder: Path, target: Path) -> None:
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        if target.exists():  # a folder without a model, or a broken one
            shutil.rmtree(target)
        os.replace(folder, target)
    except OSError as error:
        hint = "give a library folder that can be written"
        raise OutputError(f"{target}: {error.strerror}", hint) from None
