"""Run stages, keep what they found, reuse it when nothing that they read has changed."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

from ..errors import SettingError
from .reporter import LogReporter, Reporter
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
    """Computes a stage, or takes its stored result.

    The key of a result is a hash of the stage's version, its settings and the contents it read.
    Without ``start_from`` every match is reused. With it, that stage and all after it are computed
    anew, and the earlier ones must match, else the error names what differs.
    """

    def __init__(
        self,
        store: StageStore | None = None,
        reporter: Reporter | None = None,
        start_from: str | None = None,
    ) -> None:
        if start_from is not None and start_from not in STAGES:
            raise SettingError(f"unknown stage {start_from!r}", f"use one of: {', '.join(STAGES)}")
        self.reporter = reporter or LogReporter()
        self._store = store
        self._start_from = start_from
        self._key: StageKey | None = None

    def run(
        self,
        stage: str,
        stage_version: int,
        settings: Any,
        inputs: dict[str, Any],
        kind: type[T],
        compute: Callable[[], T],
    ) -> T:
        """The result of ``stage``: stored, or computed now and stored.

        Args:
            stage: One of `STAGES`.
            stage_version: The stage's ``VERSION``.
            settings: Its settings, a dataclass or nested plain data.
            inputs: What it reads: content hashes, or values to hash.
            kind: Type of the result.
            compute: Called when nothing stored matches.
        """
        if self._store is None:
            self.reporter.stage(stage, False)
            return compute()
        hashes = {k: v if isinstance(v, str) else content_hash(v) for k, v in inputs.items()}
        self._key = self._store.key(stage, stage_version, settings, hashes)
        stored = self._load(stage, kind)
        if stored is not None:
            self.reporter.stage(stage, True)
            return stored
        self.reporter.stage(stage, False)
        value = compute()
        self._store.save(stage, self._key, value)
        self._drop_checkpoint(stage)
        return value

    def _load(self, stage: str, kind: type[T]) -> T | None:
        assert self._store is not None and self._key is not None
        if self._start_from is None:
            return self._store.load(stage, self._key, kind)
        if STAGES.index(stage) >= STAGES.index(self._start_from):
            return None
        stored = self._store.load(stage, self._key, kind)
        if stored is None:
            raise SettingError(
                f"--from {self._start_from} needs the stored result of {stage}, "
                f"which does not match: {self._store.explain(stage, self._key)}",
                f"give the settings of that run, or start with --from {stage}",
            )
        return stored

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
        assert self._store is not None
        for path in self._store.root.glob(f"{stage}.checkpoint*"):
            path.unlink()
