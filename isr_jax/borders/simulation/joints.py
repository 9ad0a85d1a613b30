"""Border: MuJoCo. Hinges and slides: their ranges, and how far they can really be moved."""

# MuJoCo's compiled names have no stubs.
# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

import dataclasses

import mujoco
import numpy as np

from ...errors import SceneError
from .contacts import at_start
from .names import joint_name, joint_row

_SWING_RATE = 8.0
"""1/s, of the spring that pulls: the end is reached in about half a second."""


@dataclasses.dataclass(frozen=True)
class JointTravel:
    """How far a joint went when it was pushed to both ends; radians or metres."""

    joint: str
    limits: tuple[float, float]
    reached: tuple[float, float]

    @property
    def share(self) -> float:
        """Reached part of the range; 1 is all of it."""
        return (self.reached[1] - self.reached[0]) / (self.limits[1] - self.limits[0])


def moving_joints(model: mujoco.MjModel) -> tuple[str, ...]:
    """Names of the hinges and slides, in the order of the model."""
    return tuple(joint_name(model, row) for row in moving_rows(model))


def moving_rows(model: mujoco.MjModel) -> list[int]:
    """Numbers of the hinges and slides, in the order of the model."""
    kinds = (mujoco.mjtJoint.mjJNT_HINGE, mujoco.mjtJoint.mjJNT_SLIDE)
    return np.flatnonzero(np.isin(model.jnt_type, [int(kind) for kind in kinds])).tolist()


def joint_ranges(model: mujoco.MjModel) -> dict[str, float]:
    """Width of the range of every hinge and slide, radians or metres; 0 without limits."""
    ranges = {}
    for row in moving_rows(model):
        low, high = model.jnt_range[row]
        ranges[joint_name(model, row)] = float(high - low) if model.jnt_limited[row] else 0.0
    return ranges


def joint_travel(model: mujoco.MjModel, joint: str, patience_s: float = 4.0) -> JointTravel:
    """Push a joint to its lower, then to its upper end; how far it got.

    The generalized force overcomes the joint's friction and weight, and follows a damped spring
    towards a point beyond the end: a blocked joint shows a range not reached. A joint without
    limits is turned half round (a slide moved pi metres) both ways.

    Args:
        model: Of the scene; the start is ``qpos0``.
        joint: Name of a hinge or slide: one of `moving_joints`.
        patience_s: Longest time that one end is pushed for.

    Raises:
        SceneError: no hinge or slide has that name.
    """
    row = joint_row(model, joint)
    if row not in moving_rows(model):
        raise SceneError(
            f"joint {joint!r} is no hinge and no slide",
            f"use one of: {', '.join(moving_joints(model)) or 'none'}",
        )
    data = at_start(model)
    limits = model.jnt_range[row] if model.jnt_limited[row] else (-np.pi, np.pi)
    low, high = (float(v) for v in limits)
    reached = []
    for end, sign in ((low, -1.0), (high, 1.0)):
        _drive(model, data, row, end, sign * 0.1 * (high - low), patience_s)
        reached.append(float(data.qpos[model.jnt_qposadr[row]]))
    return JointTravel(joint, (low, high), (reached[0], reached[1]))


def _drive(model, data, row: int, end: float, beyond: float, patience_s: float) -> None:
    """Pull a joint to its end with a force that makes its motion that of a damped spring."""
    dof, address = int(model.jnt_dofadr[row]), int(model.jnt_qposadr[row])
    inertia = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, inertia)
    mass, rate = float(inertia[dof, dof]), _SWING_RATE
    friction = float(model.dof_frictionloss[dof])
    damping = float(model.dof_damping[dof].ravel()[0])
    for _ in range(round(patience_s / model.opt.timestep)):
        position, speed = data.qpos[address], data.qvel[dof]
        if (position - end) * beyond >= 0:
            break
        force = rate * (rate * (end + beyond - position) - 2 * speed)
        push = mass * force + np.sign(beyond) * 1.2 * friction + damping * speed
        data.qfrc_applied[dof] = push + data.qfrc_bias[dof]
        mujoco.mj_step(model, data)
    data.qfrc_applied[dof] = 0
