"""A furnished box of a room whose depth is known in closed form, written in every layout."""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path

import cv2
import numpy as np

WIDTH, HEIGHT, FOCAL = 160, 120, 140.0
TABLE_HEIGHT_M = 0.7
ROOM_M = np.array([4.0, 3.0, 2.5])
_FLIP = np.diag([1.0, -1.0, -1.0, 1.0])
# A frame of the recording whose down is far from any axis.
_TURN = cv2.Rodrigues(np.array([0.9, -0.5, 0.7]))[0]
T_DATASET_WORLD = np.eye(4)
T_DATASET_WORLD[:3, :3], T_DATASET_WORLD[:3, 3] = _TURN, (0.3, -1.2, 0.8)
GRAVITY = -_TURN[:, 2]


@dataclasses.dataclass(frozen=True)
class Shot:
    """One frame: exact depth in metres and the true pose."""

    depth_m: np.ndarray
    color: np.ndarray
    T_world_camera: np.ndarray


def look_at(eye, target) -> np.ndarray:
    """T_world_camera of an OpenCV camera held level."""
    forward = np.asarray(target, float) - eye
    forward /= np.linalg.norm(forward)
    right = np.cross(forward, [0, 0, 1.0])
    right /= np.linalg.norm(right)
    T = np.eye(4)
    T[:3, :3] = np.stack([right, np.cross(forward, right), forward], 1)
    T[:3, 3] = eye
    return T


def depth_of(T: np.ndarray) -> np.ndarray:
    """Depth of the room, its floor at z = 0, with a table of 1.2 x 0.8 m in it."""
    v, u = np.mgrid[:HEIGHT, :WIDTH]
    rays = np.stack([(u - WIDTH / 2) / FOCAL, (v - HEIGHT / 2) / FOCAL, np.ones(u.shape)], -1)
    direction, origin = rays @ T[:3, :3].T, T[:3, 3]
    best = np.full(u.shape, np.inf)
    with np.errstate(divide="ignore", invalid="ignore"):
        for axis, at in ((2, 0.0), (2, 2.5), (0, -2.0), (0, 2.0), (1, -1.5), (1, 1.5)):
            t = (at - origin[axis]) / direction[..., axis]
            best = np.where((t > 0) & (t < best), t, best)
        t = (TABLE_HEIGHT_M - origin[2]) / direction[..., 2]
        hit = origin + t[..., None] * direction
        on_top = (np.abs(hit[..., 0]) < 0.6) & (np.abs(hit[..., 1]) < 0.4) & (t > 0)
    return np.where(on_top & (t < best), t, best).astype(np.float32)


def shots(count: int = 12) -> list[Shot]:
    """A walk around the table, looking at it."""
    rng = np.random.default_rng(0)
    found = []
    for turn in np.linspace(0, 1.8 * np.pi, count):
        eye = np.array([1.6 * np.cos(turn), 1.2 * np.sin(turn), 1.5 + 0.1 * np.sin(3 * turn)])
        T = look_at(eye, (0.3 * np.sin(turn), 0, 0.4))
        color = rng.integers(0, 255, (HEIGHT, WIDTH, 3), np.uint8)
        found.append(Shot(depth_of(T), color, T))
    return found


def stored_pose(T_world_camera: np.ndarray, convention: str) -> np.ndarray:
    """The pose in the recording's frame, as a recorder of this convention would write it."""
    T = T_DATASET_WORLD @ T_world_camera
    if convention.startswith("opengl"):
        T = T @ _FLIP
    return np.linalg.inv(T) if convention.endswith("world_to_camera") else T


def write_depth(path: Path, depth_m: np.ndarray, units: float) -> None:
    cv2.imwrite(str(path), np.round(depth_m * units).astype(np.uint16))


def write_plain(
    path: Path,
    frames: list[Shot],
    *,
    convention: str = "opencv_camera_to_world",
    with_gravity: bool = True,
    units: float = 1000.0,
    **changes,
) -> Path:
    for folder in ("rgb", "depth", "poses"):
        (path / folder).mkdir(parents=True)
    for i, shot in enumerate(frames):
        cv2.imwrite(str(path / f"rgb/{i:06d}.jpg"), shot.color[..., ::-1])
        write_depth(path / f"depth/{i:06d}.png", shot.depth_m, units)
        np.savetxt(path / f"poses/{i:06d}.txt", stored_pose(shot.T_world_camera, convention))
    data = {
        "fx": FOCAL,
        "fy": FOCAL,
        "cx": WIDTH / 2,
        "cy": HEIGHT / 2,
        "width": WIDTH,
        "height": HEIGHT,
        "depth_scale": 1000.0,
        **({"gravity": GRAVITY.tolist()} if with_gravity else {}),
        **changes,
    }
    (path / "intrinsics.json").write_text(json.dumps(data))
    return path


def write_7scenes(path: Path, frames: list[Shot]) -> Path:
    path.mkdir(parents=True)
    for i, shot in enumerate(frames):
        stem = f"frame-{i:06d}"
        cv2.imwrite(str(path / f"{stem}.color.png"), shot.color[..., ::-1])
        write_depth(path / f"{stem}.depth.png", shot.depth_m, 1000.0)
        pose = stored_pose(shot.T_world_camera, "opencv_camera_to_world")
        np.savetxt(path / f"{stem}.pose.txt", pose)
    K = [[FOCAL, 0, WIDTH / 2], [0, FOCAL, HEIGHT / 2], [0, 0, 1]]
    np.savetxt(path / "camera-intrinsics.txt", K)
    np.savetxt(path / "gravity-direction.txt", GRAVITY)
    return path


def write_tum(path: Path, frames: list[Shot]) -> Path:
    """Depth comes 5 ms after colour; poses at 100 Hz, between which it falls."""
    (path / "rgb").mkdir(parents=True)
    (path / "depth").mkdir()
    color, depth, truth = ["# color images"], ["# depth maps"], ["# ground truth"]
    for i, shot in enumerate(frames):
        t = 1000.0 + i / 10
        cv2.imwrite(str(path / f"rgb/{t:.6f}.png"), shot.color[..., ::-1])
        write_depth(path / f"depth/{t + 0.005:.6f}.png", shot.depth_m, 5000.0)
        color.append(f"{t:.6f} rgb/{t:.6f}.png")
        depth.append(f"{t + 0.005:.6f} depth/{t + 0.005:.6f}.png")
        T = stored_pose(shot.T_world_camera, "opencv_camera_to_world")
        for shift, sign in ((-0.003, 1.0), (0.007, -1.0)):  # q and -q are one rotation
            moved = T[:3, 3] + (shift - 0.002) * np.array([1.0, 0.5, 0.2])
            row = [*moved, *(sign * quaternion_xyzw(T[:3, :3]))]
            truth.append(f"{t + 0.005 + shift - 0.002:.6f} " + " ".join(f"{v:.9f}" for v in row))
    for name, lines in (("rgb", color), ("depth", depth), ("groundtruth", truth)):
        (path / f"{name}.txt").write_text("\n".join(lines) + "\n")
    (path / "calibration.txt").write_text(f"{FOCAL} {FOCAL} {WIDTH / 2} {HEIGHT / 2}\n")
    return path


def quaternion_xyzw(R: np.ndarray) -> np.ndarray:
    vector = cv2.Rodrigues(R)[0].ravel()
    angle = np.linalg.norm(vector)
    axis = vector / angle if angle > 0 else vector
    return np.array([*(np.sin(angle / 2) * axis), np.cos(angle / 2)])
