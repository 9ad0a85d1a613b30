"""From a sequence to a panoptic map and its files, and no further: what ``isr map`` does."""

from __future__ import annotations

import dataclasses
import json
from contextlib import closing
from pathlib import Path

import numpy as np
from jaxtyping import Float
from rich.table import Table

from .. import datasets, segmentation
from ..config import Settings, preset
from ..errors import MapError
from ..runtime.reporter import Reporter, logged
from ..runtime.run_folder import RunFolder
from ..types import Frame, FrameSegments, RgbdSequence
from .frames import frame_indices, fuse_usable, segmented_frames, try_segmenter
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
        """A row an instance."""
        table = Table(title="instances", title_justify="left")
        table.add_column("instance")
        for heading in ("vertices", "area"):
            table.add_column(heading, justify="right")
        for one in self.instances:
            table.add_row(one.name, str(len(one.mesh.vertices)), f"{one.area_m2:.2f} m2")
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
    """Fuse a sequence into a panoptic map; write its meshes, and the map itself to go on from.

    Args:
        sequence_dir: A folder in a layout that `open_sequence` knows.
        out_dir: Receives ``map/`` (see `map_files`, and map.npz), config.toml and run.log.
        segmenter: As in `open_segmenter`.
        settings: By default the preset ``default``.
        start: First frame.
        continue_from: A map.npz to which the frames are added. Its camera must be the sequence's;
            its mapping settings hold. Both sequences' poses must be in one frame.
        reporter: Receives progress.

    Raises:
        IsrError: whatever is wrong, with the file and the way out.
    """
    settings, reporter = settings or preset("default"), logged(reporter)
    with RunFolder(Path(out_dir), settings):
        sequence = datasets.open_sequence(Path(sequence_dir), settings.input)
        masks = segmentation.open_segmenter(
            segmenter, Path(sequence_dir), settings=settings.segmentation
        )
        for note in sequence.notes:
            reporter.note(note)
        live, T_world = _opened(sequence, masks, settings, continue_from, reporter)
        T_map_sequence = T_world @ np.linalg.inv(sequence.T_world_dataset)
        reporter.stage("mapping", False)
        before, folder = live.frames, Path(out_dir) / "map"
        try:
            skipped = _fuse(live, sequence, masks, T_map_sequence, start, reporter)
        except BaseException:  # Ctrl-C too: what was fused is kept
            if live.frames > before:
                _write(live, sequence, T_world, folder)
            raise
        reporter.stage("export", False)
        found = _write(live, sequence, T_world, folder)
        return MadeMap(live, tuple(found), skipped, folder)


def _write(
    live: LiveMap, sequence: RgbdSequence, T_world: Float[np.ndarray, "4 4"], folder: Path
) -> list[MapInstance]:
    about = {"sequence": sequence.name, "frames": live.frames, "map": MAP_FILE}
    found = write_map(live.surface(), folder, T_world_dataset=T_world, about=about)
    live.save(folder / MAP_FILE)
    return found


def _opened(
    sequence: RgbdSequence,
    masks: segmentation.Segmenter,
    settings: Settings,
    continue_from: str | Path | None,
    reporter: Reporter,
) -> tuple[LiveMap, Float[np.ndarray, "4 4"]]:
    """A new map or the saved one, and the dataset's frame in its world."""
    if continue_from is None:
        T_world = np.asarray(sequence.T_world_dataset, np.float64)
        return LiveMap(sequence.camera, masks, settings, T_world_dataset=T_world), T_world
    path = Path(continue_from)
    T_world = _world_of(path)
    live = LiveMap.load(path, masks, settings, T_world_dataset=T_world)
    if live.mapper.camera != sequence.camera:
        raise MapError(
            f"{path} was made with another camera: {live.mapper.camera}, not {sequence.camera}",
            "continue it with frames of its own camera, or make a new map",
        )
    if live.mapper.settings != settings.mapping:
        reporter.note(f"the mapping settings of {path} hold, not those given")
    reporter.note(f"{path}: goes on after {live.frames} frames")
    return live, T_world


def _world_of(path: Path) -> Float[np.ndarray, "4 4"]:
    """T_world_dataset of a saved map, from the file beside it."""
    beside = path.with_name("instances.json")
    try:
        return np.array(json.loads(beside.read_text("utf-8"))["T_world_dataset"], np.float64)
    except (OSError, ValueError, KeyError) as error:
        raise MapError(
            f"{beside} does not say in which world {path.name} lies: {error}",
            "keep instances.json of `isr map` beside its map.npz",
        ) from error


def _fuse(
    live: LiveMap,
    sequence: RgbdSequence,
    masks: segmentation.Segmenter,
    T_map_sequence: Float[np.ndarray, "4 4"],
    start: int,
    reporter: Reporter,
) -> tuple[str, ...]:
    """Add the frames from ``start`` on; what was wrong with each that is skipped."""
    indices = frame_indices(sequence, live.settings, start)
    try_segmenter(sequence, masks, indices, live.settings)

    def integrate(frame: Frame, segments: FrameSegments) -> None:
        live.mapper.integrate(_moved(frame, T_map_sequence), segments)

    skipped: list[str] = []
    with closing(segmented_frames(sequence, indices, masks, live.settings)) as ready:
        fused = fuse_usable(ready, integrate, skipped, len(indices), live.settings, reporter)
        for done, _ in enumerate(fused, 1):
            reporter.progress("mapping", done, len(indices))
    return tuple(skipped)


def _moved(frame: Frame, T: Float[np.ndarray, "4 4"]) -> Frame:
    if np.allclose(T, np.eye(4), atol=1e-9):
        return frame
    pose = (T @ frame.T_world_camera.astype(np.float64)).astype(np.float32)
    return dataclasses.replace(frame, T_world_camera=pose)


__all__ = ["MAP_FILE", "MadeMap", "make_map"]
