"""Masks of one image, laid over each other."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Sequence

import numpy as np
from jaxtyping import Bool

from ..types import PanopticFrame
from .components import connected_components

MIN_PIXELS = 50
"""What shows less of itself is no mask."""


@dataclasses.dataclass(frozen=True, eq=False)
class Mask:
    """One segment of an image."""

    pixels: Bool[np.ndarray, "height width"]
    class_id: int
    score: float


def paint(masks: Sequence[Mask], shape: tuple[int, ...]) -> PanopticFrame:
    """One label per pixel; later masks lie over earlier ones, hidden ones are left out."""
    label = np.zeros(shape, np.int32)
    for k, mask in enumerate(masks, 1):
        label[mask.pixels] = k
    visible = np.bincount(label.ravel(), minlength=len(masks) + 1) >= MIN_PIXELS
    visible[0] = False
    number = np.where(visible, np.cumsum(visible), 0).astype(np.int32)
    kept = [m for m, v in zip(masks, visible[1:], strict=True) if v]
    return PanopticFrame(
        number[label],
        np.array([0, *(m.class_id for m in kept)], np.int32),
        np.array([0.0, *(m.score for m in kept)], np.float32),
    )


def separate(mask: Mask, *, min_pixels: int = MIN_PIXELS) -> Iterator[Mask]:
    """The connected components of a mask that holds all instances of its class."""
    label, area = connected_components(mask.pixels)
    for k in np.flatnonzero(area >= min_pixels):
        yield Mask(label == k, mask.class_id, mask.score)
