"""Labels of the map: triplet counts Phi(l, c, o), merges of labels and of instances.

Phi(l, c, o) counts the frames in which a segment was of geometric label l, class c and instance o
(paper, sec. IV, Data Fusion).

Everything here is small (hundreds of labels), lives on the host, and is deterministic: ties go
to the lower number. ``counts="pairs"`` (Grinvald et al. 2019) walks the same path with pair counts:
Phi(l, 0, o) and Phi(l, c, 0), and so without a class condition on instances.
"""

from __future__ import annotations

import collections
from collections.abc import Mapping

import numpy as np
from jaxtyping import Bool, Int

from ..classes import classes
from ..config import MappingSettings
from ..errors import MapError
from .association import one_to_one
from .instances import Instances
from .pool import LABEL_MASK
from .shares import Shares, Triplets
from .votes import Votes, assign_labels, overlapping_pairs

_NO_INSTANCE = (0, 0)
"""Class and instance of a segment of the background."""


class MapLabels:
    """What is known of every map label and every global instance."""

    def __init__(self, settings: MappingSettings) -> None:
        self.settings = settings
        self.pairwise = settings.counts == "pairs"
        self.instances = Instances(settings)
        self.canonical = np.zeros(1, np.int64)
        """Label -> the label it has become by merges; itself where it has not."""
        self.frames_seen: list[int] = [0]
        self.counts: list[Triplets] = [{}]
        self.pair_frames: dict[tuple[int, int], int] = {}
        """Frames in which two labels claimed the same segment."""
        self.shares = Shares(self.instances.is_thing)

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

        Raises:
            MapError: the map has given as many labels as its voxels can hold.
        """
        owner = self._owners(_frame_instances(class_of, instance_of))
        how = self.settings.association
        label_of = assign_labels(votes, self.settings.min_votes, owner, how)
        for segment in np.flatnonzero(votes.total >= self.settings.min_votes).tolist():
            if segment and not label_of[segment]:
                label_of[segment] = self._fresh_label()
        self._count_overlaps(votes)
        return self.canonical[label_of]

    def _owners(self, instances: list[tuple[int, int]]) -> list[int]:
        """Segments with the same number may take the same label."""
        if not self.settings.share_labels:
            return list(range(len(instances)))
        first: dict[tuple[int, int], int] = {}
        return [
            segment if key == _NO_INSTANCE else first.setdefault(key, segment)
            for segment, key in enumerate(instances)
        ]

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

        Unless ``merge_any_class``, two labels of decided, different classes stay apart whatever
        they share (a depth segment that spans a cup and its table is that frame's error), and so
        do two of instances that were seen as two in as many frames.
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
        if self.settings.merge_any_class:
            return True
        (class_a, instance_a), (class_b, instance_b) = self.decide(a), self.decide(b)
        if class_a and class_b and class_a != class_b:
            return False
        frames_apart = self.instances.frames_apart_of(instance_a, instance_b)
        return frames_apart <= self.settings.merge_min_frames

    def _merge_labels(self, keep: int, gone: int) -> None:
        self.canonical[self.canonical == gone] = keep
        self.frames_seen[keep] += self.frames_seen[gone]
        for key, count in self.counts[gone].items():
            self.counts[keep][key] = self.counts[keep].get(key, 0) + count
        self.frames_seen[gone], self.counts[gone] = 0, {}
        for label in (keep, gone):
            self.shares.rewrite(label, self.counts[label])
        moved: dict[tuple[int, int], int] = {}
        for pair, frames in self.pair_frames.items():
            a, b = sorted(keep if label == gone else label for label in pair)
            if a != b:
                moved[a, b] = max(frames, moved.get((a, b), 0))
        self.pair_frames = moved

    def renumber_merged(self) -> Int[np.ndarray, " labels"] | None:
        """The new number of each label, merged ones as what they became; None if all stay.

        From now on labels bear their new numbers, counted without gaps: those of merged labels
        are given again. The voxels must be renumbered.
        """
        return self._renumber(self.canonical == np.arange(self.label_count))

    def forget(self, leading: Bool[np.ndarray, " labels"]) -> Int[np.ndarray, " labels"] | None:
        """As `renumber_merged`, and labels that lead no voxel become 0.

        Votes are of leading labels, so such a label can be given to no segment again. Segments
        that are cut anew in every frame leave many behind.
        """
        kept = np.zeros(self.label_count, bool)
        kept[self.canonical[leading]] = True
        kept[0] = True
        return self._renumber(kept)

    def _renumber(self, keeps: Bool[np.ndarray, " labels"]) -> Int[np.ndarray, " labels"] | None:
        """Number the labels that are kept without gaps; None if that is all of them."""
        if keeps.all():
            return None
        new = np.where(keeps, np.cumsum(keeps) - 1, 0)[self.canonical]
        kept = np.flatnonzero(keeps).tolist()
        self.canonical = np.arange(len(kept))
        self.frames_seen = [self.frames_seen[label] for label in kept]
        self.counts = [self.counts[label] for label in kept]
        # Numbers keep their order, so a pair stays a pair of a lower and a higher one.
        self.pair_frames = {
            (int(new[a]), int(new[b])): n
            for (a, b), n in self.pair_frames.items()
            if keeps[a] and keeps[b]
        }
        self.shares.renumber(kept)
        return new

    def observe(
        self,
        label_of: Int[np.ndarray, " segments"],
        class_of: Int[np.ndarray, " segments"],
        instance_of: Int[np.ndarray, " segments"],
    ) -> None:
        """Count one frame: Phi(l, c, o) <- Phi(l, c, o) + 1 for each of its segments."""
        labels = label_of.tolist()
        instances = _frame_instances(class_of, instance_of)
        global_of = self._associate(labels, instances)
        touched = set()
        for label, class_id, key in zip(labels, class_of.tolist(), instances, strict=True):
            if not label:
                continue
            self.frames_seen[label] += 1
            instance = global_of.get(key, 0)
            for counted in self._keys(class_id, instance):
                self.counts[label][counted] = self.counts[label].get(counted, 0) + 1
                self.shares.count(label, counted[1])
            touched.add(instance)
        self.instances.count(touched)
        if self.settings.regulate:
            while (pair := self.instances.mergeable_pair(self.shares, touched)) is not None:
                self._merge_instances(*pair)

    def _merge_instances(self, keep: int, gone: int) -> None:
        labels = self.shares.labels_of(gone)
        self.instances.merge(keep, gone, [self.counts[label] for label in labels])
        for label in labels:
            self.shares.rewrite(label, self.counts[label])

    def _keys(self, class_id: int, instance: int) -> list[tuple[int, int]]:
        if not class_id:
            return []
        return [(class_id, 0), (0, instance)] if self.pairwise else [(class_id, instance)]

    def _associate(
        self, labels: list[int], instances: list[tuple[int, int]]
    ) -> dict[tuple[int, int], int]:
        """Frame instances to global ones: the best unassigned of the same class, else fresh."""
        labels_of: dict[tuple[int, int], list[int]] = {}
        for label, key in zip(labels, instances, strict=True):
            if label and key != _NO_INSTANCE:
                labels_of.setdefault(key, []).append(label)
        global_of = {key: self.instances.of_stuff(key[0]) for key in labels_of if key[1] == 0}
        keys, claims = sorted(labels_of), {}
        for row, key in enumerate(keys):
            if key[1]:
                for instance, count in self._instance_scores(key[0], labels_of[key]).items():
                    claims[row, instance] = count
        for row, instance in one_to_one(claims, self.settings.association).items():
            global_of[keys[row]] = instance
        for key in keys:
            if key not in global_of:
                global_of[key] = self.instances.fresh(key[0])
        return global_of

    def _instance_scores(self, class_id: int, labels: list[int]) -> collections.Counter[int]:
        scores: collections.Counter[int] = collections.Counter()
        for label in labels:
            for (c, o), count in self.counts[label].items():
                if o and (self.pairwise or c == class_id) and self.instances.is_thing(o):
                    scores[o] += count
        return scores

    def decide(self, label: int) -> tuple[int, int]:
        """Class and instance of a map label; 0 where undecided.

        c = argmax_c sum_o Phi(l, c, o), background aside;  o = argmax_o Phi(l, c, o), if its count
        exceeds ``instance_count_ratio`` of the frames that saw the label otherwise, and o was seen
        in ``instance_min_frames``. Pair counts hold o for any class.
        """
        counts = self.counts[label]
        by_class: collections.Counter[int] = collections.Counter()
        for (class_id, _), count in counts.items():
            if class_id:
                by_class[class_id] += count
        if not by_class:
            return 0, 0
        class_id = _most(by_class)
        by_instance: collections.Counter[int] = collections.Counter()
        for (c, o), count in counts.items():
            if o and (self.pairwise or c == class_id):
                by_instance[o] += count
        if not by_instance:
            return class_id, 0
        instance = _most(by_instance)
        others = self.frames_seen[label] - by_instance[instance]
        believed = by_instance[instance] > self.settings.instance_count_ratio * others
        lasting = self.instances.frames[instance] >= self.settings.instance_min_frames
        return class_id, instance if believed and lasting else 0

    def decisions(self) -> tuple[Int[np.ndarray, " labels"], Int[np.ndarray, " labels"]]:
        """Class and instance of every label, merged ones as what they became."""
        found = np.array([self.decide(int(label)) for label in self.canonical], np.int64)
        return found[:, 0], found[:, 1]


def _most(counts: Mapping[int, int]) -> int:
    """The key with the largest count; ties go to the lower key."""
    return min(counts, key=lambda key: (-counts[key], key))


def _frame_instances(class_of, instance_of) -> list[tuple[int, int]]:
    """(class, instance in the frame) of each segment; instance 0 for stuff."""
    return [
        _frame_instance(class_id, instance)
        for class_id, instance in zip(class_of.tolist(), instance_of.tolist(), strict=True)
    ]


def _frame_instance(class_id: int, instance: int) -> tuple[int, int]:
    kind = classes()[class_id].kind
    if kind in ("layout", "stuff"):
        return class_id, 0
    return (class_id, instance) if kind == "thing" and instance else _NO_INSTANCE
