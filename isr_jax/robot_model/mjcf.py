"""Border: models as bodies, joints and geoms of a MuJoCo spec (mujoco)."""

# MuJoCo's compiled names have no stubs.
# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

import dataclasses
import xml.etree.ElementTree as ET

import mujoco
import numpy as np

from ..geometry import nearest_rotation
from ..types import Mesh
from .mesh_files import MeshFiles
from .model import Joint, Link, RobotModel, Texture, Visual
from .mtl import image_name
from .naming import excluded_pairs
from .png import as_png
from .primitives import as_box

_DRY_FRICTION = (0.9999, 0.9999, 0.001, 0.5, 2.0)
"""Impedance of a joint's friction, as stiff as MuJoCo lets it be."""
VISUAL_GROUP = 2
COLLISION_GROUP = 3
HIDDEN_GROUP = 4


@dataclasses.dataclass(frozen=True)
class ContactModel:
    """How geoms touch. The defaults let a stack of 1, 1 and 50 kg sink 0.13 mm (MuJoCo's: it
    falls over)."""

    solref: tuple[float, float] = (0.005, 1.0)
    """Time constant (s) and damping ratio; the constant is at least two timesteps."""
    solimp: tuple[float, float, float, float, float] = (0.99, 0.999, 0.001, 0.5, 2.0)
    friction: tuple[float, float, float] = (0.8, 0.005, 0.0001)
    """Sliding (-) of what states none of its own, torsional (m), rolling (m)."""
    max_hull_vertices: int = 64
    armature: float = 1e-4
    """Added inertia of a joint, kg m^2 or kg."""


def pose_of(T: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Position and quaternion (w x y z) of a transform whose rotation may be a little off."""
    rotation = nearest_rotation(np.asarray(T, np.float64)[:3, :3])
    quat = np.zeros(4)
    mujoco.mju_mat2Quat(quat, rotation.ravel())
    return np.asarray(T, np.float64)[:3, 3], quat


def add_robot(
    spec: mujoco.MjSpec,
    model: RobotModel,
    T_world_root: np.ndarray,
    *,
    free: bool,
    files: MeshFiles,
    contact: ContactModel,
) -> None:
    """Add a model whose links and joints already carry their names in the scene.

    Args:
        spec: Takes the bodies, meshes and contact exclusions.
        model: The names of its links and joints are used as they are.
        T_world_root: Pose of the root link.
        free: Give the root a free joint; otherwise it is fixed to the world.
        files: Where mesh files and textures go; ``spec.meshdir`` must point there.
        contact: Contact parameters of every collision geom; sliding friction is the link's.
    """
    root = model.links[0]
    bodies = {root.name: _add_body(spec, spec.worldbody, root, T_world_root, files, contact)}
    if free:
        bodies[root.name].add_freejoint(name=f"{root.name}_free")
    pending = list(model.joints)
    while pending:
        joint = next(j for j in pending if j.parent in bodies)
        pending.remove(joint)
        parent, link = bodies[joint.parent], model.link(joint.child)
        body = _add_body(spec, parent, link, joint.T_parent_child, files, contact)
        bodies[joint.child] = body
        if joint.kind != "fixed":
            _add_joint(body, joint, contact)
    for a, b in excluded_pairs(model):
        spec.add_exclude(name=f"{a}__{b}", bodyname1=a, bodyname2=b)


def _add_body(spec, parent, link: Link, T_parent_link: np.ndarray, files, contact):
    position, quat = pose_of(T_parent_link)
    body = parent.add_body(name=link.name, pos=position, quat=quat)
    body.explicitinertial = True
    body.mass, body.ipos = link.mass_kg, np.asarray(link.com, np.float64)
    body.fullinertia = full_inertia(link.inertia)
    for i, hull in enumerate(link.hulls):
        geom = _add_hull_geom(spec, body, hull, f"{link.name}_hull_{i}", files, contact)
        set_contact(geom, contact)
        geom.friction = (link.friction, *contact.friction[1:])
    for i, visual in enumerate(link.visuals):
        _add_visual(spec, body, visual, f"{link.name}_visual_{i}", files)
    return body


def _add_visual(spec, body, visual: Visual, name: str, files: MeshFiles) -> None:
    texture = None if visual.texture is None else as_png(visual.texture)
    mesh = add_mesh(spec, visual.mesh, files, name, texture=texture)
    geom = body.add_geom(name=name, type=mujoco.mjtGeom.mjGEOM_MESH, meshname=mesh)
    if texture is None:
        make_visual(geom, visual.rgba)
        return
    make_visual(geom, (1.0, 1.0, 1.0, visual.rgba[3]))
    geom.material = _add_texture(spec, texture)


def _add_texture(spec: mujoco.MjSpec, texture: Texture) -> str:
    """Name of the material with this image, added if it is new; its file was written already."""
    file = image_name(texture)
    name = file.removesuffix(".png")
    if spec.material(name) is None:
        spec.texturedir = spec.meshdir
        # Shown as it is, like the colours of geoms, whatever the file says of its colour space.
        space, kind = mujoco.mjtColorSpace.mjCOLORSPACE_LINEAR, mujoco.mjtTexture.mjTEXTURE_2D
        spec.add_texture(name=name, type=kind, file=file, colorspace=space)
        material = spec.add_material(name=name)
        material.textures[mujoco.mjtTextureRole.mjTEXROLE_RGB] = name
    return name


def full_inertia(inertia: np.ndarray) -> list[float]:
    """xx, yy, zz, xy, xz, yz."""
    I = np.asarray(inertia, np.float64)
    I = np.where(np.abs(I) > 1e-9 * np.trace(I), I, 0.0)  # rounding noise of the integration
    return [I[0, 0], I[1, 1], I[2, 2], I[0, 1], I[0, 2], I[1, 2]]


def _add_hull_geom(spec, body, hull, name: str, files: MeshFiles, contact: ContactModel):
    bounds = as_box(hull)
    if bounds is None:
        return _add_mesh_geom(spec, body, hull, name, files, contact)
    low, high = (np.asarray(corner, np.float64) for corner in bounds)
    kind = mujoco.mjtGeom.mjGEOM_BOX
    return body.add_geom(name=name, type=kind, size=(high - low) / 2, pos=(low + high) / 2)


def _add_mesh_geom(spec, body, mesh, name: str, files: MeshFiles, contact: ContactModel):
    mesh_name = add_mesh(spec, mesh, files, name, contact.max_hull_vertices)
    return body.add_geom(name=name, type=mujoco.mjtGeom.mjGEOM_MESH, meshname=mesh_name)


def add_mesh(
    spec: mujoco.MjSpec,
    mesh: Mesh,
    files: MeshFiles,
    stem: str,
    max_hull_vertices: int = 64,
    texture: Texture | None = None,
) -> str:
    """Name of the mesh asset with this content, added if it is new."""
    # MuJoCo has no colours per vertex; without them equal shapes share one file.
    file = files.add(dataclasses.replace(mesh, colors=None), stem, texture)
    name = file.removesuffix(".obj")
    if spec.mesh(name) is None:
        asset = spec.add_mesh(name=name, file=file, maxhullvert=max_hull_vertices)
        # The volume of an open or flat mesh cannot be computed; inertials are explicit anyway.
        asset.inertia = mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL
    return name


def set_contact(geom, contact: ContactModel) -> None:
    """Make a geom collide, and hide it behind the visuals."""
    geom.contype, geom.conaffinity, geom.condim = 1, 1, 4
    geom.solref, geom.solimp = contact.solref, contact.solimp
    geom.friction, geom.group = contact.friction, COLLISION_GROUP
    geom.rgba = (0.8, 0.3, 0.3, 0.5)


def make_visual(geom, rgba, group: int = VISUAL_GROUP) -> None:
    """Make a geom something to look at only."""
    geom.contype, geom.conaffinity, geom.group = 0, 0, group
    geom.rgba, geom.mass = rgba, 0.0


def _add_joint(body, joint: Joint, contact: ContactModel) -> None:
    slide = joint.kind == "prismatic"
    kinds = mujoco.mjtJoint
    added = body.add_joint(
        name=joint.name,
        type=kinds.mjJNT_SLIDE if slide else kinds.mjJNT_HINGE,
        axis=np.asarray(joint.axis, np.float64),
        damping=[joint.damping, 0, 0],
        frictionloss=joint.friction,
        armature=contact.armature,
    )
    # MuJoCo's own dry friction creeps: a laptop's lid sank 70 mm in 5 s under a third of it.
    added.solref_friction, added.solimp_friction = contact.solref, _DRY_FRICTION
    added.limited = int(joint.kind != "continuous")
    if joint.kind != "continuous":
        added.range = [joint.lower, joint.upper]
        added.solref_limit, added.solimp_limit = contact.solref, contact.solimp


def spec_xml(spec: mujoco.MjSpec) -> str:
    """MJCF text of a compiled spec, with body poses and inertials at 9 digits.

    ``MjSpec.to_xml`` keeps 6, which is 0.05 mm at 50 m; and it writes the rounding noise of mesh
    geoms, all of which stand at their body's origin here.
    """
    root = ET.fromstring(spec.to_xml())
    option = root.find("option")
    if option is not None:
        option.set("timestep", _digits([spec.option.timestep]))
    bodies = {body.name: body for body in spec.bodies}
    for element in root.iter("body"):
        body = bodies[element.get("name", "")]
        element.set("pos", _digits(body.pos))
        element.set("quat", _digits(body.quat))
        inertial = element.find("inertial")
        if inertial is not None:
            inertial.attrib.clear()
            inertial.set("pos", _digits(body.ipos))
            inertial.set("mass", _digits([body.mass]))
            inertial.set("fullinertia", _digits(body.fullinertia))
        for geom in element.findall("geom"):
            _exact_geom(geom, spec)
    ET.indent(root, " ")
    return ET.tostring(root, "unicode") + "\n"


def _exact_geom(element: ET.Element, spec: mujoco.MjSpec) -> None:
    if element.get("type") == "mesh":
        element.attrib.pop("pos", None)
        element.attrib.pop("quat", None)
    else:
        geom = spec.geom(element.get("name", ""))
        element.set("pos", _digits(geom.pos))
        element.set("size", _digits(geom.size))


def _digits(values) -> str:
    # Adding 0.0 turns -0.0 into 0.0, so that equal scenes give equal bytes.
    return " ".join(f"{float(v) + 0.0:.9g}" for v in values)
