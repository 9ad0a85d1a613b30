"""Export: every format loads, agrees with the scene, stands still, and can be moved."""

from __future__ import annotations

import dataclasses
import io
import json
import re
import shutil

import mujoco
import numpy as np
import pytest
import trimesh
import yourdfpy

from isr_jax.borders import simulation
from isr_jax.config import ExportSettings
from isr_jax.errors import OutputError, SceneError
from isr_jax.export import export_scene
from isr_jax.export.bodies import scene_bodies, stretched
from isr_jax.export.glb import GlbFile, linear_of_srgb
from isr_jax.export.slabs import slabs_of
from isr_jax.export.verify import verify_exports
from isr_jax.geometry import box_corners
from isr_jax.robot_model import RobotModel, Texture, Visual, box_between, solid_properties
from isr_jax.scene_file import read_scene
from isr_jax.types import UNSUPPORTED

from .builders import box_entity, floor_entity, library_of, scene_of, with_robot
from .physics_scenes import (
    cabinet_model,
    cube_model,
    cubes_scene,
    furnished_scene,
    kept,
    placed,
    support_graph,
    table_model,
)
from .test_robot_model_urdf import png

POSE = 1e-5  # what export promises
TOUCH_M = 1e-4  # start of a settled scene: contact, not overlap


@pytest.fixture(scope="module")
def exported(tmp_path_factory):
    """The furnished scene on disk, in a folder that was moved after writing."""
    written = tmp_path_factory.mktemp("written") / "scene"
    scene = export_scene(*furnished_scene().arguments, written)
    moved = tmp_path_factory.mktemp("elsewhere") / "moved scene"
    shutil.move(written, moved)
    return moved, scene


def test_writes_every_format(exported):
    folder, scene = exported
    for name in ("scene.xml", "scene.json", "scene.glb", "map/table_3.ply"):
        assert (folder / name).is_file()
    for name in ("package.xml", "CMakeLists.txt", "urdf/scene.urdf", "launch/display.launch.py"):
        assert (folder / "scene_description" / name).is_file()
    assert read_scene(folder / "scene.json").entity("cup_4").parent == "table_3"
    assert scene.metrics["export"]["free"] == ["cup_4", "chair_5"]
    assert scene.metrics["export"]["fixed"] == ["table_3", "cabinet_6", "clock_7"]


def test_moved_folder_loads_everywhere_with_the_same_bodies(exported):
    folder, _ = exported
    mjcf = mujoco.MjModel.from_xml_path(str(folder / "scene.xml"))
    path = folder / "scene_description" / "urdf" / "scene.urdf"
    from_urdf = mujoco.MjModel.from_xml_path(str(path))
    robot = yourdfpy.URDF.load(str(path))
    names = {mjcf.body(i).name for i in range(1, mjcf.nbody)}
    assert names <= {from_urdf.body(i).name for i in range(from_urdf.nbody)}
    assert names <= set(robot.link_map)
    for name in names:
        mass = mjcf.body(name).mass[0]
        if mass:
            assert np.isclose(from_urdf.body(name).mass[0], mass, rtol=POSE)
            assert np.isclose(robot.link_map[name].inertial.mass, mass, rtol=POSE)
            # loaders turn the principal axes differently; the moments are the same
            moments = (np.sort(m.body(name).inertia) for m in (mjcf, from_urdf))
            assert np.allclose(*moments, rtol=1e-4)
    assert len(robot.scene.geometry) > 10  # meshes were found after the move


def test_joints_keep_their_kind_and_range(exported):
    folder, _ = exported
    model = simulation.load_model(folder / "scene.xml")
    assert simulation.moving_joints(model) == ("cabinet_6_hinge", "cabinet_6_slide")
    ranges = simulation.joint_ranges(model)
    assert np.isclose(ranges["cabinet_6_hinge"], 1.8)
    assert np.isclose(ranges["cabinet_6_slide"], 1.2 * 0.3)  # slides grow with the model


def test_every_joint_moves_its_whole_range(exported):
    model = simulation.load_model(exported[0] / "scene.xml")
    for joint in simulation.moving_joints(model):
        assert simulation.joint_travel(model, joint).share > 0.99


def test_starts_without_overlap_and_stays(exported):
    model = simulation.load_model(exported[0] / "scene.xml")
    assert all(t.depth_m < TOUCH_M for t in simulation.touches(model))
    path = simulation.simulate(model, 5.0)
    drift = np.linalg.norm(path.position_m[-1] - path.position_m[0], axis=-1)
    assert path.bodies == ("cup_4", "chair_5")
    assert np.all(drift < 1e-3) and not path.warnings


def test_scene_json_holds_the_exported_pose(exported):
    folder, scene = exported
    model = simulation.load_model(folder / "scene.xml")
    cad = read_scene(folder / "scene.json").entity("cup_4").cad
    assert np.allclose(cad.T_world_cad[:3, 3], model.body("cup_4").pos, atol=POSE)
    assert np.allclose(scene.metrics["export"]["shift_m"]["cup_4"], [0, 0, -0.004], atol=POSE)
    assert np.isclose(cad.T_world_cad[2, 3], 0.74 + 0.05, atol=POSE)


def test_glb_is_y_up_and_keeps_names_and_colors(exported):
    glb = trimesh.load_scene(exported[0] / "scene.glb")
    T = glb.graph.get("table_3")[0]
    assert np.allclose(T[:3, 3], [0, 0.37, 0], atol=POSE)  # z of the world is y here
    assert {"floor_1", "cup_4", "cabinet_6", "cabinet_6_door"} <= set(glb.graph.nodes)
    scan = glb.geometry["chair_5"].visual
    linear = 65535 * linear_of_srgb(np.array(128 / 255))
    assert np.all(scan.vertex_attributes["color"][:, :3] == np.rint(linear))
    assert scan.material.metallicFactor == 0.0  # glTF's default is metal, shown black


def glb_of(*shown) -> tuple[dict, bytes, trimesh.Scene]:
    """A node each for (mesh, rgba, texture): the JSON, the bytes, and what trimesh reads."""
    file = GlbFile()
    for i, (mesh, rgba, texture) in enumerate(shown):
        file.set_mesh(file.add_node(f"n{i}", None, np.eye(4)), mesh, rgba, texture, 0.5)
    content = file.content()
    length = int.from_bytes(content[12:16], "little")
    assert len(content) % 4 == 0 and int.from_bytes(content[8:12], "little") == len(content)
    scene = trimesh.load_scene(io.BytesIO(content), file_type="glb")
    return json.loads(content[20 : 20 + length]), content, scene


def test_glb_colors_are_linear():
    mesh = box_between(np.zeros(3), np.ones(3))
    tree, _, _ = glb_of((mesh, (0.5, 0.04045, 1.0, 0.25), None))
    material = tree["materials"][0]
    factor = material["pbrMetallicRoughness"]["baseColorFactor"]
    # IEC 61966-2-1: ((0.5 + 0.055) / 1.055)^2.4, and the end of its straight part
    assert np.allclose(factor, [0.214041, 0.04045 / 12.92, 1.0, 0.25], atol=1e-6)
    assert material["alphaMode"] == "BLEND"


def test_glb_splits_vertices_where_uv_part_and_keeps_images_as_they_are():
    mesh = box_between(np.zeros(3), np.ones(3))
    uv = np.tile(np.array([[0, 0], [1, 0], [1, 2]], np.float32), (12, 1, 1))
    textured = dataclasses.replace(mesh, uv=uv)
    image = Texture("small.png", png((200, 100, 50), (2, 3)))
    white = (1.0, 1.0, 1.0, 1.0)
    tree, content, scene = glb_of(
        (textured, white, image),
        (textured, white, image),
        (textured, white, None),
        (mesh, white, None),
    )
    assert content.count(image.content) == 1
    assert [len(tree[key]) for key in ("images", "textures", "materials")] == [1, 1, 2]
    assert len(tree["accessors"]) == 5  # positions, uv, faces; positions and faces without uv
    seen = scene.geometry["n0"]
    assert seen.visual.material.baseColorTexture.size == (2, 3)
    # trimesh turns glTF's v around again
    corners = np.concatenate([seen.vertices[seen.faces], seen.visual.uv[seen.faces]], -1)
    assert np.allclose(corners, np.concatenate([mesh.vertices[mesh.faces], uv], -1))
    pairs = np.concatenate([mesh.faces.reshape(-1, 1), uv.reshape(-1, 2)], 1)
    assert (
        len(seen.vertices) == len(np.unique(pairs, axis=0))
        and len(scene.geometry["n3"].vertices) == 8
    )


def test_a_textured_model_keeps_its_image_in_every_format(tmp_path):
    items = (floor_entity(1), box_entity(2, "cup", (0, 0, 0.05), (0.1, 0.1, 0.1)))
    entities, model = scene_of(*items), cube_model()
    link = model.robot.links[0]
    mesh = dataclasses.replace(
        link.visuals[0].mesh, uv=np.zeros((len(link.visuals[0].mesh.faces), 3, 2), np.float32)
    )
    image = Texture("glaze.png", png((20, 80, 200)))
    seen = Visual("glaze", mesh, (0.1, 0.3, 0.8, 1.0), image)
    link = dataclasses.replace(link, visuals=(seen,), friction=0.3)
    library = library_of(with_robot(model, RobotModel("cup", (link,), ())))
    placements = (kept(items[0]), placed(items[1], "cup/cube"))
    settings = ExportSettings(friction=0.6)
    export_scene(
        entities, support_graph(entities, [-1, 0]), placements, library, tmp_path, settings
    )
    assert image.content in (tmp_path / "scene.glb").read_bytes()
    compiled = simulation.load_model(tmp_path / "scene.xml")
    assert compiled.ntex == 2  # and the sky
    frictions = {compiled.geom(g).name: compiled.geom(g).friction[0] for g in range(compiled.ngeom)}
    assert frictions["cup_2_hull_0"] == 0.3 and frictions["floor_1_slab"] == 0.6
    package = tmp_path / "scene_description"
    files = {p.suffix: p.read_bytes() for p in (package / "meshes").glob("cup_2_glaze*")}
    assert set(files) == {".obj", ".mtl"}
    assert [p.read_bytes() for p in (package / "meshes").glob("*.png")] == [image.content]
    robot = yourdfpy.URDF.load(str(package / "urdf" / "scene.urdf"))
    shown = [g.visual for g in robot.scene.geometry.values() if hasattr(g.visual, "uv")]
    assert any(getattr(v.material, "image", None) is not None for v in shown)


def test_scan_ply_is_read_back(exported):
    mesh = trimesh.load_mesh(exported[0] / "map" / "chair_5.ply", process=False)
    truth = furnished_scene().entities[4].mesh
    assert np.allclose(mesh.vertices, truth.vertices) and np.array_equal(mesh.faces, truth.faces)


def test_same_scene_gives_the_same_bytes(tmp_path):
    for name in ("a", "b"):
        export_scene(*furnished_scene().arguments, tmp_path / name)
    files = sorted(p.relative_to(tmp_path / "a") for p in (tmp_path / "a").rglob("*.*"))
    assert len(files) > 20
    for file in files:
        assert (tmp_path / "a" / file).read_bytes() == (tmp_path / "b" / file).read_bytes(), file


def test_fixed_cabinet_does_not_fight_its_door(tmp_path):
    export_scene(*furnished_scene().arguments, tmp_path)
    model = simulation.load_model(tmp_path / "scene.xml")
    pairs = {(t.body_a, t.body_b) for t in simulation.touches(model)}
    assert ("cabinet_6", "cabinet_6_door") not in pairs
    freed = simulation.freed_model(tmp_path / "scene.xml", ("floor_1", "wall_2", "clock_7"))
    assert "cabinet_6" in simulation.free_bodies(freed)
    assert all(t.depth_m < TOUCH_M for t in simulation.touches(freed))


def test_free_body_sinks_to_a_lower_model_and_carries_its_children(tmp_path):
    # The table's model is 2 cm lower than the scan said: what stands on it follows, in stacks.
    items = (
        floor_entity(1),
        box_entity(2, "table", (0, 0, 0.37), (1.2, 0.8, 0.74)),
        box_entity(3, "cup", (0.1, 0, 0.79), (0.1, 0.1, 0.1)),
        box_entity(4, "cup", (0.1, 0.01, 0.89), (0.1, 0.1, 0.1)),
    )
    entities = scene_of(*items)
    low = table_model("table/low", (1.2, 0.8, 0.72))
    cups = [placed(e, "cup/cube") for e in items[2:]]
    table = placed(items[1], "table/low", lift_m=-0.01)
    library = library_of(low, cube_model())
    graph = support_graph(entities, [-1, 0, 1, 2])
    scene = export_scene(entities, graph, (kept(items[0]), table, *cups), library, tmp_path)
    shifts = scene.metrics["export"]["shift_m"]
    assert np.allclose([shifts["cup_3"], shifts["cup_4"]], [[0, 0, -0.02]] * 2, atol=POSE)
    assert scene.metrics["export"]["unresolved"] == {}


def test_overlap_with_a_neighbour_is_pushed_out_sideways(tmp_path):
    scene = cubes_scene((0, 0, 0.1), (0.195, 0.03, 0.1))
    report = export_scene(*scene.arguments, tmp_path).metrics["export"]
    assert np.allclose(report["shift_m"]["cup_2"], [-0.00501, 0, 0], atol=2e-5)
    assert report["unresolved"] == {}


def test_what_cannot_be_mended_is_named(tmp_path):
    # The second cube floats 30 cm above the floor that is said to carry it, the third on nothing.
    scene = cubes_scene((0, 0, 0.1), (1, 0, 0.4), (-1, 0, 0.5), parents=[0, 0, UNSUPPORTED])
    report = export_scene(*scene.arguments, tmp_path).metrics["export"]
    assert report["unresolved"] == {
        "cup_3": "300.0 mm above floor_1",
        "cup_4": "nothing carries it",
    }


def test_scan_hull_is_cut_where_it_reaches_into_a_model(tmp_path):
    items = (
        floor_entity(1),
        box_entity(2, "table", (0, 0, 0.37), (1.2, 0.8, 0.74)),
        box_entity(3, "chair", (0, -0.55, 0.45), (0.5, 0.5, 0.9)),  # 10 cm into the table top
    )
    entities = scene_of(*items)
    library = library_of(table_model())
    placements = (kept(items[0]), placed(items[1], "table/test"), kept(items[2], "no model"))
    graph = support_graph(entities, [-1, 0, 0])
    scene = export_scene(entities, graph, placements, library, tmp_path)
    assert np.isclose(scene.metrics["export"]["cut_share"]["chair_3"], 0.8, atol=1e-3)
    model = simulation.load_model(tmp_path / "scene.xml")
    assert all(t.depth_m < TOUCH_M for t in simulation.touches(model))
    assert np.isclose(model.body("chair_3").mass[0], 250 * 0.5 * 0.4 * 0.9, rtol=1e-3)


def test_scan_mass_is_density_times_hull(exported):
    model = simulation.load_model(exported[0] / "scene.xml")
    assert np.isclose(model.body("chair_5").mass[0], 250 * 0.45 * 0.45 * 0.9, rtol=1e-4)
    assert model.body("floor_1").mass[0] == 0


def test_stretched_link_has_the_inertia_of_the_stretched_solid():
    link = cube_model().robot.links[0]
    scale = np.array([1.5, 0.5, 2.0])
    mass, com, inertia = solid_properties(stretched(link, scale).hulls[0], 500.0)
    made = stretched(link, scale)
    assert np.isclose(made.mass_kg, mass, rtol=1e-5)
    assert np.allclose(made.com, com, atol=1e-6)
    assert np.allclose(made.inertia, inertia, rtol=1e-4, atol=1e-8)


def test_unequal_scales_of_an_articulated_model_are_refused():
    items = (floor_entity(1), box_entity(2, "cabinet", (0, 0, 0.4), (0.6, 0.5, 0.8)))
    entities = scene_of(*items)
    wrong = placed(items[1], "cabinet/doors", scale=(1.0, 1.0, 1.2))
    placements = (kept(items[0]), wrong)
    with pytest.raises(SceneError, match="cabinet_2"):
        scene_bodies(
            entities,
            support_graph(entities, [-1, 0]),
            placements,
            library_of(cabinet_model()),
            ExportSettings(),
        )


def test_unwritable_folder_is_refused_before_any_work(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(OutputError, match="cannot write"):
        export_scene(*furnished_scene().arguments, tmp_path / "file" / "out")
    assert [p.name for p in tmp_path.iterdir()] == ["file"]


@pytest.mark.parametrize(
    ("pattern", "damage", "what"),
    [
        (r'(name="cup_2".*?mass=)"[^"]+"', r'\1"0.6"', "mass of cup_2"),
        (r'(name="cup_2" pos=)"[^"]+"', r'\1"0 0 0.2"', "pose of cup_2"),
        (r'<joint name="cup_2_free" type="free" />', "", "free bodies"),
        (r"<worldbody>.*</worldbody>", "<worldbody />", "links lost"),
    ],
)
def test_a_difference_in_a_file_is_named(tmp_path, pattern, damage, what):
    scene = cubes_scene((0, 0, 0.05), side=0.1)
    export_scene(*scene.arguments, tmp_path)
    slabs, bodies = scene_bodies(*scene.arguments, ExportSettings())
    urdf = tmp_path / "scene_description" / "urdf" / "scene.urdf"
    verify_exports(slabs, bodies, tmp_path, urdf)
    path = tmp_path / "scene.xml"
    damaged, count = re.subn(pattern, damage, path.read_text(), flags=re.DOTALL)
    assert count == 1
    path.write_text(damaged)
    with pytest.raises(OutputError, match=what):
        verify_exports(slabs, bodies, tmp_path, urdf)


def test_the_floor_reaches_under_what_stands_beyond_the_part_that_was_seen():
    """Half a floor was seen; a thing past its end must not fall through."""
    floor = floor_entity(1, (1.0, 1.0))
    far = box_entity(2, "box", (6.0, -3.0, 0.2), (0.4, 0.4, 0.4), 0.3)
    (slab,) = slabs_of(floor, ExportSettings(), np.asarray(box_corners(far.box)))
    local = np.linalg.inv(slab.T_world_slab) @ np.append(far.box.center, 1.0)
    assert np.all(np.abs(local[:2]) < slab.size[:2] / 2 - 0.2)
    top = slab.T_world_slab @ [0, 0, slab.size[2] / 2, 1]
    assert np.isclose(top[2], 0.0, atol=POSE)
    assert np.all(np.abs((np.linalg.inv(slab.T_world_slab) @ [0, 0, 0, 1])[:2]) < slab.size[:2] / 2)
