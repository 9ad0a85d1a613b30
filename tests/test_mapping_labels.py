"""Labels of the map: votes, triplet counts, merges of labels, regulation of instances."""

from __future__ import annotations

import dataclasses
import itertools

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from isr_jax.classes import class_named
from isr_jax.config import MappingSettings
from isr_jax.mapping.association import one_to_one
from isr_jax.mapping.labels import MapLabels
from isr_jax.mapping.votes import Votes, assign_labels, count_votes, overlapping_pairs

CHAIR, TABLE, DESK, FLOOR = (class_named(n).id for n in ("chair", "table", "desk", "floor"))
SETTINGS = MappingSettings(min_votes=5, instance_min_frames=1)


def votes_of(table) -> Votes:
    """From a dense [segments, labels] table; column 0 is voxels without a label."""
    table = np.asarray(table)
    segment, label = np.nonzero(table[:, 1:])
    return Votes(segment, label + 1, table[segment, label + 1], table.sum(1))


def observe(labels, label_of, class_of, instance_of):
    labels.observe(np.array([0, *label_of]), np.array([0, *class_of]), np.array([0, *instance_of]))


def name(labels, table, class_of=None, instance_of=None):
    nothing = np.zeros(len(table), np.int32)
    return labels.name_segments(
        votes_of(table),
        nothing if class_of is None else np.array(class_of),
        nothing if instance_of is None else np.array(instance_of),
    )


def with_labels(count, **changes) -> MapLabels:
    labels = MapLabels(dataclasses.replace(SETTINGS, **changes))
    for _ in range(count):
        labels._fresh_label()
    return labels


def test_votes_are_counted_and_merged_labels_vote_for_what_they_became():
    became = np.array([0, 1, 2, 3, 4, 2])
    cast = [(3, 2)] * 7 + [(3, 5)] * 4 + [(1, 0)] * 5 + [(0, 0)] * 3  # segment 0: no vote
    ballots = np.array([segment * len(became) + label for segment, label in cast], np.uint32)
    votes = count_votes(ballots, became, 4)
    assert votes.total.tolist() == [0, 5, 0, 11]
    assert [(s, l, c) for s, l, c in zip(votes.segment, votes.label, votes.count)] == [(3, 2, 11)]


def test_votes_are_counted_alike_in_a_map_of_few_labels_and_of_many():
    rng = np.random.default_rng(0)
    segment, label = rng.integers(0, 40, 5000), rng.integers(0, 100, 5000)

    def counted(labels):
        became = np.where(np.arange(labels) < 100, np.maximum(np.arange(labels) - 7, 0), 0)
        return count_votes((segment * labels + label).astype(np.uint32), became, 40)

    few, many = counted(100), counted(3000)
    for field in ("segment", "label", "count", "total"):
        assert np.array_equal(getattr(few, field), getattr(many, field))
    assert few.total.sum() == (segment > 0).sum()


@settings(max_examples=50, deadline=None)
@given(
    st.lists(st.lists(st.integers(0, 60), min_size=6, max_size=6), min_size=1, max_size=6),
    st.integers(1, 30),
)
def test_assignment_is_one_to_one_and_respects_the_minimum(table, least):
    votes = votes_of([[0] * 6, *table])
    label_of = assign_labels(votes, least, range(len(table) + 1))
    given_out = label_of[label_of > 0]
    assert len(set(given_out)) == len(given_out)
    for segment, label in enumerate(label_of):
        if label:
            assert table[segment - 1][label] >= least
        else:  # whatever it could have had, another took
            strong = [l for l in range(1, 6) if segment and table[segment - 1][l] >= least]
            assert set(strong) <= set(given_out.tolist())


def test_a_small_segment_gets_no_label_and_a_large_one_a_fresh_one():
    labels = with_labels(1)
    label_of = name(labels, [[0, 0], [4, 0], [50, 0], [3, 40]])
    assert label_of.tolist() == [0, 0, 2, 1]


def test_labels_that_share_a_segment_merge_after_enough_frames():
    labels = with_labels(2, merge_min_frames=3)
    for frame in range(4):
        assert labels.canonical[2] == 2, frame
        label_of = name(labels, [[0, 0, 0], [0, 60, 40]])
    assert labels.canonical.tolist() == [0, 1, 1]
    assert label_of[1] == 1


def test_a_rim_of_another_label_is_no_overlap():
    assert overlapping_pairs(votes_of([[0, 0, 0], [0, 85, 15]]), 0.2) == []
    assert overlapping_pairs(votes_of([[0, 0, 0], [0, 75, 25]]), 0.2) == [(1, 2)]


def test_labels_of_different_classes_merge_only_where_it_is_asked_for():
    for merged in (False, True):
        labels = with_labels(2, merge_any_class=merged, merge_min_frames=1)
        for _ in range(3):
            observe(labels, [1, 2], [TABLE, CHAIR], [1, 2])
        for _ in range(5):
            name(labels, [[0, 0, 0], [0, 60, 40]])
        assert (labels.canonical[2] == 1) == merged


def test_a_frame_instance_keeps_its_global_instance():
    labels = with_labels(3)
    for frame_instance in (4, 9, 2):  # ids within a frame mean nothing
        observe(labels, [1, 2, 3], [CHAIR, CHAIR, CHAIR], [frame_instance, frame_instance, 30])
    (_, a), (_, b), (_, c) = (labels.decide(label) for label in (1, 2, 3))
    assert a == b != c


def test_one_global_instance_goes_to_one_frame_instance():
    labels = with_labels(2)
    observe(labels, [1, 2], [CHAIR, CHAIR], [1, 1])
    observe(labels, [1, 2], [CHAIR, CHAIR], [1, 2])
    assert len(labels.instances.class_of) == 3  # none, the first, and a fresh one


def test_all_of_a_stuff_class_is_one_instance():
    labels = with_labels(3)
    observe(labels, [1, 2, 3], [FLOOR, FLOOR, FLOOR], [1, 2, 3])
    assert {labels.decide(label) for label in (1, 2, 3)} == {(FLOOR, 1)}


def test_segments_of_one_instance_may_share_a_label():
    table = [[0, 0], [0, 60], [0, 40]]
    chair = ([0, CHAIR, CHAIR], [0, 7, 7])
    assert name(with_labels(1), table, *chair).tolist() == [0, 1, 1]
    assert name(with_labels(1, share_labels=False), table, *chair).tolist() == [0, 1, 2]
    assert name(with_labels(1), table, [0, CHAIR, CHAIR], [0, 7, 8]).tolist() == [0, 1, 2]
    assert name(with_labels(1), table).tolist() == [0, 1, 2]  # background


def test_an_instance_must_last():
    labels = with_labels(1, instance_min_frames=3)
    for frame in range(3):
        assert labels.decide(1) == ((CHAIR, 0) if frame else (0, 0))
        observe(labels, [1], [CHAIR], [1])
    assert labels.decide(1) == (CHAIR, 1)


def test_a_table_that_is_called_a_desk_now_and_then_is_one_table():
    labels = with_labels(2)
    for frame in range(9):
        observe(labels, [1, 2], [DESK if frame % 3 == 0 else TABLE] * 2, [1, 1])
    assert labels.decide(1) == labels.decide(2)
    assert labels.decide(1)[0] == TABLE


def test_a_thing_of_two_classes_is_one_unless_seen_as_two():
    for beside, merged in ((False, True), (True, False)):
        labels = with_labels(2)
        for _ in range(20):
            observe(labels, [1, 2], [TABLE, 0], [1, 0])
        for _ in range(15):
            observe(labels, [1, 2], [CHAIR, CHAIR], [1, 1])
        for _ in range(16):
            observe(labels, [1, 2], [TABLE, CHAIR if beside else 0], [1, 2])
        assert (labels.decide(1)[1] == labels.decide(2)[1]) == merged, beside


def test_triplets_hold_class_and_instance_together():
    """10 frames table, 6 frames chair: the instance is that of the table, not the most frequent.

    Pair counts may pair the class with an instance that was never of it.
    """
    labels = with_labels(1)
    for frame in range(10):
        observe(labels, [1], [TABLE], [1])
        if frame < 6:
            observe(labels, [1], [CHAIR], [1])
    class_id, instance = labels.decide(1)
    assert class_id == TABLE and labels.instances.class_of[instance] == TABLE


def test_an_instance_that_is_rarely_seen_is_not_believed():
    labels = with_labels(1)
    observe(labels, [1], [CHAIR], [1])
    assert labels.decide(1) == (CHAIR, 1)
    for _ in range(12):
        observe(labels, [1], [0], [0])
    assert labels.decide(1) == (CHAIR, 0)


def test_instances_that_lastingly_share_labels_merge():
    """A chair met from two sides gets two instances; then both sides are seen as one."""
    labels = with_labels(2)
    for _ in range(30):
        observe(labels, [1], [CHAIR], [1])
    for _ in range(15):
        observe(labels, [2], [CHAIR], [1])
    assert labels.decide(1)[1] != labels.decide(2)[1]
    for _ in range(14):
        observe(labels, [1, 2], [CHAIR, CHAIR], [1, 1])
    assert labels.decide(1)[1] == labels.decide(2)[1] == 1
    assert labels.counts[2] == {(CHAIR, 1): 29}


def test_two_chairs_seen_as_two_never_merge():
    """As above, but other frames show them side by side."""
    labels = with_labels(2)
    for _ in range(40):
        observe(labels, [1, 2], [CHAIR, CHAIR], [1, 2])
    for _ in range(39):
        observe(labels, [1, 2], [CHAIR, CHAIR], [1, 1])
    assert labels.decide(1)[1] != labels.decide(2)[1]


def test_without_regulation_instances_stay():
    labels = with_labels(2, regulate=False)
    for _ in range(30):
        observe(labels, [1], [CHAIR], [1])
    for _ in range(15):
        observe(labels, [2], [CHAIR], [1])
    for _ in range(14):
        observe(labels, [1, 2], [CHAIR, CHAIR], [1, 1])
    assert labels.decide(1) == (CHAIR, 1) and labels.decide(2) == (CHAIR, 2)


def test_labels_of_things_seen_as_two_stay_two():
    """Doors of two cabinets in one plane: a depth segment that spans them is no reason."""
    for beside, merged in ((0, True), (4, False)):
        labels = with_labels(2, merge_min_frames=3)
        for _ in range(10):
            observe(labels, [1], [CHAIR], [1])
        for _ in range(10):
            observe(labels, [2], [CHAIR], [1])
        for _ in range(beside):
            observe(labels, [1, 2], [CHAIR, CHAIR], [1, 2])
        for _ in range(5):
            name(labels, [[0, 0, 0], [0, 60, 40]])
        assert (labels.canonical[2] == 1) == merged


def test_merged_labels_give_their_numbers_back():
    labels = with_labels(5)
    for label in range(1, 6):
        for _ in range(label):
            observe(labels, [label], [TABLE], [1])
    labels._merge_labels(2, 4)
    seen = list(labels.frames_seen)
    decided = labels.decisions()
    new = labels.renumber_merged()
    assert new is not None and new.tolist() == [0, 1, 2, 3, 2, 4]
    assert labels.label_count == 5 and labels.frames_seen == [seen[i] for i in (0, 1, 2, 3, 5)]
    for before, after in zip(decided, labels.decisions(), strict=True):
        assert np.array_equal(before, after[new])
    assert labels._fresh_label() == 5, "the number is given again"
    assert labels.renumber_merged() is None


def test_optimal_assignment_gives_the_most_votes():
    """Greedy takes 60 and leaves 10; the best sum is 50 + 55."""
    votes = votes_of([[0, 0, 0], [0, 60, 55], [0, 50, 10]])
    owner = range(3)
    assert assign_labels(votes, 5, owner).tolist() == [0, 1, 2]
    assert assign_labels(votes, 5, owner, "optimal").tolist() == [0, 2, 1]


@settings(max_examples=50, deadline=None)
@given(table=arrays(np.int64, (4, 5), elements=st.integers(0, 9)))
def test_one_to_one_is_the_best_of_all(table):
    """Against all permutations."""
    counts = {(i, j): int(n) for (i, j), n in np.ndenumerate(table) if n}
    best = max(sum(table[i, p[i]] for i in range(4)) for p in itertools.permutations(range(5), 4))
    found = one_to_one(counts, "optimal")
    assert len(set(found.values())) == len(found)
    assert sum(counts[pair] for pair in found.items()) == best
    greedy = one_to_one(counts, "greedy")
    assert len(set(greedy.values())) == len(greedy)
    assert sum(counts[pair] for pair in greedy.items()) <= best


MERGES = st.lists(
    st.tuples(st.sampled_from(["labels", "instances"]), st.integers(1, 5), st.integers(1, 5)),
    max_size=4,
)


@settings(max_examples=60, deadline=None)
@given(steps=st.lists(st.tuples(st.integers(1, 5), st.integers(1, 5)), max_size=60), merges=MERGES)
def test_shares_kept_up_to_date_are_those_of_the_counts(steps, merges):
    """Against the definition, summed over all labels; after merges and new numbers too."""
    labels = with_labels(5)
    things = [labels.instances.fresh(CHAIR) for _ in range(5)]
    for label, which in steps:
        key = CHAIR, things[which - 1]
        labels.counts[label][key] = labels.counts[label].get(key, 0) + 1
        labels.shares.count(label, key[1])
    assert_shares(labels, things)
    for what, a, b in merges:
        keep, gone = sorted((a, b))
        if what == "labels" and {keep, gone} <= set(labels.canonical.tolist()) and keep != gone:
            labels._merge_labels(keep, gone)
        one, other = things[keep - 1], things[gone - 1]
        both_left = labels.instances.is_thing(one) and labels.instances.is_thing(other)
        if what == "instances" and keep != gone and both_left:
            labels._merge_instances(one, other)
        assert_shares(labels, things)
    labels.renumber_merged()
    assert_shares(labels, things)
    labels.forget(np.arange(labels.label_count) != 1)
    assert_shares(labels, things)


def assert_shares(labels, things):
    phi = np.zeros((labels.label_count, len(things)), int)
    for label, triplets in enumerate(labels.counts):
        for (_, instance), n in triplets.items():
            phi[label, things.index(instance)] += n
    for (a, one), (b, other) in itertools.combinations(enumerate(things), 2):
        wanted = np.minimum(phi[:, a], phi[:, b]).sum()
        assert labels.shares.shared.get(one, {}).get(other, 0) == wanted
    assert [labels.shares.total[o] for o in things] == phi.sum(0).tolist()


def test_labels_that_lead_no_voxel_are_forgotten():
    labels = with_labels(5)
    for label in range(1, 6):
        observe(labels, [label], [TABLE], [1])
    labels._merge_labels(2, 4)
    labels.pair_frames = {(1, 3): 1, (3, 5): 2}
    leading = np.array([True, False, False, True, True, True])  # 4 is 2 by now
    new = labels.forget(leading)
    assert new is not None and new.tolist() == [0, 0, 1, 2, 1, 3]
    assert labels.label_count == 4 and labels.pair_frames == {(2, 3): 2}
    assert labels.forget(np.ones(4, bool)) is None
