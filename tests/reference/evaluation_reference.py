"""Slow twins of the evaluation kernels, one loop a sentence of their definition."""

from __future__ import annotations

import numpy as np


def contingency(truth, predicted, truth_count, predicted_count) -> np.ndarray:
    shared = np.zeros((truth_count, predicted_count), int)
    for t, p in zip(truth, predicted, strict=True):
        if t >= 0 and p >= 0:
            shared[t, p] += 1
    return shared


def panoptic_quality(shared, truth_size, predicted_size, truth_class, predicted_class, classes):
    """(pq, sq, rq) a class."""
    scores = np.zeros((3, classes))
    for c in range(classes):
        ious, used = [], set()
        truths = [t for t in range(len(truth_size)) if truth_class[t] == c and truth_size[t] > 0]
        guesses = [
            p
            for p in range(len(predicted_size))
            if predicted_class[p] == c and predicted_size[p] > 0
        ]
        for t in truths:
            for p in guesses:
                union = truth_size[t] + predicted_size[p] - shared[t, p]
                if shared[t, p] / union > 0.5:
                    ious.append(shared[t, p] / union)
                    used.add(p)
        fn, fp = len(truths) - len(ious), len(guesses) - len(used)
        if ious:
            sq = float(np.mean(ious))
            rq = len(ious) / (len(ious) + fp / 2 + fn / 2)
            scores[:, c] = sq * rq, sq, rq
    return scores


def average_precision(iou, score, threshold) -> float:
    """Area under the curve, recall step by recall step."""
    taken, hits = set(), []
    for row in sorted(range(len(score)), key=lambda i: -score[i]):
        best = max(
            (t for t in range(iou.shape[1]) if t not in taken),
            key=lambda t: iou[row, t],
            default=None,
        )
        good = best is not None and iou[row, best] >= threshold
        if good:
            taken.add(best)
        hits.append(good)
    area = 0.0
    for k in range(len(hits)):
        if hits[k]:
            area += max(sum(hits[: j + 1]) / (j + 1) for j in range(k, len(hits)))
    return area / iou.shape[1] if iou.shape[1] else 0.0


def eleven_point(iou, score, threshold) -> float:
    """VOC 2007: the best precision at or beyond each of eleven recalls, counted in whole hits."""
    taken, hits = set(), []
    for row in sorted(range(len(score)), key=lambda i: -score[i]):
        free = [t for t in range(iou.shape[1]) if t not in taken]
        best = max(free, key=lambda t: iou[row, t], default=None)
        good = best is not None and iou[row, best] >= threshold
        if good:
            taken.add(best)
        hits.append(good)
    total = 0.0
    for tenths in range(11):
        reached = [
            sum(hits[: k + 1]) / (k + 1)
            for k in range(len(hits))
            if 10 * sum(hits[: k + 1]) >= tenths * iou.shape[1]
        ]
        total += max(reached, default=0.0)
    return total / 11 if iou.shape[1] else 0.0


def mask_average_precision(
    true, predicted, true_class, predicted_class, class_id, threshold, least
):
    """AP of the instance masks of one class; labels a point, 0 = none; None without true ones."""

    def masks(labels, class_of):
        named = [i for i in np.unique(labels) if i > 0 and class_of[i] == class_id]
        whole = [np.flatnonzero((labels == i) & (true > 0)) for i in named]
        return [set(mask) for mask in whole if len(mask) >= least]

    truths, guesses = masks(true, true_class), masks(predicted, predicted_class)
    if not truths:
        return None
    iou = np.array([[len(g & t) / len(g | t) for t in truths] for g in guesses])
    size = {frozenset(g): 0 for g in guesses}
    for i in np.unique(predicted):
        whole = np.flatnonzero(predicted == i)
        seen = frozenset(k for k in whole if true[k] > 0)
        if seen in size:
            size[seen] = len(whole)
    score = [size[frozenset(g)] for g in guesses]
    return average_precision(iou.reshape(len(guesses), len(truths)), score, threshold)
