"""From the dataset's frame to the world: z up, the floor at z = 0.

About 30 frames spread over the sequence give points with normals. Gravity is the recording's or,
where it gives none, the direction that most normals are parallel or perpendicular to, near the
cameras' mean down direction. The floor is the lowest level surface of enough area, not the
largest: a table seen from near outweighs the floor. On the host: it runs once a sequence.
"""

from __future__ import annotations

import dataclasses

import numpy as np
from jaxtyping import Bool, Float

from ..errors import SequenceError
from ..geometry import smallest_rotation
from ..types import Camera

_COLUMNS = 80
"""Depth is averaged over square blocks, so many across: single pixels' normals are noise."""
_FLAT_RATIO = 0.05
"""A block or a step between blocks with a larger relative change of depth is an edge."""
_LEVEL_COSINE = np.cos(np.deg2rad(20.0))
"""Normals this near the vertical are level: Kinect noise at 3 m turns them by up to 15 degrees."""
_SLAB_M = 0.025
_CELL_M = 0.1
_MIN_AREA_M2 = 0.3
_MIN_AREA_SHARE = 0.05
"""And of the largest level surface: keeps reflections below the floor out of large rooms."""
_LEVELLED_DEG = (0.7, 5.0)
"""A given gravity this far off what floors and walls say is corrected by them: below, the estimate
is no better; above, one of the two is wrong, and `isr inspect` says so."""
_MIN_LEAN = 0.3
"""Mean of the cameras' down directions; shorter, the camera rolled and says nothing."""


@dataclasses.dataclass(frozen=True, eq=False)
class Cloud:
    """Points with normals towards the camera, dataset frame, of all sampled frames."""

    points: Float[np.ndarray, "points 3"]
    normals: Float[np.ndarray, "points 3"]
    camera_down: Float[np.ndarray, "frames 3"]
    """The y axis of each camera."""


@dataclasses.dataclass(frozen=True, eq=False)
class WorldFrame:
    """How the world lies in the dataset, and how well that is known."""

    T_world_dataset: Float[np.ndarray, "4 4"]
    gravity: Float[np.ndarray, "3"]
    """Unit, down, dataset frame."""
    floor_area_m2: float
    """Area of level surface seen at floor height."""
    levels: tuple[tuple[float, float], ...]
    """(height above the floor in metres, area in m^2) of every level surface, from below."""


def sample_cloud(
    depth_m: Float[np.ndarray, "height width"],
    camera: Camera,
    T_dataset_camera: Float[np.ndarray, "4 4"],
) -> tuple[Float[np.ndarray, "points 3"], Float[np.ndarray, "points 3"]]:
    """Points and unit normals of one frame, one point per block of pixels (8x8 in VGA)."""
    side = max(1, depth_m.shape[1] // _COLUMNS)
    mean, valid = _block_means(depth_m, side)
    v, u = np.indices(mean.shape) * side + (side - 1) / 2
    x, y = (u - camera.cx) / camera.fx * mean, (v - camera.cy) / camera.fy * mean
    points = np.stack([x, y, mean], -1)
    right, below = points[1:-1, 2:] - points[1:-1, :-2], points[2:, 1:-1] - points[:-2, 1:-1]
    normals = np.cross(below, right)  # towards the camera, since v grows downwards
    length = np.linalg.norm(normals, axis=-1, keepdims=True)
    steps = np.maximum(np.abs(right[..., 2]), np.abs(below[..., 2]))
    inner = (slice(1, -1), slice(1, -1))
    keep = valid[inner] & valid[1:-1, 2:] & valid[1:-1, :-2] & valid[2:, 1:-1] & valid[:-2, 1:-1]
    keep &= (steps < 2 * _FLAT_RATIO * mean[inner]) & (length[..., 0] > 0)
    R, t = T_dataset_camera[:3, :3], T_dataset_camera[:3, 3]
    return points[inner][keep] @ R.T + t, (normals[keep] / length[keep]) @ R.T


def _block_means(
    depth_m: Float[np.ndarray, "height width"], side: int
) -> tuple[Float[np.ndarray, "rows columns"], Bool[np.ndarray, "rows columns"]]:
    """Mean depth of each full block, and whether it is flat and mostly has returns."""
    rows, columns = depth_m.shape[0] // side, depth_m.shape[1] // side
    cut = depth_m[: rows * side, : columns * side]
    blocks = cut.reshape(rows, side, columns, side).swapaxes(1, 2)
    blocks = blocks.reshape(rows, columns, -1).astype(np.float64)
    returns = blocks > 0
    count = returns.sum(-1)
    mean = blocks.sum(-1) / np.maximum(count, 1)
    low = np.where(returns, blocks, np.inf).min(-1)
    flat = blocks.max(-1) - low < 2 * _FLAT_RATIO * mean
    return mean, (count * 2 > side**2) & flat


def find_world_frame(cloud: Cloud, gravity: Float[np.ndarray, "3"] | None) -> WorldFrame:
    """T_world_dataset: the smallest rotation that brings gravity to -z, then the floor to z = 0.

    Args:
        cloud: Points of frames spread over the sequence.
        gravity: Unit vector, down, dataset frame, levelled by floors and walls where it is a few
            degrees off them (things must stand on the floor that was seen); None: it is estimated.

    Raises:
        SequenceError: no floor was seen, or gravity cannot be estimated.
    """
    down = estimate_gravity(cloud) if gravity is None else _levelled(cloud, gravity)
    R = smallest_rotation(down, np.array([0.0, 0.0, -1.0]))
    points, up = cloud.points @ R.T, cloud.normals @ R[2]
    heights, areas = level_surfaces(points[up > _LEVEL_COSINE])
    if len(heights) == 0:
        raise SequenceError(
            "no level, up-facing surface was seen in the sampled frames, so there is no floor",
            "check the pose convention and the gravity with `isr inspect`",
        )
    T = np.eye(4)
    T[:3, :3], T[2, 3] = R, -heights[0]
    levels = tuple((float(h - heights[0]), float(a)) for h, a in zip(heights, areas, strict=True))
    return WorldFrame(T, down, float(areas[0]), levels)


def _levelled(cloud: Cloud, gravity: Float[np.ndarray, "3"]) -> Float[np.ndarray, "3"]:
    try:
        estimate = estimate_gravity(cloud)
    except SequenceError:  # nothing to correct it by
        return gravity
    low, high = _LEVELLED_DEG
    return estimate if low < degrees_between(gravity, estimate) < high else gravity


def degrees_between(a: Float[np.ndarray, "3"], b: Float[np.ndarray, "3"]) -> float:
    """Angle between two unit vectors."""
    return float(np.rad2deg(np.arctan2(np.linalg.norm(np.cross(a, b)), a @ b)))


def level_surfaces(
    points: Float[np.ndarray, "points 3"],
) -> tuple[Float[np.ndarray, " levels"], Float[np.ndarray, " levels"]]:
    """Heights and areas of the level surfaces that up-facing points lie on, from below.

    A surface is a local maximum, over height, of the number of 10 cm cells that points within
    2.5 cm occupy: area, unlike the number of points, does not favour what is near the camera.
    """
    if len(points) == 0:
        return np.zeros(0), np.zeros(0)
    low = points[:, 2].min()
    step = np.floor((points[:, 2] - low) / _SLAB_M).astype(np.int64)
    cells = np.floor((points[:, :2] - points[:, :2].min(0)) / _CELL_M).astype(np.int64)
    flat = cells[:, 0] * (cells[:, 1].max() + 1) + cells[:, 1]
    top = int(step.max())
    area = np.zeros(top + 1)
    for s in range(top + 1):
        near = np.abs(step - s) <= 1
        area[s] = len(np.unique(flat[near])) * _CELL_M**2
    floor_area = max(_MIN_AREA_M2, _MIN_AREA_SHARE * float(area.max()))
    padded = np.pad(area, 2, constant_values=-1)
    around = np.stack([padded[i : i + top + 1] for i in (0, 1, 3, 4)])
    # >= below and > above keep one of several equal neighbours.
    peak = (area >= floor_area) & (area >= around[2:].max(0)) & (area > around[:2].max(0))
    slabs = np.flatnonzero(peak)
    heights = np.array([np.median(points[np.abs(step - s) <= 1, 2]) for s in slabs])
    return heights.reshape(-1), area[slabs]


def estimate_gravity(cloud: Cloud) -> Float[np.ndarray, "3"]:
    """The direction that normals vote for: parallel (floor, tables) or perpendicular (walls).

    Searches a grid of directions within 60 degrees of the cameras' mean down direction, then
    refines: with inlier normals n, down = argmin sum_perpendicular (n . g)^2 -
    sum_parallel (n . g)^2, the eigenvector of the least eigenvalue.

    Raises:
        SequenceError: the cameras' down directions cancel.
    """
    mean = cloud.camera_down.mean(0)
    lean = float(np.linalg.norm(mean))
    if lean < _MIN_LEAN or len(cloud.normals) < 100:
        raise SequenceError(
            f"gravity cannot be estimated: the cameras' down directions cancel (mean {lean:.2f})",
            "give it: gravity-direction.txt (7scenes) or gravity in intrinsics.json (plain)",
        )
    down = _best_direction(cloud.normals, mean / lean)
    for degrees in (10.0, 6.0, 4.0, 3.0, 3.0):
        cosine = cloud.normals @ down
        parallel = cloud.normals[np.abs(cosine) > np.cos(np.deg2rad(degrees))]
        across = cloud.normals[np.abs(cosine) < np.sin(np.deg2rad(degrees))]
        if len(parallel) + len(across) < 3:
            break
        _, vectors = np.linalg.eigh(across.T @ across - parallel.T @ parallel)
        down = vectors[:, 0] * np.sign(vectors[:, 0] @ down)
    return down


def _best_direction(
    normals: Float[np.ndarray, "points 3"], start: Float[np.ndarray, "3"]
) -> Float[np.ndarray, "3"]:
    """The grid direction near ``start`` with the most votes; walls count half."""
    count = 3000  # about 4 degrees apart on the whole sphere
    i = np.arange(count) + 0.5
    z, turn = 1 - 2 * i / count, np.pi * (1 + 5**0.5) * i
    ring = np.sqrt(1 - z * z)
    grid = np.stack([ring * np.cos(turn), ring * np.sin(turn), z], -1)
    grid = np.concatenate([start[None], grid[grid @ start > 0.5]])
    cosine = np.abs(normals[:: max(1, len(normals) // 20000)] @ grid.T)
    window = np.deg2rad(5.0)
    votes = (cosine > np.cos(window)).sum(0) + 0.5 * (cosine < np.sin(window)).sum(0)
    return grid[np.argmax(votes)]
