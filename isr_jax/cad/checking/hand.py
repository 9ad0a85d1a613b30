"""Border: a hand that opens a joint by a bounded force at its handle (mujoco)."""

# MuJoCo's compiled names have no stubs.
# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

import dataclasses
from collections.abc import Callable

import mujoco
import numpy as np

from .settings import CheckSettings

FLOOR = "the floor"
Contacts = dict[tuple[str, str], float]
"""Depth of the deepest contact (m) between two links, or a link and `FLOOR`."""
_ContactsOf = Callable[[mujoco.MjData], Contacts]
_RATE_PER_S = 25.0
"""Stiffness of the hand: what it lags behind dies out in some 0.1 s."""
_LEAST_ARM_M = 1e-3
"""Nearer to its axis nothing turns a joint."""


@dataclasses.dataclass(frozen=True)
class Travel:
    """How far a joint went under the hand, and what happened meanwhile."""

    reached: tuple[float, float]
    """Radians or metres."""
    share: float
    """Reached part of the range."""
    force_n: float
    """Largest force of the hand."""
    tilt_rad: float
    """Farthest that the base tilted."""
    touched: tuple[str, str] | None
    """The links that touched deepest, if any."""
    depth_m: float
    at: float
    """Where the joint was at that contact."""
    on_floor: tuple[str, ...]
    """Links other than the base that touched the floor."""


class Hand:
    """Pulls at a point of a link along the motion of the joint.

    The force follows a point that moves from closed to open within the settings' time, smoothly:
    tau = M (w^2 (q_ref - q) + 2 w (v_ref - v)) + friction + damping + weight about the joint, as a
    force tau / |dp/dq| along the handle's own path dp/dq, cut off at the settings' bound.
    """

    def __init__(
        self,
        model: mujoco.MjModel,
        joint: str,
        body: str,
        point: np.ndarray,
        settings: CheckSettings,
    ) -> None:
        info = model.joint(joint)
        self._model, self._settings = model, settings
        self._dof, self._address = int(info.dofadr[0]), int(info.qposadr[0])
        self._row = int(info.id)
        self._slides = int(model.jnt_type[self._row]) == int(mujoco.mjtJoint.mjJNT_SLIDE)
        self._body, self._point = model.body(body).id, np.asarray(point, np.float64)
        self._friction = float(model.dof_frictionloss[self._dof])
        self._damping = float(model.dof_damping[self._dof].ravel()[0])

    def travel(self, low: float, high: float, base: str, contacts: _ContactsOf) -> Travel:
        """Move the joint from closed to each end of its range that is not closed itself."""
        runs = [_Run(), _Run()]
        for run, end in zip(runs, (low, high), strict=True):
            if end != 0:
                self._pull(end, run, base, contacts)
        reached = (runs[0].position, runs[1].position)
        worst = max(runs, key=lambda run: run.depth_m)
        return Travel(
            reached=reached,
            share=(min(reached[1], high) - max(reached[0], low)) / (high - low),
            force_n=max(run.force_n for run in runs),
            tilt_rad=max(run.tilt_rad for run in runs),
            touched=worst.touched,
            depth_m=worst.depth_m,
            at=worst.at,
            on_floor=tuple(sorted(runs[0].on_floor | runs[1].on_floor)),
        )

    def _pull(self, end: float, run: _Run, base: str, contacts: _ContactsOf) -> None:
        model, settings, data = self._model, self._settings, mujoco.MjData(self._model)
        mujoco.mj_forward(model, data)
        inertia = np.zeros((model.nv, model.nv))
        mujoco.mj_fullM(model, data, inertia)
        mass, root = float(inertia[self._dof, self._dof]), model.body(base).id
        turns = 0.0 if self._slides else abs(end) / (np.pi / 2)
        duration_s = settings.opening_s * max(1.0, turns)
        for step in range(round((duration_s + settings.patience_s) / settings.timestep_s)):
            mujoco.mj_step1(model, data)
            position = float(data.qpos[self._address])
            if not np.isfinite(position):
                break
            run.position = max(run.position, position) if end > 0 else min(run.position, position)
            run.note(contacts(data), position, float(data.xmat[root][8]))
            if (position - end) * np.sign(end) >= -1e-4 * abs(end):
                break
            share = min(1.0, step * settings.timestep_s / duration_s)
            wish, speed = smooth(share)
            lag = wish * end * 1.02 - position
            rush = speed * end / duration_s - float(data.qvel[self._dof])
            drive = mass * _RATE_PER_S * (_RATE_PER_S * lag + 2 * rush)
            drive += np.sign(end) * self._friction + self._damping * float(data.qvel[self._dof])
            self._apply(data, drive + float(data.qfrc_bias[self._dof]), run)
            mujoco.mj_step2(model, data)

    def _apply(self, data: mujoco.MjData, drive: float, run: _Run) -> None:
        """Turn the wanted force or moment about the joint into a force at the handle."""
        at = data.xpos[self._body] + data.xmat[self._body].reshape(3, 3) @ self._point
        axis = data.xaxis[self._row]
        path = axis if self._slides else np.cross(axis, at - data.xanchor[self._row])
        arm = float(np.linalg.norm(path))
        data.qfrc_applied[:] = 0
        if arm < _LEAST_ARM_M:
            return
        bound = self._settings.force_n
        force = float(np.clip(drive / arm, -bound, bound))
        run.force_n = max(run.force_n, abs(force))
        along = force * path / arm
        mujoco.mj_applyFT(self._model, data, along, np.zeros(3), at, self._body, data.qfrc_applied)


@dataclasses.dataclass
class _Run:
    """Extremes of one pull."""

    position: float = 0.0
    force_n: float = 0.0
    tilt_rad: float = 0.0
    touched: tuple[str, str] | None = None
    depth_m: float = 0.0
    at: float = 0.0
    on_floor: set[str] = dataclasses.field(default_factory=set)

    def note(self, contacts: Contacts, at: float, upright: float) -> None:
        self.tilt_rad = max(self.tilt_rad, float(np.arccos(np.clip(upright, -1, 1))))
        for pair, depth in contacts.items():
            if FLOOR in pair:
                self.on_floor |= {*pair} - {FLOOR}
            elif depth > self.depth_m:
                self.touched, self.depth_m, self.at = pair, depth, at


def smooth(share: float) -> tuple[float, float]:
    """Part of the way (0..1) and its rate after ``share`` of the time: least jerk, 10 s^3 - ..."""
    s = share
    return s**3 * (10 - 15 * s + 6 * s * s), 30 * s * s * (1 - s) ** 2
