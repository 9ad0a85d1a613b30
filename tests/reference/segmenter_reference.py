"""Slow twins of how model outputs become masks: one pixel, one query, one box at a time."""

from __future__ import annotations

import math

import numpy as np


def sample(model_map: np.ndarray, x: int, y: int, step: tuple[float, float]) -> float:
    """Bilinear value of a map at the centre of image pixel (x, y); edges are continued."""
    u = min(max((x + 0.5) * step[0] - 0.5, 0.0), model_map.shape[1] - 1.0)
    v = min(max((y + 0.5) * step[1] - 0.5, 0.0), model_map.shape[0] - 1.0)
    i, j = math.floor(u), math.floor(v)
    i1, j1 = min(i + 1, model_map.shape[1] - 1), min(j + 1, model_map.shape[0] - 1)
    a, b = u - i, v - j
    top = (1 - a) * model_map[j, i] + a * model_map[j, i1]
    low = (1 - a) * model_map[j1, i] + a * model_map[j1, i1]
    return float((1 - b) * top + b * low)


def queries(class_logits, mask_logits, shape, *, min_score, min_shown=0.8) -> dict:
    """{query: (label, score, pixels)} of MaskFormer's panoptic inference."""
    step = (mask_logits.shape[2] / shape[1], mask_logits.shape[1] / shape[0])
    alive = {}
    for q, logits in enumerate(class_logits):
        p = np.exp(logits - logits.max())
        p /= p.sum()
        label = int(np.argmax(p))
        if label != len(p) - 1 and p[label] >= min_score:
            alive[q] = (label, float(p[label]))
    winner = np.full(shape, -1)
    inside = {q: np.zeros(shape, bool) for q in alive}
    for y in range(shape[0]):
        for x in range(shape[1]):
            best = 0.0
            for q, (_, score) in alive.items():
                sigmoid = 1 / (1 + math.exp(-sample(mask_logits[q], x, y, step)))
                inside[q][y, x] = sigmoid >= 0.5
                if score * sigmoid > best:
                    best, winner[y, x] = score * sigmoid, q
    found = {}
    for q, (label, score) in alive.items():
        pixels = inside[q] & (winner == q)
        if pixels.any() and pixels.sum() >= min_shown * inside[q].sum():
            found[q] = (label, score, pixels)
    return found


def yolo_seg(cells, prototypes, labels, input_size, shape, *, min_score, max_iou=0.45) -> list:
    """[(label, score, box, pixels)], best first; letterboxed top left, boxes in input pixels."""
    ratio = min(input_size[0] / shape[0], input_size[1] / shape[1])
    boxes = []
    for cell in cells.T:
        label = int(np.argmax(cell[4 : 4 + labels]))
        score = float(cell[4 + label])
        if score < min_score:
            continue
        x, y, w, h = cell[:4] / ratio
        box = [max(x - w / 2, 0), max(y - h / 2, 0)]
        box += [min(x + w / 2, shape[1]), min(y + h / 2, shape[0])]
        boxes.append((label, score, box, cell[4 + labels :]))
    boxes.sort(key=lambda b: -b[1])
    kept = []
    for candidate in boxes:
        if all(_iou(candidate[2], other[2]) <= max_iou for other in kept):
            kept.append(candidate)
    step = ratio * prototypes.shape[2] / input_size[1], ratio * prototypes.shape[1] / input_size[0]
    return [(b[0], b[1], b[2], _mask(b, prototypes, shape, step)) for b in kept]


def _mask(box, prototypes, shape, step) -> np.ndarray:
    logit = sum(c * p for c, p in zip(box[3], prototypes, strict=True))
    x0, y0, x1, y1 = box[2]
    mask = np.zeros(shape, bool)
    for y in range(math.floor(y0), math.ceil(y1)):
        for x in range(math.floor(x0), math.ceil(x1)):
            mask[y, x] = sample(logit, x, y, step) > 0
    return mask


def _iou(a, b) -> float:
    width = min(a[2], b[2]) - max(a[0], b[0])
    height = min(a[3], b[3]) - max(a[1], b[1])
    shared = max(width, 0) * max(height, 0)
    areas = [(c[2] - c[0]) * (c[3] - c[1]) for c in (a, b)]
    return shared / (sum(areas) - shared)
