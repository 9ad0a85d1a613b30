"""Border: every export is loaded again and compared with the scene (mujoco, yourdfpy, trimesh)."""

# MuJoCo's compiled names have no stubs.
# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

import dataclasses
from pathlib import Path

import mujoco
import numpy as np
import trimesh
import yourdfpy

from ..errors import OutputError
from ..robot_model import link_transforms
from ..scene_file import ROOM_NAME, read_scene
from .bodies import Body
from .glb_scene import T_GLTF_WORLD
from .slabs import Slab
from .urdf_scene import WORLD

TOLERANCE = 1e-5
"""Relative for masses, absolute for poses (m and entries of the rotation) and joint limits."""


@dataclasses.dataclass
class _Contents:
    """What a file holds, or should hold: comparable whatever the format."""

    poses: dict[str, np.ndarray] = dataclasses.field(default_factory=dict)
    """T_world_link by link name."""
    masses: dict[str, float] = dataclasses.field(default_factory=dict)
    joints: dict[str, tuple[str, float, float]] = dataclasses.field(default_factory=dict)
    """Kind and limits of moving joints."""
    free: set[str] = dataclasses.field(default_factory=set)


def verify_exports(
    slabs: tuple[Slab, ...], bodies: tuple[Body, ...], out_dir: Path, urdf: Path
) -> None:
    """Load scene.xml, the URDF (twice), scene.glb and scene.json; compare with what was meant.

    Raises:
        OutputError: naming the file and the first difference.
    """
    meant = _meant(slabs, bodies)
    _compare(meant, _from_mujoco(out_dir / "scene.xml"), out_dir / "scene.xml")
    _compare(meant, _from_mujoco(urdf), urdf)
    _compare(meant, _from_yourdfpy(urdf), urdf)
    _compare_poses(meant.poses, _from_glb(out_dir / "scene.glb"), out_dir / "scene.glb")
    _compare_scene_json(bodies, out_dir / "scene.json")


def _meant(slabs: tuple[Slab, ...], bodies: tuple[Body, ...]) -> _Contents:
    meant = _Contents({s.name: s.T_world_slab for s in slabs}, {s.name: 0.0 for s in slabs})
    for body in bodies:
        for name, T in link_transforms(body.robot).items():
            meant.poses[name] = body.T_world_root @ T
            meant.masses[name] = body.robot.link(name).mass_kg
        for joint in body.robot.moving_joints:
            limits = (joint.lower, joint.upper) if joint.kind != "continuous" else (0.0, 0.0)
            kind = "slide" if joint.kind == "prismatic" else "hinge"
            meant.joints[joint.name] = (kind, *limits)
        if body.free:
            meant.free.add(body.name)
    return meant


def _from_mujoco(path: Path) -> _Contents:
    try:
        model = mujoco.MjModel.from_xml_path(str(path))
    except ValueError as error:
        raise OutputError(f"{path} does not load in MuJoCo: {error}", _HINT) from None
    data, found = mujoco.MjData(model), _Contents()
    mujoco.mj_kinematics(model, data)
    for i in range(1, model.nbody):
        name = model.body(i).name
        if name in (WORLD, ROOM_NAME):
            continue
        found.poses[name] = np.eye(4)
        found.poses[name][:3, :3] = data.xmat[i].reshape(3, 3)
        found.poses[name][:3, 3] = data.xpos[i]
        found.masses[name] = float(model.body_mass[i])
    kinds = {int(mujoco.mjtJoint.mjJNT_SLIDE): "slide", int(mujoco.mjtJoint.mjJNT_HINGE): "hinge"}
    for j in range(model.njnt):
        kind = kinds.get(int(model.jnt_type[j]))
        if kind is None:
            found.free.add(model.body(model.jnt_bodyid[j]).name)
            continue
        low, high = model.jnt_range[j] if model.jnt_limited[j] else (0.0, 0.0)
        found.joints[model.joint(j).name] = (kind, float(low), float(high))
    return found


def _from_yourdfpy(path: Path) -> _Contents:
    try:
        urdf = yourdfpy.URDF.load(str(path))
    except (ValueError, OSError) as error:
        raise OutputError(f"{path} does not load in yourdfpy: {error}", _HINT) from None
    found = _Contents()
    for name, link in urdf.link_map.items():
        if name in (WORLD, ROOM_NAME):
            continue
        found.poses[name] = urdf.get_transform(name, WORLD)
        found.masses[name] = float(link.inertial.mass) if link.inertial else 0.0
    for name, joint in urdf.joint_map.items():
        limit = joint.limit
        if joint.type == "floating":
            found.free.add(joint.child)
        elif joint.type == "continuous":
            found.joints[name] = ("hinge", 0.0, 0.0)
        elif joint.type != "fixed" and limit is not None:
            kind = "slide" if joint.type == "prismatic" else "hinge"
            found.joints[name] = (kind, float(limit.lower), float(limit.upper))
    return found


def _from_glb(path: Path) -> dict[str, np.ndarray]:
    graph = trimesh.load_scene(path).graph
    T_world_gltf = np.linalg.inv(T_GLTF_WORLD)
    return {name: T_world_gltf @ graph.get(name)[0] for name in graph.nodes}


_HINT = "this is a fault of the exporter; report it with the folder"


def _compare(meant: _Contents, found: _Contents, path: Path) -> None:
    _same_names("links", set(meant.poses), set(found.poses), path)
    _same_names("joints", set(meant.joints), set(found.joints), path)
    _same_names("free bodies", meant.free, found.free, path)
    _compare_poses(meant.poses, found.poses, path)
    for name, mass in meant.masses.items():
        # Layout has no mass of its own; loaders may derive one from its box.
        if mass > 0 and abs(found.masses[name] - mass) > TOLERANCE * mass:
            _differs(path, f"mass of {name}", mass, found.masses[name])
    for name, (kind, *limits) in meant.joints.items():
        if found.joints[name][0] != kind:
            _differs(path, f"kind of joint {name}", kind, found.joints[name][0])
        if not np.allclose(limits, found.joints[name][1:], rtol=0, atol=TOLERANCE):
            _differs(path, f"limits of joint {name}", limits, found.joints[name][1:])


def _compare_poses(meant: dict, found: dict, path: Path) -> None:
    for name, T in meant.items():
        if name not in found:
            _differs(path, f"node {name}", "there", "missing")
        # A slab's pose is told by its scan in the GLB, which is in world coordinates.
        if path.suffix == ".glb" and np.array_equal(found[name], np.eye(4)):
            continue
        error = float(np.abs(found[name] - T).max())
        if error > TOLERANCE:
            _differs(path, f"pose of {name}", T.tolist(), found[name].tolist())


def _compare_scene_json(bodies: tuple[Body, ...], path: Path) -> None:
    scene = read_scene(path)
    for body in bodies:
        record = scene.entity(body.name)
        if (record.cad is None) != (body.scan is not None):
            _differs(path, f"model of {body.name}", body.scan is None, record.cad is not None)
        if record.cad is not None:
            _compare_poses(
                {body.name: body.T_world_root}, {body.name: record.cad.T_world_cad}, path
            )


def _same_names(what: str, meant: set[str], found: set[str], path: Path) -> None:
    if meant != found:
        lost, extra = sorted(meant - found), sorted(found - meant)
        raise OutputError(f"{path}: {what} lost {lost[:5]}, extra {extra[:5]}", _HINT)


def _differs(path: Path, what: str, meant: object, found: object) -> None:
    raise OutputError(f"{path}: {what} is {found}, not {meant}", _HINT)
