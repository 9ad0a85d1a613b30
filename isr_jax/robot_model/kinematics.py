"""Where the links of a model are, for given joint positions (host)."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from .model import Joint, RobotModel


def link_transforms(
    model: RobotModel, positions: Mapping[str, float] | None = None
) -> dict[str, np.ndarray]:
    """``T_model_link`` [4, 4] of every link; joints that ``positions`` does not name are at 0."""
    positions = positions or {}
    found = {model.links[0].name: np.eye(4)}
    waiting = list(model.joints)
    while waiting:
        ready = [j for j in waiting if j.parent in found]
        if not ready:
            break
        for joint in ready:
            T = found[joint.parent] @ np.asarray(joint.T_parent_child, np.float64)
            found[joint.child] = T @ joint_motion(joint, positions.get(joint.name, 0.0))
        waiting = [j for j in waiting if j.child not in found]
    return found


def joint_motion(joint: Joint, position: float) -> np.ndarray:
    """Move [4, 4] of the child frame for one joint position, radians or metres."""
    T, axis = np.eye(4), np.asarray(joint.axis, np.float64)
    if joint.kind == "prismatic":
        T[:3, 3] = axis * position
    elif joint.kind in ("revolute", "continuous"):
        x, y, z = axis
        K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
        T[:3, :3] += np.sin(position) * K + (1 - np.cos(position)) * (K @ K)
    return T
