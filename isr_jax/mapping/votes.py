"""What a frame's segments are called in the map: votes of the voxels they were seen at."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from itertools import combinations

import numpy as np
from jaxtyping import Int, UInt32

from .association import one_to_one


@dataclasses.dataclass(frozen=True, eq=False)
class Votes:
    """How many voxels of each segment bear each map label: a table in sparse form."""

    segment: Int[np.ndarray, " pairs"]
    label: Int[np.ndarray, " pairs"]
    """Never 0."""
    count: Int[np.ndarray, " pairs"]
    total: Int[np.ndarray, " segments"]
    """Voxels that voted for each segment, those without a label too."""


def count_votes(
    ballots: UInt32[np.ndarray, " ballots"],
    canonical: Int[np.ndarray, " labels"],
    segments: int,
) -> Votes:
    """Tally ballots; merged labels vote for the label they became.

    Args:
        ballots: ``segment * labels + label`` (`ballots.cast_votes`); segment 0 does not vote.
        segments: Their number, 0 included.
    """
    labels = len(canonical)
    cast, often = _counted(ballots, segments * labels)
    voting = cast >= labels
    segment, label = np.divmod(cast[voting], labels)
    found, column = np.unique(canonical[label], return_inverse=True)
    table = np.zeros((segments, len(found)), np.int64)
    np.add.at(table, (segment, column), often[voting])
    columns = np.flatnonzero(found > 0)
    rows, kept = np.nonzero(table[:, columns])
    return Votes(rows, found[columns[kept]], table[rows, columns[kept]], table.sum(1))


def _counted(values, end: int):
    """The values below ``end`` that occur, and how often.

    A table with more entries than there are values takes longer than sorting them, and would make
    the time per frame grow with the labels of the map.
    """
    if end > len(values):
        return np.unique(values, return_counts=True)
    table = np.bincount(values, minlength=end)
    occur = np.flatnonzero(table)
    return occur, table[occur]


def assign_labels(
    votes: Votes, min_votes: int, owner: Sequence[int], how: str = "greedy"
) -> Int[np.ndarray, " segments"]:
    """The map label of each segment; 0 where no label has ``min_votes`` left to give.

    Each label goes to one owner: a segment, or the instance that segments belong to.

    Args:
        votes: Of a frame's segments.
        min_votes: Voxels.
        owner: Number of each segment's owner.
        how: ``greedy`` goes down from the largest count, ties to the lower segment, then to the
            lower label. ``optimal`` maximises the votes of a one-to-one assignment; segments that
            it leaves without a label then take, greedily, what is free or their owner's.
    """
    enough = (votes.count >= min_votes) & (votes.segment > 0)
    pairs = list(zip(votes.segment[enough].tolist(), votes.label[enough].tolist(), strict=True))
    counts = dict(zip(pairs, votes.count[enough].tolist(), strict=True))
    chosen = one_to_one(counts, how) if how == "optimal" else {}
    taken = {label: owner[segment] for segment, label in chosen.items()}
    for segment, label in sorted(counts, key=lambda pair: (-counts[pair], pair)):
        if segment not in chosen and taken.setdefault(label, owner[segment]) == owner[segment]:
            chosen[segment] = label
    label_of = np.zeros(len(votes.total), np.int64)
    label_of[list(chosen)] = list(chosen.values())
    return label_of


def overlapping_pairs(votes: Votes, min_ratio: float) -> list[tuple[int, int]]:
    """Pairs of labels that each hold more than ``min_ratio`` of one segment's voxels."""
    strong = votes.count > min_ratio * votes.total[votes.segment]
    labels_of: dict[int, list[int]] = {}
    for segment, label in zip(votes.segment[strong].tolist(), votes.label[strong].tolist()):
        labels_of.setdefault(segment, []).append(label)
    return sorted({pair for of in labels_of.values() for pair in combinations(sorted(of), 2)})
