"""What the measures of CAD replacement compare: a true thing, and what stands for it."""

from __future__ import annotations

import dataclasses
import functools

import numpy as np
from jaxtyping import Float

from ...errors import SceneError
from ...geometry import CUBE_ROTATIONS
from ...library import CadLibrary, CadModel
from ...scene_file import CadRecord, EntityRecord
from ..matches import Match
from ..result_files import Result, Truth
from .chamfer import Surface, SurfaceDistance, model_surface, surface_distance


@dataclasses.dataclass(frozen=True, eq=False)
class PosedModel:
    """A model where it stands, in the truth's world."""

    model: CadModel
    T_world_cad: Float[np.ndarray, "4 4"]
    """Without scale."""
    scale: Float[np.ndarray, "3"]

    @property
    def size(self) -> np.ndarray:
        """[3] extent along the model's own axes, metres."""
        return np.asarray(self.model.size, np.float64) * self.scale

    @property
    def rotation(self) -> np.ndarray:
        return self.T_world_cad[:3, :3]

    @property
    def center(self) -> np.ndarray:
        return self.T_world_cad[:3, 3]

    @functools.cached_property
    def surface(self) -> Surface:
        """World frame."""
        return model_surface(self.model, self.T_world_cad, self.scale)

    def to_world(self, points: np.ndarray) -> np.ndarray:
        """Points of the model's canonical frame, in the world."""
        return np.asarray(points, np.float64) * self.scale @ self.rotation.T + self.center

    def size_along(self, rotation: Float[np.ndarray, "3 3"]) -> np.ndarray:
        """[3] extent along other axes, to which the nearest of the 24 rotations turns the box."""
        between = rotation.T @ self.rotation
        nearest = CUBE_ROTATIONS[np.argmax(np.einsum("kij,ij->k", CUBE_ROTATIONS, between))]
        return np.abs(nearest) @ self.size


@dataclasses.dataclass(frozen=True, eq=False)
class CadCase:
    """One seen true thing whose model is known, and the entity that stands for it."""

    true: EntityRecord
    found: EntityRecord | None
    """None: nothing stands for it."""
    true_model: PosedModel
    placed: PosedModel | None
    """None: nothing was found, or it stayed a scan."""
    seen_points: Float[np.ndarray, "points 3"]
    """Of the true surface, those that the camera saw."""

    @functools.cached_property
    def distance(self) -> SurfaceDistance | None:
        """From the true model to the placed one, and back."""
        if self.placed is None:
            return None
        return surface_distance(self.true_model.surface, self.placed.surface)


def cad_cases(
    truth: Truth,
    result: Result,
    matches: tuple[Match, ...],
    library: CadLibrary,
    truth_library: CadLibrary,
) -> tuple[CadCase, ...]:
    """A case for every seen true thing with a model, missing ones too.

    Raises:
        SceneError: a model is in neither library.
    """
    cases = []
    for match in matches:
        true = truth.scene.entity(match.truth)
        if true.cad is None:
            continue
        found = None if match.predicted is None else result.scene.entity(match.predicted)
        placed = None
        if found is not None and found.cad is not None:
            placed = posed_model(found.cad, library, result.T_truth_result)
        seen = truth.points[truth.instance == true.id]
        posed = posed_model(true.cad, truth_library, np.eye(4))
        cases.append(CadCase(true, found, posed, placed, seen))
    return tuple(cases)


def model_named(cad_id: str, library: CadLibrary) -> CadModel:
    """The model of this id.

    Raises:
        SceneError: the library has no such model.
    """
    try:
        return library.by_id(cad_id)
    except KeyError:
        raise SceneError(
            f"model {cad_id} is not in {library.source}, which has {len(library)} models",
            "give the library that the scene was made with",
        ) from None


def same_model(a: CadModel, b: CadModel) -> bool:
    """Whether two libraries mean the same model."""
    return a.id == b.id and a.content_hash == b.content_hash


def posed_model(cad: CadRecord, library: CadLibrary, T: np.ndarray) -> PosedModel:
    """The model of a scene in another world, to which ``T`` [4, 4] brings the scene's.

    Raises:
        SceneError: the library has no such model.
    """
    return PosedModel(
        model_named(cad.id, library),
        T @ np.asarray(cad.T_world_cad, np.float64),
        np.asarray(cad.scale, np.float64),
    )
