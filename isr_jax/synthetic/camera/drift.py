"""What tracking makes of a camera's way: drift that grows with the way, and jitter."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float
from scipy.spatial.transform import Rotation

from ...config import PoseNoise

NO_DRIFT = PoseNoise()
"""Poses as they are."""


def tracked_path(
    T_world_camera: Float[np.ndarray, "frames 4 4"], noise: PoseNoise, seed: int
) -> Float[np.ndarray, "frames 4 4"]:
    """The poses that a tracker gives, float64; the first is the true one but for its jitter.

    Each step of the way is taken over in the heading that is believed so far:

        p'_i = p'_(i-1) + Rz(e_(i-1)) (p_i - p_(i-1)) + n_i,   n_i ~ N(0, a^2 d_i) an axis,
        R'_i = Rz(e_i) R_i,   e_i = e_(i-1) + m_i,             m_i ~ N(0, b^2 t_i)

    with d_i the length of the step in metres, t_i its turn in radians, a = ``drift_m`` and b =
    ``drift_rad``: random walks whose deviation grows with the root of the way, however many frames
    it is filmed in, as visual odometry errs (Sturm et al., IROS 2012, measure it per metre and per
    second for that reason). Only the heading drifts: gravity shows what is upright. The jitter of
    each frame, Gaussian in place and about any axis, comes on top and is forgotten.

    Args:
        T_world_camera: True poses.
        noise: Deviations.
        seed: Of the drift.
    """
    rng = np.random.default_rng([seed, 4])
    true = np.asarray(T_world_camera, np.float64)
    count = len(true)
    steps = np.diff(true[:, :3, 3], axis=0)
    turns = Rotation.from_matrix(true[:-1, :3, :3]).inv() * Rotation.from_matrix(true[1:, :3, :3])
    length, turn = np.linalg.norm(steps, axis=1), turns.magnitude()
    slip = noise.drift_m * np.sqrt(length)[:, None] * rng.standard_normal((count - 1, 3))
    bend = noise.drift_rad * np.sqrt(turn) * rng.standard_normal(count - 1)
    heading = np.concatenate([[0.0], np.cumsum(bend)])
    about_up = Rotation.from_rotvec(heading[:, None] * [0.0, 0.0, 1.0])
    believed = about_up[:-1].apply(steps) + slip
    shake = Rotation.from_rotvec(noise.jitter_rad * rng.standard_normal((count, 3)))
    turned = about_up * Rotation.from_matrix(true[:, :3, :3]) * shake
    given = true.copy()
    given[:, :3, :3] = turned.as_matrix()
    given[1:, :3, 3] = true[0, :3, 3] + np.cumsum(believed, axis=0)
    given[:, :3, 3] += noise.jitter_m * rng.standard_normal((count, 3))
    return given if noise != NO_DRIFT else true
