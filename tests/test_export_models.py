"""Models in a scene: names, rigid groups, contact exclusions, and the MJCF that they become."""

from __future__ import annotations

import dataclasses
import io
import itertools

import mujoco
import numpy as np
import pytest
from PIL import Image

from isr_jax.borders import simulation
from isr_jax.errors import OutputError
from isr_jax.robot_model import Joint, Link, RobotModel, Texture, Visual, box_between, scaled
from isr_jax.robot_model.mesh_files import MeshFiles
from isr_jax.robot_model.mjcf import ContactModel, add_robot, pose_of, spec_xml
from isr_jax.robot_model.naming import excluded_pairs, named_in_scene, weld_groups
from isr_jax.types import Mesh

from .physics_scenes import cabinet_model, cube_model


def with_worktop() -> RobotModel:
    """The cabinet with a board that is a link of its own, fixed on top."""
    robot = cabinet_model().robot
    board = dataclasses.replace(cube_model().robot.links[0], name="worktop")
    T = np.eye(4)
    T[2, 3] = 0.45
    fixed = Joint("glue", "fixed", "base", "worktop", T, np.array([0.0, 0.0, 1.0]))
    return RobotModel("cabinet", (*robot.links, board), (*robot.joints, fixed))


def test_names_in_scene_keep_the_tree():
    named = named_in_scene(with_worktop(), "cabinet_7")
    assert [link.name for link in named.links] == [
        "cabinet_7",
        "cabinet_7_door",
        "cabinet_7_drawer",
        "cabinet_7_worktop",
    ]
    parents = {j.child: j.parent for j in named.joints}
    assert set(parents.values()) == {"cabinet_7"} and len(parents) == 3


def test_links_joined_by_fixed_joints_are_one_group():
    group = weld_groups(with_worktop())
    assert group["base"] == group["worktop"]
    assert len({group["base"], group["door"], group["drawer"]}) == 3


def test_contact_is_excluded_across_joints_only():
    pairs = {frozenset(p) for p in excluded_pairs(with_worktop())}
    expected = itertools.product(("base", "worktop"), ("door", "drawer"))
    assert pairs == {frozenset(p) for p in expected}


def compiled(tmp_path, model: RobotModel, T: np.ndarray, free: bool) -> mujoco.MjModel:
    spec = mujoco.MjSpec()
    spec.meshdir, spec.modelfiledir = "assets", str(tmp_path)
    spec.compiler.degree = False
    files = MeshFiles(tmp_path / "assets")
    add_robot(spec, model, T, free=free, files=files, contact=ContactModel())
    spec.compile()
    (tmp_path / "model.xml").write_text(spec_xml(spec))
    return simulation.load_model(tmp_path / "model.xml")


def test_a_turned_model_keeps_its_pose_mass_and_inertia(tmp_path):
    model = named_in_scene(scaled(with_worktop(), 1.3), "cabinet_7")
    quat = np.array([0.8, 0.2, -0.4, 0.4])
    T, R = np.eye(4), np.zeros(9)
    mujoco.mju_quat2Mat(R, quat / np.linalg.norm(quat))
    T[:3, :3], T[:3, 3] = R.reshape(3, 3), [123.456789, -45.6789012, 7.89012345]
    loaded = compiled(tmp_path, model, T, free=True)
    assert np.allclose(loaded.body("cabinet_7").pos, T[:3, 3], atol=1e-6)  # 9 digits of 123 m
    assert np.allclose(loaded.body("cabinet_7").quat, pose_of(T)[1], atol=1e-8)
    for link in model.links:
        body = loaded.body(link.name)
        assert np.isclose(body.mass[0], link.mass_kg, rtol=1e-8)
        assert np.allclose(body.ipos, link.com, atol=1e-8)
        moments = np.linalg.eigvalsh(np.asarray(link.inertia, float))
        assert np.allclose(np.sort(body.inertia), moments, rtol=1e-6)
    slide = loaded.joint("cabinet_7_slide")
    assert np.allclose(slide.range, [0, 1.3 * 0.3]) and np.isclose(slide.frictionloss[0], 0.5)


def test_equal_meshes_share_one_file(tmp_path):
    model = cube_model().robot
    compiled(tmp_path, named_in_scene(model, "cup_1"), np.eye(4), free=False)
    # the cube's visual and its hull are the same mesh
    assert len(list((tmp_path / "assets").iterdir())) == 1


def test_boxes_collide_as_boxes(tmp_path):
    loaded = compiled(tmp_path, named_in_scene(with_worktop(), "c"), np.eye(4), free=False)
    door = [g for g in range(loaded.ngeom) if loaded.geom(g).name == "c_door_hull_0"]
    assert loaded.geom_type[door[0]] == mujoco.mjtGeom.mjGEOM_BOX
    assert np.allclose(2 * loaded.geom_size[door[0]], [0.554, 0.02, 0.357], atol=1e-6)


def checkered(ending: str) -> Texture:
    """Red, green, blue and white quarters: what stands where shows which way up it is."""
    pixels = np.array([[[255, 0, 0], [0, 255, 0]], [[0, 0, 255], [255, 255, 255]]], np.uint8)
    written = io.BytesIO()
    Image.fromarray(pixels.repeat(16, 0).repeat(16, 1)).save(
        written,
        {"png": "PNG", "jpg": "JPEG"}[ending],
        **({"quality": 95} if ending == "jpg" else {}),
    )
    return Texture(f"quarters.{ending}", written.getvalue())


def picture_on(texture: Texture, name: str = "picture") -> RobotModel:
    """A board in x and z, 1 m wide, that shows the whole image towards -y."""
    corners = np.array([[-1, 0, -1], [1, 0, -1], [1, 0, 1], [-1, 0, 1]], np.float32) / 2
    faces = np.array([[0, 1, 2], [0, 2, 3]], np.int32)
    uv = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], np.float32)[faces]
    seen = Visual("board", Mesh(corners, faces, uv=uv), (0.5, 0.5, 0.5, 1.0), texture)
    hull = box_between(np.array([-0.5, 0.0, -0.5]), np.array([0.5, 0.05, 0.5]))
    link = Link(name, (seen,), (hull,), 1.0, np.zeros(3), np.eye(3), friction=0.37)
    return RobotModel(name, (link,), ())


@pytest.mark.parametrize("ending", ["png", "jpg"])
def test_a_texture_is_seen_the_right_way_up(tmp_path, ending):
    loaded = compiled(tmp_path, picture_on(checkered(ending)), np.eye(4), free=False)
    assert loaded.ntex == loaded.nmat == 1
    names = {p.suffix for p in (tmp_path / "assets").iterdir()}
    assert names == {".obj", ".mtl", ".png"}
    height, width = int(loaded.tex_height[0]), int(loaded.tex_width[0])
    image = loaded.tex_data.reshape(height, width, -1)
    seen, data = {}, mujoco.MjData(loaded)
    mujoco.mj_forward(loaded, data)
    board = data.geom("picture_visual_0")
    vertices = loaded.mesh_vert @ board.xmat.reshape(3, 3).T + board.xpos
    for at, face in zip(loaded.mesh_face.ravel(), loaded.mesh_facetexcoord.ravel(), strict=True):
        u, v = 0.25 + 0.5 * loaded.mesh_texcoord[face]  # the middle of its quarter
        x, _, z = np.rint(2 * vertices[at])  # OpenGL: v = 0 is the first row
        seen[int(x), int(z)] = tuple(image[int(v * height), int(u * width)] > 128)
    upper, lower = (
        {(-1, 1): (1, 0, 0), (1, 1): (0, 1, 0)},
        {(-1, -1): (0, 0, 1), (1, -1): (1, 1, 1)},
    )
    assert seen == upper | lower


def test_equal_textures_are_one_asset_and_uv_alone_are_none(tmp_path):
    spec = mujoco.MjSpec()
    spec.meshdir, spec.modelfiledir = "assets", str(tmp_path)
    files = MeshFiles(tmp_path / "assets")
    plain = picture_on(checkered("png"), "plain").links[0]
    bare = dataclasses.replace(plain.visuals[0], texture=None)
    models = [
        picture_on(checkered("png"), "a"),
        picture_on(checkered("png"), "b"),
        RobotModel("plain", (dataclasses.replace(plain, visuals=(bare,)),), ()),
    ]
    for model in models:
        add_robot(spec, model, np.eye(4), free=False, files=files, contact=ContactModel())
    loaded = spec.compile()
    assert loaded.ntex == 1 and loaded.nmesh == 2
    without = [p for p in (tmp_path / "assets").glob("*.obj") if "vt " not in p.read_text()]
    assert len(without) == 1


def test_a_texture_that_is_no_image_is_named(tmp_path):
    with pytest.raises(OutputError, match=r"broken\.jpg"):
        compiled(tmp_path, picture_on(Texture("broken.jpg", b"no image")), np.eye(4), free=False)


def test_a_link_slides_as_its_material_says(tmp_path):
    loaded = compiled(tmp_path, picture_on(checkered("png")), np.eye(4), free=False)
    hull = loaded.geom("picture_hull_0").friction
    assert np.allclose(hull, [0.37, *ContactModel().friction[1:]])
