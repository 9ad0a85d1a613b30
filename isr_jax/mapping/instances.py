"""Global instances: what is known of each, and which of them turn out to be one."""

from __future__ import annotations

from ..classes import classes
from ..config import MappingSettings
from .shares import Shares, Triplets


class Instances:
    """Class, frames and merges of every global instance; instance 0 is none."""

    def __init__(self, settings: MappingSettings) -> None:
        self.settings = settings
        self.class_of: list[int] = [0]
        self.frames: list[int] = [0]
        """Frames in which an instance was seen."""
        self.merged_into: list[int] = [0]
        """Instance -> the instance it has become; itself where it has not."""
        self.frames_apart: dict[tuple[int, int], int] = {}
        """Two instances, the lower first -> frames in which they were seen as two."""

    def is_thing(self, instance: int) -> bool:
        """Whether it is a thing, and not merged into another."""
        return instance > 0 and classes()[self.class_of[instance]].kind == "thing"

    def fresh(self, class_id: int) -> int:
        """A new instance of a class."""
        self.class_of.append(class_id)
        self.frames.append(0)
        self.merged_into.append(len(self.merged_into))
        return len(self.merged_into) - 1

    def of_stuff(self, class_id: int) -> int:
        """All of one stuff or layout class is one instance."""
        if class_id in self.class_of:
            return self.class_of.index(class_id)
        return self.fresh(class_id)

    def count(self, seen: set[int]) -> None:
        """Count one frame in which these instances were seen, each apart from the others."""
        for instance in seen:
            self.frames[instance] += 1
        things = sorted(o for o in seen if self.is_thing(o))
        for i, a in enumerate(things):
            for b in things[i + 1 :]:
                self.frames_apart[a, b] = self.frames_apart.get((a, b), 0) + 1

    def frames_apart_of(self, a: int, b: int) -> int:
        """Frames in which two instances were seen as two."""
        return self.frames_apart.get((min(a, b), max(a, b)), 0)

    def mergeable_pair(self, shares: Shares, seen: set[int]) -> tuple[int, int] | None:
        """The first pair of instances, one of them just ``seen``, that turn out to be one thing.

        i and j are one when shared(i, j) > ratio * min(total(i), total(j)) and > min (`Shares`).
        The released code counts associations after the first shared one against n_i + n_j; the
        minimum forgives single wrong frames. Instances that were seen as two in one frame more
        often than that stay two, so the classes need not agree (``regulate_classes``): a table
        that was a counter for some frames is one thing, a cup on a table is seen beside it.
        """
        pairs = {
            (min(a, b), max(a, b))
            for a in seen
            for b, count in shares.shared.get(a, {}).items()
            if count > self.settings.instance_merge_min
        }
        return next((pair for pair in sorted(pairs) if self._may_merge(*pair, shares)), None)

    def _may_merge(self, a: int, b: int, shares: Shares) -> bool:
        alike = self.class_of[a] == self.class_of[b]
        shared = shares.shared[a][b]
        return bool(
            (self.settings.regulate_classes or alike)
            and shared > self.settings.instance_merge_ratio * min(shares.total[a], shares.total[b])
            and shared > max(self.settings.instance_merge_min, self.frames_apart_of(a, b))
        )

    def merge(self, keep: int, gone: int, counts: list[Triplets]) -> None:
        """Make two instances one; ``counts`` follow."""
        self.merged_into = [keep if o == gone else o for o in self.merged_into]
        self.class_of[gone] = 0
        self.frames[keep] += self.frames[gone]
        for triplets in counts:
            for class_id, instance in [key for key in triplets if key[1] == gone]:
                count = triplets.pop((class_id, instance))
                triplets[class_id, keep] = triplets.get((class_id, keep), 0) + count
        moved: dict[tuple[int, int], int] = {}
        for pair, frames in self.frames_apart.items():
            a, b = sorted(keep if o == gone else o for o in pair)
            if a != b:
                moved[a, b] = moved.get((a, b), 0) + frames
        self.frames_apart = moved
