"""A scene that was saved comes back whole, and a sweep is one call."""

from __future__ import annotations

import json
import shutil

import jax
import numpy as np
import pytest

import isr_jax as isr
from isr_jax.errors import LibraryError, SceneError, SettingError
from isr_jax.runtime.stage_runner import StageRunner
from isr_jax.runtime.store import StageStore, content_hash
from isr_jax.types import Entities

from .builders import library_of, table_model
from .films import film, finished  # noqa: F401 (fixtures)


@pytest.fixture(scope="module")
def loaded(finished):  # noqa: F811
    return isr.load_scene(finished.out_dir)


def same(a, b) -> bool:
    leaves = zip(jax.tree.leaves(a), jax.tree.leaves(b), strict=True)
    return all(np.array_equal(x, y) for x, y in leaves)


def test_entities_come_back_bit_for_bit(finished, loaded):  # noqa: F811
    for before, after in zip(finished.scene.entities, loaded.entities, strict=True):
        names = ("id", "name", "class_name", "is_layout", "merged_ids")
        assert all(getattr(before, n) == getattr(after, n) for n in names)
        assert same(before.box, after.box) and same(before.planes, after.planes)
        assert np.array_equal(before.mesh.vertices, after.mesh.vertices)
        assert np.array_equal(before.mesh.faces, after.mesh.faces)
        assert np.array_equal(before.mesh.colors, after.mesh.colors)
    assert loaded.entities.voxel_size_m == finished.scene.entities.voxel_size_m


def test_graph_candidates_and_settings_come_back(finished, loaded):  # noqa: F811
    assert content_hash(loaded.graph) == content_hash(finished.scene.graph)
    assert content_hash(loaded.shortlist) == content_hash(finished.scene.shortlist)
    assert content_hash(loaded.aligned) == content_hash(finished.scene.aligned)
    assert loaded.settings == finished.scene.settings
    assert loaded.library.content_hash == finished.scene.library.content_hash


def test_placements_come_back_as_they_were_written(finished, loaded):  # noqa: F811
    for record, placement in zip(finished.scene_file.entities, loaded.placements, strict=True):
        assert (placement.cad_id is None) == (record.cad is None)
        assert placement.candidates == record.candidates and placement.reason == record.reason
        if record.cad is not None:
            np.testing.assert_allclose(placement.T_world_cad, record.cad.T_world_cad, atol=1e-6)


def test_what_came_back_is_saved_as_the_same_scene(loaded, tmp_path):
    again = loaded.save(tmp_path)
    twice = isr.load_scene(tmp_path)
    assert content_hash(twice.graph) == content_hash(loaded.graph)
    assert content_hash(twice.shortlist) == content_hash(loaded.shortlist)
    for before, record in zip(loaded.placements, again.entities, strict=True):
        if record.cad is not None:
            np.testing.assert_allclose(before.T_world_cad, record.cad.T_world_cad, atol=2e-4)


def test_a_true_scene_comes_back_without_candidates(film):  # noqa: F811
    truth = isr.load_scene(film / "truth")
    assert truth.shortlist is None and truth.aligned is None
    assert any(p.cad_id is not None for p in truth.placements)
    assert all(len(e.mesh.vertices) for e in truth.entities)


def test_candidates_of_another_scene_json_are_not_taken(finished, tmp_path):  # noqa: F811
    folder = shutil.copytree(finished.out_dir, tmp_path / "changed")
    data = json.loads((folder / "scene.json").read_text())
    data["entities"] = data["entities"][:-1]
    names = {e["name"] for e in data["entities"]}
    data["proximal"] = [p for p in data["proximal"] if {p["a"], p["b"]} <= names]
    (folder / "scene.json").write_text(json.dumps(data))
    found = isr.load_scene(folder)
    assert len(found.entities) == len(finished.scene.entities) - 1
    assert found.shortlist is None


def test_with_another_library_there_are_no_candidates(finished):  # noqa: F811
    models = finished.scene.library.models
    placed = {p.cad_id for p in finished.scene.placements} - {None}
    larger = library_of(*(m for m in models if m.id in placed), table_model())
    assert isr.load_scene(finished.out_dir, library=larger).shortlist is None


def test_what_is_missing_is_named(finished, tmp_path):  # noqa: F811
    with pytest.raises(SceneError, match=r"scene\.json"):
        isr.load_scene(tmp_path)
    with pytest.raises(LibraryError, match="lacks"):
        isr.load_scene(finished.out_dir, library=library_of(table_model()))
    folder = shutil.copytree(finished.out_dir, tmp_path / "other")
    data = json.loads((folder / "scene.json").read_text())
    data["settings"]["mapping"]["voxel_sze_m"] = 0.01
    (folder / "scene.json").write_text(json.dumps(data))
    with pytest.raises(SettingError, match="voxel_sze_m"):
        isr.load_scene(folder)


def test_scenes_furnished_together_are_as_each_alone(finished, tmp_path):  # noqa: F811
    whole = finished.scene
    half = Entities(
        tuple(e for e in whole.entities if e.is_layout or e.id % 2),
        whole.entities.T_world_dataset,
        whole.entities.voxel_size_m,
    )
    stores = [StageStore(tmp_path / name) for name in ("whole", "half")]
    rooms = [whole.entities, half]
    together = isr.furnish_scenes(rooms, whole.library, whole.settings, runner=StageRunner(stores))
    assert content_hash(together[0].graph) == content_hash(whole.graph)
    assert content_hash(together[0].shortlist) == content_hash(whole.shortlist)
    chosen = [[p.cad_id for p in scene.placements] for scene in together]
    alone = [whole, isr.replace_with_cad(half, whole.library, whole.settings)]
    assert chosen == [[p.cad_id for p in scene.placements] for scene in alone]
    assert (tmp_path / "half" / "physical_check.json").is_file()


def test_an_empty_library_stays_empty(finished):  # noqa: F811
    scene = isr.replace_with_cad(finished.scene.entities, library_of(), finished.scene.settings)
    assert len(scene.shortlist.entity) == 0
    assert all(p.cad_id is None for p in scene.placements)


def test_the_old_name_of_replace_with_cad_says_the_new_one(finished):  # noqa: F811
    with pytest.warns(DeprecationWarning, match="replace_with_cad"):
        isr.furnish(finished.scene.entities, library_of(), finished.scene.settings)
