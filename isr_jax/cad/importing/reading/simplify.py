"""Border: models with too many triangles, made lighter (fast-simplification)."""

from __future__ import annotations

import dataclasses

import fast_simplification
import numpy as np

from ....errors import LibraryError
from ....robot_model import RobotModel, Visual
from ....types import Mesh
from .limits import ReadLimits

_FEWEST_FACES = 200  # parts that have less are left as they are


def within_budget(robot: RobotModel, limits: ReadLimits) -> tuple[RobotModel, tuple[str, ...]]:
    """The model with at most ``limits.simplify_faces`` triangles, and what was done to it.

    Raises:
        LibraryError: It has more than ``limits.max_faces``.
    """
    count = sum(len(v.mesh.faces) for link in robot.links for v in link.visuals)
    if count > limits.max_faces:
        problem = f"{robot.name} has {count} triangles, above {limits.max_faces}"
        raise LibraryError(problem, "simplify it first, or raise max_faces")
    if count <= limits.simplify_faces:
        return robot, ()
    ratio = limits.simplify_faces / count
    links = [
        dataclasses.replace(link, visuals=tuple(_lighter(v, ratio) for v in link.visuals))
        for link in robot.links
    ]
    now = sum(len(v.mesh.faces) for link in links for v in link.visuals)
    lost = any(v.texture for link in robot.links for v in link.visuals)
    textures = ", textures replaced by their mean colours" if lost else ""
    note = f"simplified from {count} to {now} triangles{textures}"
    return dataclasses.replace(robot, links=tuple(links)), (note,)


def _lighter(visual: Visual, ratio: float) -> Visual:
    mesh = visual.mesh
    target = max(_FEWEST_FACES, int(ratio * len(mesh.faces)))
    if len(mesh.faces) <= target:
        return visual
    vertices, faces, *_ = fast_simplification.simplify(
        np.ascontiguousarray(mesh.vertices, np.float64),
        np.ascontiguousarray(mesh.faces, np.int32),
        target_count=target,
    )
    if not len(faces):
        return visual
    light = Mesh(np.asarray(vertices, np.float64), np.asarray(faces, np.int32))
    return dataclasses.replace(visual, mesh=light, texture=None)
