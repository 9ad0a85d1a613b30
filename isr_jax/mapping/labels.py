"""Label fusion: triplet counts Phi(l, c, o), merges of labels and of instances (paper, sec. IV).

Everything here is small (hundreds of labels), lives on the host, and is deterministic: ties go
to the lower number. ``fusion="voxblox++"`` (Grinvald et al. 2019) walks the same path with pair
counts: Phi(l, 0, o) and Phi(l, c, 0), no class condition, no regulation of instances.
"""

from __future__ import annotations

import collections
from collections.abc import Mapping

import numpy as np
from jaxtyping import Int

from ..classes import classes
from ..config import MappingSettings
from ..errors import MapError
from .pool import LABEL_MASK
from .votes import Votes, assign_labels, overlapping_pairs

Triplets = dict[tuple[int, int], int]
"""(class, instance) -> frames."""


class LabelFusion:
    """What is known of every map label and every global instance."""

    def __init__(self, settings: MappingSettings) -> None:
        self.settings = settings
        self.pairwise = settings.fusion == "voxblox++"
        self.group = _groups(settings.instance_condition)
        """Class -> its group: an instance keeps to the classes of one group."""
        self.canonical = np.zeros(1, np.int64)
        """Label -> the label it has become by merges; itself where it has not."""
        self.frames_seen: list[int] = [0]
        self.counts: list[Triplets] = [{}]
        self.pair_frames: dict[tuple[int, int], int] = {}
        """Frames in which two labels claimed the same segment."""
        self.instance_class: list[int] = [0]
        self.instance_into: list[int] = [0]
        """Instance -> the instance it has become."""
        self.apart: dict[tuple[int, int], int] = {}
        """Frames in which two instances were seen as two."""

    @property
    def label_count(self) -> int:
        """Labels given so far, 0 included."""
        return len(self.canonical)

    def name_segments(
        self,
        votes: Votes,
        class_of: Int[np.ndarray, " segments"],
        instance_of: Int[np.ndarray, " segments"],
    ) -> Int[np.ndarray, " segments"]:
        """Map label of each segment of a frame, fresh ones where no known label fits.

        A label goes to one segment or, with ``share_labels``, to the segments of one instance, so
        that cutting an instance differently in each frame makes no new labels. A segment of fewer
        than ``min_votes`` voxels gets none: it could not be known again.
        """
        owner = self._owners(class_of, instance_of)
        label_of = assign_labels(votes, self.settings.min_votes, owner)
        for segment in np.flatnonzero(votes.total >= self.settings.min_votes).tolist():
            if segment and not label_of[segment]:
                label_of[segment] = self._fresh_label()
        self._count_overlaps(votes)
        return self.canonical[label_of]

    def _owners(self, class_of, instance_of) -> Int[np.ndarray, " segments"]:
        """Segments with the same number may take the same label."""
        owner = np.arange(len(class_of))
        if self.settings.share_labels and not self.pairwise:
            first: dict[tuple[int, int], int] = {}
            for segment in owner.tolist():
                key = _frame_instance(segment, class_of, instance_of)
                if key != (0, 0):
                    owner[segment] = first.setdefault(key, segment)
        return owner

    def _fresh_label(self) -> int:
        label = self.label_count
        if label >= LABEL_MASK:
            raise MapError(
                f"the map has given {label} labels",
                "raise MappingSettings.min_votes or SegmentationSettings.min_segment_px",
            )
        self.canonical = np.append(self.canonical, label)
        self.frames_seen.append(0)
        self.counts.append({})
        return label

    def _count_overlaps(self, votes: Votes) -> None:
        """Merge labels that share segments in more than ``merge_min_frames`` frames.

        Two labels of decided, different groups of classes stay apart whatever they share (panoptic only):
        a depth segment that spans a cup and its table is an error of that frame.
        """
        for pair in overlapping_pairs(votes, self.settings.merge_overlap_ratio):
            a, b = sorted(int(self.canonical[label]) for label in pair)
            if a == b:
                continue
            frames = self.pair_frames.get((a, b), 0) + 1
            self.pair_frames[a, b] = frames
            if frames > self.settings.merge_min_frames and self._may_merge(a, b):
                self._merge_labels(a, b)

    def _may_merge(self, a: int, b: int) -> bool:
        if self.pairwise:
            return True
        group_a, group_b = (self.group[self.decide(label)[0]] for label in (a, b))
        return bool(group_a == group_b or not group_a or not group_b)

    def _merge_labels(self, keep: int, gone: int) -> None:
        self.canonical[self.canonical == gone] = keep
        self.frames_seen[keep] += self.frames_seen[gone]
        for key, count in self.counts[gone].items():
            self.counts[keep][key] = self.counts[keep].get(key, 0) + count
        self.frames_seen[gone], self.counts[gone] = 0, {}
        moved: dict[tuple[int, int], int] = {}
        for pair, frames in self.pair_frames.items():
            a, b = sorted(keep if label == gone else label for label in pair)
            if a != b:
                moved[a, b] = max(frames, moved.get((a, b), 0))
        self.pair_frames = moved

    def observe(
        self,
        label_of: Int[np.ndarray, " segments"],
        class_of: Int[np.ndarray, " segments"],
        instance_of: Int[np.ndarray, " segments"],
    ) -> None:
        """Count one frame: Phi(l, c, o) <- Phi(l, c, o) + 1 for each of its segments."""
        seen = np.flatnonzero(label_of)
        for segment in seen.tolist():
            self.frames_seen[label_of[segment]] += 1
        global_of = self._associate(label_of, class_of, instance_of, seen)
        touched = set()
        for segment in seen.tolist():
            label, class_id = int(label_of[segment]), int(class_of[segment])
            instance = global_of.get(_frame_instance(segment, class_of, instance_of), 0)
            for key in self._keys(class_id, instance):
                self.counts[label][key] = self.counts[label].get(key, 0) + 1
            touched.add(instance)
        if not self.pairwise:
            self._count_apart({o for o in touched if self._is_thing(o)})
            self._regulate(touched)

    def _keys(self, class_id: int, instance: int) -> list[tuple[int, int]]:
        if not class_id:
            return []
        return [(class_id, 0), (0, instance)] if self.pairwise else [(class_id, instance)]

    def _associate(self, label_of, class_of, instance_of, seen) -> dict[tuple[int, int], int]:
        """Frame instances to global ones: the best unassigned of the same group, else fresh."""
        groups: dict[tuple[int, int], list[int]] = {}
        for segment in seen.tolist():
            key = _frame_instance(segment, class_of, instance_of)
            if key != (0, 0):
                groups.setdefault(key, []).append(int(label_of[segment]))
        global_of = {key: self._stuff_instance(key[0]) for key in groups if key[1] == 0}
        claims = []
        for key, labels in sorted(groups.items()):
            if key[1]:
                scores = self._instance_scores(key[0], labels)
                claims += [(-count, key, instance) for instance, count in scores.items()]
        taken: set[int] = set()
        for _, key, instance in sorted(claims):
            if key not in global_of and instance not in taken:
                global_of[key] = instance
                taken.add(instance)
        for key in sorted(groups):
            if key not in global_of:
                global_of[key] = self._fresh_instance(key[0])
        return global_of

    def _instance_scores(self, class_id: int, labels: list[int]) -> collections.Counter[int]:
        scores: collections.Counter[int] = collections.Counter()
        for label in labels:
            for (c, o), count in self.counts[label].items():
                same = self.pairwise or self.group[c] == self.group[class_id]
                if o and same and self._is_thing(o):
                    scores[o] += count
        return scores

    def _is_thing(self, instance: int) -> bool:
        return instance > 0 and classes()[self.instance_class[instance]].kind == "thing"

    def _fresh_instance(self, class_id: int) -> int:
        self.instance_class.append(class_id)
        self.instance_into.append(len(self.instance_into))
        return len(self.instance_class) - 1

    def _stuff_instance(self, class_id: int) -> int:
        """All of one stuff or layout class is one instance."""
        if class_id in self.instance_class:
            return self.instance_class.index(class_id)
        return self._fresh_instance(class_id)

    def _count_apart(self, instances: set[int]) -> None:
        ordered = sorted(instances)
        for i, a in enumerate(ordered):
            for b in ordered[i + 1 :]:
                self.apart[a, b] = self.apart.get((a, b), 0) + 1

    def _regulate(self, touched: set[int]) -> None:
        """Merge instances that lastingly share geometric labels.

        i and j merge when sum_l min(Phi(l,i), Phi(l,j)) > ratio * min(n_i, n_j) and > min, with
        Phi(l,o) = sum_c Phi(l,c,o) and n = sum_l Phi(l,o). The released code counts associations
        after the first shared one against n_i + n_j; the minimum forgives single wrong frames.
        Instances that were seen as two in one frame more often than that never merge, so the
        classes need not agree (``regulate_classes``): a table that was a counter for some frames
        is one thing, a cup on a table is seen beside it and stays two.
        """
        shared: collections.Counter[tuple[int, int]] = collections.Counter()
        totals: collections.Counter[int] = collections.Counter()
        for counts in self.counts:
            things = self._things(counts)
            for i, (a, n_a) in enumerate(things):
                totals[a] += n_a
                for b, n_b in things[i + 1 :]:
                    shared[a, b] += min(n_a, n_b)
        for (a, b), count in sorted(shared.items()):
            if (a in touched or b in touched) and self._are_one(a, b, count, totals):
                self._merge_instances(a, b)

    def _things(self, counts: Triplets) -> list[tuple[int, int]]:
        """Thing instances of a label and their counts over all classes, ascending."""
        by_instance: collections.Counter[int] = collections.Counter()
        for (_, instance), count in counts.items():
            if self._is_thing(instance):
                by_instance[instance] += count
        return sorted(by_instance.items())

    def _are_one(self, a: int, b: int, shared: int, totals) -> bool:
        groups = (self.group[self.instance_class[o]] for o in (a, b))
        alive = self.instance_into[a] == a and self.instance_into[b] == b
        return (
            alive
            and (self.settings.regulate_classes or len(set(groups)) == 1)
            and shared > self.settings.instance_merge_ratio * min(totals[a], totals[b])
            and shared > max(self.settings.instance_merge_min, self.apart.get((a, b), 0))
        )

    def _merge_instances(self, keep: int, gone: int) -> None:
        self.instance_into = [keep if o == gone else o for o in self.instance_into]
        self.instance_class[gone] = 0
        for counts in self.counts:
            for class_id, instance in [key for key in counts if key[1] == gone]:
                count = counts.pop((class_id, instance))
                counts[class_id, keep] = counts.get((class_id, keep), 0) + count
        moved: dict[tuple[int, int], int] = {}
        for pair, frames in self.apart.items():
            a, b = sorted(keep if o == gone else o for o in pair)
            if a != b:
                moved[a, b] = moved.get((a, b), 0) + frames
        self.apart = moved

    def decide(self, label: int) -> tuple[int, int]:
        """Class and instance of a map label; 0 where undecided.

        The group of classes with the largest count wins (not background), in it the class c and
        the instance o: c = argmax_c sum_o Phi(l, c, o);  o = argmax_o sum_c Phi(l, c, o), if its
        count exceeds ``instance_count_ratio`` of the frames that saw the label otherwise. With
        ``instance_condition="class"`` a group is a class, and this is the paper's rule.
        """
        counts = self.counts[label]
        by_class: collections.Counter[int] = collections.Counter()
        by_group: collections.Counter[int] = collections.Counter()
        for (class_id, _), count in counts.items():
            if class_id:
                by_class[class_id] += count
                by_group[int(self.group[class_id])] += count
        if not by_class:
            return 0, 0
        group = _most(by_group)
        class_id = _most({c: n for c, n in by_class.items() if self.group[c] == group})
        by_instance: collections.Counter[int] = collections.Counter()
        for (c, o), count in counts.items():
            if o and (self.pairwise or self.group[c] == group):
                by_instance[o] += count
        if not by_instance:
            return class_id, 0
        instance = _most(by_instance)
        others = self.frames_seen[label] - by_instance[instance]
        believed = by_instance[instance] > self.settings.instance_count_ratio * others
        return class_id, instance if believed else 0

    def decisions(self) -> tuple[Int[np.ndarray, " labels"], Int[np.ndarray, " labels"]]:
        """Class and instance of every label, merged ones as what they became."""
        found = np.array([self.decide(int(label)) for label in self.canonical], np.int64)
        return found[:, 0], found[:, 1]


def _most(counts: Mapping[int, int]) -> int:
    """The key with the largest count; ties go to the lower key."""
    return min(counts, key=lambda key: (-counts[key], key))


def _groups(condition: str) -> np.ndarray:
    """Group of each class; 0 for background."""
    if condition == "class":
        return np.arange(len(classes()))
    names = [info.match_group for info in classes()]
    return np.array([0] + [1 + names.index(name) for name in names[1:]])


def _frame_instance(segment: int, class_of, instance_of) -> tuple[int, int]:
    """(class, instance in the frame); instance 0 for stuff, (0, 0) for background."""
    class_id, instance = int(class_of[segment]), int(instance_of[segment])
    kind = classes()[class_id].kind
    if kind in ("layout", "stuff"):
        return class_id, 0
    return (class_id, instance) if kind == "thing" and instance else (0, 0)
