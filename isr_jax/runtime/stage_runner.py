"""Run stages over scenes; keep what they found, and reuse it while what they read is the same."""

from __future__ import annotations

import dataclasses
import inspect
import json
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, TypeVar

from ..config import Settings
from ..errors import SettingError
from .reporter import LogReporter, Reporter
from .stage import Stage
from .store import StageKey, StageStore, content_hash

STAGES = (
    "mapping",
    "entities",
    "contact_graph",
    "matching",
    "alignment",
    "physical_check",
)
"""Stages whose results are kept, in order: what ``--from`` takes."""

T = TypeVar("T")


class StageRunner:
    """Computes stages of one scene or of many, or takes their stored results.

    The key of a result is a hash of the stage's version, its settings and the contents it read.
    Without ``start_from`` every match is reused. With it, that stage and all after it are computed
    anew, and the earlier ones must match, else the error names what differs.

    Args:
        stores: Where the results of each scene are kept; by default nowhere.
        reporter: Receives progress.
        start_from: One of `STAGES`.

    Raises:
        SettingError: there is no such stage.
    """

    def __init__(
        self,
        stores: StageStore | Sequence[StageStore] | None = None,
        reporter: Reporter | None = None,
        start_from: str | None = None,
    ) -> None:
        if start_from is not None and start_from not in STAGES:
            raise SettingError(f"unknown stage {start_from!r}", f"use one of: {', '.join(STAGES)}")
        self.reporter = reporter or LogReporter()
        self._stores = [stores] if isinstance(stores, StageStore) else list(stores or ())
        self._start_from = start_from
        self._key: StageKey | None = None

    def run(
        self,
        settings: Settings,
        stage: Stage[T],
        compute: Callable[..., Sequence[T]],
        *inputs: Any,
    ) -> list[T]:
        """The result of a stage for every scene: stored, or computed now and stored.

        Scenes whose results are stored are left out of the call, so all others are computed
        together.

        Args:
            settings: Of the whole run; the stage gets its sections after its inputs.
            stage: What its package states.
            compute: The stage's public function: takes the inputs and the sections, and returns
                one result per scene.
            *inputs: What it reads: a list has one item per scene, anything else is of all scenes.

        Raises:
            SettingError: a stage before ``start_from`` has no stored result that matches.
        """
        count = next(len(value) for value in inputs if isinstance(value, list))
        sections = [getattr(settings, name) for name in stage.settings]
        if not self._stores:
            self.reporter.stage(stage.name, False)
            return list(compute(*inputs, *sections))
        keys = self._keys(stage, settings, _named(compute, inputs), count)
        found = [
            self._stored(store, stage, key) for store, key in zip(self._stores, keys, strict=True)
        ]
        missing = [i for i, result in enumerate(found) if result is None]
        self.reporter.stage(stage.name, not missing)
        if missing:
            self._key = keys[missing[0]]  # of the checkpoint, where one scene is computed
            some = [[v[i] for i in missing] if isinstance(v, list) else v for v in inputs]
            for i, result in zip(missing, compute(*some, *sections), strict=True):
                self._stores[i].save(stage.name, keys[i], result)
                found[i] = result
            self._drop_checkpoint(stage.name)
        return [result for result in found if result is not None]

    def _keys(
        self, stage: Stage, settings: Settings, inputs: dict[str, Any], count: int
    ) -> list[StageKey]:
        plain = {name: dataclasses.asdict(getattr(settings, name)) for name in stage.settings}
        shared = {n: _hash(v) for n, v in inputs.items() if not isinstance(v, list)}
        return [
            self._stores[i].key(
                stage.name,
                stage.version,
                plain,
                shared | {n: _hash(v[i]) for n, v in inputs.items() if isinstance(v, list)},
            )
            for i in range(count)
        ]

    def _stored(self, store: StageStore, stage: Stage[T], key: StageKey) -> T | None:
        if self._start_from is None:
            return store.load(stage.name, key, stage.result)
        if STAGES.index(stage.name) >= STAGES.index(self._start_from):
            return None
        stored = store.load(stage.name, key, stage.result)
        if stored is None:
            raise SettingError(
                f"--from {self._start_from} needs the stored result of {stage.name}, "
                f"which does not match: {store.explain(stage.name, key)}",
                f"give the settings of that run, or start with --from {stage.name}",
            )
        return stored

    @property
    def _store(self) -> StageStore | None:
        """Of the one scene that checkpoints are kept of."""
        return self._stores[0] if len(self._stores) == 1 else None

    def checkpoint(
        self, stage: str, save: Callable[[Path], None], state: dict[str, Any]
    ) -> Path | None:
        """Keep an unfinished stage: ``save`` writes the file, ``state`` is small and plain.

        Returns the file; None where results are kept nowhere.

        The state names its file and replaces the older state in one step, so that a run killed in
        between leaves the older checkpoint whole.
        """
        if self._store is None or self._key is None:
            return None
        path = self._store.root / f"{stage}.checkpoint-{state['done']}.npz"
        save(path)
        fresh = self._state_path(stage).with_suffix(".new")
        text = json.dumps({"key": self._key.digest, "file": path.name, **state})
        fresh.write_text(text, "utf-8")
        fresh.replace(self._state_path(stage))
        for old in self._store.root.glob(f"{stage}.checkpoint-*.npz"):
            if old != path:
                old.unlink()
        return path

    def resume(self, stage: str) -> tuple[Path, dict[str, Any]] | None:
        """The checkpoint of this very stage, settings and inputs, or None."""
        if self._store is None or self._key is None or self._start_from == stage:
            return None
        if not self._state_path(stage).exists():
            return None
        state = json.loads(self._state_path(stage).read_text("utf-8"))
        path = self._store.root / state["file"]
        return (path, state) if state["key"] == self._key.digest and path.exists() else None

    def _state_path(self, stage: str) -> Path:
        assert self._store is not None
        return self._store.root / f"{stage}.checkpoint.json"

    def _drop_checkpoint(self, stage: str) -> None:
        if self._store is None:
            return
        for path in self._store.root.glob(f"{stage}.checkpoint*"):
            path.unlink()


def _named(compute: Callable[..., Any], inputs: tuple[Any, ...]) -> dict[str, Any]:
    """The inputs by the names that the stage's function gives them."""
    return dict(zip(inspect.signature(compute).parameters, inputs, strict=False))


def _hash(value: Any) -> str:
    """Content hash of an input: its own where it has one."""
    own = getattr(value, "content_hash", None)
    if own is None:
        return value if isinstance(value, str) else content_hash(value)
    return own if isinstance(own, str) else own()
