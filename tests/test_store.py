"""Stored stage results: round trips, keys, damage."""

from __future__ import annotations

import dataclasses
import os

import jax.numpy as jnp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from isr_jax.config import MatchingSettings, Settings
from isr_jax.errors import OutputError
from isr_jax.runtime.store import StageStore, content_hash
from isr_jax.types import Box, Candidate, ContactGraph, Entities, Mesh, Placement

from .builders import box_entity, floor_entity, library_of, scene_of, table_model


@pytest.fixture
def store(tmp_path) -> StageStore:
    return StageStore(tmp_path / "stages")


def same(a, b) -> bool:
    """Deep equality with types, dtypes and shapes."""
    if dataclasses.is_dataclass(a):
        names = [f.name for f in dataclasses.fields(a)]
        return type(a) is type(b) and all(same(getattr(a, n), getattr(b, n)) for n in names)
    if isinstance(a, np.ndarray) or hasattr(a, "devices"):
        left, right = np.asarray(a), np.asarray(b)
        return (
            left.dtype == right.dtype
            and left.shape == right.shape
            and left.tobytes() == right.tobytes()
        )
    if isinstance(a, (tuple, list)):
        return type(a) is type(b) and len(a) == len(b) and all(map(same, a, b))
    if isinstance(a, dict):
        return isinstance(b, dict) and list(a) == list(b) and all(same(a[k], b[k]) for k in a)
    return type(a) is type(b) and (a == b or a != a)


def round_trip(store, value):
    key = store.key("stage", 1, {"a": 1}, {})
    store.save("stage", key, value)
    return store.load("stage", key, type(value))


def graph() -> ContactGraph:
    return ContactGraph(
        parent=np.array([-1, 0], np.int32),
        support_plane=np.array([-1, 0], np.int32),
        score=np.array([0, 0.75], np.float32),
        attachment=("none", "none"),
        refined_box=Box(jnp.zeros((2, 3)), jnp.zeros(2), jnp.ones((2, 3))),
        support_height_m=np.array([-0.5, 0.25], np.float32),
        proximal=np.zeros((0, 2), np.int32),
        proximal_depth_m=np.zeros(0, np.float32),
    )


def placement() -> Placement:
    lost = Candidate("table/a", 3, 0.5, float("inf"), "at bound", "penetrates wall_2")
    return Placement(7, None, None, None, None, None, (lost,), "nothing fits")


@pytest.mark.parametrize(
    "value",
    [
        scene_of(floor_entity(), box_entity(2, "table", (0, 0, 0.4), (1.2, 0.8, 0.8), yaw=0.2)),
        graph(),
        (placement(), placement()),
        table_model().robot,
        Mesh(np.zeros((0, 3), np.float32), np.zeros((0, 3), np.int32)),
        {"a": [1, 2.5, None, True, "x"], 3: (float("nan"), -float("inf"), np.float32(1.5))},
        (np.array(True), np.zeros((0, 4), bool), np.array(3, np.int64), np.arange(6)[::2]),
    ],
    ids=["entities", "graph", "placements", "robot", "empty mesh", "plain", "arrays"],
)
def test_round_trip_gives_the_same_tree(store, value):
    assert same(round_trip(store, value), value)


def test_a_library_is_named_by_its_hash_and_never_stored(store):
    with pytest.raises(TypeError, match="partial"):
        content_hash(library_of(table_model()))


@settings(max_examples=30, deadline=None)
@given(
    array=hnp.arrays(
        st.sampled_from([np.float32, np.float64, np.int32, np.uint8, np.bool_]),
        hnp.array_shapes(min_dims=0, max_dims=3, min_side=0, max_side=4),
    ),
    number=st.floats(),
    text=st.text(),
)
def test_any_leaf_survives(tmp_path_factory, array, number, text):
    store = StageStore(tmp_path_factory.getbasetemp() / "leaf_store")
    value = (array, {text: number})
    assert same(round_trip(store, value), value)


def test_content_hash_is_of_content_alone():
    box = box_entity(2, "table", (0, 0, 0.4), (1.2, 0.8, 0.8)).box
    on_device = Box(*(jnp.asarray(v) for v in (box.center, box.yaw, box.size)))
    assert content_hash(box) == content_hash(on_device)
    grown = Box(box.center, box.yaw, box.size * np.float32(1 + 1e-6))
    assert content_hash(box) != content_hash(grown)


@pytest.mark.parametrize(
    ("a", "b"),
    [
        ((1, 2), [1, 2]),
        ((1, (2,)), ((1,), 2)),
        ("1", 1),
        (True, 1),
        (np.zeros((2, 3)), np.zeros((3, 2))),
        (np.zeros(2, np.float32), np.zeros(1, np.float64)),
        (("ab", "c"), ("a", "bc")),
        ({"a": None}, {}),
    ],
)
def test_content_hash_tells_structure_apart(a, b):
    assert content_hash(a) != content_hash(b)


def test_equal_results_are_equal_files(tmp_path):
    stores = StageStore(tmp_path / "a"), StageStore(tmp_path / "b")
    for store in stores:
        store.save("graph", store.key("graph", 1, {}, {}), graph())
    for name in ("graph.npz", "graph.json"):
        assert (tmp_path / "a" / name).read_bytes() == (tmp_path / "b" / name).read_bytes()


def test_another_key_finds_nothing_and_says_what_differs(store):
    key = store.key("matching", 1, MatchingSettings(), {"entities": "aa"})
    assert store.load("matching", key, ContactGraph) is None
    assert "nothing is stored" in store.explain("matching", key)
    stored = store.save("matching", key, graph())
    assert store.stored_hash("matching", key) == stored == content_hash(graph())
    assert "matches" in store.explain("matching", key)

    other = store.key("matching", 2, MatchingSettings(weight_size=3.0), {"entities": "bb"})
    assert store.load("matching", other, ContactGraph) is None
    assert store.stored_hash("matching", other) is None
    text = store.explain("matching", other)
    assert "version: stored 1, now 2" in text
    assert "setting weight_size: stored 1.0, now 3.0" in text
    assert "input entities: stored aa, now bb" in text
    assert "weight_planes" not in text


def test_key_takes_nested_settings_and_ignores_their_order(store):
    whole = store.key("all", 1, Settings(), {"a": "1", "b": "2"})
    assert whole.digest == store.key("all", 1, Settings(), {"b": "2", "a": "1"}).digest
    nested = dataclasses.replace(Settings(), matching=MatchingSettings(shortlist=3))
    assert whole.digest != store.key("all", 1, nested, {"a": "1", "b": "2"}).digest


@pytest.mark.parametrize("name", ["stage.npz", "stage.json"])
@pytest.mark.parametrize("damage", ["cut", "flip", "empty"])
def test_damage_is_named(store, name, damage):
    key = store.key("stage", 1, {}, {})
    store.save("stage", key, (np.arange(1000, dtype=np.float32), 12345.678))
    path = store.root / name
    data = bytearray(path.read_bytes())
    if damage == "flip" and name == "stage.json":
        data = data.replace(b"12345.678", b"12345.679")
    elif damage == "flip":
        data[len(data) // 2] ^= 0xFF
    path.write_bytes({"cut": data[: len(data) // 2], "flip": data, "empty": b""}[damage])
    with pytest.raises(OutputError, match=r"--from") as error:
        store.load("stage", key, tuple)
    assert str(store.root) in str(error.value)


def test_killed_between_two_files_is_no_result(store):
    old, new = store.key("stage", 1, {"a": 1}, {}), store.key("stage", 1, {"a": 2}, {})
    store.save("stage", new, (np.ones(3),))
    arrays = (store.root / "stage.npz").read_bytes()
    store.save("stage", old, (np.zeros(3),))
    (store.root / "stage.npz").write_bytes(arrays)
    assert store.load("stage", old, tuple) is None
    assert store.load("stage", new, tuple) is None


def test_failed_save_leaves_the_old_result_and_no_litter(store):
    key = store.key("stage", 1, {}, {})
    store.save("stage", key, (np.ones(3),))
    before = sorted(os.listdir(store.root))
    with pytest.raises(TypeError, match="object"):
        store.save("stage", key, (object(),))
    assert sorted(os.listdir(store.root)) == before
    loaded = store.load("stage", key, tuple)
    assert loaded is not None
    np.testing.assert_array_equal(loaded[0], np.ones(3))


def test_a_file_in_the_way_is_named(tmp_path):
    (tmp_path / "taken").write_text("")
    with pytest.raises(OutputError, match=r"taken.*cannot be written"):
        StageStore(tmp_path / "taken")


def test_only_own_classes_are_made(store):
    key = store.key("stage", 1, {}, {})
    store.save("stage", key, placement())
    path = store.root / "stage.json"
    path.write_text(path.read_text().replace("types.Placement", "os.system"))
    with pytest.raises(OutputError, match="damaged"):
        store.load("stage", key, Placement)


def test_wrong_type_is_refused(store):
    key = store.key("stage", 1, {}, {})
    store.save("stage", key, (1, 2))
    with pytest.raises(OutputError):
        store.load("stage", key, Entities)
