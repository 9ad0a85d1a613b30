"""Which instances share geometric labels, and for how long: kept up to date a count at a time.

Phi(l, o) = sum_c Phi(l, c, o);  shared(i, j) = sum_l min(Phi(l, i), Phi(l, j));
total(o) = sum_l Phi(l, o). Tallying them anew would cost as much as the map has labels, a frame.
"""

from __future__ import annotations

import collections
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

    def labels_of(self, instance: int) -> list[int]:
        """Labels that were ever this instance."""
        return [label for label, here in self._of_label.items() if instance in here]

    def rewrite(self, label: int, triplets: Triplets) -> None:
        """All counts of a label are these from now on."""
        self._withdraw(label)
        for (_, instance), frames in triplets.items():
            self.count(label, instance, frames)

    def renumber(self, kept: list[int]) -> None:
        """Label ``kept[i]`` is now ``i``; the others are gone."""
        for label in self._of_label.keys() - set(kept):
            self._withdraw(label)
        self._of_label = {
            i: self._of_label[label] for i, label in enumerate(kept) if label in self._of_label
        }

    def _withdraw(self, label: int) -> None:
        here = list(self._of_label.pop(label, {}).items())
        for i, (a, frames) in enumerate(here):
            self.total[a] -= frames
            for b, n in here[i + 1 :]:
                both = min(frames, n)
                self.shared[a][b] -= both
                self.shared[b][a] -= both
