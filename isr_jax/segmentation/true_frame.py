"""One true frame, what makes its things hard to see, and the random numbers that belong to it."""

from __future__ import annotations

import re
from collections.abc import Mapping

import numpy as np
from jaxtyping import Bool, Float, Int

from ..classes import classes
from ..types import Frame, PanopticFrame
from .noise_rates import MIN_PIXELS

_MEMORY_FRAMES = 10.0
"""Errors persist over about so many frames."""
_GAPS_PX = (1, 3)
"""Things touch whose pixels lie so far apart along a row or a column ..."""
_CONTACT_PX = 8
"""... in so many places."""
_CUT = 0.5
"""What the image's border cuts is as hard to see as something whole of this share of its width."""


class TrueFrame:
    """True masks with their lasting ids; rows of ``truth`` name instances throughout."""

    def __init__(
        self,
        truth: PanopticFrame,
        ids: Int[np.ndarray, " rows"],
        frame: Frame,
        seed: int,
        visible: Mapping[int, float],
    ) -> None:
        self.truth, self.ids, self.seed = truth, ids, seed
        self._visible = visible
        self._time = _frame_number(frame) / _MEMORY_FRAMES
        self.random = np.random.default_rng([seed, *frame.name.encode()])
        kinds = np.array([info.kind for info in classes()])[truth.class_id]
        self.area = np.bincount(truth.mask.ravel(), minlength=len(ids))
        self.rows = [k for k in range(1, len(ids)) if self.area[k] > 0]
        is_thing = np.isin(kinds, ("thing", "dynamic"))
        self.things = [k for k in self.rows if is_thing[k] and self.area[k] >= MIN_PIXELS]
        stuff = [k for k in self.rows if not is_thing[k]]
        self.stuff_classes = np.unique(truth.class_id[stuff])

    def pixels(self, *rows: int) -> Bool[np.ndarray, "height width"]:
        """Of all these instances together."""
        if len(rows) == 1:
            return self.truth.mask == rows[0]
        wanted = np.zeros(len(self.ids), bool)
        wanted[list(rows)] = True
        return wanted[self.truth.mask]

    def class_name(self, row: int) -> str:
        return classes()[self.truth.class_id[row]].name

    def lasting(self, what: int, *rows: int) -> float:
        """A standard normal number of an instance, or of a pair, that changes slowly over frames.

        Between two frames of the memory it is their sum, weighted to unit variance.
        """
        knot = int(np.floor(self._time))
        key = [self.seed, what, *sorted(int(self.ids[row]) for row in rows)]
        draws = [np.random.default_rng([*key, knot + k]).normal() for k in (0, 1)]
        part = self._time - knot
        return float(((1 - part) * draws[0] + part * draws[1]) / np.hypot(1 - part, part))

    def fixed(self, what: int, row: int) -> np.random.Generator:
        """Random numbers of an instance that are the same in every frame."""
        return np.random.default_rng([self.seed, what, int(self.ids[row])])

    def ease(self) -> Float[np.ndarray, " things"]:
        """How easily each thing is seen: its width in pixels, less where it is cut or occluded."""
        mask, border = self.truth.mask, np.zeros(len(self.ids), bool)
        border[np.concatenate([mask[0], mask[-1], mask[:, 0], mask[:, -1]])] = True
        visible = [self._visible.get(int(self.ids[row]), 1.0) for row in self.things]
        cut = np.where(border[self.things], _CUT, 1.0)
        return np.sqrt(self.area[self.things]) * cut * np.array(visible, float)

    def touching(self) -> list[tuple[int, int]]:
        """Pairs of things that touch, the larger first; the longest contact first."""
        mask, count, keys = self.truth.mask, len(self.ids), []
        for gap in _GAPS_PX:
            for a, b in ((mask[gap:], mask[:-gap]), (mask[:, gap:], mask[:, :-gap])):
                differ = a != b
                a, b = a[differ].astype(np.int64), b[differ].astype(np.int64)
                keys.append(np.minimum(a, b) * count + np.maximum(a, b))
        pairs, contact = np.unique(np.concatenate(keys), return_counts=True)
        order = np.argsort(-contact, kind="stable")
        order = order[contact[order] >= _CONTACT_PX * len(_GAPS_PX)]
        found = [divmod(int(pairs[i]), count) for i in order]
        things = set(self.things)
        kept = [(a, b) for a, b in found if a in things and b in things]
        return [(a, b) if self.area[a] >= self.area[b] else (b, a) for a, b in kept]


def _frame_number(frame: Frame) -> int:
    """The number that ends the frame's name, so that a stride does not change its masks."""
    number = re.search(r"(\d+)\D*$", frame.name)
    return int(number.group(1)) if number else frame.index
