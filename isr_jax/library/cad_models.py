"""CAD models and the library that holds them: what matching, alignment and export read."""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, Literal

import numpy as np
from jaxtyping import Bool, Float

from ..classes import Mount, class_named
from ..config import HullMethod
from ..errors import LibraryError
from ..geometry.surface_samples import SurfaceSamples, surface_samples
from ..robot_model import RobotModel, merged_mesh
from ..types import Mesh, PlaneSet
from .arrays import LibraryArrays, library_arrays

Collision = Literal["exact", "stated", "coacd", "vhacd", "none"]
"""How a model's hulls were made: by construction, by an imported file, by CoACD, by V-HACD (the
fast stand-in), or not yet."""


@dataclasses.dataclass(frozen=True, eq=False)
class Handle:
    """Where a hand moves a joint."""

    joint: str
    link: str
    position: Float[np.ndarray, "3"]
    """Link frame, metres."""
    estimated: bool = False
    """True: no handle was stated; it is the point of the link farthest from the joint."""


@dataclasses.dataclass(frozen=True, eq=False)
class CadModel:
    """One model in canonical pose: z up, front towards -y, origin at the centre of its box."""

    id: str
    """``<class>/<name>``, the folder below the library's root."""
    class_name: str
    load_robot: Callable[[], RobotModel]
    """Reads links and joints; models of a large library are read only when they are used."""
    moving_joints: tuple[str, ...]
    size: Float[np.ndarray, "3"]
    """Box with joints closed and handles left out, metres."""
    planes: PlaneSet
    """[planes]: unpadded, canonical frame."""
    plane_link: tuple[str, ...]
    """The link that owns each plane."""
    plane_supporting: Bool[np.ndarray, " planes"]
    symmetry: int
    """Order of rotational symmetry about z: 1, 2, 4, or 0 = round."""
    mount: Mount
    licence: str
    content_hash: str
    """Of its files: what is stored about a model is stored under it."""
    handles: tuple[Handle, ...] = ()
    """One for each moving joint."""
    collision: Collision = "exact"
    swelling_m: float = 0.0
    """How far the hulls reach beyond the surface at most."""
    creator: str = "isr_jax"
    source: str = "kit"
    """Where it came from: ``kit``, or file and entry."""
    notes: tuple[str, ...] = ()
    """What was guessed or repaired when it was imported."""
    load_samples: Callable[[], SurfaceSamples] | None = None
    """Reads `samples` that were made before; None: they are made from the mesh. Who replaces
    ``load_robot`` replaces this too."""

    def __getstate__(self) -> dict[str, Any]:
        """For other processes: what was read from files is read again there, when it is used."""
        return {field.name: getattr(self, field.name) for field in dataclasses.fields(self)}

    @functools.cached_property
    def robot(self) -> RobotModel:
        """Links and joints; root frame = canonical frame, joints closed at zero."""
        return self.load_robot()

    @functools.cached_property
    def mesh(self) -> Mesh:
        """All visuals in the canonical frame, joints closed."""
        return merged_mesh(self.robot)

    @functools.cached_property
    def samples(self) -> SurfaceSamples:
        """Points spread evenly over the mesh, canonical frame, joints closed."""
        if self.load_samples is not None:
            return self.load_samples()
        return surface_samples(self.mesh.vertices, self.mesh.faces)

    @property
    def articulated(self) -> bool:
        return bool(self.moving_joints)

    def lacks_hulls(self, method: HullMethod) -> bool:
        """Whether a model with hulls of this method would have other ones: hulls of the fast method
        give way to those of the slow one, and all others stay."""
        return self.collision == "none" or (self.collision == "vhacd" and method == "coacd")


HullMaker = Callable[[Sequence[CadModel], HullMethod], Sequence[CadModel]]
"""Models with collision hulls by a method, in the order of those that came without."""


def held(robot: RobotModel) -> Callable[[], RobotModel]:
    """A ``load_robot`` for a robot model that is in memory already."""
    return functools.partial(_same, robot)


def _same(robot: RobotModel) -> RobotModel:
    return robot


@dataclasses.dataclass(frozen=True, eq=False)
class CadLibrary:
    """Models, sorted by id."""

    models: tuple[CadModel, ...]
    source: str
    """Where it came from, for messages."""
    content_hash: str
    make_hulls: HullMaker | None = None
    """Makes hulls where `with_hulls` finds none."""

    def __len__(self) -> int:
        return len(self.models)

    def __getitem__(self, index: int) -> CadModel:
        return self.models[index]

    @functools.cached_property
    def arrays(self) -> LibraryArrays:
        """Boxes and planes of all models, padded for kernels."""
        return library_arrays(
            [model.size for model in self.models],
            [model.planes for model in self.models],
            [model.plane_supporting for model in self.models],
            [model.symmetry for model in self.models],
        )

    @functools.cached_property
    def _by_group(self) -> dict[str, np.ndarray]:
        groups: dict[str, list[int]] = {}
        for i, model in enumerate(self.models):
            groups.setdefault(class_named(model.class_name).match_group, []).append(i)
        return {group: np.array(rows, np.int32) for group, rows in groups.items()}

    def matching_class(self, class_name: str) -> np.ndarray:
        """Positions of the models that may stand for an entity of this class."""
        return self._by_group.get(class_named(class_name).match_group, np.zeros(0, np.int32))

    def position(self, cad_id: str) -> int:
        return self._positions[cad_id]

    def by_id(self, cad_id: str) -> CadModel:
        return self.models[self._positions[cad_id]]

    def with_hulls(self, positions: Iterable[int], method: HullMethod) -> CadLibrary:
        """The library, its models at these positions with collision hulls of at least this grade.

        Raises:
            LibraryError: a model came without, and the library does not know how to make them.
        """
        wanted = [i for i in sorted({int(i) for i in positions}) if self[i].lacks_hulls(method)]
        if not wanted:
            return self
        if self.make_hulls is None:
            raise LibraryError(
                f"{self[wanted[0]].id} of {self.source} has no collision hulls by {method}",
                "open the library with `isr_jax.load_library`, which makes them",
            )
        ready = self.make_hulls([self[i] for i in wanted], method)
        return self.replaced(dict(zip(wanted, ready, strict=True)))

    def replaced(self, models: Mapping[int, CadModel]) -> CadLibrary:
        """The library with other forms of the models at these positions: of the same files, with
        collision hulls that they came without."""
        return dataclasses.replace(
            self, models=tuple(models.get(i, model) for i, model in enumerate(self.models))
        )

    @functools.cached_property
    def _positions(self) -> dict[str, int]:
        return {model.id: i for i, model in enumerate(self.models)}
