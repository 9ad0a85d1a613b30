"""Links and joints of one model, as plain data; `urdf` and `mjcf` read and write it."""

from __future__ import annotations

import dataclasses
from typing import Literal

import numpy as np
from jaxtyping import Float

from ..types import Mesh

JointKind = Literal["fixed", "revolute", "continuous", "prismatic"]


@dataclasses.dataclass(frozen=True)
class Texture:
    """An image for the ``uv`` of a mesh, as its file holds it."""

    name: str
    """File name with its ending, ``.png`` or ``.jpg``."""
    content: bytes


@dataclasses.dataclass(frozen=True, eq=False)
class Visual:
    """A mesh to look at, link frame, with one colour or a texture."""

    name: str
    mesh: Mesh
    rgba: tuple[float, float, float, float]
    """With a texture: its mean colour, for what shows no textures."""
    texture: Texture | None = None
    """Needs ``mesh.uv``."""


@dataclasses.dataclass(frozen=True, eq=False)
class Link:
    """A rigid body. Collision is by convex hulls only."""

    name: str
    visuals: tuple[Visual, ...]
    hulls: tuple[Mesh, ...]
    """Convex, link frame, at most 64 vertices each."""
    mass_kg: float
    com: Float[np.ndarray, "3"]
    """Centre of mass, link frame, metres."""
    inertia: Float[np.ndarray, "3 3"]
    """About the centre of mass, link axes, kg m^2."""
    friction: float = 0.8
    """Sliding friction of its surface, Coulomb, no unit."""


@dataclasses.dataclass(frozen=True, eq=False)
class Joint:
    """What holds a child link to its parent."""

    name: str
    kind: JointKind
    parent: str
    child: str
    T_parent_child: Float[np.ndarray, "4 4"]
    """Child frame in the parent's, joint at zero (closed)."""
    axis: Float[np.ndarray, "3"]
    """Unit, child frame."""
    lower: float = 0.0
    upper: float = 0.0
    """Limits, radians or metres; not used by fixed and continuous joints."""
    damping: float = 0.0
    friction: float = 0.0
    """Coulomb friction, N m or N."""


@dataclasses.dataclass(frozen=True, eq=False)
class RobotModel:
    """A tree of links. ``links[0]`` is the root; its frame is the model's frame."""

    name: str
    links: tuple[Link, ...]
    joints: tuple[Joint, ...]

    @property
    def moving_joints(self) -> tuple[Joint, ...]:
        return tuple(j for j in self.joints if j.kind != "fixed")

    @property
    def mass_kg(self) -> float:
        return sum(link.mass_kg for link in self.links)

    def link(self, name: str) -> Link:
        return next(link for link in self.links if link.name == name)
