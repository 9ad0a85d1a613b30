"""From parts to a `CadModel`: meshes, hulls, masses, planes, all computed from the solids."""

from __future__ import annotations

import dataclasses

import numpy as np

from ...cad_types import CadModel, held
from ...classes import class_named
from ...robot_model import Joint, Link, RobotModel, Visual, combined_properties, solid_properties
from ...robot_model.model import JointKind
from ...types import Mesh, PlaneSet
from ..model_files import with_content_hash
from .materials import Material
from .solids import Solid, fan_triangles, rounded
from .surfaces import Piece, Plane, model_planes

BASE = "base"
LICENCE = "MIT"


@dataclasses.dataclass(frozen=True, eq=False)
class _Part:
    link: str
    material: Material
    solid: Solid
    is_handle: bool
    carries: bool


@dataclasses.dataclass(frozen=True, eq=False)
class _Hinge:
    """A joint whose child frame stands at ``origin``, design coordinates."""

    kind: JointKind
    child: str
    parent: str
    origin: np.ndarray
    axis: np.ndarray
    upper: float
    damping: float
    friction: float


class ModelBuilder:
    """Collects convex parts and joints in design coordinates: z = 0 below, front towards -y.

    Parts touch, they never overlap: then masses add up and no hull presses on another.
    """

    def __init__(self, class_name: str, name: str, *, symmetry: int) -> None:
        self._class_name, self._name, self._symmetry = class_name, name, symmetry
        self._parts: list[_Part] = []
        self._joints: list[_Hinge] = []

    def add(
        self,
        material: Material,
        *solids: Solid,
        link: str = BASE,
        handle: bool = False,
        carries: bool = True,
    ) -> None:
        """Add solids of one material.

        A ``handle`` collides and weighs, but is not in the box. Without ``carries`` it has
        no supporting planes.
        """
        self._parts += [_Part(link, material, solid, handle, carries) for solid in solids]

    @property
    def links(self) -> list[str]:
        """Links so far, in order."""
        return list(dict.fromkeys(part.link for part in self._parts))

    def hinge(
        self, child: str, origin, axis, upper_rad: float, *, damping=0.4, friction=0.3
    ) -> None:
        """A door's hinge, closed at zero, that opens to ``upper_rad``."""
        self._join("revolute", child, origin, axis, upper_rad, damping, friction)

    def slide(self, child: str, axis, upper_m: float, *, damping=6.0, friction=2.0) -> None:
        """A drawer's rails, closed at zero, that draw out to ``upper_m``."""
        self._join("prismatic", child, (0, 0, 0), axis, upper_m, damping, friction)

    def _join(self, kind: JointKind, child, origin, axis, upper, damping, friction) -> None:
        at, along = np.asarray(origin, np.float64), np.asarray(axis, np.float64)
        hinge = _Hinge(kind, child, BASE, at, along, float(upper), float(damping), float(friction))
        self._joints.append(hinge)

    def build(self) -> CadModel:
        """The model, its root frame at the centre of its box."""
        body = np.concatenate([p.solid.vertices for p in self._parts if not p.is_handle])
        low, high = body.min(0), body.max(0)
        center = (low + high) / 2
        robot = self._robot(center)
        pieces = [Piece(p.solid, p.link, p.carries) for p in self._parts if not p.is_handle]
        planes = model_planes(pieces, high - low)
        model = CadModel(
            id=f"{self._class_name}/{self._name}",
            class_name=self._class_name,
            load_robot=held(robot),
            moving_joints=tuple(joint.name for joint in robot.moving_joints),
            size=rounded(high - low),
            planes=_plane_set(planes, center),
            plane_link=tuple(p.link for p in planes),
            plane_supporting=np.array([p.supporting for p in planes], bool),
            symmetry=self._symmetry,
            mount=class_named(self._class_name).mount,
            licence=LICENCE,
            content_hash="",
        )
        return with_content_hash(model)

    def _robot(self, center: np.ndarray) -> RobotModel:
        origins = {BASE: center}
        for hinge in self._joints:
            origins[hinge.child] = hinge.origin if hinge.kind == "revolute" else center
        links = [self._link(name, origin) for name, origin in origins.items()]
        joints = [self._joint(h, origins) for h in self._joints]
        return RobotModel(f"{self._class_name}_{self._name}", tuple(links), tuple(joints))

    def _joint(self, hinge: _Hinge, origins: dict[str, np.ndarray]) -> Joint:
        T = np.eye(4)
        T[:3, 3] = np.round(origins[hinge.child] - origins[hinge.parent], 7)
        return Joint(
            name=f"{hinge.child}_joint",
            kind=hinge.kind,
            parent=hinge.parent,
            child=hinge.child,
            T_parent_child=T,
            axis=hinge.axis,
            upper=hinge.upper,
            damping=hinge.damping,
            friction=hinge.friction,
        )

    def _link(self, name: str, origin: np.ndarray) -> Link:
        parts = [
            dataclasses.replace(p, solid=p.solid.moved(-origin))
            for p in self._parts
            if p.link == name
        ]
        hulls = tuple(p.solid.mesh() for p in parts)
        mass, com, inertia = combined_properties(
            [solid_properties(h, p.material.density_kg_m3) for h, p in zip(hulls, parts)]
        )
        materials = dict.fromkeys(p.material for p in parts)
        visuals = [
            Visual(m.name, _visual_mesh([p.solid for p in parts if p.material == m]), m.rgba)
            for m in materials
        ]
        noise = 1e-9 * np.trace(inertia)
        inertia = np.array([[_digits(v) if abs(v) > noise else 0.0 for v in r] for r in inertia])
        com = np.round(com, 6) + 0.0
        return Link(name, tuple(visuals), hulls, _digits(mass), com, inertia)


def _digits(value: float) -> float:
    """Seven digits: more would differ between machines in the last ones."""
    return float(f"{value:.7g}")


def _visual_mesh(solids: list[Solid]) -> Mesh:
    """What is seen of the solids; staves of one wall share corners, so that it stays closed."""
    vertices: list[tuple[float, ...]] = []
    rows: dict[tuple, int] = {}
    polygons = []
    for i, solid in enumerate(solids):
        # Only staves share corners with others; touching boxes stay closed bodies of their own.
        body = -1 if solid.hidden else i
        corners = [tuple(v) for v in rounded(solid.vertices).tolist()]
        for k, face in enumerate(solid.faces):
            if k in solid.hidden:
                continue
            for c in face:
                if (body, corners[c]) not in rows:
                    rows[body, corners[c]] = len(vertices)
                    vertices.append(corners[c])
            polygons.append([rows[body, corners[c]] for c in face])
    return Mesh(np.array(vertices, np.float32), fan_triangles(polygons))


def _plane_set(planes: list[Plane], center: np.ndarray) -> PlaneSet:
    corners = np.array([p.corners - center for p in planes])
    normal = np.round(np.array([p.normal for p in planes]), 7) + 0.0
    offset = -np.einsum("pc,pkc->pk", normal, corners).mean(1)
    return PlaneSet(
        normal.astype(np.float32),
        np.round(offset, 7).astype(np.float32),
        rounded(corners),
        np.round([p.area_m2 for p in planes], 7).astype(np.float32),
        np.ones(len(planes), bool),
    )
