"""Which instances share geometric labels, and for how long: kept up to date count by count.

Phi(l, o) = sum_c Phi(l, c, o);  shared(i, j) = sum_l min(Phi(l, i), Phi(l, j));
total(o) = sum_l Phi(l, o), with the Phi(l, c, o) of the paper (sec. IV, Data Fusion). Tallying them
anew for each frame would cost as much as the map has labels.
"""

from __future__ import annotations

import collections
from collections.abc import Callable

Triplets = dict[tuple[int, int], int]
"""Of one label: (class, instance) -> Phi, the frames in which it was both."""


class Shares:
    """Sums over the triplet counts of things.

    Args:
        is_thing: Whether an instance is a thing; of others nothing is summed.
    """

    def __init__(self, is_thing: Callable[[int], bool]) -> None:
        self._is_thing = is_thing
        self.total: collections.Counter[int] = collections.Counter()
        self.shared: dict[int, collections.Counter[int]] = {}
        """Instance -> the others that share labels with it, and how much."""
        self._of_label: dict[int, collections.Counter[int]] = {}

    def count(self, label: int, instance: int, frames: int = 1) -> None:
        """``label`` was ``instance`` in so many frames more."""
        if not self._is_thing(instance):
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
