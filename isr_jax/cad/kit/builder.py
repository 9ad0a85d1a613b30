"""From parts to a `CadModel`: meshes, hulls, masses, planes, all computed from the solids."""

from __future__ import annotations

import dataclasses

import numpy as np

from ...classes import Mount, class_named
from ...library import CadModel, Handle, held
from ...robot_model import (
    Joint,
    JointKind,
    Link,
    RobotModel,
    Visual,
    combined_properties,
    solid_properties,
)
from ...types import PlaneSet
from ..model_files import with_content_hash
from ..planes import Plane
from .materials import Material
from .solids import Solid, rounded
from .surfaces import TIE, Piece, model_planes
from .uv import visual_mesh

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
class _Joint:
    """A joint in design coordinates; its child's frame stands at ``origin`` if it has one."""

    kind: JointKind
    child: str
    parent: str
    origin: np.ndarray | None
    axis: np.ndarray
    lower: float
    upper: float
    damping: float
    friction: float
    at: np.ndarray | None
    """Where a hand moves it; None: at the handle."""


class ModelBuilder:
    """Collects convex parts and joints in design coordinates: z = 0 below, front towards -y.

    Parts touch, they never overlap: then masses add up and no hull presses on another. All
    joints are closed; whatever moves keeps 2 mm from everything else over its whole travel.
    """

    def __init__(self, class_name: str, *, symmetry: int, mount: Mount | None = None) -> None:
        self.class_name = class_name
        self._symmetry = symmetry
        self._mount: Mount = mount or class_named(class_name).mount
        self._parts: list[_Part] = []
        self._joints: list[_Joint] = []

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

    @property
    def size(self) -> np.ndarray:
        """[3] box with joints closed and handles left out, metres."""
        low, high = self._bounds()
        return high - low

    def hinge(
        self,
        child: str,
        origin,
        axis,
        upper_rad: float,
        *,
        parent: str = BASE,
        lower_rad: float = 0.0,
        damping: float = 0.4,
        friction: float = 0.3,
        at=None,
    ) -> None:
        """A door's hinge through ``origin``, closed at zero, that opens to ``upper_rad``.

        Args:
            child: Link that turns.
            origin: Point on the axis, design coordinates; the child's frame stands there.
            axis: Unit, design coordinates.
            upper_rad: Upper limit.
            parent: Link that the hinge is on.
            lower_rad: Lower limit, at most 0.
            damping: N m s/rad.
            friction: Coulomb friction, N m.
            at: Where a hand pulls, design coordinates; by default the middle of the handle.
        """
        limits = (lower_rad, upper_rad)
        self._join("revolute", child, parent, origin, axis, limits, (damping, friction), at)

    def slide(
        self,
        child: str,
        axis,
        upper_m: float,
        *,
        parent: str = BASE,
        damping: float = 6.0,
        friction: float = 2.0,
        at=None,
    ) -> None:
        """A drawer's rails, closed at zero, that draw out to ``upper_m`` (N s/m, N)."""
        self._join("prismatic", child, parent, None, axis, (0.0, upper_m), (damping, friction), at)

    def knob(
        self,
        child: str,
        origin,
        axis,
        upper_rad: float,
        *,
        parent: str = BASE,
        lower_rad: float = 0.0,
        damping: float = 0.002,
        friction: float = 0.01,
        at=None,
    ) -> None:
        """A hinge with the losses of something turned by two fingers."""
        limits = (lower_rad, upper_rad)
        self._join("revolute", child, parent, origin, axis, limits, (damping, friction), at)

    def swivel(
        self,
        child: str,
        origin,
        axis=(0, 0, 1),
        *,
        parent: str = BASE,
        damping: float = 0.1,
        friction: float = 0.3,
        at=None,
    ) -> None:
        """A joint that turns without end, as the seat of an office chair does."""
        self._join("continuous", child, parent, origin, axis, (0, 0), (damping, friction), at)

    def _join(self, kind: JointKind, child, parent, origin, axis, limits, losses, at) -> None:
        def point(values) -> np.ndarray | None:
            return None if values is None else np.asarray(values, np.float64)

        along = np.asarray(axis, np.float64)
        lower, upper = (float(v) for v in limits)
        damping, friction = (float(v) for v in losses)
        frame = (kind, child, parent, point(origin), along)
        self._joints.append(_Joint(*frame, lower, upper, damping, friction, point(at)))

    def build(self, name: str) -> CadModel:
        """The model ``<class>/<name>``, its root frame at the centre of its box."""
        low, high = self._bounds()
        center = (low + high) / 2
        robot = self._robot(name, center)
        pieces = [Piece(p.solid, p.link, p.carries) for p in self._parts if not p.is_handle]
        planes = model_planes(pieces, high - low)
        model = CadModel(
            id=f"{self.class_name}/{name}",
            class_name=self.class_name,
            load_robot=held(robot),
            moving_joints=tuple(joint.name for joint in robot.moving_joints),
            size=rounded(high - low),
            planes=_plane_set(planes, center),
            plane_link=tuple(p.link for p in planes),
            plane_supporting=np.array([p.supporting for p in planes], bool),
            symmetry=self._symmetry,
            mount=self._mount,
            licence=LICENCE,
            content_hash="",
            handles=tuple(self._handle(joint, center) for joint in self._ordered_joints()),
        )
        return with_content_hash(model)

    def _bounds(self) -> tuple[np.ndarray, np.ndarray]:
        body = np.concatenate([p.solid.vertices for p in self._parts if not p.is_handle])
        return body.min(0), body.max(0)

    def _ordered_joints(self) -> list[_Joint]:
        """Every joint after the one that carries its parent."""
        known, ordered, waiting = {BASE}, [], list(self._joints)
        while waiting:
            joint = next(j for j in waiting if j.parent in known)
            waiting.remove(joint)
            ordered.append(joint)
            known.add(joint.child)
        return ordered

    def _robot(self, name: str, center: np.ndarray) -> RobotModel:
        joints = self._ordered_joints()
        origins = {BASE: center}
        for joint in joints:
            origins[joint.child] = center if joint.origin is None else joint.origin
        links = [self._link(link, origin) for link, origin in origins.items()]
        moving = [_robot_joint(joint, origins) for joint in joints]
        return RobotModel(f"{self.class_name}_{name}", tuple(links), tuple(moving))

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
            Visual(m.name, visual_mesh([p.solid for p in parts if p.material == m]), m.rgba)
            for m in materials
        ]
        # Seven digits of the whole, not of each entry: what is left of products that cancel is
        # the rounding of the vertices, and differs between processors.
        decimals = 7 - int(np.floor(np.log10(np.trace(inertia))))
        inertia = np.round(inertia, decimals) + 0.0
        com = np.round(com, 6) + 0.0
        area_m2 = {m: sum(p.solid.area_m2 for p in parts if p.material == m) for m in materials}
        friction = max(materials, key=lambda m: round(area_m2[m], 6)).friction
        return Link(name, tuple(visuals), hulls, _digits(mass), com, inertia, friction)

    def _handle(self, joint: _Joint, center: np.ndarray) -> Handle:
        """Where a hand moves ``joint``, in its child's frame."""
        origin = center if joint.origin is None else joint.origin
        at, parts = joint.at, [p for p in self._parts if p.link == joint.child]
        grips = [p.solid.vertices for p in parts if p.is_handle]
        estimated = at is None and not grips
        if at is None and grips:
            points = np.concatenate(grips)
            at = (points.min(0) + points.max(0)) / 2
        elif at is None:
            at = _farthest(joint, np.concatenate([p.solid.vertices for p in parts]))
        position = np.round(at - origin, 6) + 0.0
        return Handle(f"{joint.child}_joint", joint.child, position, estimated)


def _farthest(joint: _Joint, points: np.ndarray) -> np.ndarray:
    """The point farthest from a hinge's axis, or along a slide; the middle of such an edge."""
    along = points @ joint.axis
    if joint.origin is None:
        return points[along > along.max() - 1e-6].mean(0)
    arms = points - joint.origin
    arms -= np.outer(arms @ joint.axis, joint.axis)
    reach = np.round(np.linalg.norm(arms, axis=1), 6)
    first = arms[int(np.argmax(reach))]
    return points[np.linalg.norm(arms - first, axis=1) < 1e-6].mean(0)


def _robot_joint(joint: _Joint, origins: dict[str, np.ndarray]) -> Joint:
    T = np.eye(4)
    T[:3, 3] = np.round(origins[joint.child] - origins[joint.parent], 7)
    return Joint(
        name=f"{joint.child}_joint",
        kind=joint.kind,
        parent=joint.parent,
        child=joint.child,
        T_parent_child=T,
        axis=joint.axis,
        lower=joint.lower,
        upper=joint.upper,
        damping=joint.damping,
        friction=joint.friction,
    )


def _digits(value: float) -> float:
    """Seven digits: more would differ between machines in the last ones."""
    return float(f"{value:.7g}")


def _plane_set(planes: list[Plane], center: np.ndarray) -> PlaneSet:
    corners = np.array([p.corners - center for p in planes])
    normal = np.round(np.array([p.normal for p in planes]), 7) + 0.0
    offset = -np.einsum("pc,pkc->pk", normal, corners).mean(1)
    return PlaneSet(
        normal.astype(np.float32),
        np.round(offset, 7).astype(np.float32),
        rounded(corners),
        np.round([p.area_m2 + TIE for p in planes], 7).astype(np.float32),
        np.ones(len(planes), bool),
    )
