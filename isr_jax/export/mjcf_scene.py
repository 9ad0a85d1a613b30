"""Border: the scene as MJCF, composed as a MuJoCo spec (mujoco)."""

# MuJoCo's compiled names have no stubs.
# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np

from ..config import ExportSettings
from ..errors import OutputError
from ..robot_model.mesh_files import MeshFiles, write_text
from ..robot_model.mjcf import (
    HIDDEN_GROUP,
    ContactModel,
    add_mesh,
    add_robot,
    make_visual,
    pose_of,
    set_contact,
    spec_xml,
)
from ..types import Mesh
from .bodies import Body
from .scan_bodies import mean_color
from .simplify import simplified
from .slabs import Slab

RENDER_WIDTH, RENDER_HEIGHT = 1280, 960


def write_mjcf(
    out_dir: Path, slabs: tuple[Slab, ...], bodies: tuple[Body, ...], settings: ExportSettings
) -> Path:
    """Write ``scene.xml`` and ``assets/``; returns the path of the scene.

    Raises:
        OutputError: the folder cannot be written.
    """
    contact = ContactModel(
        solref=(max(0.005, 2 * settings.timestep_s), 1.0),
        friction=(settings.friction, 0.005, 0.0001),
        max_hull_vertices=settings.max_hull_vertices,
    )
    files = MeshFiles(out_dir / "assets")
    spec = _empty_spec(out_dir, settings)
    _add_surroundings(spec, *_bounds(slabs, bodies))
    for slab in slabs:
        _add_slab(spec, slab, files, contact, settings.scan_max_faces)
    for body in bodies:
        add_robot(spec, body.robot, body.T_world_root, free=body.free, files=files, contact=contact)
    try:
        spec.compile()
    except ValueError as error:
        raise OutputError(
            f"MuJoCo refuses the scene: {error}", "look at the named model of the CAD library"
        ) from None
    path = out_dir / "scene.xml"
    write_text(path, spec_xml(spec))
    return path


def _empty_spec(out_dir: Path, settings: ExportSettings) -> mujoco.MjSpec:
    spec = mujoco.MjSpec()
    spec.modelname, spec.meshdir, spec.modelfiledir = "scene", "assets", str(out_dir)
    spec.compiler.degree = False
    spec.option.timestep = settings.timestep_s
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    # Pyramidal friction lets stacks creep; the elliptic cone with impratio 10 holds them.
    spec.option.cone, spec.option.impratio = mujoco.mjtCone.mjCONE_ELLIPTIC, 10
    return spec


def _bounds(slabs, bodies) -> tuple[np.ndarray, float]:
    """Middle of the scene, and the radius about it."""
    points = [b.T_world_root[:3, 3] for b in bodies]
    for slab in slabs:
        half = np.abs(slab.T_world_slab[:3, :3]) @ slab.size / 2
        points += [slab.T_world_slab[:3, 3] - half, slab.T_world_slab[:3, 3] + half]
    cloud = np.array(points) if points else np.zeros((1, 3))
    low, high = cloud.min(0), cloud.max(0)
    return (low + high) / 2, max(1.0, float(np.linalg.norm(high - low)) / 2)


def _add_surroundings(spec: mujoco.MjSpec, center: np.ndarray, radius: float) -> None:
    """Sky, lights and two cameras: ``overview`` from a corner, ``top`` from above."""
    texture = mujoco.mjtTexture.mjTEXTURE_SKYBOX
    gradient = mujoco.mjtBuiltin.mjBUILTIN_GRADIENT
    spec.add_texture(
        name="sky",
        type=texture,
        builtin=gradient,
        rgb1=[0.85, 0.9, 0.95],
        rgb2=[0.45, 0.55, 0.65],
        width=256,
        height=1536,
    )
    spec.visual.global_.offwidth, spec.visual.global_.offheight = RENDER_WIDTH, RENDER_HEIGHT
    spec.visual.headlight.ambient = [0.35, 0.35, 0.35]
    spec.visual.headlight.diffuse = [0.35, 0.35, 0.35]
    spec.visual.headlight.specular = [0.05, 0.05, 0.05]
    spec.stat.center, spec.stat.extent = center, radius
    world, toward = spec.worldbody, np.array([-0.45, 0.65, -2.0])
    # A directional light speckles flat faces with shadows of themselves; a spot does not.
    lamp = world.add_light(
        name="lamp",
        type=mujoco.mjtLightType.mjLIGHT_SPOT,
        pos=center - radius * toward,
        dir=toward / np.linalg.norm(toward),
        diffuse=[0.5, 0.5, 0.5],
        specular=[0.1, 0.1, 0.1],
    )
    lamp.cutoff, lamp.exponent = 60.0, 0.5
    for name, direction in (("overview", [-0.5, -0.65, 0.75]), ("top", [0, -1e-3, 1])):
        away = np.array(direction) / np.linalg.norm(direction)
        position = center + 1.9 * radius * away
        world.add_camera(name=name, pos=position, quat=_looking(away), fovy=45)


def _looking(backward: np.ndarray) -> np.ndarray:
    """Quaternion of a camera (x right, y up, looking along -z) whose +z is ``backward``."""
    right = np.cross([0, 0, 1], backward)
    right /= np.linalg.norm(right)
    T = np.eye(4)
    T[:3, :3] = np.stack([right, np.cross(backward, right), backward], 1)
    return pose_of(T)[1]


def _add_slab(spec, slab: Slab, files: MeshFiles, contact: ContactModel, max_faces: int) -> None:
    position, quat = pose_of(slab.T_world_slab)
    body = spec.worldbody.add_body(name=slab.name, pos=position, quat=quat)
    kinds = mujoco.mjtGeom
    geom = body.add_geom(name=f"{slab.name}_slab", type=kinds.mjGEOM_BOX, size=slab.size / 2)
    set_contact(geom, contact)
    geom.mass = 0.0
    scan = simplified(slab.scan, max_faces)
    # A one-sided sheet: seen from behind it is not there, so one can look into the room.
    sheet = add_mesh(spec, front_sheet(slab), files, f"{slab.name}_sheet")
    seen = body.add_geom(name=f"{slab.name}_sheet", type=kinds.mjGEOM_MESH, meshname=sheet)
    make_visual(seen, mean_color(scan))
    if len(scan.faces):
        local = (scan.vertices - slab.T_world_slab[:3, 3]) @ slab.T_world_slab[:3, :3]
        mesh = Mesh(local.astype(np.float32), scan.faces)
        name = add_mesh(spec, mesh, files, f"{slab.name}_scan")
        hidden = body.add_geom(name=f"{slab.name}_scan", type=kinds.mjGEOM_MESH, meshname=name)
        make_visual(hidden, mean_color(scan), HIDDEN_GROUP)


def front_sheet(slab: Slab) -> Mesh:
    """The slab's +z face, slab frame."""
    x, y, z = slab.size / 2
    corners = np.array([[-x, -y, z], [x, -y, z], [x, y, z], [-x, y, z]], np.float32)
    return Mesh(corners, np.array([[0, 1, 2], [0, 2, 3]], np.int32))
