"""Which pose convention holds: depth of one frame, moved to another, must lie on its depth.

On the host: a few pairs of frames, a few thousand points each.
"""

from __future__ import annotations

import numpy as np
from jaxtyping import Bool, Float

from ..types import Camera
from .conventions import CONVENTIONS, PoseConvention, from_camera_to_dataset, to_camera_to_dataset

_STEP_PX = 8
_MIN_OVERLAP = 0.1
"""Share of the points that must land inside the other image on valid depth to say anything."""
_MIN_TURN_RAD = np.deg2rad(8.0)
_MIN_MOVE_M = 0.15
HOLDS_M = 0.05
"""A convention holds when depth reprojects to this; noise and drift alone give 4-12 mm on a
Kinect. Nothing is said of frames too far apart to see the same."""
_WORSE_FACTOR = 2.0


def reprojection_error_m(
    depth_a: Float[np.ndarray, "height width"],
    depth_b: Float[np.ndarray, "height width"],
    T_b_a: Float[np.ndarray, "4 4"],
    camera: Camera,
) -> float:
    """Median distance along the axis of b between a's moved points and b's depth; inf if apart."""
    v, u = np.mgrid[
        _STEP_PX // 2 : camera.height : _STEP_PX, _STEP_PX // 2 : camera.width : _STEP_PX
    ]
    z = depth_a[v, u]
    seen = z > 0
    v, u, z = v[seen], u[seen], z[seen].astype(np.float64)
    points = np.stack([(u - camera.cx) / camera.fx * z, (v - camera.cy) / camera.fy * z, z], -1)
    x, y, depth = (points @ T_b_a[:3, :3].T + T_b_a[:3, 3]).T
    ahead = depth > 0.05
    safe = np.where(ahead, depth, 1.0)
    column = np.rint(camera.fx * x / safe + camera.cx)
    row = np.rint(camera.fy * y / safe + camera.cy)
    inside = ahead & (column >= 0) & (column < camera.width) & (row >= 0) & (row < camera.height)
    there = depth_b[row[inside].astype(int), column[inside].astype(int)]
    gaps = np.abs(there - depth[inside])[there > 0]
    return float(np.median(gaps)) if len(gaps) >= max(_MIN_OVERLAP * len(z), 50) else np.inf


def moved_pair(
    poses: Float[np.ndarray, "frames 4 4"], usable: Bool[np.ndarray, " frames"], first: int
) -> int | None:
    """The first later frame that turned by 8 degrees or moved by 15 cm; None without one.

    Both angles and, for small turns, distances are the same under every convention.
    """
    a, later = poses[first], poses[first + 1 :]
    cosine = (np.einsum("ij,nij->n", a[:3, :3], later[:, :3, :3]) - 1) / 2
    moved = np.linalg.norm(later[:, :3, 3] - a[:3, 3], axis=1) > _MIN_MOVE_M
    found = np.flatnonzero(usable[first + 1 :] & (moved | (cosine < np.cos(_MIN_TURN_RAD))))
    return first + 1 + int(found[0]) if len(found) else None


def convention_errors_m(
    pairs: list[tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]],
    camera: Camera,
    declared: PoseConvention,
) -> dict[PoseConvention, float]:
    """Median reprojection error of each of `CONVENTIONS` over pairs of frames.

    Args:
        pairs: (depth a, depth b, pose a, pose b), poses converted from ``declared``.
        camera: Of the depth images.
        declared: The convention that the poses were read with.
    """
    size = (camera.height, camera.width)
    pairs = [pair for pair in pairs if pair[0].shape == pair[1].shape == size]
    errors: dict[PoseConvention, float] = {}
    for convention in CONVENTIONS:
        found = []
        for depth_a, depth_b, pose_a, pose_b in pairs:
            a, b = (
                to_camera_to_dataset(from_camera_to_dataset(p, declared), convention)
                for p in (pose_a, pose_b)
            )
            found.append(reprojection_error_m(depth_a, depth_b, np.linalg.inv(b) @ a, camera))
        errors[convention] = float(np.median(found)) if found else np.inf
    return errors


def holding(
    errors_m: dict[PoseConvention, float], declared: PoseConvention
) -> PoseConvention | None:
    """The convention that holds; None where none does, or nothing can be said.

    The declared one is kept unless another is clearly better: of frames that hardly turn, all
    conventions reproject much alike.
    """
    best = min(errors_m, key=lambda name: errors_m[name])
    if errors_m[best] > HOLDS_M:
        return None
    alike = errors_m[declared] <= max(HOLDS_M, _WORSE_FACTOR * errors_m[best])
    return declared if alike else best
