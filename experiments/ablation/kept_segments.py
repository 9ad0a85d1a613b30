"""The segments of a film on disk: they do not depend on how they are mapped."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

from isr_jax.types import FrameSegments

_PARTS = ("segment", "class_id", "instance")


class KeptSegments:
    """Segments of every frame, read when they are asked for."""

    def __init__(self, path: Path) -> None:
        self._data = np.load(path, allow_pickle=False)

    def __getitem__(self, index: int) -> FrameSegments:
        return FrameSegments(*(self._data[f"{part}_{index}"].astype(np.int32) for part in _PARTS))


def kept_segments(path: Path, make: Callable[[], Iterator[FrameSegments]]) -> KeptSegments:
    """The segments in a file, which is written first if it is not there.

    Args:
        path: Appears whole or not at all.
        make: The segments of the frames in order.
    """
    if not path.exists():
        arrays: dict[str, Any] = {}
        for index, segments in enumerate(make()):
            for part in _PARTS:
                values = getattr(segments, part)
                kind = np.min_scalar_type(int(values.max(initial=0)))
                arrays[f"{part}_{index}"] = values.astype(kind)
        path.parent.mkdir(parents=True, exist_ok=True)
        fresh = path.with_suffix(".new")
        with fresh.open("wb") as file:
            np.savez_compressed(file, **arrays)
        fresh.replace(path)
    return KeptSegments(path)
