"""Which instances share geometric labels, and for how long: kept up to date a count at a time.

Phi(l, o) = sum_c Phi(l, c, o);  shared(i, j) = sum_l min(Phi(l, i), Phi(l, j));
total(o) = sum_l Phi(l, o). Tallying them anew would cost as much as the map has labels, a frame.
"""

from __future__ import annotations

import collections
from collections.abc import Iterable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .instances import Instances, Triplets


class Shares:
    """Sums over the triplet counts of things."""

    def __init__(self, instances: Instances) -> None:
        self._instances = instances
        self.total: collections.Counter[int] = collections.Counter()
        self.shared: dict[int, collections.Counter[int]] = {}
        """Instance -> the others that share labels with it, and how much."""
        self._of_label: dict[int, collections.Counter[int]] = {}

    def count(self, label: int, instance: int, frames: int = 1) -> None:
        """``label`` was ``instance`` in so many frames more."""
        if not self._instances.is_thing(instance):
            return
        here = self._of_label.setdefault(label, collections.Counter())
        old = here[instance]
        for other, n in here.items():
            gained = min(old + frames, n) - min(old, n)
            if other != instance and gained:
                self.shared.setdefault(instance, collections.Counter())[other] += gained
                self.shared.setdefault(other, collections.Counter())[instance] += gained
        here[instance] = old + frames
        self.total[instance] += frames

    def recount(self, counts: Iterable[Triplets]) -> None:
        """Start anew from all triplet counts."""
        self.total, self.shared, self._of_label = collections.Counter(), {}, {}
        for label, triplets in enumerate(counts):
            for (_, instance), frames in sorted(triplets.items()):
                self.count(label, instance, frames)
