"""Border: foreign URDF as found models (yourdfpy), its files read from the given folder alone."""

from __future__ import annotations

import dataclasses
import io
import posixpath
from typing import Any, cast, get_args

import numpy as np
import yourdfpy

from ....errors import LibraryError
from ....robot_model import Joint, JointKind
from ....types import Mesh
from ..found import FoundModel
from ..names import shown
from .convex_shapes import ball, box, convex_pieces, cylinder
from .files import Files, locate
from .limits import ReadLimits
from .mesh_parts import MeshPart, Shape, moved
from .mesh_shapes import read_shape
from .rigid import folder_tags, model_name, source_of
from .robot_tree import JointFacts, LinkFacts, assembled
from .safe_xml import parse_xml
from .textures import Images

_KINDS = get_args(JointKind)
_UP = np.array([0.0, 0.0, 1.0])


def read_urdf_model(files: Files, name: str, limits: ReadLimits) -> FoundModel:
    """The model of a URDF: metres, z up. Raises `LibraryError`."""
    content = files.read(name)
    if parse_xml(content, name, limits).tag != "robot":
        raise LibraryError(f"{shown(name)} is no URDF: no <robot>", "give another file")
    robot = _parsed(content, name)
    reader = _Reader(files, name, limits, robot)
    links = [reader.link(link) for link in robot.links]
    joints = [reader.joint(joint) for joint in robot.joints]
    called = model_name(name)
    if note := reader.hollow_note():
        reader.notes += note
        # Some links with hulls and some without would let things pass through the latter.
        for link in links:
            link.hulls = []
    made = assembled(called, links, joints, reader.notes)
    return FoundModel(
        name=called,
        source=source_of(files, name),
        robot=made,
        unit_m=1.0,
        up=_UP,
        tags=(*folder_tags(files, name), str(robot.name or "")),
        notes=tuple(dict.fromkeys(reader.notes)),
    )


def referenced_files(files: Files, name: str, limits: ReadLimits) -> set[str]:
    """Meshes that a URDF uses, of those that are there; none where it cannot be read."""
    try:
        root = parse_xml(files.read(name), name, limits)
        named = {element.get("filename", "") for element in root.iter("mesh")}
        found = {resolved(files, name, reference) for reference in named}
    except LibraryError:
        return set()
    return {reference for reference in found if reference is not None}


def resolved(files: Files, name: str, reference: str) -> str | None:
    """Name of the file that a URDF means: relative, ``file://``, or ``package://``.

    A package is the nearest folder of its name above the URDF, or below any of those.
    """
    folder = posixpath.dirname(name)
    if reference.startswith("file://"):
        return locate(files, folder, reference.removeprefix("file://"))
    if "://" not in reference:
        return locate(files, folder, reference)
    package, _, rest = reference.partition("://")[2].partition("/")
    above = folder
    while True:
        if posixpath.basename(above or files.label) == package:
            found = locate(files, above, rest)
        else:
            found = locate(files, above, f"{package}/{rest}")
        if found is not None or not above:
            return found or locate(files, folder, rest)
        above = posixpath.dirname(above)


def _parsed(content: bytes, name: str) -> Any:
    try:
        urdf = yourdfpy.URDF.load(
            io.BytesIO(content),
            build_scene_graph=False,
            build_collision_scene_graph=False,
            load_meshes=False,
            load_collision_meshes=False,
        )
    # A foreign parser of a foreign file: whatever it trips over is this file's fault.
    except Exception as error:
        said = " ".join(f"{type(error).__name__}: {error}".split())[:160]
        problem = f"{shown(name)} cannot be read as URDF ({said})"
        raise LibraryError(problem, "repair the file") from None
    return urdf.robot


class _Reader:
    """Reads the links and joints of one URDF; each of its meshes once."""

    def __init__(self, files: Files, name: str, limits: ReadLimits, robot: Any) -> None:
        self._files, self._name, self._limits = files, name, limits
        self._materials = {m.name: m for m in robot.materials or []}
        self._shapes: dict[str, Shape] = {}
        self._hollow: list[str] = []
        self.notes: list[str] = []
        self._images = Images(files, limits, self.notes)

    def link(self, element: Any) -> LinkFacts:
        facts = LinkFacts(element.name)
        for visual in element.visuals:
            facts.parts += self._visual(visual, element.name)
        facts.hulls = self._hulls(element)
        if not facts.parts and element.collisions:
            facts.parts = [p for c in element.collisions for p in self._visual(c, element.name)]
            self.notes.append(f"link {element.name} has no visuals: its collision shapes are shown")
        if element.inertial is not None:
            _add_inertial(facts, element.inertial)
        return facts

    def hollow_note(self) -> list[str]:
        """A note of the links whose collision shapes are not convex, if there are any."""
        if not self._hollow:
            return []
        return [f"collision shapes dropped: those of {', '.join(self._hollow)} are not convex"]

    def joint(self, element: Any) -> JointFacts:
        kind, limit, dynamics = element.type, element.limit, element.dynamics
        if kind not in _KINDS:
            self.notes.append(f"joint {element.name}: {kind}, fixed")
        if element.mimic is not None:
            said = f"joint {element.name}: follows {element.mimic.joint}, here moves by itself"
            self.notes.append(said)
        lower = None if limit is None else limit.lower
        upper = None if limit is None else limit.upper
        limited = lower is not None and upper is not None
        joint = Joint(
            name=element.name,
            kind=cast(JointKind, kind if kind in _KINDS else "fixed"),
            parent=element.parent,
            child=element.child,
            T_parent_child=_pose(element.origin),
            axis=np.asarray(element.axis, np.float64),
            lower=lower if lower is not None and limited else 0.0,
            upper=upper if upper is not None and limited else 0.0,
            damping=_loss(dynamics, "damping"),
            friction=_loss(dynamics, "friction"),
        )
        return JointFacts(joint, limited)

    def _visual(self, element: Any, link: str) -> list[MeshPart]:
        """Parts of a visual, or of a collision that is to be seen, link frame."""
        shape = moved(self._shape(element.geometry, link), _pose(element.origin))
        material = getattr(element, "material", None)
        if material is not None:
            shape = self._coloured(shape, material)
        several = len(shape.parts) > 1
        return [
            dataclasses.replace(part, name=_part_name(element.name, part.name, several))
            for part in shape.parts
        ]

    def _coloured(self, shape: Shape, material: Any) -> Shape:
        """A URDF's own colour or texture goes over what the mesh file says."""
        known = self._materials.get(material.name, material)
        color = material.color if material.color is not None else known.color
        texture = material.texture if material.texture is not None else known.texture
        change: dict[str, Any] = {}
        if color is not None and color.rgba is not None:
            red, green, blue, alpha = (float(v) for v in color.rgba)
            change = {"rgba": (red, green, blue, alpha), "colors": None}
        if texture is not None and texture.filename:
            image = self._images.find(posixpath.dirname(self._name), texture.filename)
            if image is not None:
                change |= {"rgba": (*image.mean_rgb, 1.0), "texture": image.texture}
        if not change or any(part.texture is not None for part in shape.parts):
            return shape
        parts = tuple(dataclasses.replace(part, **change) for part in shape.parts)
        return dataclasses.replace(shape, parts=parts)

    def _hulls(self, element: Any) -> list[Mesh]:
        hulls: list[Mesh] = []
        for collision in element.collisions:
            shape = moved(self._shape(collision.geometry, element.name), _pose(collision.origin))
            if collision.geometry.mesh is None:
                hulls += [Mesh(p.vertices, p.faces) for p in shape.parts]
                continue
            pieces = [convex_pieces(Mesh(p.vertices, p.faces)) for p in shape.parts]
            if any(piece is None for piece in pieces):
                self._hollow.append(element.name)
                return []
            hulls += [hull for piece in pieces for hull in piece or ()]
        return hulls

    def _shape(self, geometry: Any, link: str) -> Shape:
        if geometry is not None and geometry.mesh is not None:
            return self._mesh(geometry.mesh)
        try:
            mesh = _primitive(geometry)
        except (TypeError, ValueError) as error:
            problem = f"{shown(self._name)}: a shape of link {link} is incomplete: {error}"
            raise LibraryError(problem, "give every shape its size") from None
        return Shape((MeshPart("shape", mesh.vertices.astype(np.float64), mesh.faces),))

    def _mesh(self, element: Any) -> Shape:
        name = resolved(self._files, self._name, element.filename or "")
        if name is None:
            problem = f"{shown(self._name)}: mesh {shown(element.filename or '')} is missing"
            raise LibraryError(problem, "give the folder that holds the URDF and its meshes")
        if name not in self._shapes:
            self._shapes[name] = read_shape(self._files, name, self._limits)
            self.notes += self._shapes[name].notes
        shape = self._shapes[name]
        scale = np.ones(3) if element.scale is None else np.ravel(element.scale).astype(np.float64)
        if not np.all(np.isfinite(scale)) or np.any(scale == 0) or scale.size not in (1, 3):
            problem = f"{shown(self._name)}: mesh scale {element.scale}"
            raise LibraryError(problem, "give three numbers that are not zero")
        # Of the mesh formats only COLLADA has a unit of its own that URDF readers honour.
        unit = (shape.unit_m or 1.0) if name.lower().endswith(".dae") else 1.0
        return moved(shape, np.diag([*(unit * scale * np.ones(3)), 1.0]))


def _primitive(geometry: Any) -> Mesh:
    if geometry is None:
        raise ValueError("no geometry")
    if geometry.box is not None:
        size = _lengths(geometry.box.size, 3)
        return box(size)
    if geometry.cylinder is not None:
        radius, length = _lengths([geometry.cylinder.radius, geometry.cylinder.length], 2)
        return cylinder(radius, length)
    if geometry.sphere is not None:
        return ball(np.full(3, _lengths([geometry.sphere.radius], 1)[0]))
    raise ValueError("no box, cylinder, sphere or mesh")


def _lengths(values: Any, count: int) -> np.ndarray:
    lengths = np.asarray(values, np.float64).reshape(-1)
    if lengths.shape != (count,) or not np.all(np.isfinite(lengths)) or np.any(lengths <= 0):
        raise ValueError(f"lengths {values}")
    return lengths


def _pose(origin: np.ndarray | None) -> np.ndarray:
    return np.eye(4) if origin is None else np.asarray(origin, np.float64)


def _loss(dynamics: Any, key: str) -> float:
    try:
        value = float(getattr(dynamics, key, None) or 0.0)
    except ValueError:
        return 0.0
    return value if np.isfinite(value) and value > 0 else 0.0


def _add_inertial(facts: LinkFacts, inertial: Any) -> None:
    T = _pose(inertial.origin)
    facts.mass_kg = float(inertial.mass or 0.0)
    facts.com = T[:3, 3]
    if inertial.inertia is not None:
        about_own = np.asarray(inertial.inertia, np.float64)
        facts.inertia = T[:3, :3] @ about_own @ T[:3, :3].T


def _part_name(visual: str | None, part: str, several: bool) -> str:
    if not visual:
        return part
    return f"{visual}_{part}" if several else visual
