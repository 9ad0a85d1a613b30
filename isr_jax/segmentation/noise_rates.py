"""The stated error rates of the simulated segmenter, and what it takes for what."""

from __future__ import annotations

import dataclasses

MIN_PIXELS = 100
"""Smaller true masks are never seen, and do not count in the rates."""

CONFUSED = (
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
    """The noise model of one level. `measured_rates` counts the same figures in masks."""

    recall: float
    """Share of the true things of `MIN_PIXELS` with a mask of IoU > 0.5, whatever its class."""
    right_class: float
    """Share of those with the right class."""
    mean_iou: float
    """Mean IoU of those, merged and split ones among them."""
    false_masks: float
    """Masks of things per frame that no true thing matches; pieces of split things among them."""
    layout_recall: float
    """Share of the pixels of layout and stuff that carry their class, where ``class_recall`` does
    not say another."""
    merges: float
    """Share, of the pairs of touching things of like classes where a mask of both would leave the
    matches as they are, that get one mask: a missed one by a larger found one, or two missed ones
    of one size. Merges are thus a part of the misses."""
    splits: float
    """Share of the found things whose mask falls in two ids, one of them with an IoU > 0.5. Lower
    where the pieces would be more than half of ``false_masks``."""
    class_recall: tuple[tuple[str, float], ...] = ()
    """Share of the pixels of single classes that carry their class. For a class of things, chances
    of the other things make up for it, so that the rates above hold."""


LEVELS: dict[str, NoiseRates | None] = {
    "perfect": None,
    "strong": NoiseRates(0.75, 0.90, 0.85, 0.3, 0.95, 0.15, 0.02),
    "medium": NoiseRates(0.50, 0.80, 0.80, 0.4, 0.90, 0.25, 0.04),
    "weak": NoiseRates(
        0.20,
        0.50,
        0.78,
        0.4,
        0.70,
        0.25,
        0.04,
        (("wall", 0.83), ("floor", 0.63), ("chair", 0.20), ("table", 0.11)),
    ),
}
"""``strong`` is a large panoptic network; ``weak`` is what detectors of 4 to 14 MB showed on 54
labelled frames of a real scan. Rates of merges and splits are of our own choosing."""


def confusable(a: str, b: str) -> bool:
    """Whether the two are one class or are taken for each other."""
    return a == b or any(a in group and b in group for group in CONFUSED)


def described(rates: NoiseRates) -> str:
    """The rates in one line."""
    line = (
        f"recall {rates.recall:.0%} at IoU 0.5, {rates.right_class:.0%} of hits with the right "
        f"class, mean IoU {rates.mean_iou:.2f}, {rates.false_masks} false masks per frame, "
        f"{rates.layout_recall:.0%} of layout pixels, {rates.merges:.0%} of likely merges, "
        f"{rates.splits:.0%} of hits split"
    )
    single = ", ".join(f"{name} {share:.0%}" for name, share in rates.class_recall)
    return f"{line}, of pixels: {single}" if single else line
