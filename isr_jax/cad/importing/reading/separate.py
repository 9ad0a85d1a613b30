"""A world of several objects as several models: bodies that stand apart are not one thing."""

from __future__ import annotations

import dataclasses

import numpy as np
from jaxtyping import Float

from ....robot_model import Joint, Link, RobotModel, Visual, link_transforms
from ....types import Mesh
from ..names import Unique

_GAP = 0.01
"""Boxes farther apart than this share of the smaller one's diagonal do not touch."""

_Box = Float[np.ndarray, "2 3"]


def separate(robot: RobotModel, free: set[str]) -> tuple[RobotModel, ...]:
    """One model for each group of the root's children whose boxes touch; each keeps its axes.

    A body that may move freely is a model of its own. Where one body alone hangs on a root
    without shapes, by no joint that moves, it becomes the root.

    Args:
        robot: Its root is the world.
        free: Names of links that had free joints.
    """
    root = robot.links[0].name
    units = [{root}, *(_below(robot, j.child) for j in robot.joints if j.parent == root)]
    boxes = [_box(robot, names) for names in units]
    seen = [i for i, found in enumerate(boxes) if found is not None]
    groups: list[list[int]] = []
    for i in seen:
        near = [g for g in groups if any(_together(units, boxes, free, i, k) for k in g)]
        groups = [g for g in groups if g not in near] + [sorted([i, *(k for g in near for k in g)])]
    models = [_part(robot, units, group) for group in sorted(groups)]
    if len(models) == 1:
        return (models[0],)
    unique = Unique()
    return tuple(
        dataclasses.replace(model, name=unique(f"{robot.name}_{_called(model, root)}"))
        for model in models
    )


def _called(model: RobotModel, world: str) -> str:
    names = [link.name for link in model.links if link.name != world and link.visuals]
    return names[0] if names else world


def _below(robot: RobotModel, name: str) -> set[str]:
    """A link and all that hangs on it."""
    names = [name]
    for parent in names:
        names += [joint.child for joint in robot.joints if joint.parent == parent]
    return set(names)


def _box(robot: RobotModel, names: set[str]) -> _Box | None:
    """Low and high corner of some links in the root frame, joints at zero."""
    poses, points = link_transforms(robot), []
    for link in robot.links:
        if link.name in names:
            T = poses[link.name]
            points += [v.mesh.vertices @ T[:3, :3].T + T[:3, 3] for v in link.visuals]
    if not points:
        return None
    every = np.concatenate(points)
    return np.stack([every.min(0), every.max(0)])


def _together(units: list, boxes: list, free: set[str], i: int, k: int) -> bool:
    if units[i] & free or units[k] & free:
        return False
    a, b = boxes[i], boxes[k]
    gap = np.maximum(np.maximum(a[0] - b[1], b[0] - a[1]), 0.0)
    smaller = min(np.linalg.norm(np.ptp(a, axis=0)), np.linalg.norm(np.ptp(b, axis=0)))
    return bool(np.linalg.norm(gap) <= _GAP * smaller)


def _part(robot: RobotModel, units: list[set[str]], group: list[int]) -> RobotModel:
    root = robot.links[0].name
    names = {root}.union(*(units[i] for i in group))
    links = tuple(link for link in robot.links if link.name in names)
    joints = tuple(j for j in robot.joints if j.parent in names and j.child in names)
    hung = [joint for joint in joints if joint.parent == root]
    if 0 in group or len(hung) != 1 or hung[0].kind != "fixed":
        return RobotModel(robot.name, links, joints)
    T, child = np.asarray(hung[0].T_parent_child), hung[0].child
    moved = [_moved_link(link, T) for link in links if link.name == child]
    rest = [link for link in links if link.name not in (root, child)]
    return RobotModel(
        robot.name,
        (*moved, *rest),
        tuple(_rehung(joint, child, T) for joint in joints if joint is not hung[0]),
    )


def _rehung(joint: Joint, moved: str, T: np.ndarray) -> Joint:
    if joint.parent != moved:
        return joint
    return dataclasses.replace(joint, T_parent_child=T @ np.asarray(joint.T_parent_child))


def _moved_link(link: Link, T: np.ndarray) -> Link:
    """The same body, described in the frame that T maps its own to."""
    R = T[:3, :3]
    return dataclasses.replace(
        link,
        visuals=tuple(_moved_visual(visual, T) for visual in link.visuals),
        hulls=tuple(_moved_mesh(hull, T) for hull in link.hulls),
        com=R @ link.com + T[:3, 3],
        inertia=R @ link.inertia @ R.T,
    )


def _moved_visual(visual: Visual, T: np.ndarray) -> Visual:
    return dataclasses.replace(visual, mesh=_moved_mesh(visual.mesh, T))


def _moved_mesh(mesh: Mesh, T: np.ndarray) -> Mesh:
    vertices = mesh.vertices.astype(np.float64) @ T[:3, :3].T + T[:3, 3]
    return dataclasses.replace(mesh, vertices=vertices)
