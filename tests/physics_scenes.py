"""Small scenes, placed by hand, for the tests of export, simulation and stability."""

from __future__ import annotations

import dataclasses

import numpy as np

from isr_jax.library import CadLibrary, CadModel
from isr_jax.robot_model import Joint, Link, RobotModel, Visual, box_between
from isr_jax.types import (
    ROOM,
    UNSUPPORTED,
    ContactGraph,
    Entities,
    Entity,
    Mesh,
    Placement,
)

from .builders import (
    box_entity,
    floor_entity,
    library_of,
    parts_model,
    rotation_z,
    scene_of,
    support_graph,
    table_model,
    with_robot,
)


@dataclasses.dataclass(frozen=True, eq=False)
class PlacedScene:
    """What `export_scene` takes."""

    entities: Entities
    graph: ContactGraph
    placements: tuple[Placement, ...]
    library: CadLibrary

    @property
    def arguments(self):
        return self.entities, self.graph, self.placements, self.library


def kept(entity: Entity, reason: str = "layout") -> Placement:
    """The scan stays."""
    return Placement(entity.id, None, None, None, None, None, (), reason)


def placed(entity: Entity, cad_id: str, scale=1.0, lift_m: float = 0.0) -> Placement:
    """A model at the entity's box, upright."""
    T = np.eye(4, dtype=np.float32)
    T[:3, :3] = rotation_z(float(entity.box.yaw))
    T[:3, 3] = np.asarray(entity.box.center) + np.array([0, 0, lift_m], np.float32)
    scales = np.broadcast_to(np.asarray(scale, np.float32), 3).copy()
    return Placement(entity.id, cad_id, T, scales, 0.1, 0.012, (), None)


def cube_model(cad_id: str = "cup/cube", side: float = 0.1) -> CadModel:
    """A solid cube that stands on surfaces."""
    return parts_model(cad_id, cad_id.split("/")[0], [((side, side, side), (0, 0, 0))])


def cabinet_model(cad_id: str = "cabinet/doors") -> CadModel:
    """An open carcass of five boards, a door on a hinge and a drawer on a slide."""
    w, d, h, t = 0.6, 0.5, 0.8, 0.02
    boards = [
        ((t, d, h), (-(w - t) / 2, 0, 0)),
        ((t, d, h), ((w - t) / 2, 0, 0)),
        ((w - 2 * t, d, t), (0, 0, (h - t) / 2)),
        ((w - 2 * t, d, t), (0, 0, -(h - t) / 2)),
        ((w - 2 * t, t, h - 2 * t), (0, (d - t) / 2, 0)),
    ]
    carcass = parts_model(cad_id, "cabinet", boards)
    gap = 0.003
    door = _board((gap, 0, -h / 2 + t + gap), (w - 2 * t - gap, t, -0.02))
    drawer = _board((-w / 2 + t + gap, -d / 2, 0.0), (w / 2 - t - gap, 0.1, h / 2 - t - gap))
    joints = (
        Joint(
            "hinge",
            "revolute",
            "base",
            "door",
            _at(-w / 2 + t, -d / 2, 0),
            np.array([0.0, 0.0, 1.0]),
            -1.8,
            0.0,
            damping=0.05,
            friction=0.05,
        ),
        Joint(
            "slide",
            "prismatic",
            "base",
            "drawer",
            _at(0, 0, 0),
            np.array([0.0, -1.0, 0.0]),
            0.0,
            0.3,
            damping=1.0,
            friction=0.5,
        ),
    )
    links = (*carcass.robot.links, _solid("door", door, 6.0), _solid("drawer", drawer, 4.0))
    return with_robot(carcass, RobotModel("cabinet", links, joints))


def _board(low, high) -> Mesh:
    return box_between(np.array(low), np.array(high))


def _solid(name: str, mesh: Mesh, mass_kg: float) -> Link:
    low, high = mesh.vertices.min(0).astype(float), mesh.vertices.max(0).astype(float)
    s = high - low
    inertia = mass_kg * (np.eye(3) * (s @ s) - np.diag(s * s)) / 12
    visual = Visual("panel", mesh, (0.9, 0.9, 0.85, 1.0))
    return Link(name, (visual,), (mesh,), mass_kg, (low + high) / 2, inertia)


def _at(x: float, y: float, z: float) -> np.ndarray:
    T = np.eye(4)
    T[:3, 3] = x, y, z
    return T


def furnished_scene() -> PlacedScene:
    """A floor, a wall, a turned table with a cube on it (placed 4 mm too high), a scanned chair,
    a cabinet (door, drawer) at 1.2 times its size, and a clock that hangs on the wall."""
    items = (
        floor_entity(1),
        box_entity(2, "wall", (0, 2.01, 1.25), (5, 0.02, 2.5), faces=(5,)),
        box_entity(3, "table", (0, 0, 0.37), (1.2, 0.8, 0.74), 0.3),
        box_entity(4, "cup", (0.2, 0.1, 0.79), (0.1, 0.1, 0.1)),
        box_entity(5, "chair", (-1.4, 0.1, 0.45), (0.45, 0.45, 0.9), -0.2),
        box_entity(6, "cabinet", (1.6, 1.5, 0.48), (0.72, 0.6, 0.96)),
        box_entity(7, "clock", (0, 1.98, 1.8), (0.3, 0.04, 0.3)),
    )
    entities = scene_of(*items)
    parents = [ROOM, ROOM, 0, 2, 0, 0, UNSUPPORTED]
    graph = support_graph(entities, parents, attachment=[*["none"] * 6, "wall"])
    placements = (
        kept(items[0]),
        kept(items[1]),
        placed(items[2], "table/test"),
        placed(items[3], "cup/cube", lift_m=0.004),
        kept(items[4], "no chair in the library"),
        placed(items[5], "cabinet/doors", scale=1.2),
        kept(items[6], "no clock in the library"),
    )
    library = library_of(table_model(), cube_model(), cabinet_model())
    return PlacedScene(entities, graph, placements, library)


def cubes_scene(*centers, parents=None, side: float = 0.2) -> PlacedScene:
    """Free cubes above a floor."""
    cubes = [box_entity(i + 2, "cup", c, (side, side, side)) for i, c in enumerate(centers)]
    entities = scene_of(floor_entity(1), *cubes)
    graph = support_graph(entities, [ROOM, *(parents or [0] * len(cubes))])
    library = library_of(cube_model("cup/cube", side))
    placements = (kept(entities[0]), *(placed(c, "cup/cube") for c in cubes))
    return PlacedScene(entities, graph, placements, library)
