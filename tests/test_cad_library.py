"""A library on disk: exact both ways, the same bytes, fast, and clear about what is wrong."""

from __future__ import annotations

import json
import logging
import re
import time
from pathlib import Path

import numpy as np
import pytest

from isr_jax.cad import build_library, default_library, library, load_library, save_model
from isr_jax.cad.kit import make
from isr_jax.errors import LibraryError, OutputError
from isr_jax.library import CadModel

from .conftest import REPOSITORY
from .test_robot_model_urdf import assert_same_mesh, assert_same_robot

IDS = ("cabinet/base_40", "chair/ladder_42", "cup/mug", "fridge/mini_48", "table/round_90")


@pytest.fixture(scope="module")
def kit_root(tmp_path_factory) -> Path:
    root = tmp_path_factory.mktemp("library")
    build_library(root, ids=IDS)
    return root


@pytest.fixture
def root(tmp_path) -> Path:
    """A library of two models that a test may break."""
    build_library(tmp_path / "cad", ids=("cup/mug", "table/round_90"))
    return tmp_path / "cad"


def contents(root: Path) -> dict[str, bytes]:
    return {p.relative_to(root).as_posix(): p.read_bytes() for p in root.rglob("*") if p.is_file()}


def assert_same_model(a: CadModel, b: CadModel) -> None:
    fields = ("id", "class_name", "plane_link", "symmetry", "mount", "licence", "content_hash")
    for field in fields:
        assert getattr(a, field) == getattr(b, field), field
    np.testing.assert_array_equal(a.size, b.size)
    np.testing.assert_array_equal(a.plane_supporting, b.plane_supporting)
    for name in ("normal", "offset", "corners", "area_m2", "valid"):
        np.testing.assert_array_equal(getattr(a.planes, name), getattr(b.planes, name))
    assert_same_mesh(a.mesh, b.mesh)
    assert_same_robot(a.robot, b.robot)


def test_what_is_saved_loads_equal(kit_root):
    loaded = load_library(kit_root)
    assert [m.id for m in loaded.models] == sorted(IDS)
    for cad_id in IDS:
        assert_same_model(loaded.by_id(cad_id), make(cad_id))


def test_same_bytes_twice_whatever_else_is_built(kit_root, tmp_path):
    again = build_library(tmp_path / "a", ids=IDS[::-1])
    build_library(tmp_path / "b", ids=IDS[:2])
    whole = contents(kit_root)
    assert contents(tmp_path / "a") == whole
    part = contents(tmp_path / "b")
    assert part == {name: whole[name] for name in part} and part
    assert again.content_hash == load_library(kit_root).content_hash


def test_content_hash_follows_content(kit_root):
    model = make("cup/mug")
    other = make("cup/mug_large")
    assert model.content_hash != other.content_hash
    assert load_library(kit_root).by_id("cup/mug").content_hash == model.content_hash


def test_progress_is_told(tmp_path):
    told = []
    build_library(tmp_path, lambda done, total: told.append((done, total)), ids=IDS[1:3])
    assert told == [(1, 2), (2, 2)]


def test_the_default_library_loads_at_once():
    first = load_library(REPOSITORY / "cad_db")
    start = time.process_time()
    again = load_library(REPOSITORY / "cad_db")
    # 0.03 s measured for 500 models, without the checks of shapes that tests run under.
    assert time.process_time() - start < 2.0
    assert len(again) > 100 and again.content_hash == first.content_hash


def test_missing_empty_and_misplaced_folders(tmp_path, root):
    empty = tmp_path / "empty"
    empty.mkdir()
    with pytest.raises(LibraryError, match=r"no CAD library at .*nowhere"):
        load_library(tmp_path / "nowhere")
    with pytest.raises(LibraryError, match="holds no models"):
        load_library(empty)
    with pytest.raises(LibraryError, match=r"first model\.json is in .*cad/cup/mug"):
        load_library(root.parent)


def edit(root: Path, cad_id: str, **changes) -> None:
    path = root / cad_id / "model.json"
    record = json.loads(path.read_text())
    for key, value in changes.items():
        if value is None:
            del record[key]
        else:
            record[key] = value
    path.write_text(json.dumps(record))


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"class": "tabel"}, "unknown class 'tabel'"),
        ({"class": None}, "'class' is missing"),
        ({"planes": None}, "'planes' is missing"),
        ({"schema_version": "9.0"}, "schema version '9.0'"),
        ({"mount": "ceiling"}, "'ceiling'"),
        ({"symmetry": 3}, "3"),
        ({"size": [1.0, 2.0]}, "size"),
        ({"size": [1.0, -2.0, 1.0]}, "size"),
    ],
)
def test_a_bad_record_is_named_with_its_file(root, changes, said):
    edit(root, "table/round_90", content_hash=None, **changes)
    with pytest.raises(LibraryError, match=said) as caught:
        load_library(root)
    assert "round_90/model.json" in str(caught.value) and caught.value.hint


def test_corrupt_files_are_named(root):
    table = root / "table" / "round_90"
    good = (table / "model.json").read_text()
    (table / "model.json").write_text(good[:100])
    with pytest.raises(LibraryError, match=r"round_90/model\.json"):
        load_library(root)
    (table / "model.json").write_text(good)
    load_library(root)
    (table / "model.urdf").write_text("<robot>")
    with pytest.raises(LibraryError, match=r"round_90/model\.urdf"):
        load_library(root).by_id("table/round_90").load_robot()
    edit(root, "table/round_90", content_hash=None)
    with pytest.raises(LibraryError, match=r"round_90/model\.urdf"):
        load_library(root)
    (table / "model.json").write_text(good)
    (table / "model.urdf").unlink()
    with pytest.raises(LibraryError, match=r"round_90/model\.urdf"):
        load_library(root).by_id("table/round_90").load_robot()


def test_a_changed_mesh_is_noticed_unless_the_hash_is_gone(root):
    mesh = next((root / "cup" / "mug" / "meshes").glob("*.obj"))
    before = load_library(root)
    mesh.write_text(re.sub(r"^v .*$", "v 0.5 0.5 0.5", mesh.read_text(), count=1, flags=re.M))
    for loaded in (before, load_library(root)):
        with pytest.raises(LibraryError, match="differs from its content hash") as caught:
            loaded.by_id("cup/mug").load_robot()
        assert str(mesh) in caught.value.problem
    edit(root, "cup/mug", content_hash=None)
    after = load_library(root)
    assert after.by_id("cup/mug").robot.mass_kg > 0
    assert after.by_id("cup/mug").content_hash != before.by_id("cup/mug").content_hash
    assert after.content_hash != before.content_hash


def test_a_plane_of_an_unknown_link_is_named(root):
    record = json.loads((root / "cup/mug/model.json").read_text())
    record["planes"][0]["link"] = "lid"
    edit(root, "cup/mug", content_hash=None, planes=record["planes"])
    with pytest.raises(LibraryError, match="lid"):
        load_library(root)


def test_a_folder_that_cannot_be_written(tmp_path):
    blocked = tmp_path / "file"
    blocked.write_text("")
    with pytest.raises(OutputError, match="file"):
        save_model(make("cup/mug"), blocked)


def test_default_library_is_the_one_of_the_repository():
    assert Path(default_library().source) == REPOSITORY / "cad_db"


def test_without_one_the_default_is_built_once_into_the_cache(tmp_path, monkeypatch, caplog):
    monkeypatch.setattr(library, "_REPOSITORY_LIBRARY", tmp_path / "absent")
    monkeypatch.setattr(library, "KIT", {k: library.KIT[k] for k in IDS[:2]})
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    with caplog.at_level(logging.INFO):
        first = default_library()
        assert "building 2 CAD models" in caplog.text
        second = default_library()
        assert "from the cache" in caplog.text
    assert Path(first.source).is_relative_to(tmp_path / "cache")
    assert first.content_hash == second.content_hash and len(second) == 2
    # A build that was cut short is built again.
    (Path(first.source) / "complete").unlink()
    assert default_library().content_hash == first.content_hash


def test_groups_of_classes_share_models():
    loaded = default_library()
    rows = loaded.matching_class("desk")
    assert {loaded[int(i)].class_name for i in rows} == {"desk", "table"}
