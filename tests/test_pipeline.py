"""The whole way through: what is promised is written, and what is finished is never lost."""

from __future__ import annotations

import json
import shutil

import mujoco
import numpy as np
import pytest
import yourdfpy

from isr_jax import pipeline
from isr_jax.borders import simulation
from isr_jax.cad import default_library
from isr_jax.cad.collision import making_hulls
from isr_jax.demonstration.film import film_room
from isr_jax.errors import LibraryError, OutputError, SettingError
from isr_jax.robot_model.mesh_files import MeshFiles
from isr_jax.robot_model.mjcf import ContactModel, add_robot, spec_xml
from isr_jax.scene_file import read_scene

from .builders import library_of, table_model, without_hulls
from .films import FRAMES, Recorder, film, finished, run  # noqa: F401 (fixtures)

PROMISED = (
    "scene.json",
    "scene.xml",
    "scene.glb",
    "scene.png",
    "scene_description/package.xml",
    "scene_description/urdf/scene.urdf",
    "map/panoptic.ply",
    "map/panoptic.png",
    "stability.json",
    "config.toml",
    "run.log",
)
SAME = ("scene.json", "scene.xml", "scene.glb", "map/panoptic.ply", "config.toml")
"""Files that hold no times: the same input writes the same bytes."""
FIRST = ("mapping", "entities", "contact_graph", "matching")
LAST = ("alignment", "physical_check")


@pytest.fixture
def undrawn(monkeypatch):
    """No pictures, which take longer than all the rest."""
    monkeypatch.setattr(pipeline, "_draw", lambda scene, out_dir: None)


@pytest.fixture
def copy(finished, tmp_path):  # noqa: F811
    """The finished run in a folder of its own, which may be changed."""
    return shutil.copytree(finished.out_dir, tmp_path / "moved out")


def joints_of(result) -> dict[str, list[str]]:
    """Names in the scene of the moving joints of every placed model, by entity."""
    scene = result.scene
    pairs = zip(scene.entities, scene.placements, strict=True)
    return {
        entity.name: [
            f"{entity.name}_{j.name}"
            for j in scene.library.by_id(placement.cad_id).robot.moving_joints
        ]
        for entity, placement in pairs
        if placement.cad_id is not None
    }


def test_every_promised_file_is_written(finished):  # noqa: F811
    for name in PROMISED:
        assert (finished.out_dir / name).stat().st_size > 0, name
    for entity in finished.scene_file.entities:
        assert entity.mesh is None or (finished.out_dir / entity.mesh).is_file()


def test_the_film_becomes_a_furnished_scene(finished):  # noqa: F811
    scene = finished.scene_file
    placed = [e for e in scene.entities if e.cad is not None]
    assert any(e.type == "layout" and e.class_name == "floor" for e in scene.entities)
    assert len(placed) >= 5 and any(e.type == "articulated" for e in placed)
    assert any(e.parent == "floor" for e in placed)
    assert scene.metrics["frames_used"] == FRAMES and scene.metrics["frames_skipped"] == []
    # A scene starts without overlap, and what stands on a plane that was seen stays where it is. So
    # few frames show too little of some supports: what stands on those falls.
    assert finished.stability.exported.penetration_max_m < 1e-3
    carried = {e.name for e in scene.entities if e.support_plane is not None}
    moved = {b.name: b.drift_end_m for b in finished.stability.exported.bodies}
    assert len(carried & set(moved)) >= 3
    assert all(moved[name] < 0.01 for name in carried & set(moved)), moved


def test_a_moved_scene_loads_in_mujoco_and_yourdfpy(finished, copy):  # noqa: F811
    model = mujoco.MjModel.from_xml_path(str(copy / "scene.xml"))
    robot = yourdfpy.URDF.load(str(copy / "scene_description" / "urdf" / "scene.urdf"))
    names = {e.name for e in finished.scene_file.entities}
    assert names <= {model.body(i).name for i in range(model.nbody)}
    assert names <= set(robot.link_map)
    assert read_scene(copy / "scene.json").entities[0].name in names


def test_every_joint_of_every_placed_model_is_in_the_scene(finished):  # noqa: F811
    expected = {joint for joints in joints_of(finished).values() for joint in joints}
    model = simulation.load_model(finished.out_dir / "scene.xml")
    assert expected and set(simulation.moving_joints(model)) == expected
    path = finished.out_dir / "scene_description" / "urdf" / "scene.urdf"
    assert expected <= set(yourdfpy.URDF.load(str(path)).actuated_joint_names)


def test_every_joint_of_a_placed_model_moves_where_nothing_is_in_its_way(
    finished,  # noqa: F811
    tmp_path,
):
    library = finished.scene.library
    placed = {p.cad_id for p in finished.scene.placements if p.cad_id is not None}
    moved = 0
    for number, cad_id in enumerate(sorted(placed)):
        robot = library.by_id(cad_id).robot
        if not robot.moving_joints:
            continue
        folder = tmp_path / str(number)
        spec = mujoco.MjSpec()
        spec.meshdir, spec.modelfiledir = "assets", str(folder)
        spec.compiler.degree = False
        files = MeshFiles(folder / "assets")
        add_robot(spec, robot, np.eye(4), free=False, files=files, contact=ContactModel())
        spec.compile()
        (folder / "alone.xml").write_text(spec_xml(spec))
        model = simulation.load_model(folder / "alone.xml")
        for joint in simulation.moving_joints(model):
            assert simulation.joint_travel(model, joint).share > 0.9, (cad_id, joint)
            moved += 1
    assert moved > 0


def test_a_second_run_reuses_every_stage(film, copy, undrawn):  # noqa: F811
    recorder = Recorder()
    run(film, copy, reporter=recorder)
    assert all(recorder.reused[stage] for stage in (*FIRST, *LAST)) and not recorder.frames


def test_from_alignment_reuses_what_comes_before(film, copy, undrawn):  # noqa: F811
    recorder = Recorder()
    before = (copy / "scene.json").read_bytes()
    run(film, copy, start_from="alignment", reporter=recorder)
    assert all(recorder.reused[stage] for stage in FIRST)
    assert not any(recorder.reused[stage] for stage in LAST)
    assert (copy / "scene.json").read_bytes() == before


def test_from_names_the_setting_that_differs(film, copy):  # noqa: F811
    with pytest.raises(SettingError, match=r"mapping\.voxel_size_m: stored 0\.04, now 0\.05"):
        run(film, copy, "mapping.voxel_size_m=0.05", start_from="alignment")


def test_a_killed_run_resumes_and_ends_as_if_nothing_had_happened(
    film,  # noqa: F811
    finished,  # noqa: F811
    tmp_path,
    undrawn,
):
    with pytest.raises(KeyboardInterrupt):
        run(film, tmp_path, reporter=Recorder(die_after=13))
    recorder = Recorder()
    resumed = run(film, tmp_path, reporter=recorder)
    assert recorder.frames == list(range(11, FRAMES + 1))
    assert any("resumes after 10 frames" in note for note in recorder.notes)
    mine, theirs = resumed.scene.mapping.surface, finished.scene.mapping.surface
    np.testing.assert_array_equal(mine.mesh.vertices, theirs.mesh.vertices)
    np.testing.assert_array_equal(mine.mesh.faces, theirs.mesh.faces)
    np.testing.assert_array_equal(mine.instance, theirs.instance)
    for name in SAME:
        assert (tmp_path / name).read_bytes() == (finished.out_dir / name).read_bytes(), name


def test_metrics_and_settings_stand_beside_the_result(finished):  # noqa: F811
    content = json.loads((finished.out_dir / "scene.json").read_text())
    assert content["settings"]["mapping"]["voxel_size_m"] == 0.04
    assert content["versions"]["isr_jax"]
    log = (finished.out_dir / "run.log").read_text()
    assert "finished in" in log and all(stage in log for stage in (*FIRST, *LAST))


def test_what_is_printed_is_a_table(finished):  # noqa: F811
    text = str(finished.stability)
    assert "penetration at t = 0" in text and "\x1b" not in text


def test_a_film_is_kept_and_another_one_replaces_it(tmp_path):
    def film_of(frames: int) -> Recorder:
        recorder = Recorder()
        options = {"width": 32, "height": 24, "library": library, "reporter": recorder}
        assert film_room(tmp_path / "film", frames=frames, **options) == tmp_path / "film"
        assert len(list((tmp_path / "film" / "depth").iterdir())) == frames
        return recorder

    library = default_library()
    assert not film_of(3).reused["synthetic"]
    assert film_of(3).reused["synthetic"]
    assert not film_of(2).reused["synthetic"]
    (tmp_path / "film" / "film.json").write_text("{}")  # as a killed run leaves it
    assert not film_of(2).reused["synthetic"]


def test_a_folder_that_holds_something_else_is_not_filmed_into(tmp_path):
    (tmp_path / "letters.txt").write_text("dear")
    with pytest.raises(OutputError, match="holds something else"):
        film_room(tmp_path, frames=1)
    assert [p.name for p in tmp_path.iterdir()] == ["letters.txt"]


def test_a_room_is_not_furnished_with_the_kit_in_place_of_an_empty_library(tmp_path):
    with pytest.raises(LibraryError, match="no usable model"):
        film_room(tmp_path / "film", frames=1, library=library_of())


def test_imported_models_get_hulls_when_a_scene_uses_them(tmp_path, monkeypatch):
    """The fast ones to be tried, the exact ones to be written; all others stay as they are."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    bare = without_hulls(table_model("table/imported"))
    library = library_of(bare, without_hulls(table_model("table/unused")), table_model())
    place = library.position("table/imported")
    recorder = Recorder()
    tried = making_hulls(library, recorder).with_hulls([place, place], "vhacd")
    assert tried[place].collision == "vhacd" and len(tried[place].robot.links[0].hulls) >= 5
    assert any("table/imported: collision hulls by vhacd" in note for note in recorder.notes)
    assert all(tried[i] is library[i] for i in range(3) if i != place)
    final = tried.with_hulls([place], "coacd")
    assert any("table/imported: collision hulls by coacd" in note for note in recorder.notes)
    assert final.with_hulls([place], "vhacd") is final, "the better ones stay"
    assert final[place].collision == "coacd"
    assert final.content_hash == library.content_hash, "of the same files"
