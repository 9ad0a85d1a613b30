"""How large things are, and which unit of length makes a model that large.

Ranges of the largest side are those of furniture and household catalogues with some room on both
ends; they only have to tell metres from centimetres, inches and millimetres.
"""

from __future__ import annotations

import dataclasses

import numpy as np

from .class_guess import OTHER

_LARGEST_SIDE_M: dict[str, tuple[float, float]] = {
    "chair": (0.45, 2.2),
    "stool": (0.25, 1.2),
    "bench": (0.5, 3.0),
    "table": (0.35, 4.5),
    "desk": (0.6, 3.0),
    "sofa": (0.9, 4.5),
    "bed": (0.8, 2.8),
    "nightstand": (0.3, 1.0),
    "wardrobe": (0.9, 4.0),
    "cabinet": (0.3, 4.0),
    "wall_cabinet": (0.25, 2.5),
    "drawer_unit": (0.25, 2.2),
    "counter": (0.5, 5.0),
    "bookshelf": (0.3, 4.0),
    "fridge": (0.45, 2.3),
    "microwave": (0.3, 0.8),
    "oven": (0.35, 2.2),
    "dishwasher": (0.4, 1.2),
    "washing_machine": (0.4, 1.4),
    "sink": (0.25, 2.0),
    "toilet": (0.25, 1.3),
    "bathtub": (0.9, 3.0),
    "monitor": (0.25, 2.2),
    "laptop": (0.2, 0.6),
    "keyboard": (0.2, 0.7),
    "mouse": (0.06, 0.2),
    "remote": (0.07, 0.4),
    "phone": (0.08, 0.4),
    "book": (0.08, 0.6),
    "cup": (0.04, 0.35),
    "bowl": (0.06, 0.6),
    "bottle": (0.05, 0.6),
    "vase": (0.06, 1.5),
    "plant": (0.06, 3.0),
    "lamp": (0.06, 3.0),
    "clock": (0.04, 2.5),
    "bin": (0.15, 1.4),
    "bag": (0.15, 1.2),
    "box": (0.05, 2.0),
    "kettle": (0.1, 0.5),
    "cushion": (0.2, 1.5),
    "door": (0.5, 6.0),
    "window": (0.3, 6.0),
    "rug": (0.3, 7.0),
    "curtain": (0.4, 7.0),
    "picture": (0.05, 4.0),
    "mirror": (0.1, 3.0),
}
_ANYTHING_M = (0.01, 20.0)
"""Largest side of a thing of no known class."""
UNITS_M: dict[str, float] = {
    "metres": 1.0,
    "millimetres": 0.001,
    "centimetres": 0.01,
    "decimetres": 0.1,
    "inches": 0.0254,
    "feet": 0.3048,
}


def largest_side_range(class_name: str) -> tuple[float, float]:
    """Least and greatest plausible largest side of a thing, metres."""
    return _LARGEST_SIDE_M.get(class_name, _ANYTHING_M)


def is_plausible(side_m: float, class_name: str) -> bool:
    """Whether a thing of this class may have this largest side."""
    low, high = largest_side_range(class_name)
    return low <= side_m <= high


@dataclasses.dataclass(frozen=True)
class UnitGuess:
    """A unit of length for a model."""

    unit_m: float
    note: str
    """What was guessed or repaired; empty where the stated unit holds."""


def unit_of(side: float, class_name: str, stated_m: float | None) -> UnitGuess | None:
    """The unit that makes a largest side of ``side`` units plausible; None where none does.

    A stated unit holds while the model is within ten times its class's range: doll's houses are
    no errors, but a chair of 900 m is. Without one, metres win if plausible, else the unit whose
    size is nearest to the middle of the range.
    """
    low, high = largest_side_range(class_name)
    if stated_m is not None and low / 10 <= side * stated_m <= high * 10:
        return UnitGuess(stated_m, "")
    what = "thing" if class_name == OTHER else class_name
    fits = {name: m for name, m in UNITS_M.items() if low <= side * m <= high}
    if not fits:
        return None
    middle = np.sqrt(low * high)
    best = min(fits, key=lambda name: abs(np.log(side * fits[name] / middle)))
    name = "metres" if "metres" in fits and stated_m is None else best
    said = f"unit estimated: {name}"
    if stated_m is not None:
        said = (
            f"stated unit of {stated_m:g} m makes a {what} of {side * stated_m:.3g} m: {name} taken"
        )
    return UnitGuess(fits[name], said)
