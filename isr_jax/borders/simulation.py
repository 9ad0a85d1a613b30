"""Border: MuJoCo. Load a scene, look for contacts, let it settle, push it, move its joints."""

# MuJoCo's compiled names have no stubs.
# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from pathlib import Path

import mujoco
import numpy as np
from jaxtyping import Float

from ..errors import SceneError

WARNING_NAMES = tuple(
    mujoco.mjtWarning(i).name.removeprefix("mjWARN_").lower()
    for i in range(mujoco.mjtWarning.mjNWARNING)
)


@dataclasses.dataclass(frozen=True)
class Touch:
    """The deepest contact between two bodies."""

    body_a: str
    body_b: str
    depth_m: float
    """Positive where they overlap."""
    contacts: int
    """Contact points between the two."""


@dataclasses.dataclass(frozen=True, eq=False)
class Trajectory:
    """Free bodies and joints over time."""

    time_s: Float[np.ndarray, " times"]
    bodies: tuple[str, ...]
    position_m: Float[np.ndarray, "times bodies 3"]
    """Of the centres of mass, which do not move when a body is turned about them."""
    quaternion: Float[np.ndarray, "times bodies 4"]
    """w x y z of the body frames."""
    joints: tuple[str, ...]
    """Hinges and slides."""
    joint_position: Float[np.ndarray, "times joints"]
    warnings: dict[str, int]
    """Solver warnings by name, with how often."""


@dataclasses.dataclass(frozen=True)
class JointTravel:
    """How far a joint went when it was pushed to both ends."""

    joint: str
    limits: tuple[float, float]
    reached: tuple[float, float]

    @property
    def share(self) -> float:
        """Reached part of the range; 1 is all of it."""
        return (self.reached[1] - self.reached[0]) / (self.limits[1] - self.limits[0])


def load_model(scene_xml: Path) -> mujoco.MjModel:
    """Compile an MJCF or URDF file; raises `SceneError` with MuJoCo's reason."""
    if not Path(scene_xml).is_file():
        raise SceneError(f"{scene_xml} is not a file", "give the scene.xml that `isr run` wrote")
    try:
        return mujoco.MjModel.from_xml_path(str(scene_xml))
    except ValueError as error:
        raise SceneError(f"{scene_xml}: {error}", "export the scene again") from None


def load_freed(scene_xml: Path, anchored: Sequence[str]) -> mujoco.MjModel:
    """The scene with a free joint on every top-level body that has a mass and is not anchored."""
    if not Path(scene_xml).is_file():
        raise SceneError(f"{scene_xml} is not a file", "give the scene.xml that `isr run` wrote")
    try:
        spec = mujoco.MjSpec.from_file(str(scene_xml))
        model = spec.compile()
        held = {*anchored, *massless_bodies(model), *free_bodies(model)}
        for body in spec.worldbody.bodies:
            if body.name not in held:
                body.add_freejoint(name=f"{body.name}_freed")
        return spec.compile()
    except ValueError as error:
        raise SceneError(f"{scene_xml}: {error}", "export the scene again") from None


def free_bodies(model: mujoco.MjModel) -> tuple[str, ...]:
    """Names of the bodies with a free joint, in the order of the model."""
    rows = model.jnt_bodyid[model.jnt_type == mujoco.mjtJoint.mjJNT_FREE]
    return tuple(model.body(i).name for i in rows)


def static_bodies(model: mujoco.MjModel) -> tuple[str, ...]:
    """Names of the top-level bodies that are fixed to the world."""
    top = [i for i in range(1, model.nbody) if model.body_parentid[i] == 0]
    return tuple(model.body(i).name for i in top if model.body_jntnum[i] == 0)


def massless_bodies(model: mujoco.MjModel) -> tuple[str, ...]:
    """Names of the fixed bodies without mass: layout, which nothing can free."""
    return tuple(n for n in static_bodies(model) if model.body(n).mass[0] == 0)


def moving_joints(model: mujoco.MjModel) -> tuple[str, ...]:
    """Names of the hinges and slides."""
    kinds = {int(mujoco.mjtJoint.mjJNT_HINGE), int(mujoco.mjtJoint.mjJNT_SLIDE)}
    return tuple(model.joint(j).name for j in range(model.njnt) if int(model.jnt_type[j]) in kinds)


def joint_ranges(model: mujoco.MjModel) -> dict[str, float]:
    """Width of the range of every hinge and slide, radians or metres; 0 without limits."""
    ranges = {}
    for name in moving_joints(model):
        row = model.joint(name).id
        low, high = model.jnt_range[row]
        ranges[name] = float(high - low) if model.jnt_limited[row] else 0.0
    return ranges


def bounds(
    model: mujoco.MjModel, margin_m: float
) -> tuple[Float[np.ndarray, "3"], Float[np.ndarray, "3"]]:
    """Axis-aligned box about all geoms at the start, grown by a margin."""
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    if model.ngeom == 0:
        return np.full(3, -margin_m), np.full(3, margin_m)
    center, half = model.geom_aabb[:, :3], model.geom_aabb[:, 3:]
    turn = data.geom_xmat.reshape(-1, 3, 3)
    middle = data.geom_xpos + np.einsum("gij,gj->gi", turn, center)
    reach = np.einsum("gij,gj->gi", np.abs(turn), half)
    return (middle - reach).min(0) - margin_m, (middle + reach).max(0) + margin_m


def perturbed_start(
    model: mujoco.MjModel, rng: np.random.Generator, size_m: float
) -> Float[np.ndarray, " n"]:
    """Start positions with every free body moved and turned a little, and never downwards.

    Sideways by a normal draw of ``size_m``, up by the absolute value of one, turned about a random
    axis by an angle that moves a point 20 cm away by as much.
    """
    qpos = model.qpos0.copy()
    for joint in np.flatnonzero(model.jnt_type == mujoco.mjtJoint.mjJNT_FREE):
        at = model.jnt_qposadr[joint]
        step = rng.normal(0.0, size_m, 3)
        qpos[at : at + 3] += [step[0], step[1], abs(step[2])]
        turn, quat = np.zeros(4), np.zeros(4)
        axis = rng.normal(size=3)
        axis /= np.linalg.norm(axis)
        mujoco.mju_axisAngle2Quat(turn, axis, rng.normal(0.0, size_m / 0.2))
        mujoco.mju_mulQuat(quat, turn, qpos[at + 3 : at + 7])
        qpos[at + 3 : at + 7] = quat
    return qpos


def _at_start(model: mujoco.MjModel) -> mujoco.MjData:
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return data


def touches(model: mujoco.MjModel, data: mujoco.MjData | None = None) -> tuple[Touch, ...]:
    """Contacts of a state (by default of the start), one entry a pair of bodies, deepest first.

    MuJoCo sees no contact between two bodies that are both fixed to the world.
    """
    state = _at_start(model) if data is None else data
    pairs: dict[tuple[int, int], list[float]] = {}
    for contact in state.contact[: state.ncon]:
        a, b = sorted(int(model.geom_bodyid[g]) for g in contact.geom)
        pairs.setdefault((a, b), []).append(-float(contact.dist))
    found = [
        Touch(model.body(a).name, model.body(b).name, max(depths), len(depths))
        for (a, b), depths in pairs.items()
    ]
    return tuple(sorted(found, key=lambda t: (-t.depth_m, t.body_a, t.body_b)))


def simulate(
    model: mujoco.MjModel,
    duration_s: float,
    sample_s: float = 0.02,
    qpos: Float[np.ndarray, " n"] | None = None,
) -> Trajectory:
    """Let the scene move by itself and sample where its free bodies and joints are.

    Args:
        model: Of the scene.
        duration_s: Simulated time.
        sample_s: Time between samples, rounded to whole timesteps.
        qpos: Start; by default that of the model.
    """
    data = mujoco.MjData(model)
    if qpos is not None:
        data.qpos[:] = qpos
    mujoco.mj_forward(model, data)
    steps = max(1, round(sample_s / model.opt.timestep))
    count = max(1, round(duration_s / (steps * model.opt.timestep)))
    bodies, joints = free_bodies(model), moving_joints(model)
    rows = np.array([model.body(n).id for n in bodies], int)
    address = np.array([model.joint(n).qposadr[0] for n in joints], int)
    samples = [_sample(data, rows, address)]
    for _ in range(count):
        mujoco.mj_step(model, data, steps)
        mujoco.mj_kinematics(model, data)  # a step leaves the poses of before its integration
        samples.append(_sample(data, rows, address))
    position, quaternion, joint = (np.stack(part) for part in zip(*samples, strict=True))
    time_s = np.arange(count + 1) * steps * model.opt.timestep
    return Trajectory(time_s, bodies, position, quaternion, joints, joint, solver_warnings(data))


def _sample(data, rows: np.ndarray, address: np.ndarray) -> tuple[np.ndarray, ...]:
    return data.xipos[rows].copy(), data.xquat[rows].copy(), data.qpos[address].copy()


def solver_warnings(data: mujoco.MjData) -> dict[str, int]:
    """Warnings that MuJoCo counted, by name."""
    counts = {name: int(data.warning[i].number) for i, name in enumerate(WARNING_NAMES)}
    return {name: count for name, count in counts.items() if count}


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
    """
    row = model.body(body).id
    for _ in range(round(duration_s / model.opt.timestep)):
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        at = data.xpos[row] + data.xmat[row].reshape(3, 3) @ point
        data.qfrc_applied[:] = 0
        mujoco.mj_applyFT(model, data, force_n, np.zeros(3), at, row, data.qfrc_applied)
        mujoco.mj_step(model, data)
    data.qfrc_applied[:] = 0


def joint_travel(model: mujoco.MjModel, joint: str, patience_s: float = 4.0) -> JointTravel:
    """Push a joint to its lower, then to its upper end; how far it got.

    The generalized force overcomes the joint's friction and weight, and follows a damped spring
    towards a point beyond the end, for so long at most: a blocked joint shows a range not reached.
    A joint without ends is turned half round both ways.
    """
    info = model.joint(joint)
    data = _at_start(model)
    has_ends = bool(model.jnt_limited[info.id])
    low, high = (float(v) for v in info.range) if has_ends else (-np.pi, np.pi)
    reached = []
    for end, sign in ((low, -1.0), (high, 1.0)):
        _drive(model, data, info, end, sign * 0.1 * (high - low), patience_s)
        reached.append(float(data.qpos[info.qposadr[0]]))
    return JointTravel(joint, (low, high), (reached[0], reached[1]))


def _drive(model, data, info, end: float, beyond: float, patience_s: float) -> None:
    """Pull a joint to its end with a force that makes its motion that of a damped spring."""
    dof, address = int(info.dofadr[0]), int(info.qposadr[0])
    inertia = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, inertia)
    mass, rate = float(inertia[dof, dof]), 8.0  # 1/s: the end is reached in about half a second
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
