"""Border: checkpoints of a map as npz files (arrays and JSON, no pickle)."""

from __future__ import annotations

import dataclasses
import json
import os
import zipfile
from pathlib import Path

import jax.numpy as jnp
import numpy as np

from ..config import MappingSettings
from ..errors import MapError
from ..types import Camera
from .pool import BLOCK_VOXELS, VoxelPool

FORMAT = 1


def save(mapper, path: Path) -> None:
    """Write the whole state; the file appears whole or not at all."""
    used, fusion = mapper.blocks.used, mapper.labels
    found = fusion.instances
    arrays = {
        "sdf_m": mapper.pool.sdf_m[:used],
        "weight": mapper.pool.weight[:used],
        "color": mapper.pool.color[:used],
        "labels": np.stack([np.asarray(s[:used]) for s in mapper.pool.labels]),
        "coords": mapper.blocks.coords[:used],
        "grid": np.stack([mapper.blocks.origin, mapper.blocks.extent]),
        "canonical": fusion.canonical,
        "frames_seen": np.array(fusion.frames_seen),
        "counts": _table(
            [(i, *k, n) for i, c in enumerate(fusion.counts) for k, n in c.items()], 4
        ),
        "pair_frames": _table([(*k, n) for k, n in fusion.pair_frames.items()], 3),
        "apart": _table([(*k, n) for k, n in found.apart.items()], 3),
        "instances": np.array([found.class_of, found.into, found.frames]),
    }
    about = {
        "format": FORMAT,
        "settings": dataclasses.asdict(mapper.settings),
        "camera": {f: getattr(mapper.camera, f) for f in ("fx", "fy", "cx", "cy")}
        | {"width": mapper.camera.width, "height": mapper.camera.height},
        "frames": mapper.frames,
        "capacity": mapper.blocks.capacity,
        "rewritten": mapper._rewritten,
    }
    path.parent.mkdir(parents=True, exist_ok=True)
    partial = path.with_name(path.name + ".partial")
    with partial.open("wb") as file:
        np.savez(file, about=np.array(json.dumps(about)), **arrays)
    os.replace(partial, path)


def _table(rows: list[tuple[int, ...]], width: int) -> np.ndarray:
    return np.array(sorted(rows), np.int64).reshape(-1, width)


def load(mapper_type, path: Path):
    """The mapper of a checkpoint; raises `MapError` when the file is not one of ours."""
    try:
        with path.open("rb") as raw, np.load(raw, allow_pickle=False) as file:
            stored = {name: file[name] for name in file.files}
        about = json.loads(str(stored["about"]))
        settings = MappingSettings(**about["settings"])
    except (OSError, ValueError, KeyError, TypeError, zipfile.BadZipFile) as error:
        raise MapError(
            f"{path} cannot be read as a map: {error}", "map the sequence anew"
        ) from error
    if about["format"] != FORMAT:
        raise MapError(f"{path} has format {about['format']}, not {FORMAT}", "map anew")
    mapper = mapper_type(Camera(**about["camera"]), settings)
    mapper.frames, mapper._rewritten = about["frames"], about["rewritten"]
    _restore_blocks(mapper, stored, about["capacity"])
    _restore_labels(mapper.labels, stored)
    return mapper


def _restore_blocks(mapper, stored: dict[str, np.ndarray], capacity: int) -> None:
    blocks, used = mapper.blocks, len(stored["coords"])
    blocks.coords = np.zeros((capacity, 3), np.int32)
    blocks.coords[:used] = stored["coords"]
    blocks.used = used
    blocks.origin = stored["grid"][0].astype(np.int32)
    blocks.grid = np.full(stored["grid"][1], -1, np.int32)
    blocks.index_rows(0, used)

    def padded(rows):
        whole = np.zeros((capacity, BLOCK_VOXELS), rows.dtype)
        whole[:used] = rows
        return jnp.asarray(whole)

    sdf_m, weight, color = (padded(stored[name]) for name in ("sdf_m", "weight", "color"))
    mapper.pool = VoxelPool(sdf_m, weight, color, tuple(padded(s) for s in stored["labels"]))


def _restore_labels(fusion, stored: dict[str, np.ndarray]) -> None:
    fusion.canonical = stored["canonical"]
    fusion.frames_seen = stored["frames_seen"].tolist()
    fusion.counts = [{} for _ in fusion.frames_seen]
    for label, class_id, instance, n in stored["counts"].tolist():
        fusion.counts[label][class_id, instance] = n
    fusion.pair_frames = {(a, b): n for a, b, n in stored["pair_frames"].tolist()}
    fusion.instances.apart = {(a, b): n for a, b, n in stored["apart"].tolist()}
    columns = stored["instances"].tolist()
    fusion.instances.class_of, fusion.instances.into, fusion.instances.frames = columns
