"""Joint positions of a model: how far each goes, and all of them open."""

from __future__ import annotations

import numpy as np

from ..robot_model import Joint, RobotModel


def travel_range(joint: Joint) -> tuple[float, float]:
    """Limits of a joint; a full turn where it has none, radians or metres."""
    return (0.0, 2 * np.pi) if joint.kind == "continuous" else (joint.lower, joint.upper)


def opened(robot: RobotModel, share: float) -> dict[str, float]:
    """Position of every joint that has limits, this share of the way to its farther end."""
    return {
        joint.name: share * max(joint.lower, joint.upper, key=abs)
        for joint in robot.moving_joints
        if joint.kind != "continuous"
    }
