"""Masks from class and mask logits of queries: DETR, MaskFormer, Mask2Former, OneFormer."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from jaxtyping import Float, Int

from ..classes import classes
from .model_image import reach, to_image
from .painting import Mask, separate
from .sidecar import Sidecar

_MIN_SHOWN_RATIO = 0.8
"""A query that wins less of its own mask than this is hidden by others, and dropped."""


def decode_queries(
    outputs: dict[str, Float[np.ndarray, "..."]],
    sidecar: Sidecar,
    shape: tuple[int, int],
    *,
    min_score: float,
) -> list[Mask]:
    """Masks without overlap, in pixels of an image of ``shape``.

    Panoptic inference of MaskFormer (Cheng et al. 2021, section 3.4): of the queries whose best
    label is not "no object" and has a probability p >= ``min_score``, each pixel takes the one
    with the largest p sigmoid(mask); a query keeps its pixels where its sigmoid is at least 1/2,
    if they are 80 % of all such. What the model or we call stuff is one mask per class; where we
    call it a thing all the same (cabinets of COCO), its connected components are the instances.

    Args:
        outputs: ``classes`` [queries, classes + 1] logits, the last for "no object", and
            ``masks`` [queries, h, w] logits.
        sidecar: Of the model.
        shape: Height and width of the image.
        min_score: Weaker queries are left out.
    """
    label, score = _labels(outputs["classes"].astype(np.float32))
    kept = np.flatnonzero((label < len(sidecar.class_of)) & (score >= min_score))
    label, score = label[kept], score[kept]
    logits = outputs["masks"].astype(np.float32)[kept]
    winner, areas = _compete(logits, score, sidecar, shape)
    masks = []
    for k, area in enumerate(areas):
        pixels = winner == k
        shown, class_id = np.count_nonzero(pixels), sidecar.class_of[label[k]]
        if class_id and shown and shown >= _MIN_SHOWN_RATIO * area:
            masks.append((Mask(pixels, class_id, float(score[k])), sidecar.is_thing[label[k]]))
    return list(_gather(masks))


def _compete(
    logits: Float[np.ndarray, "queries h w"],
    score: Float[np.ndarray, " queries"],
    sidecar: Sidecar,
    shape: tuple[int, int],
) -> tuple[Int[np.ndarray, "height width"], list[int]]:
    """The query that each pixel belongs to, -1 = none, and the pixels that each is sure of.

    Whoever is sure of a pixel has at least half the lowest score there; a query is enlarged only
    within the window where it can beat that.
    """
    best, winner = np.zeros(shape, np.float32), np.full(shape, -1, np.int32)
    is_sure, areas = np.zeros(shape, bool), []
    floor = 0.5 * min(score, default=1.0)
    for k, logit in enumerate(logits):
        share = min(float(floor / score[k]), 0.5)
        window = reach(logit, float(np.log(share / (1.0 - share))), sidecar, shape)
        if window is None:
            areas.append(0)
            continue
        at = np.s_[window[1] : window[3], window[0] : window[2]]
        logit = to_image(logit, sidecar, shape, smooth=True, window=window)
        weighted = score[k] / (1.0 + np.exp(-np.clip(logit, -50.0, 50.0)))
        wins = weighted > best[at]
        best[at] = np.where(wins, weighted, best[at])
        winner[at] = np.where(wins, k, winner[at])
        is_sure[at] = np.where(wins, logit >= 0, is_sure[at])
        areas.append(int(np.count_nonzero(logit >= 0)))
    return np.where(is_sure, winner, -1), areas


def _labels(
    logits: Float[np.ndarray, "queries labels"],
) -> tuple[np.ndarray, np.ndarray]:
    """The best label of each query, and its soft-max."""
    label = logits.argmax(1)
    top = logits[np.arange(len(logits)), label]
    return label, 1.0 / np.exp(logits - top[:, None]).sum(1)


def _gather(masks: list[tuple[Mask, bool]]) -> Iterator[Mask]:
    """Instances as they are, stuff as one mask per class, stuff that we call things in pieces."""
    kinds = {info.id: info.kind for info in classes()}
    merged: dict[int, list[Mask]] = {}
    for mask, is_thing in masks:
        if is_thing and kinds[mask.class_id] in ("thing", "dynamic"):
            yield mask
        else:
            merged.setdefault(mask.class_id, []).append(mask)
    for class_id, parts in merged.items():
        area = [np.count_nonzero(m.pixels) for m in parts]
        pixels = np.logical_or.reduce([m.pixels for m in parts])
        whole = Mask(pixels, class_id, float(np.average([m.score for m in parts], weights=area)))
        if kinds[class_id] == "thing":
            yield from separate(whole)
        else:
            yield whole
