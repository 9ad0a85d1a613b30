"""The models of a library that may furnish a room, drawn by role."""

from __future__ import annotations

import functools
import re
from collections.abc import Callable, Collection

import numpy as np
from scipy.spatial import ConvexHull, QhullError

from ...classes import class_named
from ...errors import LibraryError
from ...library import CadLibrary, CadModel
from ...robot_model import link_transforms
from .roles import ROLES, Role
from .tops import carrying_planes, top_of

SCALES = (0.9, 1.1)
"""Bounds of the uniform scale of what is drawn."""
_ANY_SIZE = (0.0, np.inf)
_CONTACT_M = 0.002
"""Lowest points of a model within this height touch what it stands on."""
_BOTTOM_SLACK_M = 1e-4
_LEAST_TILT_RAD = np.radians(5.0)
"""What falls when it is tilted less is not put anywhere."""


def any_model(model: CadModel) -> bool:
    """Fits always."""
    return True


class Stock:
    """The models of a library by role, shuffled; each is drawn once before any twice.

    What fits no role in size or mount, would fall over, or has no plane where something must
    stand on it is never drawn.
    """

    def __init__(self, library: CadLibrary, rng: np.random.Generator) -> None:
        self._rng, self._source = rng, library.source
        self._shuffled = [library.models[i] for i in rng.permutation(len(library.models))]
        self._fitting: dict[str, list[CadModel]] = {}
        self._drawn: dict[str, int] = {}

    def __contains__(self, name: str) -> bool:
        """Whether a role, or a class for what has no role, can be drawn at all."""
        return any(usable(model, role_named(name)) for model in self._of(name))

    def draw(
        self, name: str, fits: Callable[[CadModel], bool] = any_model
    ) -> tuple[CadModel, float]:
        """As `pick`, or any model of what is in stock where none fits.

        Raises:
            LibraryError: the library has no model for any of them.
        """
        return self.pick(name, fits) or self.pick(name) or self._missing(name)

    def pick(
        self, name: str, fits: Callable[[CadModel], bool] = any_model
    ) -> tuple[CadModel, float] | None:
        """A model for a role (or class) that ``fits``, and a scale near 1; None: there is none."""
        role = role_named(name)
        order = sorted(self._of(name), key=lambda model: self._drawn.get(model.id, 0))
        model = next((m for m in order if fits(m) and usable(m, role)), None)
        if model is None:
            return None
        self._drawn[model.id] = self._drawn.get(model.id, 0) + 1
        return model, float(self._rng.uniform(*SCALES))

    def first(self, roles: Collection[str]) -> tuple[str, CadModel, float] | None:
        """For the first of the roles that has a model: role, model and scale."""
        for role in roles:
            found = self.pick(role)
            if found is not None:
                return role, *found
        return None

    def _missing(self, name: str) -> tuple[CadModel, float]:
        raise LibraryError(
            f"{self._source} has no usable model of {name!r}", "add models of that class"
        )

    def _of(self, name: str) -> list[CadModel]:
        """What has the role's class, mount and size: tests that need no mesh."""
        if name not in self._fitting:
            role = role_named(name)
            self._fitting[name] = [model for model in self._shuffled if plausible(model, role)]
        return self._fitting[name]


def role_named(name: str) -> Role:
    """The role; for a class without one, any size and the mount of the class."""
    if name in ROLES:
        return ROLES[name]
    return Role((name,), _ANY_SIZE, _ANY_SIZE, _ANY_SIZE, (class_named(name).mount,))


def plausible(model: CadModel, role: Role) -> bool:
    """Whether class, mount, size and name of a model are those of a role."""
    name = model.id.split("/")[-1]
    sizes = zip(model.size, (role.width_m, role.depth_m, role.height_m), strict=True)
    return (
        model.class_name in role.class_names
        and model.mount in role.mounts
        and all(low <= float(size) <= high for size, (low, high) in sizes)
        and (not role.named or bool(re.search(role.named, name)))
        and (not role.unnamed or not re.search(role.unnamed, name))
    )


def usable(model: CadModel, role: Role) -> bool:
    """Whether a plausible model stands by itself and carries what its role must."""
    stands_free = "floor" in role.mounts or "surface" in role.mounts
    if stands_free and class_named(model.class_name).kind == "thing" and not stands(model):
        return False
    if role.top_m2 == 0:
        return True
    return any(top_of(model, int(p)).area_m2 >= role.top_m2 for p in carrying_planes(model))


@functools.lru_cache(maxsize=2048)
def stands(model: CadModel) -> bool:
    """Whether the centre of mass lies above what touches the floor, with something to spare.

    The least tilt at which it falls is the angle between the vertical and the line from the
    nearest edge of the contact polygon to the centre of mass. Classes that do not move in
    simulation need only reach their box's bottom.
    """
    vertices = model.mesh.vertices
    bottom = float(vertices[:, 2].min())
    if abs(bottom + float(model.size[2]) / 2) > _BOTTOM_SLACK_M:
        return False
    if not class_named(model.class_name).movable:
        return True
    feet = vertices[vertices[:, 2] < bottom + _CONTACT_M, :2].astype(np.float64)
    center = center_of_mass(model)
    try:
        edges = ConvexHull(feet).equations
    except (QhullError, ValueError):  # fewer than three corners, or all on a line
        return False
    spare = -(edges[:, :2] @ center[:2] + edges[:, 2]).max()
    return bool(np.arctan2(spare, center[2] - bottom) >= _LEAST_TILT_RAD)


@functools.lru_cache(maxsize=2048)
def center_of_mass(model: CadModel) -> np.ndarray:
    """[3] canonical frame, metres, joints closed."""
    poses = link_transforms(model.robot)
    masses = np.array([link.mass_kg for link in model.robot.links])
    centers = np.array(
        [
            poses[link.name][:3, :3] @ link.com + poses[link.name][:3, 3]
            for link in model.robot.links
        ]
    )
    return masses @ centers / masses.sum()
