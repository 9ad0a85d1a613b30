"""What `align` and `alignment_error` read, built from the results of the stages before (host)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from jaxtyping import Bool, Float, Int

from ..config import DEFAULT_SUPPORT, AlignmentSettings, SupportSettings
from ..errors import LibraryError
from ..geometry import CUBE_ROTATIONS
from ..library import CadLibrary, CadModel
from ..runtime.batches import bucket
from ..types import Box, ContactGraph, Entities, Entity, Shortlist
from .error import SurfacePairs
from .problem import DEFAULT_SETTINGS, AlignmentProblem, default_start

_MIN_PAIRS = 16
_MIN_PLANES = 4
_MIN_ROWS = 64
"""Of points and triangles."""


def problem_of(
    scenes: Sequence[Entities],
    graphs: Sequence[ContactGraph],
    shortlists: Sequence[Shortlist],
    library: CadLibrary,
    support: SupportSettings = DEFAULT_SUPPORT,
) -> AlignmentProblem:
    """The pairs that `align` solves: row k is row k of the shortlists, laid end to end.

    After them comes padding up to a power of two, so that scenes of about one size share a
    compiled solve. ``valid`` is False there; its cost is 0, and so are its derivatives.

    Args:
        scenes: Entities of each scene.
        graphs: What carries them: refined boxes, and heights of supports.
        shortlists: Candidates of each scene.
        library: The one that the shortlists were made from.
        support: Says which planes are supporting.

    Raises:
        LibraryError: a shortlist names a model that the library does not hold.
    """
    models = models_of(shortlists, library)
    count = bucket(len(models), _MIN_PAIRS)
    turn = np.concatenate([np.zeros(0, np.int32), *(s.rotation for s in shortlists)])
    rotation = _pad_rows(CUBE_ROTATIONS[turn], count)
    size = _pad_rows(np.array([model.size for model in models], np.float32).reshape(-1, 3), count)
    box, height = _boxes_and_heights(graphs, shortlists, count)
    planes = _matched_planes(entities_of(scenes, shortlists), models, shortlists, count)
    return AlignmentProblem(
        box=box,
        support_height_m=height,
        **planes,
        plane_supporting=_supporting(planes, rotation, support.up_cosine),
        model_size=size,
        rotation=rotation,
        start=np.asarray(default_start(box, size, rotation)),
        valid=np.arange(count) < len(models),
    )


def surfaces_of(
    scenes: Sequence[Entities],
    shortlists: Sequence[Shortlist],
    library: CadLibrary,
    settings: AlignmentSettings = DEFAULT_SETTINGS,
) -> SurfacePairs:
    """What `alignment_error` compares, its pairs on the axis of `problem_of`.

    Args:
        scenes: Entities of each scene.
        shortlists: Candidates of each scene.
        library: The one that the shortlists were made from.
        settings: Say how many vertices of an entity count (``max_points``).

    Raises:
        LibraryError: a shortlist names a model that the library does not hold.
    """
    models = models_of(shortlists, library)
    count = bucket(len(models), _MIN_PAIRS)
    entity, point_sets = _distinct(entities_of(scenes, shortlists))
    model, surfaces = _distinct(models)
    points, point_valid = _padded_sets(
        [spread(e.mesh.vertices, settings.max_points) for e in point_sets], (3,)
    )
    triangles, triangle_valid = _padded_sets([triangles_of(m) for m in surfaces], (3, 3))
    return SurfacePairs(
        points=points,
        point_valid=point_valid,
        triangles=triangles,
        triangle_valid=triangle_valid,
        entity=_pad_rows(entity, count),
        model=_pad_rows(model, count),
        valid=np.arange(count) < len(models),
    )


def models_of(shortlists: Sequence[Shortlist], library: CadLibrary) -> list[CadModel]:
    """The model of every pair.

    Raises:
        LibraryError: a shortlist names a model that the library does not hold.
    """
    positions = [m for shortlist in shortlists for m in shortlist.model.tolist()]
    most = max(positions, default=-1)
    if most >= len(library):
        raise LibraryError(
            f"a shortlist names model {most}, but {library.source} holds {len(library)} models",
            "pass the library that the shortlist was made from",
        )
    return [library[m] for m in positions]


def entities_of(scenes: Sequence[Entities], shortlists: Sequence[Shortlist]) -> list[Entity]:
    """The entity of every pair."""
    return [
        scene[i]
        for scene, shortlist in zip(scenes, shortlists, strict=True)
        for i in shortlist.entity.tolist()
    ]


def triangles_of(model: CadModel) -> Float[np.ndarray, "faces 3 3"]:
    """Triangles of a model, canonical frame, metres."""
    return model.mesh.vertices[model.mesh.faces]


def spread(
    vertices: Float[np.ndarray, "vertices 3"], max_points: int
) -> Float[np.ndarray, "points 3"]:
    """At most ``max_points`` vertices, evenly spread over their order."""
    if len(vertices) <= max_points:
        return vertices
    return vertices[np.linspace(0, len(vertices) - 1, max_points).astype(int)]


def _pad_rows(rows: np.ndarray, count: int) -> np.ndarray:
    """The rows, and zeros after them up to ``count``."""
    extra = np.zeros((count - len(rows), *rows.shape[1:]), rows.dtype)
    return np.concatenate([rows, extra])


def _boxes_and_heights(
    graphs: Sequence[ContactGraph], shortlists: Sequence[Shortlist], count: int
) -> tuple[Box, Float[np.ndarray, " pairs"]]:
    """B_x and d^s of every pair."""

    def column(of, width):
        rows = [
            np.asarray(of(graph), np.float32)[shortlist.entity]
            for graph, shortlist in zip(graphs, shortlists, strict=True)
        ]
        return _pad_rows(np.concatenate([np.zeros((0, *width), np.float32), *rows]), count)

    box = Box(
        center=column(lambda graph: graph.refined_box.center, (3,)),
        yaw=column(lambda graph: graph.refined_box.yaw, ()),
        size=column(lambda graph: graph.refined_box.size, (3,)),
    )
    return box, column(lambda graph: graph.support_height_m, ())


def _matched_planes(
    entities: list[Entity], models: list[CadModel], shortlists: Sequence[Shortlist], count: int
) -> dict[str, np.ndarray]:
    """Planes of the entities that have a partner, beside the models', padded."""
    width = bucket(max([s.plane_match.shape[1] for s in shortlists], default=0), _MIN_PLANES)
    planes = {
        "entity_normal": np.zeros((count, width, 3), np.float32),
        "entity_offset": np.zeros((count, width), np.float32),
        "model_normal": np.zeros((count, width, 3), np.float32),
        "model_offset": np.zeros((count, width), np.float32),
        "plane_valid": np.zeros((count, width), bool),
    }
    matches = [match for shortlist in shortlists for match in shortlist.plane_match]
    for row, (entity, model, match) in enumerate(zip(entities, models, matches, strict=True)):
        x = np.flatnonzero(match >= 0)
        for side, found, k in (("entity", entity.planes, x), ("model", model.planes, match[x])):
            planes[f"{side}_normal"][row, : len(x)] = np.asarray(found.normal)[k]
            planes[f"{side}_offset"][row, : len(x)] = np.asarray(found.offset)[k]
        planes["plane_valid"][row, : len(x)] = True
    return planes


def _supporting(
    planes: dict[str, np.ndarray], rotation: Float[np.ndarray, "pairs 3 3"], up_cosine: float
) -> Bool[np.ndarray, "pairs planes"]:
    """n . g <= a_th of both planes of a pair, the model's after its rotation."""
    up = np.float32(up_cosine)
    model_up = np.einsum("pki,pi->pk", planes["model_normal"], rotation[:, 2])
    return planes["plane_valid"] & (planes["entity_normal"][..., 2] >= up) & (model_up >= up)


def _distinct(items: list) -> tuple[Int[np.ndarray, " items"], list]:
    """Of each item its row among the distinct ones, and these."""
    rows: dict[int, int] = {}
    place = [rows.setdefault(id(item), len(rows)) for item in items]
    distinct = {id(item): item for item in items}
    return np.array(place, np.int32), [distinct[key] for key in rows]


def _padded_sets(
    sets: list[np.ndarray], shape: tuple[int, ...]
) -> tuple[np.ndarray, Bool[np.ndarray, "sets rows"]]:
    """Ragged sets as one array with its mask."""
    count = bucket(len(sets))
    width = bucket(max(map(len, sets), default=0), _MIN_ROWS)
    rows, valid = np.zeros((count, width, *shape), np.float32), np.zeros((count, width), bool)
    for i, one in enumerate(sets):
        rows[i, : len(one)], valid[i, : len(one)] = one, True
    return rows, valid
