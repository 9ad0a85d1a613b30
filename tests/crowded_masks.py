"""True masks of crowded images: many things of several classes and sizes, some of which touch."""

from __future__ import annotations

import numpy as np

from isr_jax.classes import class_named
from isr_jax.types import Camera, Frame, PanopticFrame

SHAPE = (240, 320)
CAMERA = Camera(290.0, 290.0, 160.0, 120.0, SHAPE[1], SHAPE[0])
_KINDS = ("chair", "table", "cup", "book", "box", "bin", "monitor", "chair", "bottle", "plant")
_CELL_PX = 64
INDEPENDENT = 40
"""Frames so far apart have errors of their own."""


def frame(number: int = 0, shape=SHAPE) -> Frame:
    color, depth = np.zeros((*shape, 3), np.uint8), np.ones(shape, np.float32)
    return Frame(number, f"{number:06d}", color, depth, np.eye(4), CAMERA)


class CrowdedTruth:
    """About 13 things before a wall and a floor; in half the cells two of one class touch."""

    def read(self, frame: Frame) -> tuple[PanopticFrame, np.ndarray]:
        rng = np.random.default_rng(frame.index // 4)
        ids = np.where(np.arange(SHAPE[0])[:, None] < 120, 1, 2) * np.ones(SHAPE, int)
        class_of = {1: "wall", 2: "floor"}
        for k in rng.permutation(15)[:9]:
            y, x = divmod(int(k), 5)
            self._furnish(ids, class_of, 10 * int(k) + 3, (8 + 76 * y, _CELL_PX * x), rng)
        values = np.array([0, *class_of])
        mask = np.searchsorted(values, ids).astype(np.int32)
        class_id = np.array([0, *(class_named(n).id for n in class_of.values())], np.int32)
        return PanopticFrame(mask, class_id, np.ones(len(values), np.float32)), values

    def _furnish(self, ids, class_of, id, corner, rng) -> None:
        (y, x), kind = corner, _KINDS[int(rng.integers(len(_KINDS)))]
        height, width = rng.integers(20, 64, 2)
        ids[y : y + height, x : x + width] = id
        class_of[id] = kind
        if rng.random() < 0.5:
            cut = int(width * rng.uniform(0.5, 0.75))
            ids[y : y + height, x + cut : x + width] = id + 1
            class_of[id + 1] = kind
        order = sorted(class_of)
        items = [(i, class_of[i]) for i in order]
        class_of.clear()
        class_of.update(items)

    def content_hash(self) -> str:
        return "crowd"
