"""Border: a whole map as one npz file (arrays and JSON, no pickle).

The checkpoints of `isr run` and the ``map.npz`` of `isr map` are such files.
"""

from __future__ import annotations

import dataclasses
import json
import os
import zipfile
from pathlib import Path
from typing import Any

import jax.numpy as jnp
import numpy as np

from ..config import MappingSettings
from ..errors import IsrError, MapError, OutputError
from ..types import Camera
from .kept_frames import KeptFrame, KeptFrames
from .labels import MapLabels
from .pool import BLOCK_VOXELS, VoxelPool
from .state import MapState

FORMAT = 4
"""Of the file; others are refused."""
_COUNTERS = ("frames", "step")


def save(mapper, path: Path) -> None:
    """Write the whole state; the file appears whole or not at all.

    Raises:
        MapError: a frame that waited gave too many labels.
        OutputError: the file cannot be written.
    """
    mapper.finish()
    state, pool = mapper.state, mapper.integrator.pool
    used = state.blocks.used
    arrays = {
        "sdf_m": pool.sdf_m[:used],
        "weight": pool.weight[:used],
        "color": pool.color[:used],
        "labels": np.stack([np.asarray(s[:used]) for s in pool.labels]),
        "coords": state.blocks.coords[:used],
        "stamp": state.blocks.stamp[:used],
        "origin": state.blocks.origin,
        "passes": state.blocks.passes,
    }
    about = {
        "format": FORMAT,
        "settings": dataclasses.asdict(mapper.settings),
        "camera": {f: getattr(mapper.camera, f) for f in ("fx", "fy", "cx", "cy")}
        | {"width": mapper.camera.width, "height": mapper.camera.height},
        "T_world_dataset": mapper.T_world_dataset.tolist(),
        "capacity": state.blocks.capacity,
        "counters": {name: getattr(state, name) for name in _COUNTERS},
    }
    arrays |= _labels_out(state.labels)
    if mapper.kept is not None:
        arrays |= _kept_out(mapper.kept)
    _write(path, arrays | {"about": np.array(json.dumps(about))})


def _write(path: Path, arrays: dict[str, Any]) -> None:
    partial = path.with_name(path.name + ".partial")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with partial.open("wb") as file:
            np.savez(file, **arrays)
        os.replace(partial, path)
    except OSError as error:
        raise OutputError(
            f"{path} cannot be written: {error}", "give a folder that can be written, with room"
        ) from error


def load(mapper_type, path: Path):
    """The mapper of a saved map.

    Raises:
        MapError: the file is no saved map, or one of another release.
    """
    try:
        with path.open("rb") as raw, np.load(raw, allow_pickle=False) as file:
            stored = {name: file[name] for name in file.files}
        about = json.loads(str(stored["about"]))
        if about["format"] != FORMAT:
            raise MapError(
                f"{path} was saved by another release of isr_jax: it has format "
                f"{about['format']}, not {FORMAT}",
                "map the sequence anew",
            )
        mapper = mapper_type(
            Camera(**about["camera"]),
            MappingSettings(**about["settings"]),
            np.array(about["T_world_dataset"], np.float64).reshape(4, 4),
        )
        for name in _COUNTERS:
            setattr(mapper.state, name, about["counters"][name])
        mapper.integrator.pool = _restore_blocks(mapper.state, stored, about["capacity"])
        _restore_labels(mapper.state.labels, stored)
        if mapper.kept is not None:
            _restore_kept(mapper.kept, stored)
    except MapError:
        raise
    except (
        OSError,
        EOFError,
        LookupError,
        ValueError,
        TypeError,
        zipfile.BadZipFile,
        IsrError,
    ) as error:
        raise MapError(
            f"{path} cannot be read as a map: {error}", "map the sequence anew"
        ) from error
    return mapper


def _restore_blocks(state: MapState, stored: dict[str, np.ndarray], capacity: int) -> VoxelPool:
    blocks, used = state.blocks, len(stored["coords"])
    blocks.resize(capacity)
    blocks.coords[:used] = stored["coords"]
    blocks.stamp[:used] = stored["stamp"]
    blocks.used = used
    blocks.origin = stored["origin"].astype(np.int32)
    blocks.passes = stored["passes"]
    blocks.grid = np.full(blocks.passes.shape, -1, np.int32)
    blocks.index_rows(0, used)

    def padded(rows):
        whole = np.zeros((capacity, BLOCK_VOXELS), rows.dtype)
        whole[:used] = rows
        return jnp.asarray(whole)

    sdf_m, weight, color = (padded(stored[name]) for name in ("sdf_m", "weight", "color"))
    return VoxelPool(sdf_m, weight, color, tuple(padded(s) for s in stored["labels"]))


def _table(rows: list[tuple[int, ...]], width: int) -> np.ndarray:
    return np.array(sorted(rows), np.int64).reshape(-1, width)


def _labels_out(labels: MapLabels) -> dict[str, np.ndarray]:
    instances = labels.instances
    counts = [(i, *k, n) for i, c in enumerate(labels.counts) for k, n in c.items()]
    return {
        "canonical": labels.canonical,
        "frames_seen": np.array(labels.frames_seen),
        "counts": _table(counts, 4),
        "pair_frames": _table([(*k, n) for k, n in labels.pair_frames.items()], 3),
        "frames_apart": _table([(*k, n) for k, n in instances.frames_apart.items()], 3),
        "instances": np.array([instances.class_of, instances.merged_into, instances.frames]),
    }


def _restore_labels(labels: MapLabels, stored: dict[str, np.ndarray]) -> None:
    labels.canonical = stored["canonical"]
    labels.frames_seen = stored["frames_seen"].tolist()
    labels.counts = [{} for _ in labels.frames_seen]
    for label, class_id, instance, n in stored["counts"].tolist():
        labels.counts[label][class_id, instance] = n
    labels.pair_frames = {(a, b): n for a, b, n in stored["pair_frames"].tolist()}
    instances = labels.instances
    instances.frames_apart = {(a, b): n for a, b, n in stored["frames_apart"].tolist()}
    columns = stored["instances"].tolist()
    instances.class_of, instances.merged_into, instances.frames = columns
    for label, triplets in enumerate(labels.counts):
        labels.shares.rewrite(label, triplets)


def _kept_out(kept: KeptFrames) -> dict[str, np.ndarray]:
    """All images end to end, the length of each, and the tables of the segments end to end."""
    frames = kept.frames
    images = [(i, len(png)) for i, frame in enumerate(frames) for png in frame.images]
    tables = [np.stack([f.class_id, f.instance]).astype(np.int64) for f in frames]
    return {
        "kept_bytes": np.frombuffer(b"".join(p for f in frames for p in f.images), np.uint8),
        "kept_images": np.array(images, np.int64).reshape(-1, 2),
        "kept_frames": np.array(
            [(f.depth_unit, f.farthest, len(f.class_id)) for f in frames], np.int64
        ).reshape(-1, 3),
        "kept_segments": np.concatenate([np.zeros((2, 0), np.int64), *tables], 1),
    }


def _restore_kept(kept: KeptFrames, stored: dict[str, np.ndarray]) -> None:
    data = stored["kept_bytes"].tobytes()
    images: list[list[bytes]] = [[] for _ in stored["kept_frames"]]
    start = 0
    for frame, length in stored["kept_images"].tolist():
        images[frame].append(data[start : start + length])
        start += length
    first = 0
    for png, (unit, farthest, segments) in zip(images, stored["kept_frames"].tolist(), strict=True):
        class_id, instance = stored["kept_segments"][:, first : first + segments].astype(np.int32)
        kept.frames.append(KeptFrame(tuple(png), unit, farthest, class_id, instance))
        first += segments
