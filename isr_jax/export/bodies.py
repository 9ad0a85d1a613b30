"""What stands in the exported scene: layout as slabs, everything else as placed models."""

from __future__ import annotations

import dataclasses

import numpy as np
from jaxtyping import Float

from ..classes import class_named
from ..config import ExportSettings
from ..errors import SceneError
from ..geometry import box_corners, moved_part, nearest_rotation
from ..geometry.placed_solids import PlacedSolid
from ..library import CadLibrary, CadModel
from ..robot_model import Link, RobotModel, link_transforms, scaled
from ..robot_model.naming import named_in_scene
from ..types import ContactGraph, Entities, Entity, Mesh, Placement
from .hull_meshes import part_of
from .scan_bodies import Niche, recentred, scan_robot
from .slabs import Slab, slabs_of

_NICHE_MARGIN_M = 0.01
"""Around what a scan carries, half of it for the thickness of flat parts."""


@dataclasses.dataclass(frozen=True, eq=False)
class Body:
    """A placed model or scan."""

    position: int
    """In the entities."""
    name: str
    robot: RobotModel
    """With its names in the scene."""
    T_world_root: np.ndarray
    free: bool
    scan: Mesh | None
    """In the root's frame, at full resolution; None for a CAD model."""


def scene_bodies(
    entities: Entities,
    graph: ContactGraph,
    placements: tuple[Placement, ...],
    library: CadLibrary,
    settings: ExportSettings,
) -> tuple[tuple[Slab, ...], tuple[Body, ...]]:
    """Slabs and bodies of a scene, as placed; nothing is moved yet."""
    bodies = tuple(
        _body(i, entities, graph, placements[i], library, settings)
        for i in range(len(entities))
        if not entities[i].is_layout
    )
    things = [np.asarray(box_corners(e.box)) for e in entities if not e.is_layout]
    above = np.concatenate([np.zeros((0, 3)), *things])
    fillings = [_vertices(b) for b in bodies if _fills_opening(entities[b.position])]
    layout = [entity for entity in entities if entity.is_layout]
    return tuple(s for e in layout for s in slabs_of(e, settings, above, fillings)), bodies


def _fills_opening(entity: Entity) -> bool:
    return class_named(entity.class_name).mount == "opening"


def _vertices(body: Body) -> np.ndarray:
    """Of all visuals, world frame, joints at zero."""
    poses = link_transforms(body.robot)
    moved = [np.zeros((0, 3))]
    for link in body.robot.links:
        T = body.T_world_root @ poses[link.name]
        moved += [v.mesh.vertices @ T[:3, :3].T + T[:3, 3] for v in link.visuals]
    return np.concatenate(moved)


def _body(
    i: int,
    entities: Entities,
    graph: ContactGraph,
    placement: Placement,
    library: CadLibrary,
    settings: ExportSettings,
) -> Body:
    entity = entities[i]
    # What hangs on a wall would fall with a free joint: the hook is not modelled.
    free = class_named(entity.class_name).movable and graph.attachment[i] not in ("wall", "hanging")
    if placement.cad_id is not None:
        assert placement.scale is not None and placement.T_world_cad is not None
        robot = placed_robot(library.by_id(placement.cad_id), placement.scale, entity.name)
        return Body(i, entity.name, robot, rigid(placement.T_world_cad), free, None)
    T = np.eye(4)
    T[:3, 3] = np.asarray(entity.box.center, np.float64)
    robot = scan_robot(
        entity,
        _support_m(i, graph),
        niches_of(i, graph),
        T[:3, 3],
        max_vertices=settings.max_hull_vertices,
        max_faces=settings.scan_max_faces,
        friction=settings.friction,
    )
    return Body(i, entity.name, robot, T, free, recentred(entity.mesh, T[:3, 3]))


def rigid(T: Float[np.ndarray, "4 4"]) -> Float[np.ndarray, "4 4"]:
    """The nearest rigid transform: float32 leaves a rotation a little off."""
    T = np.array(T, np.float64)
    T[:3, :3] = nearest_rotation(T[:3, :3])
    return T


def _support_m(i: int, graph: ContactGraph) -> float | None:
    """Height of what carries an entity; None where nothing does."""
    return float(graph.support_height_m[i]) if graph.parent[i] >= 0 else None


def niches_of(i: int, graph: ContactGraph) -> tuple[Niche, ...]:
    """Room for each entity that this one carries."""
    box = graph.refined_box
    return tuple(
        Niche(
            plane_m=float(graph.support_height_m[c]),
            top_m=float(box.center[c, 2] + box.size[c, 2] / 2) + _NICHE_MARGIN_M,
            center=np.asarray(box.center[c, :2], np.float64),
            yaw=float(box.yaw[c]),
            half=np.asarray(box.size[c, :2], np.float64) / 2 + _NICHE_MARGIN_M,
        )
        for c in graph.children(i)
    )


def placed_robot(model: CadModel, scale: np.ndarray, name: str) -> RobotModel:
    """The model at its scale, its links and joints named as in the scene.

    Raises:
        SceneError: three different scales for a model with joints (they would shear its hinges).
    """
    scale = np.asarray(scale, np.float64)
    if np.ptp(scale) <= 1e-6 * scale.max():
        return named_in_scene(scaled(model.robot, float(scale[0])), name)
    if model.robot.joints:
        raise SceneError(
            f"{name}: {model.id} has joints and the scales {scale.tolist()}",
            "scale models with joints equally along all axes",
        )
    link = stretched(model.robot.links[0], scale)
    return named_in_scene(RobotModel(model.id, (link,), ()), name)


def stretched(link: Link, scale: np.ndarray) -> Link:
    """A link scaled by three factors: second moments go with det(S) S M S."""

    def mesh(m: Mesh) -> Mesh:
        moved = (np.asarray(m.vertices, np.float64) * scale).astype(np.float32)
        normals = None
        if m.normals is not None:
            turned = m.normals / scale
            normals = (turned / np.linalg.norm(turned, axis=1, keepdims=True)).astype(np.float32)
        return dataclasses.replace(m, vertices=moved, normals=normals)

    det, I = float(np.prod(scale)), np.asarray(link.inertia, np.float64)
    moments = det * np.outer(scale, scale) * (np.trace(I) / 2 * np.eye(3) - I)
    return dataclasses.replace(
        link,
        visuals=tuple(dataclasses.replace(v, mesh=mesh(v.mesh)) for v in link.visuals),
        hulls=tuple(mesh(h) for h in link.hulls),
        mass_kg=link.mass_kg * det,
        com=np.asarray(link.com) * scale,
        inertia=np.trace(moments) * np.eye(3) - moments,
    )


def body_solid(body: Body) -> PlacedSolid:
    """Collision hulls of all links, world frame, joints at zero."""
    poses = link_transforms(body.robot)
    return PlacedSolid(
        tuple(
            moved_part(part_of(mesh), body.T_world_root @ poses[link.name])
            for link in body.robot.links
            for mesh in link.hulls
        )
    )
