"""The table of classes: complete, consistent, and helpful about wrong names."""

from __future__ import annotations

import pytest

from isr_jax.classes import LABEL_SETS, class_named, classes, label_table
from isr_jax.errors import ClassError


def test_rows_are_unique_and_row_zero_is_none():
    names = [info.name for info in classes()]
    assert names[0] == "none" and len(set(names)) == len(names)
    assert [info.id for info in classes()] == list(range(len(names)))


def test_kinds_and_mounts_are_known():
    for info in classes()[1:]:
        assert info.kind in ("thing", "layout", "stuff", "dynamic")
        assert info.mount in ("floor", "surface", "wall", "opening")
        assert info.density_kg_m3 > 0


def test_things_have_a_least_size_and_hung_classes_hang():
    for info in classes():
        assert (info.min_diagonal_m > 0) == (info.kind == "thing")
        if info.hung_class:
            assert class_named(info.hung_class).mount == "wall"


@pytest.mark.parametrize("label_set", LABEL_SETS)
def test_no_foreign_id_means_two_classes(label_set):
    ids = [v for info in classes() for v in info.labels[label_set]]
    assert len(ids) == len(set(ids))
    table = label_table(label_set)
    assert all(table[v] == info.id for info in classes() for v in info.labels[label_set])


@pytest.mark.parametrize(
    ("label_set", "foreign", "name"),
    [
        ("coco80", 56, "chair"),
        ("coco80", 60, "table"),
        ("coco80", 62, "monitor"),
        ("coco80", 41, "cup"),
        ("coco_panoptic", 190, "floor"),
        ("coco_panoptic", 188, "cabinet"),
        ("ade20k", 4, "floor"),
        ("ade20k", 34, "desk"),
        ("ade32", 16, "table"),
        ("nyu40", 24, "fridge"),
    ],
)
def test_well_known_ids(label_set, foreign, name):
    assert label_table(label_set)[foreign] == class_named(name).id


def test_an_unknown_class_names_the_nearest():
    with pytest.raises(ClassError, match="chair"):
        class_named("chiar")


def test_an_unknown_label_set_names_the_known_ones():
    with pytest.raises(ClassError, match="coco80"):
        label_table("imagenet")
