"""Foreign URDF and MJCF: every joint where its own library has it; faults repaired and said."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import mujoco
import numpy as np
import pytest
import trimesh
import yourdfpy

from isr_jax.cad.importing.found import FoundModel
from isr_jax.cad.importing.reading.convex_shapes import (
    ball,
    box,
    capsule,
    convex_pieces,
    cylinder,
    hull_of,
)
from isr_jax.cad.importing.reading.files import FolderFiles
from isr_jax.cad.importing.reading.joint_facts import sound_joint
from isr_jax.cad.importing.reading.limits import ReadLimits
from isr_jax.cad.importing.reading.mjcf_format import read_mjcf_models
from isr_jax.cad.importing.reading.stated_mass import believable
from isr_jax.cad.importing.reading.urdf_format import read_urdf_model, resolved
from isr_jax.errors import LibraryError
from isr_jax.robot_model import Joint, Link, Visual, link_transforms
from isr_jax.types import Mesh

from .foreign_models import BOMB, LIMIT, MJCF, cube_obj, cube_stl, png, urdf, write

LIMITS = ReadLimits()
RNG = np.random.default_rng(0)


def read_urdf_text(folder: Path, text: str, name: str = "a.urdf") -> FoundModel:
    write(folder, {name: text, "meshes/door.obj": cube_obj()})
    return read_urdf_model(FolderFiles(folder, LIMITS), name, LIMITS)


def read_mjcf_text(folder: Path, text: str, name: str = "a.xml") -> tuple[FoundModel, ...]:
    write(folder, {name: text, "meshes/front.stl": cube_stl()})
    return read_mjcf_models(FolderFiles(folder, LIMITS), name, LIMITS)


def world_volume(mesh: Mesh) -> float:
    return float(np.linalg.det(mesh.vertices[mesh.faces].astype(float)).sum() / 6)


def test_urdf_links_joints_colours_and_masses(tmp_path: Path) -> None:
    found = read_urdf_text(tmp_path, urdf())
    robot = found.robot
    assert [link.name for link in robot.links] == ["carcass", "door"]
    carcass, door = robot.links
    assert carcass.visuals[0].name == "side"
    assert carcass.visuals[0].rgba == (0.6, 0.4, 0.2, 1.0)
    assert carcass.mass_kg == 20 and carcass.com.tolist() == [0, 0, 0.5]
    assert door.mass_kg == 0 and not door.hulls
    np.testing.assert_allclose(np.ptp(door.visuals[0].mesh.vertices, axis=0), [0.6, 0.02, 1])
    assert world_volume(carcass.hulls[0]) == pytest.approx(0.3)
    (joint,) = robot.joints
    assert (joint.kind, joint.lower, joint.upper) == ("revolute", -1.5, 0)
    assert (joint.damping, joint.friction) == (0.3, 0.2)
    np.testing.assert_array_equal(joint.axis, [0, 0, 1])
    assert found.unit_m == 1 and found.up is not None and found.up.tolist() == [0, 0, 1]
    assert found.tags[-1] == "cupboard" and not found.notes


@pytest.mark.parametrize(
    "reference",
    [
        "meshes/door.obj",
        "./meshes/DOOR.obj",
        "package://kitchen/meshes/door.obj",
        "package://other/door.obj",
        "file:///home/me/door.obj",
    ],
)
def test_urdf_finds_its_meshes(tmp_path: Path, reference: str) -> None:
    root = tmp_path / "kitchen"
    write(
        root, {"urdf/a.urdf": "", "meshes/door.obj": "", "other/door.obj": "", "urdf/door.obj": ""}
    )
    files = FolderFiles(root, LIMITS)
    name = "urdf/a.urdf" if "package" in reference or "home" in reference else "a.urdf"
    assert resolved(files, name, reference) in (
        "meshes/door.obj",
        "other/door.obj",
        "urdf/door.obj",
    )


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        (urdf(mesh="../../etc/passwd"), "leads out of the given folder"),
        (urdf(mesh="package://../../etc/passwd"), "leads out|missing"),
        (urdf(mesh="gone.obj"), r"mesh gone\.obj is missing"),
        (BOMB + urdf(), "document type or entities"),
        (urdf().replace("</robot>", ""), "no valid XML"),
        ("<mujoco/>", "no <robot>"),
        (urdf().replace('child link="door"', 'child link="carcass"'), "loop of links"),
        (urdf().replace('child link="door"', 'child link="none"'), "unknown links"),
        (urdf().replace('<link name="door">', '<link name="carcass">'), "twice"),
        (urdf().replace("0.6 0.5 1", "0.6 -0.5 1"), "shape of link carcass is incomplete"),
        (urdf().replace('scale="0.6 0.02 1"', 'scale="0 0 0"'), "mesh scale"),
        (urdf().replace('xyz="0 0 2"', 'xyz="a b c"'), "cannot be read as URDF"),
        ('<robot name="a"><link name="b"/></robot>', "no faces"),
    ],
)
def test_bad_urdf_is_refused_with_its_reason(tmp_path: Path, text: str, reason: str) -> None:
    with pytest.raises(LibraryError, match=reason) as caught:
        read_urdf_text(tmp_path / "sub", text)
    assert caught.value.hint


def test_loops_of_links_are_refused(tmp_path: Path) -> None:
    joint = '<joint name="{}" type="fixed"><parent link="{}"/><child link="{}"/></joint>'
    shape = '<visual><geometry><sphere radius="1"/></geometry></visual>'
    links = "".join(f'<link name="{n}">{shape}</link>' for n in "abc")
    text = links + joint.format("x", "b", "c") + joint.format("y", "c", "b")
    with pytest.raises(LibraryError, match="loop of links"):
        read_urdf_text(tmp_path, f'<robot name="r">{text}</robot>')


@pytest.mark.parametrize(
    ("old", "new", "kind", "limits", "note"),
    [
        (LIMIT, "", "revolute", (-np.pi, np.pi), "no limits stated"),
        ('type="revolute"', 'type="continuous"', "continuous", (0, 0), None),
        ('type="revolute"', 'type="floating"', "fixed", (0, 0), "floating, fixed"),
        ('type="revolute"', 'type="planar"', "fixed", (0, 0), "planar, fixed"),
        (f'type="revolute">{""}', 'type="prismatic">', "prismatic", (-1.5, 0), None),
        ('lower="-1.5" upper="0"', 'lower="2" upper="-1"', "revolute", (-1, 2), "exchanged"),
        ('lower="-1.5" upper="0"', 'lower="0" upper="0"', "fixed", (0, 0), "no travel"),
        ('lower="-1.5" upper="0"', 'lower="-9e9" upper="9e9"', "continuous", (0, 0), "turns"),
        ('lower="-1.5" upper="0"', 'lower="0.5" upper="2"', "revolute", (0, 1.5), "outside"),
        ('xyz="0 0 2"', 'xyz="0 0 0"', "fixed", (0, 0), "no direction"),
        ("</joint>", '<mimic joint="x"/></joint>', "revolute", (-1.5, 0), "follows x"),
    ],
)
def test_joints_are_made_sound_and_it_is_said(tmp_path, old, new, kind, limits, note) -> None:
    assert old in urdf()
    found = read_urdf_text(tmp_path, urdf().replace(old, new))
    (joint,) = found.robot.joints
    assert joint.kind == kind
    np.testing.assert_allclose((joint.lower, joint.upper), limits)
    assert any(note in n for n in found.notes) if note else not found.notes


def test_a_slide_without_limits_gets_the_length_of_what_slides(tmp_path: Path) -> None:
    text = urdf(limit="").replace('type="revolute"', 'type="prismatic"')
    found = read_urdf_text(tmp_path, text)
    assert found.robot.joints[0].upper == pytest.approx(1.0)
    text = urdf().replace('type="revolute"', 'type="prismatic"').replace("-1.5", "-1e6")
    assert read_urdf_text(tmp_path, text).robot.joints[0].lower == 0


def test_moving_zero_into_the_limits_keeps_the_poses() -> None:
    T = np.eye(4)
    T[:3, 3] = 1, 2, 3
    axis = np.array([0.6, 0, 0.8])
    joint = Joint("j", "revolute", "a", "b", T, axis, 0.5, 2.0)
    moved = sound_joint(joint, True, 1.0, [])
    link = Link("a", (), (), 0.0, np.zeros(3), np.zeros((3, 3)))
    for position in (0.5, 1.1, 2.0):
        poses = [
            link_transforms(_two(link, j), {"j": q})["b"]
            for j, q in ((joint, position), (moved, position - 0.5))
        ]
        np.testing.assert_allclose(*poses, atol=1e-12)


def _two(link: Link, joint: Joint):
    from isr_jax.robot_model import RobotModel

    return RobotModel("r", (link, dataclasses.replace(link, name="b")), (joint,))


def solid_link(name: str, mass: float, inertia: np.ndarray) -> Link:
    mesh = box(np.array([0.4, 0.3, 0.2]))
    visual = Visual("v", mesh, (1.0, 1.0, 1.0, 1.0))
    return Link(name, (visual,), (), mass, np.zeros(3), inertia)


GOOD = np.diag([0.13, 0.2, 0.25])


@pytest.mark.parametrize(
    ("mass", "inertia", "said"),
    [
        (5.0, np.eye(3), "far too large"),
        (0.0, np.eye(3), "not positive"),
        (-1.0, GOOD, "not positive"),
        (np.nan, GOOD, "not positive"),
        (5.0, np.full((3, 3), np.nan), "not finite"),
        (5.0, np.diag([0.1, -0.1, 0.1]), "that of no body"),
        (5.0, np.diag([0.01, 0.01, 0.1]), "that of no body"),
        (1e-3, GOOD * 1e-4, "no material"),
        (5e3, GOOD * 1e3, "no material"),
    ],
)
def test_absurd_masses_are_dropped_and_it_is_said(mass, inertia, said) -> None:
    notes: list[str] = []
    bad, good = believable([solid_link("bad", mass, inertia), solid_link("good", 9.0, GOOD)], notes)
    assert bad.mass_kg == 0 and not bad.inertia.any() and good.mass_kg == 9
    assert len(notes) == 1 and "bad" in notes[0] and said in notes[0]


def test_one_mass_for_everything_is_a_placeholder() -> None:
    notes: list[str] = []
    links = [solid_link(n, 5.0, GOOD) for n in "abc"]
    assert all(link.mass_kg == 0 for link in believable(links, notes)) and "placeholder" in notes[0]
    assert all(link.mass_kg == 5 for link in believable(links[:2], []))


@pytest.mark.parametrize(
    ("mesh", "true_volume", "within"),
    [
        (box(np.array([1.0, 2.0, 3.0])), 6.0, 1e-6),
        (cylinder(0.5, 2.0), np.pi / 2, 0.01),
        (ball(np.array([1.0, 1.0, 2.0])), 8 * np.pi / 3, 0.25),
        (capsule(0.5, 1.0), np.pi / 4 + np.pi / 6, 0.16),
    ],
)
def test_primitives_are_convex_closed_and_small(mesh: Mesh, true_volume, within) -> None:
    solid = trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)
    assert solid.is_watertight and solid.is_convex and len(mesh.vertices) <= 64
    assert true_volume * (1 - within) <= solid.volume <= true_volume * (1 + 1e-9)


def test_hulls_have_few_corners_lie_inside_and_are_nearly_as_large() -> None:
    points = RNG.normal(size=(3000, 3))
    points /= np.linalg.norm(points, axis=1, keepdims=True)
    hull = hull_of(points)
    assert hull is not None and len(hull.vertices) <= 64
    solid = trimesh.Trimesh(hull.vertices, hull.faces, process=False)
    assert solid.is_watertight and solid.is_convex
    assert 0.85 * 4 * np.pi / 3 < solid.volume < 4 * np.pi / 3
    assert hull_of(points * [1, 1, 0]) is None


def test_only_convex_pieces_become_hulls() -> None:
    two = trimesh.util.concatenate(
        [trimesh.creation.box(), trimesh.creation.icosphere().apply_translation([3, 0, 0])]
    )
    pieces = convex_pieces(Mesh(np.array(two.vertices), np.array(two.faces)))
    assert pieces is not None and [len(p.vertices) for p in pieces] == [8, 64]
    ring = trimesh.creation.annulus(r_min=0.5, r_max=1, height=0.2)
    assert convex_pieces(Mesh(np.array(ring.vertices), np.array(ring.faces))) is None
    sheet = Mesh(np.eye(3), np.array([[0, 1, 2]]))
    assert convex_pieces(sheet) is None


def test_collision_meshes_that_are_not_convex_are_dropped(tmp_path: Path) -> None:
    ring = trimesh.creation.annulus(r_min=0.5, r_max=1, height=0.2).export(file_type="stl")
    write(tmp_path, {"ring.stl": ring})
    old = '<collision><origin xyz="0 0 0.5"/><geometry><box size="0.6 0.5 1"/>'
    text = urdf().replace(old, '<collision><geometry><mesh filename="ring.stl"/>')
    found = read_urdf_text(tmp_path, text)
    assert not found.robot.links[0].hulls and "not convex" in found.notes[0]


def test_mjcf_bodies_become_links_on_their_axes(tmp_path: Path) -> None:
    (found,) = read_mjcf_text(tmp_path, MJCF)
    robot = found.robot
    assert [link.name for link in robot.links] == ["box", "drawer", "knob"]
    pull, turn = robot.joints
    assert (pull.kind, pull.lower, pull.upper) == ("prismatic", 0, 0.3)
    assert (pull.damping, pull.friction) == (2, 1)
    assert turn.kind == "revolute" and turn.upper == pytest.approx(np.pi / 2)
    poses = link_transforms(robot, {"pull": 0.1})
    np.testing.assert_allclose(poses["knob"][:3, 3], [0, -0.5, 0.21], atol=1e-9)
    assert [link.mass_kg for link in robot.links] == pytest.approx([8, 1, 0.1])
    assert len(robot.links[1].hulls) == 1
    low = robot.links[0].visuals[0].mesh.vertices.min(0)
    np.testing.assert_allclose(low, [-0.3, -0.3, 0], atol=1e-6)
    assert set(found.notes) == {"left out: lights", "ground planes left out"}


def test_several_joints_of_a_body_are_a_chain_that_moves_like_it(tmp_path: Path) -> None:
    joints = (
        '<joint name="a" type="slide" axis="1 0 0" range="-1 1" limited="true"/>'
        '<joint name="b" axis="0 0 1" pos="0.1 0.2 0" range="-90 90" limited="true"/>'
        '<joint name="c" axis="0 1 1" pos="0 0 0.3"/>'
    )
    text = (
        '<mujoco><worldbody><geom size="0.1"/><body name="arm" pos="0.2 0 0" euler="10 20 30">'
        f'{joints}<geom name="g" type="box" size="0.1 0.2 0.3"/></body></worldbody></mujoco>'
    )
    (found,) = read_mjcf_text(tmp_path, text)
    kinds = [(j.name, j.kind) for j in found.robot.moving_joints]
    assert kinds == [("a", "prismatic"), ("b", "revolute"), ("c", "continuous")]
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    corners = found.robot.link("arm").visuals[0].mesh.vertices
    for q in RNG.uniform(-0.9, 0.9, (5, 3)):
        data.qpos[:] = q
        mujoco.mj_kinematics(model, data)
        T = link_transforms(found.robot, dict(zip("abc", q, strict=True)))["arm"]
        R, center = data.geom("g").xmat.reshape(3, 3), data.geom("g").xpos
        local = (corners @ T[:3, :3].T + T[:3, 3] - center) @ R
        np.testing.assert_allclose(np.abs(local), np.tile([0.1, 0.2, 0.3], (8, 1)), atol=1e-6)
        assert len(np.unique(np.sign(local), axis=0)) == 8


def test_ball_and_free_joints_springs_and_references(tmp_path: Path) -> None:
    text = (
        '<mujoco><worldbody><body name="lamp"><freejoint/><geom size="0.1" pos="0 0 0.5"/>'
        '<body name="head" pos="0 0 0.6"><joint name="neck" type="ball"/><geom size="0.1"/></body>'
        '<body name="arm"><joint name="up" type="hinge" ref="20" range="10 50" stiffness="3"/>'
        '<geom size="0.1"/></body></body></worldbody></mujoco>'
    )
    (found,) = read_mjcf_text(tmp_path, text)
    names = [j.name for j in found.robot.moving_joints]
    assert names == ["neck_x", "neck_y", "neck_z", "up"]
    up = found.robot.moving_joints[3]
    np.testing.assert_allclose(np.degrees([up.lower, up.upper]), [-10, 30])
    assert found.robot.links[0].name == "lamp"
    assert any("three hinges" in n for n in found.notes)
    assert any("spring left out" in n for n in found.notes)


def test_objects_that_stand_apart_are_models_of_their_own(tmp_path: Path) -> None:
    cup = '<body name="{0}" pos="{1} 0 0">{2}<geom type="box" size="0.1 0.1 0.1"/></body>'
    apart = cup.format("a", 0, "") + cup.format("b", 1, "") + cup.format("c", 1.2, "")
    free = cup.format("d", 1.4, "<freejoint/>")
    text = f"<mujoco><worldbody>{apart}{free}</worldbody></mujoco>"
    found = read_mjcf_text(tmp_path, text, "cups.xml")
    assert [m.name for m in found] == ["cups_a", "cups_b", "cups_d"]
    assert [len(m.robot.links) for m in found] == [1, 3, 1]
    low = [m.robot.links[0].visuals[0].mesh.vertices.min(0)[0] for m in (found[0], found[2])]
    np.testing.assert_allclose(low, [-0.1, 1.3])
    assert len({m.source for m in found}) == 3


def test_mjcf_textures_colours_and_coordinates(tmp_path: Path) -> None:
    text = (
        '<mujoco><compiler meshdir="meshes" texturedir="images"/><asset>'
        '<texture name="t" type="2d" file="t.png"/><material name="m" texture="t"/>'
        '<texture name="gone" type="2d" file="gone.png"/>'
        '<material name="n" texture="gone" rgba="0.2 0.4 0.6 1"/>'
        '<mesh file="front.obj"/></asset><worldbody>'
        '<geom type="mesh" mesh="front" material="m"/>'
        '<geom type="box" size="1 1 1" material="m"/><geom size="1" material="n"/>'
        '<geom size="1" rgba="1 0 0 0.5"/></worldbody></mujoco>'
    )
    write(tmp_path, {"meshes/front.obj": cube_obj(uv=True), "images/t.png": png()})
    (found,) = read_mjcf_text(tmp_path, text)
    mesh, block, ball_, red = found.robot.links[0].visuals
    assert mesh.texture is not None and mesh.texture.content == png() and mesh.mesh.uv is not None
    _same_texture_places(mesh.mesh)
    mean = (200 / 255, 40 / 255, 10 / 255)
    np.testing.assert_allclose(block.rgba, (*mean, 1), atol=1e-3)
    assert block.texture is None
    np.testing.assert_allclose(ball_.rgba, (0.2, 0.4, 0.6, 1), atol=1e-6)
    assert red.rgba == (1, 0, 0, 0.5)
    assert "texture gone.png is missing: the material's colour" in found.notes


def _same_texture_places(mesh: Mesh) -> None:
    """Corners have the coordinates that the cube's file gives them: of its top, u = x, v = y."""
    corners = mesh.vertices[mesh.faces]
    top = np.all(corners[..., 2] > corners[..., 2].max() - 1e-6, axis=1)
    assert top.sum() == 2 and mesh.uv is not None
    place = corners[top][..., :2] - corners[top][..., :2].min((0, 1))
    np.testing.assert_allclose(mesh.uv[top], place, atol=1e-6)


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        (BOMB + MJCF, "document type or entities"),
        (MJCF.replace("front.stl", "../../../etc/passwd"), "leads out of the given folder"),
        (MJCF.replace("front.stl", "gone.stl"), r"needs gone\.stl, which is not there"),
        (MJCF.replace("<worldbody>", '<include file="../../x.xml"/><worldbody>', 1), "leads out"),
        (MJCF.replace("<worldbody>", '<include file="a.xml"/><worldbody>', 1), "includes itself"),
        (MJCF.replace('size="0.02"', 'size="-1"'), "does not compile"),
        (MJCF.replace("<asset>", '<asset><hfield name="h" file="h.png"/>'), "height fields"),
        (MJCF.replace("<asset>", '<asset><model file="m.xml"/>'), "other models attached"),
        (MJCF.replace("<asset>", '<extension><plugin plugin="p"/></extension><asset>'), "plugins"),
        (
            "<mujoco><worldbody>"
            + '<replicate count="100">' * 3
            + '<geom size="1"/>'
            + "</replicate>" * 3
            + "</worldbody></mujoco>",
            "too many times",
        ),
        ("<mujoco><worldbody/></mujoco>", "no geoms"),
        ("<robot/>", "no <mujoco>"),
    ],
)
def test_bad_mjcf_is_refused_with_its_reason(tmp_path: Path, text: str, reason: str) -> None:
    with pytest.raises(LibraryError, match=reason) as caught:
        read_mjcf_text(tmp_path / "sub", text)
    assert caught.value.hint


def test_mujoco_reads_nothing_from_disk_by_itself(tmp_path: Path) -> None:
    """A mesh outside the folder stays unread, although MuJoCo alone would find it."""
    write(tmp_path, {"secret.stl": cube_stl()})
    text = MJCF.replace('meshdir="meshes"', f'meshdir="{tmp_path}"').replace(
        "front.stl", "secret.stl"
    )
    with pytest.raises(LibraryError, match=r"leads out|not there"):
        read_mjcf_text(tmp_path / "sub", text)


def kept_urdf_joints(path: Path) -> None:
    """Every joint of a URDF as yourdfpy has it: kind, frame, axis, limits, parent, child."""
    ours = read_urdf_model(FolderFiles(path.parent, LIMITS), path.name, LIMITS).robot
    theirs = yourdfpy.URDF.load(str(path), load_meshes=False)
    assert {j.name for j in ours.joints} == set(theirs.joint_map)
    assert {link.name for link in ours.links} == set(theirs.link_map)
    moving = theirs.actuated_joint_names
    middle = {
        n: np.mean([theirs.joint_map[n].limit.lower, theirs.joint_map[n].limit.upper])
        for n in moving
    }
    for positions in ({}, middle):
        theirs.update_cfg(np.array([positions.get(n, 0.0) for n in moving]))
        poses = link_transforms(ours, positions)
        for joint in ours.joints:
            other = theirs.joint_map[joint.name]
            assert (joint.kind, joint.parent, joint.child) == (
                other.type,
                other.parent,
                other.child,
            )
            T = theirs.get_transform(joint.child, ours.links[0].name)
            np.testing.assert_allclose(poses[joint.child], T, atol=1e-9)
            if joint.kind != "fixed":
                axis = other.axis / np.linalg.norm(other.axis)
                np.testing.assert_allclose(joint.axis, axis, atol=1e-12)
                assert (joint.lower, joint.upper) == (other.limit.lower, other.limit.upper)


@pytest.mark.data
def test_every_joint_of_the_synthesised_urdfs_is_kept(shared_data: Path) -> None:
    paths = sorted((shared_data / "cad" / "scene_synth_articulated").glob("*/*.urdf"))
    assert len(paths) == 16
    for path in paths:
        kept_urdf_joints(path)


def body_name(model: mujoco.MjModel, body: int) -> str:
    return model.body(body).name.replace(" ", "_") or f"body_{body}"


def kept_mjcf_joints(folder: Path, name: str) -> int:
    """Every joint but free ones as MuJoCo has it: kind, world axis, world anchor, range, body."""
    found = read_mjcf_models(FolderFiles(folder, LIMITS), name, LIMITS)
    model = mujoco.MjModel.from_xml_path(str(folder / name))
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    kinds = {2: "prismatic", 3: "revolute"}
    rows = [r for r in range(model.njnt) if model.jnt_type[r] != 0]
    ours = {j.name: (j, m.robot) for m in found for j in m.robot.moving_joints}
    assert set(ours) == {model.joint(r).name.replace(" ", "_") for r in rows}
    for row in rows:
        joint, robot = ours[model.joint(row).name.replace(" ", "_")]
        body = int(model.jnt_bodyid[row])
        assert joint.kind == kinds[int(model.jnt_type[row])]
        assert joint.child == body_name(model, body)
        assert joint.parent == body_name(model, int(model.body_parentid[body]))
        T = link_transforms(robot)[joint.child]
        np.testing.assert_allclose(T[:3, 3], data.xanchor[row], atol=1e-6)
        np.testing.assert_allclose(T[:3, :3] @ joint.axis, data.xaxis[row], atol=1e-6)
        np.testing.assert_allclose([joint.lower, joint.upper], model.jnt_range[row], atol=1e-9)
        dof = int(model.jnt_dofadr[row])
        assert joint.friction == model.dof_frictionloss[dof]
    return len(rows)


@pytest.mark.data
def test_every_joint_of_furniture_sim_is_kept(shared_data: Path) -> None:
    folder = shared_data / "cad" / "furniture_sim"
    documents = [*folder.glob("*.xml"), *folder.glob("kitchen/*.xml")]
    names = sorted(str(path.relative_to(folder)) for path in documents)
    assert len(names) == 16
    assert sum(kept_mjcf_joints(folder, name) for name in names) == 67
