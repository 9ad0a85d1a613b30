"""Border: MuJoCo. Let a scene move by itself, or push it."""

# MuJoCo's compiled names have no stubs.
# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

import dataclasses

import mujoco
import numpy as np
from jaxtyping import Float

from .joints import moving_joints, moving_rows
from .names import body_row
from .scenes import free_bodies, free_rows

_WARNING_NAMES = tuple(
    mujoco.mjtWarning(i).name.removeprefix("mjWARN_").lower()
    for i in range(mujoco.mjtWarning.mjNWARNING)
)
_LEVER_M = 0.2
"""A perturbed body turns by the angle that moves a point so far away by the perturbation."""


@dataclasses.dataclass(frozen=True, eq=False)
class Trajectory:
    """Free bodies and joints over time, world frame."""

    time_s: Float[np.ndarray, " times"]
    bodies: tuple[str, ...]
    position_m: Float[np.ndarray, "times bodies 3"]
    """Of the centres of mass, which do not move when a body is turned about them."""
    quaternion: Float[np.ndarray, "times bodies 4"]
    """w x y z of the body frames."""
    joints: tuple[str, ...]
    """Hinges and slides."""
    joint_position: Float[np.ndarray, "times joints"]
    """Radians or metres."""
    warnings: dict[str, int]
    """Solver warnings by name, with how often."""


def simulate(
    model: mujoco.MjModel,
    duration_s: float,
    sample_s: float = 0.02,
    qpos: Float[np.ndarray, " n"] | None = None,
) -> Trajectory:
    """Let the scene move by itself and sample where its free bodies and joints are.

    Controls are zero. Several threads may simulate one model at the same time.

    Args:
        model: Of the scene.
        duration_s: Simulated time.
        sample_s: Time between samples, rounded to whole timesteps.
        qpos: Positions at the start (``model.nq`` of them); by default ``qpos0``.
    """
    data = mujoco.MjData(model)
    if qpos is not None:
        data.qpos[:] = qpos
    mujoco.mj_forward(model, data)
    steps = max(1, round(sample_s / model.opt.timestep))
    count = max(1, round(duration_s / (steps * model.opt.timestep)))
    rows = np.array(free_rows(model), int)
    address = model.jnt_qposadr[np.array(moving_rows(model), int)]
    samples = [_sample(data, rows, address)]
    for _ in range(count):
        mujoco.mj_step(model, data, steps)
        mujoco.mj_kinematics(model, data)  # a step leaves the poses of before its integration
        samples.append(_sample(data, rows, address))
    position, quaternion, joint = (np.stack(part) for part in zip(*samples, strict=True))
    return Trajectory(
        time_s=np.arange(count + 1) * steps * model.opt.timestep,
        bodies=free_bodies(model),
        position_m=position,
        quaternion=quaternion,
        joints=moving_joints(model),
        joint_position=joint,
        warnings=solver_warnings(data),
    )


def _sample(data, rows: np.ndarray, address: np.ndarray) -> tuple[np.ndarray, ...]:
    return data.xipos[rows].copy(), data.xquat[rows].copy(), data.qpos[address].copy()


def solver_warnings(data: mujoco.MjData) -> dict[str, int]:
    """Warnings that MuJoCo counted in this state so far, by name; those that never came are
    left out."""
    counts = {name: int(data.warning[i].number) for i, name in enumerate(_WARNING_NAMES)}
    return {name: count for name, count in counts.items() if count}


def perturbed_start(
    model: mujoco.MjModel, rng: np.random.Generator, size_m: float
) -> Float[np.ndarray, " n"]:
    """Start positions with every free body moved and turned a little, and never downwards.

    Sideways by a normal draw of ``size_m``, up by the absolute value of one, turned about a random
    axis by an angle that moves a point 20 cm away by as much.

    Args:
        model: Of the scene; its ``qpos0`` is what is perturbed.
        rng: Source of the draws.
        size_m: Standard deviation of the draws, metres.

    Returns:
        All ``model.nq`` positions, for `simulate`.
    """
    qpos = model.qpos0.copy()
    for joint in np.flatnonzero(model.jnt_type == mujoco.mjtJoint.mjJNT_FREE):
        at = model.jnt_qposadr[joint]
        step = rng.normal(0.0, size_m, 3)
        qpos[at : at + 3] += [step[0], step[1], abs(step[2])]
        turn, quat = np.zeros(4), np.zeros(4)
        axis = rng.normal(size=3)
        axis /= np.linalg.norm(axis)
        mujoco.mju_axisAngle2Quat(turn, axis, rng.normal(0.0, size_m / _LEVER_M))
        mujoco.mju_mulQuat(quat, turn, qpos[at + 3 : at + 7])
        qpos[at + 3 : at + 7] = quat
    return qpos


def push(
    model: mujoco.MjModel,
    data: mujoco.MjData,
    body: str,
    force_n: Float[np.ndarray, "3"],
    point: Float[np.ndarray, "3"],
    duration_s: float,
) -> None:
    """Apply a force at a point of a body for a while; ``data`` is stepped in place.

    Args:
        model: Of the scene.
        data: State before and after.
        body: Name of the pushed body.
        force_n: World frame, newtons.
        point: Body frame, metres; it moves with the body.
        duration_s: How long the force lasts.

    Raises:
        SceneError: no body has that name.
    """
    row = body_row(model, body)
    for _ in range(round(duration_s / model.opt.timestep)):
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        at = data.xpos[row] + data.xmat[row].reshape(3, 3) @ point
        data.qfrc_applied[:] = 0
        mujoco.mj_applyFT(model, data, force_n, np.zeros(3), at, row, data.qfrc_applied)
        mujoco.mj_step(model, data)
    data.qfrc_applied[:] = 0
