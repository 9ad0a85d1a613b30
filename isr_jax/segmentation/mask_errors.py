"""The errors of the simulated segmenter, drawn so that the stated rates come out.

What is found is drawn first, so that recall and right class hold. Merges then explain misses, and
pieces of split masks take the place of false masks; neither changes what is found. What both take
from the IoU of the hits, the other hits have more.
"""

from __future__ import annotations

import dataclasses

import numpy as np
from jaxtyping import Bool, Float
from scipy.special import ndtri

from ..classes import class_named, classes
from .noise_rates import CONFUSED, MIN_PIXELS, NoiseRates, confusable
from .ragged import ragged, smooth_noise
from .true_frame import TrueFrame

_IOU_SPREAD, _IOU_LOW, _IOU_HIGH = 0.05, 0.55, 0.97
_EDGE_IOU = 0.95
"""IoU of a merged or split mask with the pixels that it stands for."""
_MERGED_SHARE = 0.58
"""A found thing that is at least this share of a merged mask stays found: 0.95 * 0.58 > 0.5."""
_LOST_SHARE = 0.52
"""Two things of which each is at most this share of a merged mask are both missed."""
_PIECE_SHARE = (0.62, 0.80)
"""The larger piece of a split mask is so much of it."""
_TRIES = 10
"""For a place of a false mask; a frame full of things has none."""
_HIT, _CLASS, _OTHER_CLASS, _MERGE, _SPLIT, _PIECE = 1, 2, 3, 4, 5, 6
"""What a lasting random number decides."""

Mask = tuple[np.ndarray, int, float]
"""Pixels, class, score."""


@dataclasses.dataclass(frozen=True)
class _Fate:
    """What becomes of the found things of a frame."""

    swallowed: dict[int, int]
    """The missed thing that the mask of a found one covers too."""
    lost: list[tuple[int, int]]
    """Missed things that share a mask."""
    split: dict[int, float]
    """Found things in two pieces, and the share of the larger piece."""
    mean_iou: float
    """Of the other found things."""
    false_masks: float
    """Expected masks of nothing."""


def noisy_masks(frame: TrueFrame, rates: NoiseRates) -> list[Mask]:
    """The frame's masks with errors; disjoint."""
    hit, right = outcome_chances(frame, rates)
    found = [r for r, p in zip(frame.things, hit) if frame.lasting(_HIT, r) < ndtri(p)]
    found.sort(key=lambda row: -frame.area[row])
    fate = _draw_fate(frame, rates, found)
    sure = dict(zip(frame.things, right))
    covered = [*found, *fate.swallowed.values(), *(row for pair in fate.lost for row in pair)]
    taken = frame.pixels(*covered)
    things: list[Mask] = []
    for row in found:
        kind = _seen_class(frame, row, sure[row])
        for pixels in _found_pixels(frame, row, fate, taken):
            things.append((pixels, kind, float(frame.random.uniform(0.6, 1.0))))
    for pair in fate.lost:
        pixels = _edged(frame.pixels(*pair), taken, _EDGE_IOU, frame)
        kind = _seen_class(frame, pair[0], sure[pair[0]])
        things.append((pixels, kind, float(frame.random.uniform(0.6, 1.0))))
    false = list(_false_masks(frame, fate.false_masks, taken))
    covered = np.logical_or.reduce([taken, *(m[0] for m in false)])
    return [*_layout(frame, rates, covered), *false, *things]


def outcome_chances(
    frame: TrueFrame, rates: NoiseRates
) -> tuple[Float[np.ndarray, " things"], Float[np.ndarray, " things"]]:
    """Chance of each thing to be found, and, when found, to be given its class.

    The means over the frame are ``recall`` and, weighted by the first, ``right_class``. A thing of
    a class with its own recall of pixels has it: a mask of IoU q that loses as much as it gains
    covers 2 q / (1 + q) of its thing, so recall = hit * right * 2 q / (1 + q), by pixels.
    """
    count, ease = len(frame.things), frame.ease()
    names = np.array([frame.class_name(row) for row in frame.things])
    hit, right = np.zeros(count), np.full(count, np.sqrt(rates.right_class))
    coverage = 2 * rates.mean_iou / (1 + rates.mean_iou)
    rest = ~np.isin(names, [name for name, _ in rates.class_recall])
    for name, share in rates.class_recall:
        own = names == name
        wanted = share / coverage / np.sqrt(rates.right_class)
        hit[own] = _ranked(ease[own], wanted, frame.area[frame.things][own])
    if rest.any():
        left = np.clip((rates.recall * count - hit.sum()) / rest.sum(), 0.02, 0.98)
        hit[rest] = _ranked(ease[rest], float(left), np.ones(rest.sum()))
        named = rates.right_class * rates.recall * count - (hit * right)[~rest].sum()
        right[rest] = np.clip(named / hit[rest].sum(), 0.02, 0.98)
    return hit, right


def _ranked(ease: np.ndarray, mean: float, weight: np.ndarray) -> np.ndarray:
    """Chances that rise with the rank of ``ease``; their weighted mean is ``mean``."""
    if len(ease) == 0:
        return np.zeros(0)
    rank = (np.argsort(np.argsort(ease, kind="stable")) + 0.5) / len(ease)
    chance = mean + 0.9 * min(mean, 1 - mean) * (2 * rank - 1)
    return np.clip(chance * mean / np.average(chance, weights=weight), 0.0, 1.0)


def _draw_fate(frame: TrueFrame, rates: NoiseRates, found: list[int]) -> _Fate:
    """Merges and splits, and what they leave to the other masks."""
    inside, alone = _merge_candidates(frame, found)
    pieces = {row: float(frame.fixed(_PIECE, row).uniform(*_PIECE_SHARE)) for row in found}
    unmatched = rates.merges * len(alone) + rates.splits * len(found)
    thin = min(1.0, 0.5 * rates.false_masks / max(unmatched, 1e-9))

    def merged(pair: tuple[int, int], chance: float) -> bool:
        return bool(frame.lasting(_MERGE, *pair) < ndtri(chance))

    swallowed = {a: b for a, b in inside if merged((a, b), rates.merges)}
    split = {
        row: share
        for row, share in pieces.items()
        if row not in swallowed and frame.lasting(_SPLIT, row) < ndtri(thin * rates.splits)
    }
    lost = [pair for pair in alone if merged(pair, thin * rates.merges)]
    odd = [(rates.merges, _share(frame, *pair)) for pair in inside]
    odd += [(thin * rates.splits, share) for share in pieces.values()]
    weight = sum(chance for chance, _ in odd)
    total = sum(chance * _EDGE_IOU * share for chance, share in odd)
    others = max(len(found) - weight, 0.25)
    mean_iou = rates.mean_iou + (rates.mean_iou * weight - total) / others
    return _Fate(swallowed, lost, split, mean_iou, rates.false_masks - thin * unmatched)


def _merge_candidates(
    frame: TrueFrame, found: list[int]
) -> tuple[list[tuple[int, int]], list[tuple[int, int]]]:
    """(found, missed) and (missed, missed) pairs that one mask could cover; no thing is in two."""
    inside, alone, used = [], [], set()
    for a, b in frame.touching():
        alike = confusable(frame.class_name(a), frame.class_name(b))
        if not alike or a in used or b in used or b in found:
            continue
        share = _share(frame, a, b)
        if a in found and share >= _MERGED_SHARE:
            inside.append((a, b))
        elif a not in found and share <= _LOST_SHARE:
            alone.append((a, b))
        else:
            continue
        used |= {a, b}
    return inside, alone


def _share(frame: TrueFrame, a: int, b: int) -> float:
    return float(frame.area[a] / (frame.area[a] + frame.area[b]))


def _found_pixels(frame: TrueFrame, row: int, fate: _Fate, taken: np.ndarray):
    """The mask of a found thing, or its two pieces; ``taken`` learns of them."""
    if row in fate.swallowed:
        both = frame.pixels(row, fate.swallowed[row])
        return [_edged(both, taken, _EDGE_IOU, frame)]
    if row in fate.split:
        whole = _edged(frame.pixels(row), taken, _EDGE_IOU, frame)
        return _cut(whole, fate.split[row])
    iou = frame.random.normal(fate.mean_iou, _IOU_SPREAD)
    iou = float(np.clip(iou, _IOU_LOW, _IOU_HIGH))
    return [_edged(frame.pixels(row), taken, iou, frame)]


def _edged(pixels: np.ndarray, taken: np.ndarray, iou: float, frame: TrueFrame) -> np.ndarray:
    """``pixels`` with a ragged edge; they grow into what is not taken, and take it."""
    edged = ragged(pixels, ~taken, iou, frame.random)
    taken |= edged
    return edged


def _cut(pixels: Bool[np.ndarray, "height width"], share: float) -> list[np.ndarray]:
    """Two parts on both sides of a line across the longer side, the first ``share`` of it."""
    y, x = np.nonzero(pixels)
    along = y if np.ptp(y) >= np.ptp(x) else x
    order = np.argsort(along, kind="stable")
    parts = []
    for part in np.split(order, [round(share * len(order))]):
        piece = np.zeros_like(pixels)
        piece[y[part], x[part]] = True
        parts.append(piece)
    return parts


def _seen_class(frame: TrueFrame, row: int, right_class: float) -> int:
    """The true class, or, for a while, one that it is often taken for."""
    true = frame.class_name(row)
    if frame.lasting(_CLASS, row) < ndtri(right_class):
        return class_named(true).id
    likely = [n for group in CONFUSED if true in group for n in group if n != true]
    likely = likely or [c.name for c in classes() if c.kind == "thing" and c.name != true]
    return class_named(likely[int(frame.fixed(_OTHER_CLASS, row).integers(len(likely)))]).id


def _false_masks(frame: TrueFrame, rate: float, taken: np.ndarray):
    """Ellipses of nothing."""
    names = {name for group in CONFUSED for name in group}
    kinds = sorted(class_named(n).id for n in names if class_named(n).kind == "thing")
    for _ in range(frame.random.poisson(rate)):
        kind = kinds[int(frame.random.integers(len(kinds)))]
        tries = (_ellipse(frame, taken) for _ in range(_TRIES))
        pixels = next((found for found in tries if found is not None), None)
        if pixels is not None:
            taken = taken | pixels
            yield pixels, kind, float(frame.random.uniform(0.5, 0.8))


def _ellipse(frame: TrueFrame, taken: np.ndarray) -> Bool[np.ndarray, "height width"] | None:
    """One where nothing is taken; None where it would show a thing that is there, or nothing."""
    height, width = taken.shape
    y, x = np.ogrid[:height, :width]
    cy, cx = frame.random.uniform((0, 0), (height, width))
    ry, rx = frame.random.uniform(0.04, 0.1, 2) * height
    pixels = (((y - cy) / ry) ** 2 + ((x - cx) / rx) ** 2 < 1) & ~taken
    overlap = np.bincount(frame.truth.mask[pixels], minlength=len(frame.area))
    union = frame.area + np.count_nonzero(pixels) - overlap
    matches = np.any(overlap[frame.things] > 0.5 * union[frame.things])
    return None if matches or np.count_nonzero(pixels) < MIN_PIXELS else pixels


def _layout(frame: TrueFrame, rates: NoiseRates, covered: np.ndarray):
    """Layout and stuff, one mask per class, with smooth holes where nothing else covers them."""
    single = {class_named(name).id: share for name, share in rates.class_recall}
    for class_id in frame.stuff_classes:
        recall = single.get(int(class_id), rates.layout_recall)
        pixels = frame.truth.class_id[frame.truth.mask] == class_id
        free = pixels & ~covered
        wanted = int(recall * np.count_nonzero(pixels))
        noise = smooth_noise(pixels.shape, 60.0, frame.random)
        if wanted < np.count_nonzero(free):
            values = np.append(noise[free], np.inf)  # so that of one pixel none can be wanted
            cut = np.partition(values, -1 - wanted)[-1 - wanted]
            free &= noise >= cut
        yield free, int(class_id), float(frame.random.uniform(0.8, 1.0))
