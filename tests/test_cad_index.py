"""The kept index of a library: fast, fresh, whole, and lazy about geometry."""

from __future__ import annotations

import dataclasses
import json
import logging
import os
import pickle
import shutil
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import get_args

import jax
import numpy as np
import pytest

from isr_jax.cad import index, load_library, open_library, save_model, validate_record
from isr_jax.cad.packed_file import read_packed, write_packed
from isr_jax.cad.records import record_schema
from isr_jax.classes import Mount
from isr_jax.errors import LibraryError
from isr_jax.geometry.surface_samples import surface_samples
from isr_jax.library import CadModel, Collision
from isr_jax.library.arrays import MAX_MODEL_PLANES

from .builders import box_mesh, library_of, planes_that_count, table_model
from .furniture import bookshelf_model, chair_model
from .physics_scenes import cabinet_model

MANY = 10_000
FIELDS = (
    *("class_name", "moving_joints", "plane_link", "symmetry", "mount", "licence"),
    *("collision", "swelling_m", "creator", "source", "notes"),
)
NAMES = ("chair", "cabinet", "table")


def example_models() -> list[CadModel]:
    """A chair, a cabinet with joints and a table, of what `model.json` can say."""
    said = dataclasses.replace(
        table_model("table/plain"),
        collision="vhacd",
        swelling_m=0.0125,
        creator="A. Joiner",
        source="tables.zip: one.obj",
        notes=("unit guessed: millimetres",),
    )
    return [chair_model("chair/plain"), cabinet_model("cabinet/plain"), said]


@pytest.fixture(autouse=True)
def cache(tmp_path, monkeypatch) -> Path:
    """A user's cache of the test's own."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    return tmp_path / "cache" / "isr_jax" / "library"


@pytest.fixture
def root(tmp_path) -> Path:
    for model in example_models():
        save_model(model, tmp_path / "cad")
    return tmp_path / "cad"


@pytest.fixture
def reads(monkeypatch) -> list[str]:
    """Folders whose model.json was opened, and with a + those read whole."""
    opened: list[str] = []
    record, model = index.read_record, index.read_model
    monkeypatch.setattr(index, "read_record", lambda f: opened.append(f.name) or record(f))
    monkeypatch.setattr(index, "read_model", lambda f: opened.append(f"+{f.name}") or model(f))
    return opened


def filled(root: Path, sources: list[Path], count: int) -> None:
    """Models that share mesh files by hard links, each with a record and a hash of its own."""
    records = [json.loads((source / "model.json").read_text()) for source in sources]
    for i in range(count):
        source, record = sources[i % len(sources)], records[i % len(sources)]
        folder = root / source.parent.name / f"{source.name}_{i}"
        (folder / "meshes").mkdir(parents=True)
        for file in (source / "model.urdf", *(source / "meshes").iterdir()):
            os.link(file, folder / file.relative_to(source))
        rest = {k: v for k, v in record.items() if k != "content_hash"}
        (folder / "model.json").write_text(json.dumps(rest | {"notes": [f"copy {i}"]}))


def test_what_is_kept_is_what_the_files_say(root):
    for _ in range(2):
        library = load_library(root)
        for model in example_models():
            found = library.by_id(model.id)
            for field in FIELDS:
                assert getattr(found, field) == getattr(model, field), field
            np.testing.assert_array_equal(found.size, model.size)
            np.testing.assert_array_equal(found.plane_supporting, model.plane_supporting)
            for name in ("normal", "offset", "corners", "area_m2", "valid"):
                kept, true = getattr(found.planes, name), getattr(model.planes, name)
                np.testing.assert_array_equal(kept, true)
            np.testing.assert_array_equal(found.mesh.vertices, model.mesh.vertices)
            np.testing.assert_array_equal(found.samples.points, model.samples.points)
            np.testing.assert_array_equal(found.samples.normals, model.samples.normals)


def test_records_follow_their_schema(root):
    for path in root.glob("*/*/model.json"):
        record = json.loads(path.read_text())
        validate_record(record, path)
        with pytest.raises(LibraryError, match=r"plain/model\.json.*at mount"):
            validate_record(record | {"mount": "ceiling"}, path)
        with pytest.raises(LibraryError, match="colour"):
            validate_record(record | {"colour": "red"}, path)


def test_the_schema_lists_what_the_types_list():
    listed = record_schema()["properties"]
    assert tuple(listed["mount"]["enum"]) == get_args(Mount)
    assert tuple(listed["collision"]["enum"]) == get_args(Collision)


def test_nothing_that_did_not_change_is_opened(root, reads):
    load_library(root)
    assert reads == [f for name in ("plain",) * 3 for f in (name, f"+{name}")]
    reads.clear()
    load_library(root)
    assert reads == []
    os.utime(root / "chair" / "plain" / "model.json", ns=(1, 1))
    load_library(root)
    assert reads == ["plain"]  # same content: its samples stay


def test_only_what_changed_is_read_again(root, reads):
    before = load_library(root)
    reads.clear()
    taller = table_model("table/plain", size=(1.2, 0.8, 0.9))
    save_model(taller, root)
    save_model(table_model("table/second"), root)
    shutil.rmtree(root / "cabinet")
    after = load_library(root)
    assert reads == ["plain", "+plain", "second", "+second"]
    assert [m.id for m in after.models] == ["chair/plain", "table/plain", "table/second"]
    np.testing.assert_array_equal(after.by_id("table/plain").size, taller.size)
    same = [lib.by_id("chair/plain").samples.points for lib in (before, after)]
    np.testing.assert_array_equal(*same)
    assert after.content_hash != before.content_hash


def test_a_copied_or_moved_model_keeps_its_samples(root, reads):
    before = load_library(root).by_id("table/plain")
    reads.clear()
    shutil.copytree(root / "table" / "plain", root / "table" / "copy")
    (root / "chair" / "plain").rename(root / "chair" / "moved")
    after = load_library(root)
    assert reads == ["moved", "copy"]
    np.testing.assert_array_equal(after.by_id("table/copy").samples.points, before.samples.points)
    assert after.by_id("table/copy").content_hash == before.content_hash


def test_geometry_is_read_when_it_is_used(root):
    load_library(root)
    library = load_library(root)
    for mesh in root.rglob("*.obj"):
        mesh.unlink()
    assert library.by_id("chair/plain").samples.points.shape == (512, 3)
    with pytest.raises(LibraryError, match=r"meshes/.*\.obj differs from its content hash"):
        library.by_id("chair/plain").load_robot()


def test_a_model_that_changed_under_its_library_is_noticed(root):
    library = load_library(root)
    save_model(table_model("table/plain", size=(1.0, 0.8, 0.9)), root)
    with pytest.raises(LibraryError, match="changed while its library was in use"):
        library.by_id("table/plain").load_robot()


@pytest.mark.parametrize("damage", ["header", "array", "cut", "other"])
def test_a_damaged_index_is_made_again_and_said(root, cache, caplog, damage):
    whole = load_library(root)
    path = next(cache.glob("*/*.index"))
    good = path.read_bytes()
    at = {"header": 100, "array": len(good) - 50, "cut": 0, "other": 2}[damage]
    data, arrays = read_packed(path)
    if damage == "array":
        at = good.index(arrays["offset"].tobytes())
    bad = good[:-64] if damage == "cut" else good[:at] + bytes([good[at] ^ 1]) + good[at + 1 :]
    del data, arrays
    path.unlink()
    path.write_bytes(bad)
    with caplog.at_level(logging.WARNING):
        again = load_library(root)
    assert "made again" in caplog.text and str(path) in caplog.text
    assert again.content_hash == whole.content_hash and path.read_bytes() == good


def test_an_index_of_an_older_version_is_not_used(root, monkeypatch, reads, caplog):
    load_library(root)
    reads.clear()
    monkeypatch.setattr(index, "INDEX_VERSION", index.INDEX_VERSION + 1)
    with caplog.at_level(logging.WARNING):
        load_library(root)
    assert "+plain" in reads and "is of version" in caplog.text


def test_a_cache_that_cannot_be_written_is_said_and_done_without(root, cache, caplog):
    cache.parent.mkdir(parents=True)
    cache.write_text("in the way")
    with caplog.at_level(logging.WARNING):
        library = load_library(root)
    assert "not kept" in caplog.text
    assert library.by_id("chair/plain").samples.points.shape == (512, 3)


def test_indices_of_libraries_that_are_gone_go(root, tmp_path, cache):
    save_model(table_model("table/other"), tmp_path / "other")
    load_library(tmp_path / "other")
    shutil.rmtree(tmp_path / "other")
    load_library(root)
    assert len(list(cache.iterdir())) == 1
    save_model(table_model("table/second"), root)
    load_library(root)
    assert len(list(cache.glob("*/*.index"))) == 1


def test_many_may_open_a_library_for_the_first_time_at_once(root, cache):
    with ThreadPoolExecutor(4) as pool:
        found = list(pool.map(load_library, [root] * 8))
    assert len({library.content_hash for library in found}) == 1
    assert all(library[0].samples.points.shape == (512, 3) for library in found)
    assert [p.suffix for p in sorted(cache.glob("*/*"))] == [".index", ".txt"]


def test_progress_is_told_for_new_models_only(root):
    told: list[tuple[int, int]] = []
    load_library(root, progress=lambda done, total: told.append((done, total)))
    load_library(root, progress=lambda done, total: told.append((done, total)))
    assert told == [(1, 3), (2, 3), (3, 3)]


def test_folders_join_and_ids_must_differ(root, tmp_path):
    mine = tmp_path / "mine+more"
    save_model(bookshelf_model("bookshelf/mine"), mine)
    joined = load_library(root, mine)
    assert [m.id for m in joined.models] == [
        *("bookshelf/mine", "cabinet/plain", "chair/plain", "table/plain"),
    ]
    assert joined.source == f"{root}+{mine}" and len(open_library(mine)) == 1
    plus = tmp_path / "plain"
    shutil.copytree(mine, plus)
    assert open_library(f"{root}+{plus}").content_hash == joined.content_hash
    save_model(table_model("table/plain"), mine)
    with pytest.raises(LibraryError, match=r"table/plain is both in .*cad and in .*mine"):
        load_library(root, mine)
    with pytest.raises(LibraryError, match=r"no CAD library at .*nowhere"):
        open_library(f"{root}+{tmp_path / 'nowhere'}")


def _measured(library) -> list[float]:
    return [model.robot.mass_kg + float(model.samples.points.sum()) for model in library.models]


def test_libraries_go_to_other_processes_without_their_geometry(root, cache):
    library = load_library(root)
    fresh = len(pickle.dumps(library))
    here = _measured(library)
    assert len(pickle.dumps(library)) < 1.01 * fresh
    assert _measured(pickle.loads(pickle.dumps(library))) == here
    for index_file in cache.rglob("*.index"):
        index_file.unlink()
    index._kept_arrays.cache_clear()
    assert _measured(pickle.loads(pickle.dumps(library))) == here  # samples are made again


def test_arrays_hold_the_planes_that_count():
    models = [table_model(), bookshelf_model(), chair_model(), cabinet_model()]
    arrays = library_of(*models).arrays
    assert arrays.normal.shape == (4, MAX_MODEL_PLANES, 3)
    assert max(len(m.plane_link) for m in models) > MAX_MODEL_PLANES
    for row, model in enumerate(library_of(*models).models):
        rows = planes_that_count(model.planes, model.plane_supporting)
        n = arrays.plane_count[row]
        assert n == len(rows) and np.all(arrays.valid[row] == (np.arange(MAX_MODEL_PLANES) < n))
        np.testing.assert_array_equal(arrays.column[row, :n], rows)
        np.testing.assert_array_equal(arrays.normal[row, :n], model.planes.normal[rows])
        np.testing.assert_array_equal(arrays.offset[row, :n], model.planes.offset[rows])
        np.testing.assert_array_equal(arrays.area_m2[row, :n], model.planes.area_m2[rows])
        np.testing.assert_array_equal(arrays.supporting[row, :n], model.plane_supporting[rows])
        np.testing.assert_array_equal(arrays.size[row], model.size)
        assert np.all(arrays.normal[row, n:] == (0, 0, 1)) and not arrays.offset[row, n:].any()
        carries, area = np.asarray(model.plane_supporting), np.asarray(model.planes.area_m2)
        lost = np.setdiff1d(np.flatnonzero(model.planes.valid), rows)
        for kind in (carries, ~carries):
            kept = area[rows][kind[rows]].min(initial=np.inf)
            assert np.all(area[lost][kind[lost]] <= kept), "small ones are lost first"


def test_a_shelf_of_many_boards_keeps_its_sides():
    boards, sides = 20, 9
    count = boards + sides
    planes = jax.tree.map(lambda leaf: np.repeat(leaf[:1], count, 0), table_model().planes)
    planes = dataclasses.replace(planes, area_m2=np.linspace(1.0, 2.0, count, dtype=np.float32))
    supporting = np.arange(count) < boards
    rows = planes_that_count(planes, supporting)
    assert len(rows) == MAX_MODEL_PLANES
    assert set(np.flatnonzero(~supporting)[-6:]) <= set(rows.tolist())
    assert len(planes_that_count(planes, np.ones(count, bool))) == MAX_MODEL_PLANES
    few = planes_that_count(planes, np.arange(count) < 2)
    assert {0, 1} <= set(few.tolist()) and len(few) == MAX_MODEL_PLANES


def test_arrays_of_nothing_and_of_models_without_planes():
    assert library_of().arrays.normal.shape == (0, MAX_MODEL_PLANES, 3)
    bare = table_model()
    none = dataclasses.replace(
        bare,
        planes=jax.tree.map(lambda leaf: leaf[:0], bare.planes),
        plane_link=(),
        plane_supporting=bare.plane_supporting[:0],
    )
    arrays = library_of(none).arrays
    assert arrays.plane_count.tolist() == [0] and np.all(arrays.normal == (0, 0, 1))


def test_samples_lie_on_the_surface_in_proportion_to_its_area():
    size = np.array([1.0, 2.0, 0.5])
    mesh = box_mesh(size, spacing_m=0.3)
    count = 4096
    found = surface_samples(mesh.vertices, mesh.faces, count)
    axis = np.abs(found.normals).argmax(1)
    np.testing.assert_allclose(np.abs(found.normals).sum(1), 1)
    on_face = np.take_along_axis(found.points * found.normals, axis[:, None], 1)[:, 0]
    np.testing.assert_allclose(on_face, size[axis] / 2, atol=1e-6)
    faces = np.array([size[1] * size[2], size[0] * size[2], size[0] * size[1]])
    share = faces / faces.sum() / 2
    for k in range(3):
        for sign in (-1, 1):
            hits = np.sum((axis == k) & (found.normals[np.arange(count), axis] == sign))
            assert abs(hits - count * share[k]) <= 2  # strata cut at the edges of the faces
    # Spread evenly: the mean of a face is its middle, four times nearer than random points'.
    top = found.points[(axis == 2) & (found.normals[:, 2] > 0)]
    assert np.all(np.abs(top[:, :2].mean(0)) < size[:2] / np.sqrt(12 * len(top)) / 2)


def test_samples_leave_out_what_has_no_area():
    mesh = box_mesh((1, 1, 1), spacing_m=1.0)
    flat = np.array([[0, 0, 1], [2, 2, 2]], np.int32)
    more = np.concatenate([flat, mesh.faces, flat])
    a = surface_samples(mesh.vertices, more, 100)
    b = surface_samples(mesh.vertices, mesh.faces, 100)
    np.testing.assert_array_equal(a.points, b.points)
    assert surface_samples(mesh.vertices, flat, 100).points.shape == (0, 3)


def test_packed_files_hold_every_kind_of_array(tmp_path):
    arrays = {
        "half": np.arange(6, dtype=np.float16).reshape(2, 3),
        "none": np.zeros((0, 4), np.float32),
        "flags": np.array([True, False, True]),
        "one": np.array(7, np.int64),
    }
    write_packed(tmp_path / "new" / "a.pack", {"x": [1, "ä"]}, arrays, unchecked=("half",))
    data, found = read_packed(tmp_path / "new" / "a.pack")
    assert data == {"x": [1, "ä"]} and list(found) == list(arrays)
    for name, values in arrays.items():
        assert found[name].dtype == values.dtype
        np.testing.assert_array_equal(found[name], values)
    assert [p.name for p in (tmp_path / "new").iterdir()] == ["a.pack"]


def test_two_hundred_models_load_at_once(root, tmp_path):
    filled(tmp_path / "many", [root / name / "plain" for name in NAMES], 200)
    first = load_library(tmp_path / "many")
    start = time.process_time()
    again = load_library(tmp_path / "many")
    # 10 ms measured without the checks of shapes that tests run under.
    assert time.process_time() - start < 1.0
    assert len(again) == 200 and again.content_hash == first.content_hash
    assert len({model.content_hash for model in again.models}) == 200


@pytest.mark.slow
def test_ten_thousand_models_load_in_two_seconds(root, tmp_path, capsys):
    filled(tmp_path / "many", [root / name / "plain" for name in NAMES], MANY)
    seconds = []
    for _ in range(3):
        start = time.perf_counter()
        library = load_library(tmp_path / "many")
        assert len(library) == MANY and library.arrays.size.shape == (MANY, 3)
        seconds.append(time.perf_counter() - start)
    with capsys.disabled():
        print(f"\n{MANY} models: {seconds[0]:.1f} s cold, {min(seconds[1:]):.2f} s warm")
    # The checks of shapes that tests run under take most of it; without them 0.6 s.
    assert min(seconds[1:]) < 8.0
