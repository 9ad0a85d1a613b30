"""Numbers of one settled set of bodies, from its trajectory."""

from __future__ import annotations

import numpy as np
from jaxtyping import Bool, Float

from ..borders.simulation import Trajectory
from .report import BodyMotion, JointMotion, Rates, VariantRates

PHYRECON_S, PHYRECON_DROP_M, PHYRECON_TILT = 200 / 60, 0.05, np.deg2rad(5.0)
MOLMO_SETTLE_S, MOLMO_MONITOR_S = 1.0, 3.0
MOLMO_DRIFT_M, MOLMO_PATH_M, MOLMO_JOINT_SHARE = 0.05, 0.10, 0.10
RATE_LIMITS_M = (0.01, 0.05, 0.20)


def geodesic_angle(a: Float[np.ndarray, "*n 4"], b: Float[np.ndarray, "*n 4"]) -> np.ndarray:
    """Angle of the turn between two unit quaternions, radians in [0, pi].

    2 atan2(|vector part|, |scalar part|) of a^-1 b: the arc cosine of the scalar part alone is
    blind below a milliradian.
    """
    scalar = np.abs(np.sum(a * b, -1))
    vector = a[..., :1] * b[..., 1:] - b[..., :1] * a[..., 1:] - np.cross(a[..., 1:], b[..., 1:])
    return np.asarray(2 * np.arctan2(np.linalg.norm(vector, axis=-1), scalar))


def tilt_angle(a: Float[np.ndarray, "*n 4"], b: Float[np.ndarray, "*n 4"]) -> np.ndarray:
    """Angle between where the world's up stood in the body then and now; yaw does not count."""
    up_a, up_b = _up_in_body(a), _up_in_body(b)
    return np.asarray(2 * np.arcsin(np.clip(np.linalg.norm(up_a - up_b, axis=-1) / 2, 0, 1)))


def _up_in_body(q: np.ndarray) -> np.ndarray:
    """Third row of the rotation matrix: R^T e_z."""
    w, x, y, z = np.moveaxis(q, -1, 0)
    return np.stack([2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)], -1)


def left_room(
    position_m: Float[np.ndarray, "*n 3"], low: np.ndarray, high: np.ndarray
) -> Bool[np.ndarray, "*n"]:
    """Whether a centre of mass is outside the room's bounds (or nowhere at all)."""
    return ~np.all((position_m >= low) & (position_m <= high), axis=-1)


def body_motions(
    path: Trajectory, low: np.ndarray, high: np.ndarray, at_s: tuple[float, float]
) -> tuple[BodyMotion, ...]:
    """Drift of every free body from t = 0 to two times, and how it got there."""
    drift = np.linalg.norm(path.position_m - path.position_m[0], axis=-1)
    turn = geodesic_angle(
        path.quaternion, np.broadcast_to(path.quaternion[:1], path.quaternion.shape)
    )
    steps = np.linalg.norm(np.diff(path.position_m, axis=0), axis=-1)
    gone = np.any(left_room(path.position_m, low, high), axis=0)
    first, last = (_row(path, t) for t in at_s)
    return tuple(
        BodyMotion(
            name=name,
            drift_early_m=float(drift[first, i]),
            drift_end_m=float(drift[last, i]),
            drop_end_m=float(path.position_m[0, i, 2] - path.position_m[last, i, 2]),
            turn_early_rad=float(turn[first, i]),
            turn_end_rad=float(turn[last, i]),
            path_m=float(steps[:last, i].sum()),
            left_room=bool(gone[i]),
        )
        for i, name in enumerate(path.bodies)
    )


def joint_motions(path: Trajectory, ranges: dict[str, float]) -> tuple[JointMotion, ...]:
    """Farthest that every joint strayed from where it began, and as a share of its range."""
    strayed = np.abs(path.joint_position - path.joint_position[0]).max(0)
    return tuple(
        JointMotion(name, float(s), float(s / ranges[name]) if ranges[name] > 0 else None)
        for name, s in zip(path.joints, strayed, strict=True)
    )


def rates(motions: tuple[BodyMotion, ...], failed: int) -> Rates | None:
    """Shares of bodies that drifted less than each limit; failed ones count as not."""
    total = len(motions) + failed
    if total == 0:
        return None
    ends = [np.inf if m.left_room else m.drift_end_m for m in motions]
    within = [sum(d < limit for d in ends) / total for limit in RATE_LIMITS_M]
    return Rates(*within, total=total)


def variant_rates(path: Trajectory, ranges: dict[str, float], failed: int) -> VariantRates:
    """The criteria of PhyRecon and MolmoSpaces, on this joint simulation; None if too short."""
    end = float(path.time_s[-1]) + 1e-9
    bodies = len(path.bodies) + failed
    phyrecon = molmo_bodies = molmo_joints = None
    if bodies and end >= PHYRECON_S:
        phyrecon = float(_phyrecon(path).sum() / bodies)
    if end >= MOLMO_SETTLE_S + MOLMO_MONITOR_S:
        still, joints = _molmo(path, ranges)
        molmo_bodies = float(still.sum() / bodies) if bodies else None
        molmo_joints = float(joints.mean()) if len(joints) else None
    return VariantRates(phyrecon, molmo_bodies, molmo_joints)


def _phyrecon(path: Trajectory) -> np.ndarray:
    row = _row(path, PHYRECON_S)
    drop = path.position_m[0, :, 2] - path.position_m[row, :, 2]
    tilt = tilt_angle(path.quaternion[0], path.quaternion[row])
    return (drop < PHYRECON_DROP_M) & (tilt < PHYRECON_TILT)


def _molmo(path: Trajectory, ranges: dict[str, float]) -> tuple[np.ndarray, np.ndarray]:
    a, b = _row(path, MOLMO_SETTLE_S), _row(path, MOLMO_SETTLE_S + MOLMO_MONITOR_S)
    position = path.position_m[a : b + 1]
    drift = np.linalg.norm(position[-1] - position[0], axis=-1)
    length = np.linalg.norm(np.diff(position, axis=0), axis=-1).sum(0)
    limits = np.array([ranges[n] for n in path.joints])
    moved = np.abs(path.joint_position[a : b + 1] - path.joint_position[a]).max(0)
    allowed = np.where(limits > 0, MOLMO_JOINT_SHARE * limits, np.inf)
    return (drift < MOLMO_DRIFT_M) & (length < MOLMO_PATH_M), moved < allowed


def _row(path: Trajectory, time_s: float) -> int:
    """Sample nearest to a time."""
    return int(np.argmin(np.abs(path.time_s - time_s)))
