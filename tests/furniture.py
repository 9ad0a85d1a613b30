"""A small analytic library: a model or two of each class that a furnished room needs."""

from __future__ import annotations

import dataclasses

import numpy as np

from isr_jax.library import CadLibrary, CadModel
from isr_jax.robot_model import Joint, Link, RobotModel, Visual

from .builders import box_mesh, library_of, parts_model, table_model, with_robot


def block_model(cad_id: str, size: tuple[float, float, float]) -> CadModel:
    """One solid box."""
    return parts_model(cad_id, cad_id.split("/")[0], [(size, (0.0, 0.0, 0.0))])


def chair_model(cad_id: str = "chair/test") -> CadModel:
    """Four legs, a seat, and a back at +y."""
    legs = [((0.04, 0.04, 0.44), (sx * 0.2, sy * 0.2, -0.22)) for sx in (-1, 1) for sy in (-1, 1)]
    seat, back = ((0.44, 0.44, 0.04), (0, 0, 0.02)), ((0.44, 0.04, 0.40), (0, 0.2, 0.24))
    return parts_model(cad_id, "chair", [*legs, seat, back])


def cabinet_model(cad_id: str = "cabinet/test", width: float = 0.6) -> CadModel:
    """A carcass and a door on a hinge, with a handle that sticks out of the box."""
    y, z = 0.56, 0.86
    carcass = parts_model(cad_id, "cabinet", [((width, y, z), (0.0, 0.0, 0.0))])
    door = box_mesh((width - 0.01, 0.018, z - 0.01), (width / 2, -0.009, 0), spacing_m=10.0)
    handle = box_mesh((0.02, 0.03, 0.15), (width - 0.08, -0.033, 0.2), spacing_m=10.0)
    link = Link(
        "door",
        (
            Visual("panel", door, (0.9, 0.9, 0.85, 1.0)),
            Visual("grip", handle, (0.3, 0.3, 0.3, 1.0)),
        ),
        (door,),
        5.0,
        np.array([width / 2, -0.009, 0]),
        np.eye(3),
    )
    T = np.eye(4)
    T[:3, 3] = [-width / 2, -y / 2 - 0.002, 0]
    axis = np.array([0.0, 0.0, 1.0])
    hinge = Joint("hinge", "revolute", "base", "door", T, axis, -1.6, 0.0)
    return with_robot(carcass, RobotModel("cabinet", (*carcass.robot.links, link), (hinge,)))


def bookshelf_model(cad_id: str = "bookshelf/test") -> CadModel:
    """Two sides, a back and four boards."""
    x, y, z, t = 0.8, 0.3, 1.8, 0.02
    boards = [((x - 2 * t, y - t, t), (0, -t / 2, h)) for h in (-0.8, -0.3, 0.2, z / 2 - t / 2)]
    sides = [((t, y, z), (s * (x - t) / 2, 0, 0)) for s in (-1, 1)]
    return parts_model(
        cad_id, "bookshelf", [*sides, ((x - 2 * t, t, z), (0, (y - t) / 2, 0)), *boards]
    )


def furniture_library() -> CadLibrary:
    """Nine classes, one of them articulated."""
    desk = dataclasses.replace(table_model("desk/test", (1.3, 0.6, 0.74)), class_name="desk")
    return library_of(
        table_model(),
        desk,
        chair_model("chair/a"),
        cabinet_model("cabinet/a", 0.6),
        cabinet_model("cabinet/b", 0.45),
        bookshelf_model(),
        block_model("sofa/a", (1.6, 0.8, 0.7)),
        block_model("fridge/a", (0.6, 0.62, 1.7)),
        block_model("microwave/a", (0.48, 0.36, 0.28)),
        block_model("monitor/a", (0.5, 0.16, 0.4)),
        block_model("book/a", (0.2, 0.26, 0.03)),
        block_model("book/b", (0.17, 0.24, 0.05)),
        block_model("cup/a", (0.08, 0.08, 0.1)),
    )
