"""What an ablation runs: rooms of the benchmark, and for each the variants and mask levels."""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path

from experiments.bench.plan import LEVELS, RoomSpec
from isr_jax.config import Settings
from isr_jax.demonstration.film import FilmPlan
from isr_jax.errors import SettingError
from isr_jax.library import CadLibrary

from .map_film import MaskedFilm
from .variants import PRESET_GROUP, chosen, variant

_ANY_LIBRARY = CadLibrary((), "", "")


@dataclasses.dataclass(frozen=True)
class MapRun:
    """One film mapped in one way."""

    room: RoomSpec
    variant: str
    level: str
    """Of the simulated masks."""

    @property
    def name(self) -> str:
        return f"{self.variant}, {self.level}"


@dataclasses.dataclass(frozen=True)
class AblationPlan:
    """All rooms and runs of an ablation, and where they lie."""

    out_dir: Path
    rooms: tuple[RoomSpec, ...]
    variants: tuple[str, ...]
    """Names or groups of `VARIANTS`."""
    level: str
    """Of the masks of all variants."""
    preset_levels: tuple[str, ...]
    """Of the masks of the presets, beside ``level``."""
    film: FilmPlan
    """But for seed and kind."""
    films: Path | None = None
    """A folder of the benchmark, whose films are taken where they are there."""
    libraries: tuple[tuple[str, Path | None], ...] = ()
    """What furnishes the rooms of a split that have no film yet; None: the kit."""
    overrides: tuple[str, ...] = ()
    """Settings that are changed in every variant."""

    def __post_init__(self) -> None:
        unknown = [v for v in (self.level, *self.preset_levels) if v not in LEVELS]
        if unknown:
            raise SettingError(f"unknown levels of masks {unknown}", f"use: {', '.join(LEVELS)}")
        if not chosen(self.variants):
            raise SettingError("no variants", "name some, or a group of them")
        for one in chosen(self.variants):
            one.settings(self.overrides)

    def runs(self, room: RoomSpec) -> tuple[MapRun, ...]:
        """Variants in the order of their table, then presets with other masks."""
        own = [MapRun(room, v.name, self.level) for v in chosen(self.variants)]
        more = [
            MapRun(room, v.name, level)
            for level in self.preset_levels
            for v in chosen((PRESET_GROUP,))
        ]
        return tuple(dict.fromkeys([*own, *more]))

    def settings(self, run: MapRun) -> Settings:
        """Of a run, with the changes of this ablation."""
        return variant(run.variant).settings(self.overrides)

    def film_plan(self, room: RoomSpec) -> FilmPlan:
        return dataclasses.replace(self.film, seed=room.seed, kind=room.kind)

    def given_film(self, room: RoomSpec) -> Path | None:
        """A finished film of this room in ``films``, whatever library furnished it."""
        if self.films is None:
            return None
        folder = self.films / "rooms" / room.name / "film"
        stamp = folder / "film.json"
        wanted = self.film_plan(room).stamp(_ANY_LIBRARY)
        found = json.loads(stamp.read_text("utf-8")) if stamp.exists() else {}
        return folder if {**found, "library": wanted["library"]} == wanted else None

    def film_dir(self, room: RoomSpec) -> Path:
        """Of the given film, or of one that is made here."""
        return self.given_film(room) or self.room_dir(room) / "film"

    def room_dir(self, room: RoomSpec) -> Path:
        return self.out_dir / "rooms" / room.name

    def masked_film(self, run: MapRun) -> MaskedFilm:
        return MaskedFilm(self.film_dir(run.room), run.level, self.room_dir(run.room) / "segments")
