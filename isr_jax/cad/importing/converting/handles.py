"""Where a hand moves each joint of an imported model."""

from __future__ import annotations

import re

import numpy as np

from ....library import Handle
from ....robot_model import Joint, Link, RobotModel, link_transforms
from ..found import Vector

_HANDLE = re.compile(r"(?i)(?<![a-z])(handle|knob|grip|pull)s?(?![a-z])")


def is_handle(name: str) -> bool:
    """Whether a link or visual is called a handle, knob or grip."""
    return bool(_HANDLE.search(re.sub(r"(?<=[a-z])(?=[A-Z])|_|(?<=[A-Za-z])(?=\d)", " ", name)))


def find_handles(robot: RobotModel, stated: dict[str, Vector]) -> tuple[Handle, ...]:
    """One handle for each moving joint.

    The stated one, else the middle of what is named a handle on the child link or on a link
    fixed to it, else the child's vertex farthest from the joint (``estimated``).
    """
    return tuple(_handle_of(robot, joint, stated) for joint in robot.moving_joints)


def _handle_of(robot: RobotModel, joint: Joint, stated: dict[str, Vector]) -> Handle:
    if joint.name in stated:
        return Handle(joint.name, joint.child, np.asarray(stated[joint.name], np.float64))
    named = _named_points(robot, joint.child)
    if len(named):
        return Handle(joint.name, joint.child, (named.min(0) + named.max(0)) / 2)
    points = _points_of(robot.link(joint.child))
    position = points[np.argmax(_reach(joint, points))] if len(points) else np.zeros(3)
    return Handle(joint.name, joint.child, position, estimated=True)


def _points_of(link: Link) -> np.ndarray:
    meshes = [v.mesh for v in link.visuals] or list(link.hulls)
    return np.concatenate([np.zeros((0, 3)), *(m.vertices.astype(np.float64) for m in meshes)])


def _named_points(robot: RobotModel, child: str) -> np.ndarray:
    """Vertices of what is named a handle and moves with a link, in that link's frame."""
    poses, found = link_transforms(robot), [np.zeros((0, 3))]
    for name in _rigid_with(robot, child):
        link = robot.link(name)
        T = np.linalg.inv(poses[child]) @ poses[name]
        for visual in link.visuals:
            if is_handle(visual.name) or (name != child and is_handle(name)):
                points = visual.mesh.vertices.astype(np.float64)
                found.append(points @ T[:3, :3].T + T[:3, 3])
    return np.concatenate(found)


def _rigid_with(robot: RobotModel, name: str) -> list[str]:
    """A link and those fixed to it, downwards."""
    group = [name]
    for parent in group:
        group += [j.child for j in robot.joints if j.kind == "fixed" and j.parent == parent]
    return group


def _reach(joint: Joint, points: np.ndarray) -> np.ndarray:
    """Lever of each point about a hinge; along a slide's opening for a drawer."""
    axis = np.asarray(joint.axis, np.float64)
    along = points @ axis
    if joint.kind == "prismatic":
        return along * (1.0 if abs(joint.upper) >= abs(joint.lower) else -1.0)
    return np.linalg.norm(points - along[:, None] * axis, axis=1)
