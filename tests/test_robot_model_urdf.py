"""URDF of one model: exact both ways, the same bytes, read by other programs; scaled models."""

from __future__ import annotations

import dataclasses
import io
import logging
import xml.etree.ElementTree as ET

import mujoco
import numpy as np
import pytest
import yourdfpy
from PIL import Image

from isr_jax.errors import OutputError, SceneError, SettingError
from isr_jax.robot_model import (
    Joint,
    Link,
    RobotModel,
    Texture,
    Visual,
    as_box,
    box_between,
    combined_properties,
    joint_motion,
    link_transforms,
    read_urdf,
    robot_elements,
    scaled,
    solid_properties,
    urdf_files,
    write_urdf,
)
from isr_jax.robot_model.obj import obj_text, read_obj_text
from isr_jax.types import Mesh

ROTATION_TOLERANCE = 2e-12  # roll, pitch and yaw are written to 12 decimals
POSE_TOLERANCE = 1e-6  # yourdfpy and MuJoCo compute in other orders


def png(color: tuple[int, int, int], size=(4, 4)) -> bytes:
    written = io.BytesIO()
    Image.new("RGB", size, color).save(written, "PNG")
    return written.getvalue()


OAK, STEEL = Texture("oak.png", png((200, 140, 60))), Texture("steel.v2.png", png((90, 90, 99)))


def random_mesh(rng, *, colors=False, normals=False, uv=False) -> Mesh:
    vertices = (rng.normal(size=(20, 3)) * 10.0 ** rng.integers(-7, 3, (20, 1))).astype(np.float32)
    faces = rng.permutation(20)[:18].reshape(6, 3).astype(np.int32)
    return Mesh(
        vertices,
        faces,
        rng.integers(0, 256, (20, 3), dtype=np.uint8) if colors else None,
        rng.normal(size=(20, 3)).astype(np.float32) if normals else None,
        rng.integers(-9, 9, (6, 3, 2)).astype(np.float32) / 7 if uv else None,
    )


def tetrahedron(size: float) -> Mesh:
    vertices = size * np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], np.float32)
    faces = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]], np.int32)
    return Mesh(vertices, faces)


def link_of(name: str, rng, hulls: tuple[Mesh, ...]) -> Link:
    A = rng.normal(size=(3, 3))
    inertia = np.trace(A @ A.T) * np.eye(3) - A @ A.T
    visuals = (
        Visual("paint", random_mesh(rng), (0.1, 0.2, 1 / 3, 1.0)),
        Visual("scan", random_mesh(rng, colors=True, normals=True), (1.0, 1.0, 1.0, 0.5)),
        Visual("plain", random_mesh(rng, uv=True), (1.0, 0.0, 0.0, 1.0)),
        Visual("grain", random_mesh(rng, uv=True), (0.8, 0.5, 0.2, 1.0), OAK),
        Visual("both", random_mesh(rng, normals=True, uv=True), (0.8, 0.5, 0.2, 1.0), OAK),
        Visual("metal", random_mesh(rng, colors=True, uv=True), (0.4, 0.4, 0.4, 1.0), STEEL),
    )
    mass, com = float(rng.uniform(1, 9)), rng.normal(size=3)
    friction = float(rng.uniform(0, 1))
    return Link(name, visuals, hulls, mass, com, (inertia + inertia.T) / 2, friction)


def cabinet_model(seed: int = 0) -> RobotModel:
    """A base with a hinged, a sliding, a turning and a welded part, and odd numbers everywhere."""
    rng = np.random.default_rng(seed)
    low = rng.uniform(-1, 0, 3).astype(np.float32)
    high = rng.uniform(0.1, 1, 3).astype(np.float32)
    hulls = (box_between(low, high), tetrahedron(0.3))
    names = ("base", "door", "drawer", "knob", "plate")
    links = tuple(link_of(name, rng, hulls) for name in names)
    tilted = np.eye(4)
    tilted[:3, :3] = joint_motion(Joint("j", "revolute", "", "", np.eye(4), unit(rng)), 0.7)[:3, :3]
    tilted[:3, 3] = rng.normal(size=3)
    plain = np.eye(4)
    plain[:3, 3] = rng.normal(size=3)
    turn = unit(rng)
    return RobotModel(
        "cabinet",
        links,
        (
            Joint("hinge", "revolute", "base", "door", plain, turn, -0.2, 1.57, 0.3, 0.1),
            Joint("rail", "prismatic", "base", "drawer", tilted, unit(rng), 0.0, 1 / 3, 5.0, 2.0),
            Joint("pin", "continuous", "door", "knob", plain, unit(rng), 0.0, 0.0, 0.01, 0.0),
            Joint("weld", "fixed", "drawer", "plate", plain, np.array([1.0, 0, 0])),
        ),
    )


def unit(rng) -> np.ndarray:
    axis = rng.normal(size=3)
    return axis / np.linalg.norm(axis)


def assert_same_mesh(a: Mesh, b: Mesh) -> None:
    np.testing.assert_array_equal(a.vertices, b.vertices)
    np.testing.assert_array_equal(a.faces, b.faces)
    for x, y in ((a.colors, b.colors), (a.normals, b.normals), (a.uv, b.uv)):
        assert (x is None) == (y is None)
        if x is not None:
            np.testing.assert_array_equal(x, y)


def assert_same_robot(a: RobotModel, b: RobotModel, rotation_tolerance: float = 0.0) -> None:
    assert a.name == b.name
    for x, y in zip(a.links, b.links, strict=True):
        assert (x.name, x.mass_kg, x.friction) == (y.name, y.mass_kg, y.friction)
        np.testing.assert_array_equal(x.com, y.com)
        np.testing.assert_array_equal(x.inertia, y.inertia)
        for v, w in zip(x.visuals, y.visuals, strict=True):
            assert (v.name, v.rgba, v.texture) == (w.name, w.rgba, w.texture)
            assert_same_mesh(v.mesh, w.mesh)
        for v, w in zip(x.hulls, y.hulls, strict=True):
            assert_same_mesh(v, w)
    for x, y in zip(a.joints, b.joints, strict=True):
        for field in ("name", "kind", "parent", "child", "lower", "upper", "damping", "friction"):
            assert getattr(x, field) == getattr(y, field), field
        np.testing.assert_array_equal(x.axis, y.axis)
        np.testing.assert_array_equal(x.T_parent_child[:3, 3], y.T_parent_child[:3, 3])
        np.testing.assert_allclose(x.T_parent_child, y.T_parent_child, atol=rotation_tolerance)


@pytest.mark.parametrize("seed", range(4))
def test_what_is_written_reads_back_equal(tmp_path, seed):
    model = cabinet_model(seed)
    assert_same_robot(model, read_urdf(write_urdf(model, tmp_path)), ROTATION_TOLERANCE)


@pytest.mark.parametrize("seed", range(4))
def test_same_model_same_bytes_and_second_round_trip_is_a_fixed_point(tmp_path, seed):
    model = cabinet_model(seed)
    assert urdf_files(model) == urdf_files(cabinet_model(seed))
    again = read_urdf(write_urdf(model, tmp_path))
    assert urdf_files(read_urdf(write_urdf(again, tmp_path / "b"))) == urdf_files(again)


def test_uv_are_written_once_each_and_equal_images_share_a_file(tmp_path):
    write_urdf(cabinet_model(), tmp_path)
    images = sorted(p for p in (tmp_path / "meshes").iterdir() if p.suffix == ".png")
    assert sorted(p.read_bytes() for p in images) == sorted([OAK.content, STEEL.content])
    uv = np.array([[[0, 0], [0.5, 0], [0.5, 0.25]], [[0, 0], [0.5, 0.25], [-0.0, 1]]], np.float32)
    square = Mesh(np.eye(4, 3, dtype=np.float32), np.array([[0, 1, 2], [0, 2, 3]], np.int32), uv=uv)
    text = obj_text(square)
    assert [line for line in text.splitlines() if line.startswith("vt ")] == [
        *("vt 0.0 0.0", "vt 0.0 1.0", "vt 0.5 0.0", "vt 0.5 0.25"),
    ]
    assert "f 1/1 3/4 4/2" in text
    assert_same_mesh(read_obj_text(text), square)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3 1\n", "no triangles"),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3\n", "one form"),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/2\n", "not there"),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1 2 3\n", "no texture coordinates"),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n", "not there"),
        ("v 0 0 0\nv 1 0 nan\nv 0 1 0\nf 1 2 3\n", "not finite"),
        ("v 0 0\nv 1 0\nv 0 1\nf 1 2 3\n", "3 or 6"),
        ("f 1 2 3\n", "3 or 6"),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nf 1//1 2//1 3//1\n", "normals"),
    ],
)
def test_an_obj_that_is_none_is_refused(text, said):
    with pytest.raises(ValueError, match=said):
        read_obj_text(text)


def test_a_texture_that_cannot_be_stored_is_named(tmp_path):
    rng = np.random.default_rng(0)
    bare = Visual("bare", random_mesh(rng), (1.0, 1.0, 1.0, 1.0), OAK)
    mesh = random_mesh(rng, uv=True)
    foreign = Visual("foreign", mesh, (1.0, 1.0, 1.0, 1.0), Texture("../oak.png", b""))
    for visual, said in ((bare, "no uv"), (foreign, "oak.png")):
        link = Link("base", (visual,), (), 1.0, np.zeros(3), np.eye(3))
        with pytest.raises(OutputError, match=said):
            write_urdf(RobotModel("m", (link,), ()), tmp_path)


@pytest.mark.parametrize("image", ["map_Kd ../../secret.png", "map_Kd absent.png", "Kd 1 1 1"])
def test_an_mtl_names_one_image_beside_it(tmp_path, image):
    path = write_urdf(cabinet_model(), tmp_path / "model")
    (tmp_path / "secret.png").write_bytes(b"secret")
    (tmp_path / "model" / "meshes" / "door_grain.mtl").write_text(f"newmtl m\n{image}\n")
    with pytest.raises(SceneError, match=r"door_grain\.mtl|absent\.png"):
        read_urdf(path)


def test_boxes_are_primitives_and_only_boxes(tmp_path):
    root = ET.parse(write_urdf(cabinet_model(), tmp_path)).getroot()
    for link in root.iter("link"):
        kinds = [c.find("geometry")[0].tag for c in link.findall("collision")]
        assert kinds == ["box", "mesh"]
    skewed = box_between(np.zeros(3), np.ones(3))
    skewed.vertices[6, 0] += 1e-6
    assert as_box(skewed) is None


def test_prefixed_elements_go_into_one_scene():
    model, stored = cabinet_model(), []

    def mesh_uri(mesh, stem, texture):
        assert texture is None or mesh.uv is not None
        stored.append(stem)
        return f"package://scene/{stem}.obj"

    elements = robot_elements(model, "a_", mesh_uri) + robot_elements(model, "b_", mesh_uri)
    names = [e.get("name") for e in elements]
    assert len(set(names)) == len(names) == 2 * (len(model.links) + len(model.joints))
    assert len(set(stored)) == len(stored)
    links = {e.get("name") for e in elements if e.tag == "link"}
    for joint in (e for e in elements if e.tag == "joint"):
        assert {joint.find("parent").get("link"), joint.find("child").get("link")} <= links


# yourdfpy calls what trimesh has renamed.
@pytest.mark.filterwarnings("ignore:.*Scene.dump:DeprecationWarning")
def test_other_programs_read_it_with_the_same_kinematics(tmp_path, caplog, capfd):
    """yourdfpy's and MuJoCo's own forward kinematics against ours, and no complaint."""
    model = cabinet_model()
    path = write_urdf(model, tmp_path)
    positions = {"hinge": 0.5, "rail": 0.2, "pin": 1.0}
    ours = link_transforms(model, positions)
    urdf = yourdfpy.URDF.load(str(path), build_collision_scene_graph=True)
    urdf.update_cfg(positions)
    compiled = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(compiled)
    for name, value in positions.items():
        data.qpos[compiled.joint(name).qposadr] = value
    mujoco.mj_forward(compiled, data)
    assert compiled.njnt == len(model.moving_joints)
    for link in model.links:
        seen = urdf.get_transform(link.name)
        np.testing.assert_allclose(seen, ours[link.name], atol=POSE_TOLERANCE)
        body = data.body(link.name)
        np.testing.assert_allclose(body.xpos, ours[link.name][:3, 3], atol=POSE_TOLERANCE)
        assert compiled.body(link.name).mass[0] == pytest.approx(link.mass_kg)
    assert not [r for r in caplog.records if r.levelno >= logging.WARNING]
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda t: t.replace('type="revolute"', 'type="floating"'), "floating"),
        (lambda t: t[: len(t) // 2], "no URDF"),
        (lambda t: t.replace('<parent link="base" />', '<parent link="bass" />', 1), "bass"),
        (lambda t: t.replace("hull_1.obj", "hull_x.obj", 1), "hull_x.obj"),
        (lambda t: t.replace('xyz="', 'xyz="nan ', 1), "model.urdf"),
    ],
)
def test_a_broken_file_is_named(tmp_path, change, said):
    path = write_urdf(cabinet_model(), tmp_path)
    path.write_text(change(path.read_text()))
    with pytest.raises(SceneError, match=said):
        read_urdf(path)


def test_a_broken_mesh_is_named(tmp_path):
    path = write_urdf(cabinet_model(), tmp_path)
    mesh = tmp_path / "meshes" / "door_paint.obj"
    mesh.write_text("v 0 0 0\nf 1 2 3\n")
    with pytest.raises(SceneError, match=r"door_paint\.obj"):
        read_urdf(path)


def test_names_that_do_not_fit_are_refused(tmp_path):
    model = cabinet_model()
    with pytest.raises(OutputError, match="my cabinet"):
        write_urdf(dataclasses.replace(model, name="my cabinet"), tmp_path)
    blocked = tmp_path / "file"
    blocked.write_text("")
    with pytest.raises(OutputError, match="file"):
        write_urdf(model, blocked)


def test_mass_and_inertia_against_sampling():
    """A tetrahedron and a box as one body, against 4e5 random points in their bounds."""
    parts = [
        (tetrahedron(1.0), 600.0),
        (box_between(np.array([0, 0, -0.5]), np.array([0.4, 0.3, 0])), 300.0),
    ]
    mass, com, inertia = combined_properties([solid_properties(m, d) for m, d in parts])
    rng = np.random.default_rng(0)
    points = rng.uniform([0, 0, -0.5], [1, 1, 1], (400_000, 3))
    x, y, z = points.T
    rho = 600.0 * ((z > 0) & (x + y + z < 1)) + 300.0 * ((z < 0) & (x < 0.4) & (y < 0.3))
    weight = rho * 1.5 / len(points)
    sampled_com = weight @ points / weight.sum()
    r = points - sampled_com
    second = np.einsum("p,pa,pb->ab", weight, r, r)
    sampled = np.trace(second) * np.eye(3) - second
    share = 0.01  # 4e5 points: about 0.3 % of standard error in each
    assert mass == pytest.approx(weight.sum(), rel=share)
    np.testing.assert_allclose(com, sampled_com, atol=share)
    np.testing.assert_allclose(inertia, sampled, atol=share * np.trace(inertia))


@pytest.mark.parametrize("alpha", [0.5, 1.0, 1.7])
def test_a_scaled_model_is_the_model_of_scaled_solids(alpha):
    model = cabinet_model()
    big = scaled(model, alpha)
    for small, large in zip(model.links, big.links, strict=True):
        for hull, grown in zip(small.hulls, large.hulls, strict=True):
            np.testing.assert_allclose(grown.vertices, alpha * hull.vertices, rtol=1e-6)
        mass, com, inertia = solid_properties(small.hulls[1], 500.0)
        expected = solid_properties(large.hulls[1], 500.0)
        np.testing.assert_allclose(mass * alpha**3, expected[0], rtol=1e-6)
        np.testing.assert_allclose(com * alpha, expected[1], rtol=1e-6)
        np.testing.assert_allclose(inertia * alpha**5, expected[2], rtol=1e-5, atol=1e-7)
        np.testing.assert_allclose(large.inertia, small.inertia * alpha**5)
        assert large.mass_kg == pytest.approx(small.mass_kg * alpha**3)
    at = {"hinge": 0.4, "rail": 0.2, "pin": 0.9}
    moved = link_transforms(model, at)
    grown = link_transforms(big, at | {"rail": 0.2 * alpha})
    for name, T in moved.items():
        np.testing.assert_allclose(grown[name][:3, 3], alpha * T[:3, 3], atol=1e-12)
        np.testing.assert_allclose(grown[name][:3, :3], T[:3, :3], atol=1e-12)
    assert [j.upper for j in big.joints][:2] == [1.57, pytest.approx(alpha / 3)]


@pytest.mark.parametrize("alpha", [0.0, -1.0, float("nan"), float("inf")])
def test_a_scale_that_is_none_is_refused(alpha):
    with pytest.raises(SettingError, match="scale"):
        scaled(cabinet_model(), alpha)
