"""Border: URDF of a model, and the model of a URDF that was written here (plain XML).

What is written reads back equal: numbers are the shortest decimals of their own precision.
Collision hulls that are axis-aligned boxes are written as ``<box>``, all others as meshes. The
friction of a link is written as PyBullet reads it; textures as ``<texture>`` and as MTL files.
Shapes are named after their links too: MuJoCo warns of names that occur twice in a file.
"""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from collections.abc import Callable
from pathlib import Path
from typing import cast, get_args

import numpy as np

from ..errors import OutputError, SceneError
from ..types import Mesh
from .mesh_files import mesh_contents, read_mesh_file
from .model import Joint, JointKind, Link, RobotModel, Texture, Visual
from .mtl import image_name
from .primitives import as_box, bounds_of, box_between, center_and_size

Element = ET.Element
MeshUri = Callable[[Mesh, str, Texture | None], str]
"""Stores a mesh and its texture under about this stem and says the URI to write."""

_EFFORT_LIMIT = 100.0  # N or N m; URDF demands one, nothing here limits effort
_VELOCITY_LIMIT = 2.0  # m/s or rad/s, likewise
_JOINT_KINDS = get_args(JointKind)
_NAME = re.compile(r"[A-Za-z0-9_.\-]+")
_MOMENTS = tuple((a, b, f"i{'xyz'[a]}{'xyz'[b]}") for a in range(3) for b in range(a, 3))


def robot_elements(model: RobotModel, prefix: str, mesh_uri: MeshUri) -> list[Element]:
    """``<link>`` and ``<joint>`` elements of a model, all names prefixed; links come first.

    Args:
        model: What to write.
        prefix: Put before every link and joint name, so that many models share one file.
        mesh_uri: Called for every mesh that is written, in a fixed order.

    Raises:
        OutputError: A name does not fit URDF.
    """
    links = [_link_element(link, prefix, mesh_uri) for link in model.links]
    return links + [joint_element(joint, prefix) for joint in model.joints]


def urdf_files(model: RobotModel) -> dict[str, bytes]:
    """Contents by relative path: ``model.urdf``, and OBJ, MTL and image files in ``meshes/``.

    Raises:
        OutputError: A name does not fit URDF, or two meshes have one.
    """
    files: dict[str, bytes] = {}

    def mesh_uri(mesh: Mesh, stem: str, texture: Texture | None) -> str:
        path = f"meshes/{stem}.obj"
        if path in files:
            raise OutputError(f"two meshes of {model.name} are called {stem}", "rename a visual")
        written = mesh_contents(mesh, stem, texture)
        files.update({f"meshes/{name}": content for name, content in written.items()})
        return path

    root = ET.Element("robot", name=_checked(model.name))
    # Without these MuJoCo looks for meshes beside the file, and drops visuals and fixed links.
    settings = {"strippath": "false", "discardvisual": "false", "fusestatic": "false"}
    ET.SubElement(ET.SubElement(root, "mujoco"), "compiler", settings)
    root.extend(robot_elements(model, "", mesh_uri))
    files["model.urdf"] = xml_bytes(root)
    return files


def write_urdf(model: RobotModel, folder: Path) -> Path:
    """Write ``model.urdf`` and ``meshes/`` into a folder; the same model gives the same bytes.

    Raises:
        OutputError: The folder cannot be written, a name does not fit URDF, or two meshes have one.
    """
    for name, content in urdf_files(model).items():
        path = folder / name
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(content)
        except OSError as error:
            raise OutputError(f"{path}: {error.strerror}", "give a writable folder") from None
    return folder / "model.urdf"


def xml_bytes(root: Element) -> bytes:
    """An indented document."""
    ET.indent(root, " ")
    return b'<?xml version="1.0"?>\n' + ET.tostring(root) + b"\n"


def _link_element(link: Link, prefix: str, mesh_uri: MeshUri) -> Element:
    element = ET.Element("link", name=_checked(prefix + link.name))
    if link.mass_kg > 0:
        inertial = ET.SubElement(element, "inertial")
        ET.SubElement(inertial, "origin", xyz=_row(link.com), rpy="0 0 0")
        ET.SubElement(inertial, "mass", value=_number(link.mass_kg))
        entries = {key: _number(link.inertia[a, b]) for a, b, key in _MOMENTS}
        ET.SubElement(inertial, "inertia", entries)
    contact = ET.SubElement(element, "contact")
    ET.SubElement(contact, "lateral_friction", value=_number(link.friction))
    for visual in link.visuals:
        element.append(_visual_element(visual, f"{prefix}{link.name}_{visual.name}", mesh_uri))
    for i, hull in enumerate(link.hulls):
        element.append(_hull_element(hull, f"{prefix}{link.name}_hull_{i}", mesh_uri))
    return element


def _visual_element(visual: Visual, name: str, mesh_uri: MeshUri) -> Element:
    element = ET.Element("visual", name=_checked(name))
    uri = mesh_uri(visual.mesh, name, visual.texture)
    ET.SubElement(ET.SubElement(element, "geometry"), "mesh", filename=uri)
    shade = "".join(f"{round(255 * min(max(c, 0.0), 1.0)):02x}" for c in visual.rgba)
    material = ET.SubElement(element, "material", name=f"{visual.name}_{shade}")
    ET.SubElement(material, "color", rgba=_row(visual.rgba))
    if visual.texture is not None:
        image = uri.rpartition("/")[0] + "/" + image_name(visual.texture)
        ET.SubElement(material, "texture", filename=image)
    return element


def _hull_element(hull: Mesh, name: str, mesh_uri: MeshUri) -> Element:
    element, bounds = ET.Element("collision", name=name), as_box(hull)
    if bounds is None:
        uri = mesh_uri(hull, name, None)
        ET.SubElement(ET.SubElement(element, "geometry"), "mesh", filename=uri)
        return element
    center, size = center_and_size(*bounds)
    ET.SubElement(element, "origin", xyz=" ".join(center), rpy="0 0 0")
    ET.SubElement(ET.SubElement(element, "geometry"), "box", size=" ".join(size))
    return element


def joint_element(joint: Joint, prefix: str = "") -> Element:
    """The ``<joint>`` element of one joint.

    Raises:
        OutputError: A name does not fit URDF.
    """
    element = ET.Element("joint", name=_checked(prefix + joint.name), type=joint.kind)
    T = np.asarray(joint.T_parent_child)
    ET.SubElement(element, "origin", xyz=_row(T[:3, 3]), rpy=_row(_rpy(T[:3, :3])))
    ET.SubElement(element, "parent", link=prefix + joint.parent)
    ET.SubElement(element, "child", link=prefix + joint.child)
    ET.SubElement(element, "axis", xyz=_row(joint.axis))
    if joint.kind != "fixed":
        limit = {"effort": _number(_EFFORT_LIMIT), "velocity": _number(_VELOCITY_LIMIT)}
        if joint.kind != "continuous":
            limit |= {"lower": _number(joint.lower), "upper": _number(joint.upper)}
        ET.SubElement(element, "limit", limit)
        dynamics = {"damping": _number(joint.damping), "friction": _number(joint.friction)}
        ET.SubElement(element, "dynamics", dynamics)
    return element


def read_urdf(path: Path) -> RobotModel:
    """The model of a URDF with box and OBJ shapes and named visuals; raises `SceneError`."""
    try:
        root = ET.fromstring(path.read_bytes())
        links = {_get(e, "name"): _read_link(e, path.parent) for e in root.findall("link")}
        joints = tuple(_read_joint(e) for e in root.findall("joint"))
    except OSError as error:
        problem = f"{error.filename or path}: {error.strerror}"
        raise SceneError(problem, "restore the file or write the model again") from None
    except (ET.ParseError, ValueError) as error:
        problem = f"{path} is no URDF that can be read: {error}"
        raise SceneError(problem, "write the model again with write_urdf") from None
    children = [joint.child for joint in joints]
    roots = [name for name in links if name not in children]
    unknown = {n for j in joints for n in (j.parent, j.child)} - set(links)
    if len(roots) != 1 or unknown or len(set(children)) != len(children):
        problem = f"{path}: its links form no tree (roots {roots}, unknown {sorted(unknown)})"
        raise SceneError(problem, "give every link but one exactly one parent joint")
    ordered = sorted(links.values(), key=lambda link: link.name != roots[0])
    return RobotModel(root.get("name", path.stem), tuple(ordered), joints)


def _child(element: Element, tag: str) -> Element:
    found = element.find(tag)
    if found is None:
        raise ValueError(f"<{element.tag} {element.get('name', '')}> has no <{tag}>")
    return found


def _get(element: Element, key: str) -> str:
    value = element.get(key)
    if value is None:
        raise ValueError(f"a <{element.tag}> has no {key!r}")
    return value


def _read_link(element: Element, folder: Path) -> Link:
    mass, com, inertia = 0.0, np.zeros(3), np.zeros((3, 3))
    inertial = element.find("inertial")
    if inertial is not None:
        mass = float(_get(_child(inertial, "mass"), "value"))
        T, moments = _read_origin(inertial), _child(inertial, "inertia")
        com = T[:3, 3]
        for a, b, key in _MOMENTS:
            inertia[a, b] = inertia[b, a] = float(moments.get(key, 0))
        if not np.array_equal(T[:3, :3], np.eye(3)):
            inertia = T[:3, :3] @ inertia @ T[:3, :3].T
    link_name = _get(element, "name")
    visuals = [
        _read_visual(e, f"visual_{i}", link_name + "_", folder)
        for i, e in enumerate(element.findall("visual"))
    ]
    hulls = [_read_shape(e, folder)[0] for e in element.findall("collision")]
    grip = element.find("contact/lateral_friction")
    friction = Link.friction if grip is None else _floats(_get(grip, "value"))[0]
    return Link(link_name, tuple(visuals), tuple(hulls), mass, com, inertia, friction)


def _read_visual(element: Element, unnamed: str, prefix: str, folder: Path) -> Visual:
    color = element.find("material/color")
    shade = "0.7 0.7 0.7 1" if color is None else _get(color, "rgba")
    red, green, blue, alpha = _floats(shade)
    name = element.get("name", unnamed).removeprefix(prefix)
    mesh, texture = _read_shape(element, folder)
    return Visual(name, mesh, (red, green, blue, alpha), texture)


def _read_shape(element: Element, folder: Path) -> tuple[Mesh, Texture | None]:
    T, box = _read_origin(element), element.find("geometry/box")
    if box is not None and np.array_equal(T[:3, :3], np.eye(3)):
        origin = element.find("origin")
        center = "0 0 0" if origin is None else origin.get("xyz", "0 0 0")
        return box_between(*bounds_of(center.split(), _get(box, "size").split())), None
    mesh = element.find("geometry/mesh")
    if mesh is None or not np.array_equal(T, np.eye(4)) or mesh.get("scale"):
        raise ValueError("a shape is neither an upright box nor a mesh in its link's frame")
    return read_mesh_file(folder / _get(mesh, "filename"))


def _read_joint(element: Element) -> Joint:
    kind = _get(element, "type")
    if kind not in _JOINT_KINDS:
        raise ValueError(f"joint type {kind!r} is not one of {', '.join(_JOINT_KINDS)}")
    axis, limit = element.find("axis"), element.find("limit")
    dynamics = element.find("dynamics")
    limits = {} if limit is None else limit.attrib
    losses = {} if dynamics is None else dynamics.attrib
    return Joint(
        name=_get(element, "name"),
        kind=cast(JointKind, kind),
        parent=_get(_child(element, "parent"), "link"),
        child=_get(_child(element, "child"), "link"),
        T_parent_child=_read_origin(element),
        axis=np.array([1.0, 0.0, 0.0] if axis is None else _floats(_get(axis, "xyz"))),
        lower=float(limits.get("lower", 0)),
        upper=float(limits.get("upper", 0)),
        damping=float(losses.get("damping", 0)),
        friction=float(losses.get("friction", 0)),
    )


def _read_origin(element: Element) -> np.ndarray:
    T, origin = np.eye(4), element.find("origin")
    if origin is not None:
        T[:3, 3] = _floats(origin.get("xyz", "0 0 0"))
        roll, pitch, yaw = _floats(origin.get("rpy", "0 0 0"))
        if roll or pitch or yaw:
            T[:3, :3] = _turn(2, yaw) @ _turn(1, pitch) @ _turn(0, roll)
    return T


def _turn(axis: int, angle: float) -> np.ndarray:
    R, (a, b) = np.eye(3), ((1, 2), (2, 0), (0, 1))[axis]
    R[a, a] = R[b, b] = np.cos(angle)
    R[a, b], R[b, a] = -np.sin(angle), np.sin(angle)
    return R


def _rpy(R: np.ndarray) -> np.ndarray:
    """Roll, pitch, yaw with R = Rz(yaw) Ry(pitch) Rx(roll); yaw = 0 where the two coincide.

    To 12 decimals: what was read is written again the same.
    """
    cosine = np.hypot(R[0, 0], R[1, 0])
    pitch = np.arctan2(-R[2, 0], cosine)
    roll, yaw = np.arctan2(R[2, 1], R[2, 2]), np.arctan2(R[1, 0], R[0, 0])
    if cosine < 1e-7:
        roll, yaw = np.arctan2(-R[1, 2], R[1, 1]), 0.0
    return np.round([roll, pitch, yaw], 12) + 0.0


def _floats(text: str) -> list[float]:
    values = [float(t) for t in text.split()]
    if not np.all(np.isfinite(values)):
        raise ValueError(f"numbers {text!r} are not finite")
    return values


def _number(value: float) -> str:
    """Shortest decimal that reads back to the same float of its own precision."""
    text = str(value) if isinstance(value, np.floating) else repr(float(value))
    text = text.removesuffix(".0")
    return "0" if text == "-0" else text


def _row(values) -> str:
    return " ".join(_number(v) for v in values)


def _checked(name: str) -> str:
    if not _NAME.fullmatch(name):
        raise OutputError(f"name {name!r} does not fit URDF", "use letters, digits and _ . -")
    return name
