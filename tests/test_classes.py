"""The table of classes: complete, consistent, and helpful about wrong names."""

from __future__ import annotations

import sys
from typing import get_args

import pytest

from isr_jax import cli
from isr_jax.classes import ClassKind, Mount, class_named, classes, label_table
from isr_jax.classes.label_lists import LABEL_SETS, label_list
from isr_jax.datasets.annotation_names import NYU40_NAMES
from isr_jax.errors import ClassError


def test_rows_are_unique_and_row_zero_is_none():
    names = [info.name for info in classes()]
    assert names[0] == "none" and len(set(names)) == len(names)
    assert [info.id for info in classes()] == list(range(len(names)))


def test_kinds_and_mounts_are_known():
    assert classes()[0].kind == "none"
    for info in classes()[1:]:
        assert info.kind in set(get_args(ClassKind)) - {"none"}
        assert info.mount in get_args(Mount)
        assert info.density_kg_m3 > 0


def test_things_have_a_least_size_and_hung_classes_hang():
    for info in classes():
        assert (info.min_diagonal_m > 0) == (info.kind == "thing")
        if info.hung_class:
            assert class_named(info.hung_class).mount == "wall"


@pytest.mark.parametrize("label_set", LABEL_SETS)
def test_every_official_label_is_one_class_or_listed_as_none(label_set):
    """The row "none" of the table lists what no class stands for: nothing is silently missing."""
    official = [label.id for label in label_list(label_set)]
    placed = [v for info in classes() for v in info.labels[label_set]]
    assert sorted(placed) == sorted(official), "each in one row, none twice, none unknown"
    table = label_table(label_set)
    assert all(table[v] == info.id for info in classes() for v in info.labels[label_set])


OFFICIAL = {
    "coco80": (80, 80, ((0, "person"), (56, "chair"), (79, "toothbrush"))),
    "coco_panoptic": (133, 80, ((1, "person"), (118, "floor-wood"), (200, "rug-merged"))),
    "ade20k": (150, 100, ((1, "wall"), (64, "blind"), (100, "buffet"), (150, "flag"))),
    "ade32": (32, 14, ((0, "other"), (16, "table"), (31, "armchair"))),
    "nyu40": (40, 37, ((1, "wall"), (24, "refridgerator"), (40, "otherprop"))),
    "scannet": (20, 18, ((1, "wall"), (28, "shower curtain"), (39, "otherfurniture"))),
    "scannet200": (200, 198, ((2, "chair"), (1169, "trash bin"), (1191, "mattress"))),
    "scenenn": (40, 37, ((1, "wall"), (32, "night stand"), (40, "otherprop"))),
}
"""How many labels and how many things each set has, and some of them."""


def names_of(label_set: str) -> dict[int, str]:
    return {label.id: label.name for label in label_list(label_set)}


@pytest.mark.parametrize("label_set", LABEL_SETS)
def test_the_official_lists(label_set):
    count, things, some = OFFICIAL[label_set]
    labels, names = label_list(label_set), names_of(label_set)
    assert len(labels) == len(names) == len(set(names.values())) == count
    assert sum(label.is_thing for label in labels) == things
    assert list(names) == sorted(names), "in the order of their ids"
    assert all(names[id] == name for id, name in some)


def test_the_lists_agree_with_each_other():
    """COCO's 80 are the things of its panoptic list, ScanNet's 20 are NYU40's, and so on."""
    things = [v.name for v in label_list("coco_panoptic") if v.is_thing]
    assert things == [v.name for v in label_list("coco80")]
    assert dict(enumerate(NYU40_NAMES, 1)) == names_of("nyu40") == names_of("scenenn")
    nyu40 = names_of("nyu40") | {24: "refrigerator"}
    assert names_of("scannet").items() <= nyu40.items()
    ade20k = names_of("ade20k") | {0: "other", 9: "window"}
    assert all(ade20k[id] == name for id, name in names_of("ade32").items())


@pytest.mark.parametrize("label_set", LABEL_SETS)
def test_one_word_is_one_class_in_every_set(label_set):
    """A label called as one of our classes is that class."""
    ours = {info.name.replace("_", " "): info.id for info in classes()[1:] if info.name != "other"}
    table = label_table(label_set)
    for label in label_list(label_set):
        if label.name in ours:
            assert table[label.id] == ours[label.name], label


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
        ("scannet", 24, "fridge"),
        ("scannet200", 10, "chair"),
        ("scannet200", 1191, "bed"),
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


def printed(monkeypatch, capsys, *arguments: str) -> tuple[int, str]:
    monkeypatch.setattr(sys, "argv", ["isr", "classes", *arguments])
    monkeypatch.setenv("COLUMNS", "200")
    try:
        cli.main()
    except SystemExit as stop:
        return int(stop.code or 0), "".join(capsys.readouterr())
    return 0, "".join(capsys.readouterr())


@pytest.mark.parametrize("label_set", LABEL_SETS)
def test_the_command_prints_what_each_label_is(monkeypatch, capsys, label_set):
    status, text = printed(monkeypatch, capsys, label_set)
    assert status == 0 and f"{len(label_list(label_set))} labels" in text
    assert all(label.name in text for label in label_list(label_set))


def test_the_command_prints_our_classes(monkeypatch, capsys):
    status, text = printed(monkeypatch, capsys)
    assert status == 0 and all(info.name in text for info in classes()[1:])
    status, text = printed(monkeypatch, capsys, "imagenet")
    assert status == 2 and "scannet200" in text
