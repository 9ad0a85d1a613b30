"""A film becomes a map, entities and a contact graph, with the settings of a variant."""

from __future__ import annotations

import dataclasses
import hashlib
import json
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from isr_jax import contact_graph, datasets, entities, mapping, segmentation
from isr_jax.config import Settings
from isr_jax.errors import FrameError, SequenceError
from isr_jax.map_runs.frames import frame_indices
from isr_jax.types import ContactGraph, Entities, FrameSegments, PanopticSurface, RgbdSequence

from .code_digest import SEGMENTATION, code_digest
from .kept_segments import KeptSegments, kept_segments


@dataclasses.dataclass(frozen=True, eq=False)
class Mapped:
    """What a film became, and how long each stage took."""

    surface: PanopticSurface
    entities: Entities
    graph: ContactGraph
    seconds: dict[str, float]


@dataclasses.dataclass(frozen=True)
class MaskedFilm:
    """A film, the masks that it is mapped with, and where its segments are kept."""

    folder: Path
    level: str
    """Of the simulated masks."""
    segments_dir: Path

    @property
    def stamp(self) -> dict[str, Any]:
        """Plain data that only the very same film has.

        Raises:
            SequenceError: the folder holds no finished film.
        """
        path = self.folder / "film.json"
        found = json.loads(path.read_text("utf-8")) if path.exists() else {}
        if not found:
            raise SequenceError(
                f"{self.folder} holds no finished film",
                "give the film/ of a room of the benchmark, or a folder that `isr synth` wrote",
            )
        return found

    def segments_path(self, settings: Settings) -> Path:
        """Where its segments with these settings are kept."""
        parts = {
            "film": self.stamp,
            "level": self.level,
            "settings": [vars(settings.input), vars(settings.segmentation)],
            "code": code_digest(SEGMENTATION),
        }
        return self.segments_dir / f"{self.level}-{digest(parts)}.npz"


def digest(parts: Any) -> str:
    """Of plain data."""
    text = json.dumps(parts, sort_keys=True)
    return hashlib.blake2b(text.encode(), digest_size=16).hexdigest()


def map_film(film: MaskedFilm, settings: Settings) -> Mapped:
    """Segment (or take the kept segments), integrate, and find entities and what carries them.

    Raises:
        IsrError: a frame cannot be read, or the map cannot go on.
    """
    clock = _Clock()
    sequence = datasets.open_sequence(film.folder, settings.input)
    indices = frame_indices(sequence, settings)
    segments = _segments(film, sequence, indices, settings)
    clock.lap("segmentation")
    mapper = mapping.PanopticMapper(sequence.camera, settings.mapping)
    for k, (_, frame) in enumerate(datasets.prefetch(sequence, indices)):
        if isinstance(frame, FrameError):
            raise frame
        mapper.integrate(frame, segments[k])
    surface = mapper.surface()
    clock.lap("mapping")
    found = entities.extract_entities(surface, sequence.T_world_dataset, settings.entities)
    clock.lap("entities")
    graph = contact_graph.build_contact_graphs([found], settings.contact_graph, settings.support)[0]
    clock.lap("contact_graph")
    return Mapped(surface, found, graph, clock.seconds)


class _Clock:
    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}
        self._since = time.perf_counter()

    def lap(self, name: str) -> None:
        now = time.perf_counter()
        self.seconds[name], self._since = now - self._since, now


def _segments(
    film: MaskedFilm, sequence: RgbdSequence, indices: list[int], settings: Settings
) -> KeptSegments:
    def make() -> Iterator[FrameSegments]:
        masks = segmentation.open_segmenter(
            f"simulated:{film.level}", film.folder, settings=settings.segmentation
        )
        for _, frame in datasets.prefetch(sequence, indices):
            if isinstance(frame, FrameError):
                raise frame
            yield segmentation.segment_frame(frame, masks(frame), settings.segmentation)

    return kept_segments(film.segments_path(settings), make)
