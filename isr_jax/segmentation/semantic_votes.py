"""Depth segments vote on the classes of a semantic model, whose outlines are coarse."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float, Int

from ..classes import classes
from .boxes import Boxes

_BOX_WEIGHT = 0.3
"""Weight of a pixel in a box, beside that of a pixel's semantic class, both times their score."""


def vote(
    class_map: Int[np.ndarray, "height width"],
    confidence: Float[np.ndarray, "height width"],
    segment: Int[np.ndarray, "height width"],
    boxes: Boxes,
    *,
    min_ratio: float,
) -> tuple[Int[np.ndarray, "height width"], Float[np.ndarray, "height width"]]:
    """Class of the segment that each pixel lies in, and the mean confidence of those who say so.

    Pixels vote with their confidence; "none" does not vote, but a class needs ``min_ratio`` of
    the segment's pixels. Each of ``boxes`` adds votes for its class to all in it. Pixels without
    segment get 0.
    """
    shape = (int(segment.max()) + 1, len(classes()))
    pair = (segment * shape[1] + class_map).ravel()
    weight = np.bincount(pair, confidence.ravel(), shape[0] * shape[1]).reshape(shape)
    pixels = np.bincount(pair, minlength=shape[0] * shape[1]).reshape(shape)
    votes = weight.copy()
    for box, class_id, score in zip(boxes.xyxy, boxes.class_id, boxes.score, strict=True):
        x0, y0, x1, y1 = np.round(box).astype(int)
        inside = np.bincount(segment[y0:y1, x0:x1].ravel(), minlength=shape[0])
        votes[:, class_id] += _BOX_WEIGHT * score * inside
    votes[:, 0] = 0
    best = votes.argmax(1)
    rows = np.arange(shape[0])
    wins = votes[rows, best] >= min_ratio * pixels.sum(1)
    wins[0] = False
    mean = weight[rows, best] / np.maximum(pixels[rows, best], 1)
    return (
        np.where(wins, best, 0).astype(np.int32)[segment],
        np.where(wins, mean, 0).astype(np.float32)[segment],
    )
