"""A segmenter that errs at stated rates, made from true masks."""

from __future__ import annotations

import dataclasses
import hashlib
import re
from typing import Protocol, runtime_checkable

import numpy as np
from scipy.special import ndtri

from ..classes import class_named, classes
from ..errors import SegmenterError
from ..types import Frame, PanopticFrame
from .ragged import ragged, smooth_noise

MIN_PIXELS = 100
"""Smaller true masks are never seen, and do not count in the rates."""
_MEMORY_FRAMES = 10.0
"""Errors persist over about so many frames."""
_IOU_SPREAD, _IOU_LOW, _IOU_HIGH = 0.05, 0.55, 0.97
_CONFUSED = (
    ("table", "desk", "counter", "nightstand"),
    ("chair", "stool", "sofa", "bench"),
    ("cabinet", "wall_cabinet", "bookshelf", "fridge", "wardrobe", "counter"),
    ("cup", "bottle", "bowl", "vase"),
    ("book", "box", "laptop", "remote"),
    ("monitor", "picture", "microwave", "oven"),
    ("bed", "sofa"),
    ("bin", "vase", "bag"),
)
"""What is taken for what."""


@dataclasses.dataclass(frozen=True)
class NoiseRates:
    """The noise model of one level."""

    recall: float
    """Share of the true things of `MIN_PIXELS` with a mask of IoU > 0.5, whatever its class."""
    right_class: float
    """Share of those with the right class."""
    mean_iou: float
    """Mean IoU of those."""
    false_masks: float
    """Masks of nothing, a frame."""
    layout_recall: float
    """Share of the pixels of layout and stuff."""


LEVELS: dict[str, NoiseRates | None] = {
    "perfect": None,
    "strong": NoiseRates(0.75, 0.90, 0.85, 0.3, 0.95),
    "medium": NoiseRates(0.50, 0.80, 0.80, 0.4, 0.90),
    "weak": NoiseRates(0.20, 0.50, 0.78, 0.4, 0.70),
}


@runtime_checkable
class TrueMasks(Protocol):
    """A source of true masks that knows the lasting id of each."""

    def read(self, frame: Frame) -> tuple[PanopticFrame, np.ndarray]: ...

    def content_hash(self) -> str: ...


class SimulatedSegmenter:
    """True masks with misses, wrong classes, ragged edges and false masks (`NoiseRates`).

    Misses fall first on things that are small or cut by the image's edge; misses and wrong
    classes last over neighbouring frames. Instances of layout and stuff become one mask a class.
    Rows change from frame to frame. The same frame name and seed give the same masks.
    """

    def __init__(self, truth: TrueMasks, level: str = "strong", *, seed: int = 0) -> None:
        if level not in LEVELS:
            raise SegmenterError(f"unknown noise level {level!r}", f"use one of: {_names()}")
        self._truth, self._rates, self._seed = truth, LEVELS[level], seed
        self.name = f"simulated:{level}"

    def __call__(self, frame: Frame) -> PanopticFrame:
        truth, ids = self._truth.read(frame)
        scene = _Scene(truth, ids, frame, self._seed)
        if self._rates is None:
            masks = [(scene.pixels(k), int(truth.class_id[k]), 1.0) for k in scene.rows]
            return _painted(masks, scene)
        return _painted(_noisy(scene, self._rates), scene)

    def rates(self) -> NoiseRates | None:
        """The stated rates; None for ``perfect``."""
        return self._rates

    def content_hash(self) -> str:
        key = f"{self._truth.content_hash()} {self._rates} {self._seed}"
        return hashlib.sha256(key.encode()).hexdigest()

    def describe(self) -> str:
        if self._rates is None:
            return f"{self.name}: the true masks"
        r = self._rates
        return (
            f"{self.name}: recall {r.recall:.0%} at IoU 0.5, {r.right_class:.0%} of hits with the "
            f"right class, mean IoU {r.mean_iou:.2f}, {r.false_masks} false masks a frame, "
            f"{r.layout_recall:.0%} of layout pixels (seed {self._seed})"
        )


def _names() -> str:
    return ", ".join(LEVELS)


class _Scene:
    """One true frame and the random numbers that belong to it."""

    def __init__(self, truth: PanopticFrame, ids: np.ndarray, frame: Frame, seed: int) -> None:
        self.truth, self.ids, self.seed = truth, ids, seed
        self.time = _frame_number(frame) / _MEMORY_FRAMES
        self.random = np.random.default_rng([seed, *frame.name.encode()])
        kinds = np.array([info.kind for info in classes()])[truth.class_id]
        area = np.bincount(truth.mask.ravel(), minlength=len(ids))
        self.rows = [k for k in range(1, len(ids)) if area[k] > 0]
        is_thing = np.isin(kinds, ("thing", "dynamic"))
        self.things = [k for k in self.rows if is_thing[k] and area[k] >= MIN_PIXELS]
        stuff = [k for k in self.rows if not is_thing[k]]
        self.stuff_classes = np.unique(truth.class_id[stuff])
        self.area = area

    def pixels(self, row: int) -> np.ndarray:
        return self.truth.mask == row

    def lasting(self, row: int, what: int) -> float:
        """A standard normal number of an instance that changes slowly over frames."""
        knot = int(np.floor(self.time))
        draws = [
            np.random.default_rng([self.seed, what, int(self.ids[row]), knot + k]).normal()
            for k in (0, 1)
        ]
        part = self.time - knot
        return float(((1 - part) * draws[0] + part * draws[1]) / np.hypot(1 - part, part))

    def hit_chances(self, recall: float) -> np.ndarray:
        """By rank of visible size, halved where the image cuts it; their mean is ``recall``."""
        border = np.zeros(len(self.ids), bool)
        mask = self.truth.mask
        border[np.concatenate([mask[0], mask[-1], mask[:, 0], mask[:, -1]])] = True
        ease = np.sqrt(self.area[self.things]) * np.where(border[self.things], 0.5, 1.0)
        rank = (np.argsort(np.argsort(ease)) + 0.5) / max(len(ease), 1)
        return recall + 0.9 * min(recall, 1 - recall) * (2 * rank - 1)


def _frame_number(frame: Frame) -> int:
    """The number that ends the frame's name, so that a stride does not change its masks."""
    number = re.search(r"(\d+)\D*$", frame.name)
    return int(number.group(1)) if number else frame.index


def _noisy(scene: _Scene, rates: NoiseRates) -> list[tuple[np.ndarray, int, float]]:
    chances = scene.hit_chances(rates.recall)
    hits = [
        row
        for row, chance in zip(scene.things, chances, strict=True)
        if scene.lasting(row, 1) < ndtri(chance)
    ]
    hits.sort(key=lambda row: -scene.area[row])
    taken = np.isin(scene.truth.mask, hits)
    things = []
    for row in hits:
        iou = scene.random.normal(rates.mean_iou, _IOU_SPREAD)
        iou = float(np.clip(iou, _IOU_LOW, _IOU_HIGH))
        pixels = ragged(scene.pixels(row), ~taken, iou, scene.random)
        taken |= pixels
        score = float(scene.random.uniform(0.6, 1.0))
        things.append((pixels, _seen_class(scene, row, rates.right_class), score))
    false = list(_false_masks(scene, rates.false_masks, taken))
    covered = np.logical_or.reduce([taken, *(m[0] for m in false)])
    return [*_layout(scene, rates.layout_recall, covered), *false, *things]


def _seen_class(scene: _Scene, row: int, right_class: float) -> int:
    """The true class, or, for a while, one that it is often taken for."""
    true = classes()[scene.truth.class_id[row]].name
    if scene.lasting(row, 2) < ndtri(right_class):
        return class_named(true).id
    likely = [n for group in _CONFUSED if true in group for n in group if n != true]
    likely = likely or [c.name for c in classes() if c.kind == "thing" and c.name != true]
    lasting = np.random.default_rng([scene.seed, 3, int(scene.ids[row])])
    return class_named(likely[int(lasting.integers(len(likely)))]).id


def _false_masks(scene: _Scene, rate: float, taken: np.ndarray):
    """Ellipses of nothing, never most of a thing that is there."""
    height, width = taken.shape
    y, x = np.mgrid[:height, :width].astype(np.float32)
    names = sorted({name for group in _CONFUSED for name in group})
    for _ in range(scene.random.poisson(rate)):
        cy, cx = scene.random.uniform((0, 0), (height, width))
        ry, rx = scene.random.uniform(0.04, 0.1, 2) * height
        pixels = (((y - cy) / ry) ** 2 + ((x - cx) / rx) ** 2 < 1) & ~taken
        overlap = np.bincount(scene.truth.mask[pixels], minlength=len(scene.area))
        union = scene.area + np.count_nonzero(pixels) - overlap
        kind = class_named(names[int(scene.random.integers(len(names)))]).id
        if np.any(overlap[scene.things] > 0.5 * union[scene.things]):
            continue
        taken = taken | pixels
        yield pixels, kind, float(scene.random.uniform(0.5, 0.8))


def _layout(scene: _Scene, recall: float, covered: np.ndarray):
    """Layout and stuff, one mask a class, with smooth holes where nothing else covers them."""
    for class_id in scene.stuff_classes:
        pixels = scene.truth.class_id[scene.truth.mask] == class_id
        free = pixels & ~covered
        wanted = int(recall * np.count_nonzero(pixels))
        noise = smooth_noise(pixels.shape, 60.0, scene.random)
        if wanted < np.count_nonzero(free):
            values = noise[free]
            cut = np.partition(values, len(values) - wanted)[len(values) - wanted]
            free &= noise >= cut
        yield free, int(class_id), float(scene.random.uniform(0.8, 1.0))


def _painted(masks: list[tuple[np.ndarray, int, float]], scene: _Scene) -> PanopticFrame:
    """One label a pixel, in an order of rows that changes from frame to frame."""
    order = scene.random.permutation(len(masks)) + 1
    label = np.zeros(scene.truth.mask.shape, np.int32)
    class_id, score = np.zeros(len(masks) + 1, np.int32), np.zeros(len(masks) + 1, np.float32)
    for row, (pixels, kind, certainty) in zip(order, masks, strict=True):
        label[pixels] = row
        class_id[row], score[row] = kind, certainty
    return PanopticFrame(label, class_id, score)
