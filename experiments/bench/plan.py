"""What a benchmark runs: rooms, and for each the presets, mask levels and truths."""

from __future__ import annotations

import dataclasses
from pathlib import Path

from isr_jax.config import Settings, preset, with_overrides
from isr_jax.demonstration.film import FilmPlan
from isr_jax.errors import SettingError
from isr_jax.synthetic.room import ROOM_KINDS

from .oracle import MASKS, NONE, TRUE_MODELS, TRUTH_UP_TO

IN_LIBRARY, HELD_OUT = "in-library", "held-out"
SPLITS = (IN_LIBRARY, HELD_OUT)
"""The room is furnished from the library that reconstructs it, or from another one."""
LEVELS = ("strong", "medium", "weak", "perfect")


@dataclasses.dataclass(frozen=True)
class RoomSpec:
    """One room of the benchmark."""

    split: str
    kind: str
    seed: int

    @property
    def name(self) -> str:
        return f"{self.split}-{self.kind}-{self.seed}"


@dataclasses.dataclass(frozen=True)
class Run:
    """One reconstruction of one room."""

    room: RoomSpec
    preset: str
    level: str
    """Of the simulated masks; empty where they play no part."""
    truth_up_to: str = NONE
    """The last stage that the truth stands in for, of `TRUTH_UP_TO`."""

    @property
    def name(self) -> str:
        what = self.level if self.truth_up_to == NONE else f"truth-{self.truth_up_to}"
        return f"{self.preset.replace('+', 'p')}-{what}"


@dataclasses.dataclass(frozen=True)
class Plan:
    """All rooms and runs of a benchmark, and where they lie."""

    out_dir: Path
    rooms: tuple[RoomSpec, ...]
    presets: tuple[str, ...]
    levels: tuple[str, ...]
    truths: tuple[str, ...]
    """Truths that the first preset is run with, of `TRUTH_UP_TO`."""
    libraries: tuple[tuple[str, Path | None], ...]
    """What furnishes the rooms of each split; None: the kit, which reconstructs them all."""
    film: FilmPlan
    """But for seed and kind."""
    overrides: tuple[str, ...] = ()
    """Settings that are changed in every preset."""

    def __post_init__(self) -> None:
        for given, known, what in (
            (self.presets, None, "presets"),
            (self.levels, LEVELS, "levels of masks"),
            (self.truths, TRUTH_UP_TO, "truths"),
        ):
            if not given and what != "truths":
                raise SettingError(f"no {what}", "name at least one")
            unknown = [name for name in given if known is not None and name not in known]
            if unknown:
                raise SettingError(
                    f"unknown {what} {unknown}", f"use some of: {', '.join(known or ())}"
                )
        for name in self.presets:
            self.settings(name)

    def settings(self, name: str) -> Settings:
        """Of a preset, with the changes of this benchmark."""
        return with_overrides(preset(name), list(self.overrides))

    def settings_of(self, run: Run) -> Settings:
        """Of a run. True models that were imported keep the collision hulls of the room's twin:
        better ones take minutes per room, and would be no truer to it."""
        settings = self.settings(run.preset)
        if run.truth_up_to not in TRUE_MODELS or self.library_of(run.room) is None:
            return settings
        return with_overrides(settings, [f"cad.chosen_hulls={settings.cad.candidate_hulls}"])

    def runs(self, room: RoomSpec) -> tuple[Run, ...]:
        """End to end first, then from the truth of each stage."""
        whole = [Run(room, p, level) for p in self.presets for level in self.levels]
        return (*whole, *(_oracle(room, self.presets[0], truth) for truth in self.truths))

    def film_plan(self, room: RoomSpec) -> FilmPlan:
        return dataclasses.replace(self.film, seed=room.seed, kind=room.kind)

    def film_dir(self, room: RoomSpec) -> Path:
        return self.out_dir / "rooms" / room.name / "film"

    def run_dir(self, run: Run) -> Path:
        return self.out_dir / "rooms" / run.room.name / run.name

    def library_of(self, room: RoomSpec) -> Path | None:
        """What furnishes a room; None: the kit."""
        return dict(self.libraries)[room.split]


def _oracle(room: RoomSpec, preset_name: str, truth: str) -> Run:
    return Run(room, preset_name, "perfect" if truth == MASKS else "", truth)


def room_specs(splits: tuple[str, ...], count: int, seeds_from: int) -> tuple[RoomSpec, ...]:
    """``count`` rooms, dealt to the splits in turn; in each split all kinds in turn."""
    if count < len(splits):
        raise SettingError(f"{count} rooms for {len(splits)} splits", "give at least one per split")
    return tuple(
        RoomSpec(split, ROOM_KINDS[i // len(splits) % len(ROOM_KINDS)], seeds_from + i)
        for k, split in enumerate(splits)
        for i in range(k, count, len(splits))
    )
