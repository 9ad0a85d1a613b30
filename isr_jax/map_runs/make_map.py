"""From a sequence to a panoptic map and its files, and no further: what ``isr map`` does."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
from rich.table import Table

from .. import datasets, segmentation
from ..config import Settings, preset
from ..errors import MapError
from ..runtime.reporter import Reporter, logged
from ..runtime.run_folder import RunFolder
from ..types import RgbdSequence
from .frames import FramesDone, frame_indices, integrate_frames
from .live import LiveMap
from .map_files import MapInstance, write_map

MAP_FILE = "map.npz"


@dataclasses.dataclass(frozen=True, eq=False)
class MadeMap:
    """A map that was written."""

    live: LiveMap
    """It can go on, and be asked."""
    instances: tuple[MapInstance, ...]
    skipped: tuple[str, ...]
    """What was wrong with each frame that was left out."""
    folder: Path

    def table(self) -> Table:
        """One row per instance."""
        table = Table(title="instances", title_justify="left")
        table.add_column("instance")
        for heading in ("vertices", "area", "box"):
            table.add_column(heading, justify="right")
        for one in self.instances:
            box = " x ".join(f"{side:.2f}" for side in one.box.size) + " m"
            table.add_row(one.name, str(len(one.mesh.vertices)), f"{one.area_m2:.2f} m2", box)
        return table


def make_map(
    sequence_dir: str | Path,
    out_dir: str | Path,
    *,
    segmenter: str = "masks",
    settings: Settings | None = None,
    start: int = 0,
    continue_from: str | Path | None = None,
    reporter: Reporter | None = None,
) -> MadeMap:
    """Map a sequence: write the meshes of its panoptic map, and the map itself to go on from.

    Args:
        sequence_dir: A folder in a layout that `open_sequence` knows.
        out_dir: Receives ``map/`` (see `map_files`, and map.npz), config.toml and run.log.
        segmenter: As in `open_segmenter`.
        settings: By default the preset ``default``.
        start: First frame.
        continue_from: A saved map to which the frames are added: map.npz of an earlier call, or a
            checkpoint of `isr run`. Its camera must be the sequence's; its mapping settings hold.
            Both sequences' poses must be in one frame.
        reporter: Receives progress.

    Raises:
        MapError: the map to go on from is none, or is of another camera; or the map cannot go on.
        IsrError: whatever else is wrong, with the file and the way out.
    """
    settings, reporter = settings or preset("default"), logged(reporter)
    with RunFolder(Path(out_dir), settings):
        sequence = datasets.open_sequence(Path(sequence_dir), settings.input)
        masks = segmentation.open_segmenter(
            segmenter, Path(sequence_dir), settings=settings.segmentation
        )
        for note in sequence.notes:
            reporter.note(note)
        live = _opened(sequence, masks, settings, continue_from, reporter)
        reporter.stage("mapping", False)
        before, folder, done = live.frames, Path(out_dir) / "map", FramesDone()
        try:
            indices = frame_indices(sequence, settings, start)
            integrate_frames(live.mapper, sequence, indices, masks, settings, reporter, done)
        except BaseException:  # Ctrl-C too: what was integrated is kept
            if live.frames > before:
                _write(live, sequence, folder)
            raise
        reporter.stage("export", False)
        found = _write(live, sequence, folder)
        return MadeMap(live, tuple(found), tuple(done.skipped), folder)


def _write(live: LiveMap, sequence: RgbdSequence, folder: Path) -> list[MapInstance]:
    about = {"sequence": sequence.name, "frames": live.frames, "map": MAP_FILE}
    found = write_map(
        live.surface(),
        folder,
        T_world_dataset=live.mapper.T_world_dataset,
        settings=live.settings.entities,
        about=about,
    )
    live.save(folder / MAP_FILE)
    return found


def _opened(
    sequence: RgbdSequence,
    masks: segmentation.Segmenter,
    settings: Settings,
    continue_from: str | Path | None,
    reporter: Reporter,
) -> LiveMap:
    """A new map, or the saved one."""
    if continue_from is None:
        T_world = np.asarray(sequence.T_world_dataset, np.float64)
        return LiveMap(sequence.camera, masks, settings, T_world_dataset=T_world)
    path = Path(continue_from)
    live = LiveMap.load(path, masks, settings)
    if live.mapper.camera != sequence.camera:
        raise MapError(
            f"{path} was made with another camera: {live.mapper.camera}, not {sequence.camera}",
            "continue it with frames of its own camera, or make a new map",
        )
    if live.mapper.settings != settings.mapping:
        reporter.note(f"the mapping settings of {path} hold, not those given")
    reporter.note(f"{path}: goes on after {live.frames} frames")
    return live


__all__ = ["MAP_FILE", "MadeMap", "make_map"]
