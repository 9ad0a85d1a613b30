"""What a frame's segments are called in the map: votes of the voxels they were seen at."""

from __future__ import annotations

import dataclasses

import numpy as np
from jaxtyping import Int, UInt32

from .pool import LABEL_BITS, LABEL_MASK


@dataclasses.dataclass(frozen=True, eq=False)
class Votes:
    """How many voxels of each segment bear each map label: a table in sparse form."""

    segment: Int[np.ndarray, " pairs"]
    label: Int[np.ndarray, " pairs"]
    """Never 0."""
    count: Int[np.ndarray, " pairs"]
    total: Int[np.ndarray, " segments"]
    """Voxels that voted, a segment, those without a label too."""


def count_votes(
    hits: UInt32[np.ndarray, "blocks 512"], canonical: Int[np.ndarray, " labels"], segments: int
) -> Votes:
    """Tally `fuse.fuse_frame`'s hits; merged labels vote for the label they became."""
    flat = hits.reshape(-1)
    flat = flat[(flat & LABEL_MASK) != LABEL_MASK]
    segment = (flat >> LABEL_BITS).astype(np.intp)
    label = canonical[flat & LABEL_MASK]
    present = np.zeros(len(canonical), bool)
    present[label] = True
    found = np.flatnonzero(present)
    place = np.zeros(len(canonical), np.intp)
    place[found] = np.arange(len(found))
    width = max(len(found), 1)
    table = np.bincount(segment * width + place[label], minlength=segments * width)
    table = table.reshape(segments, width)
    total = table.sum(1)
    columns = np.flatnonzero(found > 0)
    rows, kept = np.nonzero(table[:, columns])
    return Votes(rows, found[columns[kept]], table[rows, columns[kept]], total)


def assign_labels(
    votes: Votes, min_votes: int, owner: Int[np.ndarray, " segments"]
) -> Int[np.ndarray, " segments"]:
    """The map label of each segment; 0 where no label has ``min_votes`` left to give.

    Greedy from the largest count, each label to one owner; ties go to the lower segment, then to
    the lower label. Owners are segments, or the instances that segments belong to.
    """
    label_of = np.zeros(len(votes.total), np.int64)
    taken: dict[int, int] = {}
    for i in np.lexsort((votes.label, votes.segment, -votes.count)):
        segment, label = int(votes.segment[i]), int(votes.label[i])
        if votes.count[i] < min_votes:
            break
        free = segment > 0 and not label_of[segment]
        if free and taken.setdefault(label, int(owner[segment])) == owner[segment]:
            label_of[segment] = label
    return label_of


def overlapping_pairs(votes: Votes, min_ratio: float) -> list[tuple[int, int]]:
    """Pairs of labels that each hold more than ``min_ratio`` of one segment's voxels."""
    strong = votes.count > min_ratio * votes.total[votes.segment]
    pairs: set[tuple[int, int]] = set()
    for segment in np.unique(votes.segment[strong]):
        labels = sorted(votes.label[strong & (votes.segment == segment)].tolist())
        pairs.update((a, b) for i, a in enumerate(labels) for b in labels[i + 1 :])
    return sorted(pairs)
